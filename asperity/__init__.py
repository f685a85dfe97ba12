"""Contact mechanics of rough surfaces from atoms to device: the names to start from, and the
command `asperity`.

From a scan to a switch::

    import asperity as asp

    film = asp.Film(["first.gwy", "second.ibw"], tip_nm=8)  # or a folder, or a container
    print("\\n".join(film.doubts))
    material = {"e_star": 75.0, "h_macro": 1.3}  # GPa; the rest: the paper's Table 1
    contact = film.press(material, load_nN=7000)
    contact.plot()
    switch = contact.switch(asp.DeviceSettings(gap_um=2.0))
    print(switch, switch.release_V)

Lengths are in nm, forces in nN, pressures and moduli in GPa; `help()` of every name states its
units.
"""

import os
import sys

if os.path.basename(sys.argv[0]) in ("asperity", "-m"):
    # the command: an empty or relative entry of PYTHONPATH is the working folder, whose modules
    # would be taken for Python's own by the imports below; the folder of this package stays
    _given = os.environ.get("PYTHONPATH")
    _unsafe = (
        {os.path.abspath(path) for path in _given.split(os.pathsep) if not os.path.isabs(path)}
        if _given
        else set()
    )
    _unsafe -= {os.path.dirname(os.path.dirname(os.path.abspath(__file__)))}
    sys.path[:] = [path for path in sys.path if os.path.abspath(path) not in _unsafe]

import ast
import importlib
from pathlib import Path
from typing import Any


def _modules() -> dict[str, str]:
    """The module of each name, as `__init__.pyi` tells it to type checkers."""
    stub = ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    imports = [node for node in stub.body if isinstance(node, ast.ImportFrom)]
    return {alias.name: str(node.module) for node in imports for alias in node.names}


_MODULES = _modules()
__all__ = sorted(_MODULES)  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    """A name at its first use: the command must set its environment before numba is imported
    (`environment`).
    """
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home = importlib.import_module(_MODULES[name])
    if not hasattr(home, name):  # a module of a package, such as `theory`
        importlib.import_module(f"{_MODULES[name]}.{name}")
    globals()[name] = value = getattr(home, name)
    return value


def __dir__() -> list[str]:
    return __all__
