"""Where the workflow, its scenes and its data lie: inside an installed package, or in the
checkout.
"""

import importlib.util
import sys
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]
ROOT = _PACKAGE / "_bundle" if (_PACKAGE / "_bundle").is_dir() else _PACKAGE.parent
"""Folder that holds `Snakefile`, `workflow/` and `config/`."""


def bind_workflow() -> None:
    """Let `import workflow.…` find the package that lies here, also in the process of a host that
    has a folder `workflow` of its own.

    A package `workflow` that the host has imported before stays, and finds our modules, too.

    Raises
    ------
    SystemExit : the host has imported a module in whose place ours must be.
    """
    folder = ROOT / "workflow"
    package = sys.modules.get("workflow")
    if package is None:
        spec = importlib.util.spec_from_file_location(
            "workflow", folder / "__init__.py", submodule_search_locations=[str(folder)]
        )
        assert spec is not None
        assert spec.loader is not None
        package = importlib.util.module_from_spec(spec)
        sys.modules["workflow"] = package
        spec.loader.exec_module(package)
        return
    if str(folder) in package.__path__:
        return
    for file in folder.glob("*/__init__.py"):
        name = f"workflow.{file.parent.name}"
        if name in sys.modules:
            raise SystemExit(
                f"ERROR {name}: the host workflow has imported a module of this name, which"
                " Asperity has, too; give it another name"
            )
    package.__path__ = [str(folder), *package.__path__]
