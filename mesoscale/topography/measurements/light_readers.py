"""Readers of SurfaceTopography for common AFM formats, without the rest of that library.

To import anything from a package is to run the package's own `__init__` first. SurfaceTopography's loads every
analysis it offers, and with them pandas, matplotlib and SciPy's statistics: 4.5 s, longer than a scan takes to be
analysed. Its readers need none of that. Here a few of them are loaded below empty stand-ins for their two packages;
afterwards the table of loaded modules is as it was, so that the whole library can still be imported as usual.
"""

import importlib
import importlib.util
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

from mesoscale.extras import needs

SUFFIXES = {  # reader (and module below SurfaceTopography.IO) by the suffixes of its files
    "GWY": ("gwy",),
    "IBW": ("ibw",),
    "DI": ("di", "spm", "000", "001", "002", "003", "004", "005"),
    "JPK": ("jpk",),
    "MI": ("mi",),
    "MDT": ("mdt",),
    "EZD": ("ezd", "nid"),
    "PS": ("tiff", "tif"),
}
PACKAGES = ("SurfaceTopography", "SurfaceTopography.IO")


_parked: dict[str, ModuleType] = {}  # the light modules while they are not in the table of loaded modules


@contextmanager
def light_reader(path: Path) -> Iterator[type[Any] | None]:
    """The reader class for the suffix of a file, if it is one of the common formats; use it inside the context."""
    suffix = path.suffix.lower().removeprefix(".")
    name = next((name for name, suffixes in SUFFIXES.items() if suffix in suffixes), None)
    if name is None or _loaded():  # the whole library is there already
        yield None
        return
    try:
        with needs("scans"):
            sys.modules.update(_parked or _stand_ins())
        try:
            module = importlib.import_module(f"{PACKAGES[1]}.{name}")
            reader = getattr(module, f"{name}Reader")
        except (ImportError, AttributeError):  # unexpected layout: import all of it
            reader = None
        yield reader
    finally:
        for key in _loaded():
            _parked[key] = sys.modules.pop(key)


def _stand_ins() -> dict[str, ModuleType]:
    """The packages, found but not initialised: enough to import modules below them."""
    modules = {}
    for name in PACKAGES:
        spec = importlib.util.find_spec(name)
        if spec is None:
            raise ModuleNotFoundError(name=name)
        modules[name] = sys.modules[name] = importlib.util.module_from_spec(spec)
    return modules


def _loaded() -> list[str]:
    """Names of the library's modules that are loaded."""
    return [name for name in sys.modules if name.split(".")[0] == PACKAGES[0]]
