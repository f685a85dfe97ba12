"""Contact mechanics of rough surfaces from atoms to device: the names to start from, and the command `asperity`.

From a scan to a switch::

    import asperity as asp

    roughness = asp.measure_roughness([asp.load_scan("film.gwy")])
    table = asp.input_table(topography=roughness)  # the rest: the paper's Table 1
    settings = asp.ContactSettings(pixels=256)
    cycle = asp.run_cycle(asp.ContactInputs(**table.medians()), settings, seed=1)
    switch = asp.drive_switch(asp.DeviceSettings(), *asp.laws_of(cycle))
    samples = asp.monte_carlo(table, settings, samples=20)
    switches = asp.drive_switch(asp.DeviceSettings(), samples.closing, samples.opening)

Lengths are in nm, forces in nN, pressures and moduli in GPa; `help()` of every name states its units.
"""

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
    """A name at its first use: the command must set its environment before numba is imported (`environment`)."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value = getattr(importlib.import_module(_MODULES[name]), name)
    return value


def __dir__() -> list[str]:
    return [*globals(), *__all__]
