"""Scans from AFM files, through the readers of SurfaceTopography, and Gwyddion files for synthetic ones.

Files come from strangers: readers that may run code (pickles inside NumPy files) are never tried.
"""

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from mesoscale.errors import InputError
from mesoscale.extras import needs
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.light_readers import light_reader

REFUSED_FORMATS = frozenset({"npy", "npz"})  # NumPy files hold no physical size and may hold pickles
MAGIC_BYTES = 512
MAX_PIXELS = 16384**2
MIN_SIDE = 32


def load_scan(path: str | Path, name: str | None = None, channel: str | None = None) -> Scan:
    """Read the height channel of an AFM file, in nm.

    Parameters
    ----------
    path : file of any format that SurfaceTopography reads, NumPy's own excepted.
    name : what to call the scan; by default the file's name.
    channel : name of the height channel; None takes the only one, or the first of several of one name
        (trace and retrace).

    Raises
    ------
    InputError : file missing, unreadable or of unknown format; no or several height channels; no physical
        size or unit; pixels not on a regular two-dimensional grid.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"{path}: no such scan; correct topography.scans in the scene")
    try:
        with path.open("rb") as stream:
            start = stream.read(MAGIC_BYTES)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); make the file readable") from None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # readers warn of metadata that nothing here uses
        with light_reader(path) as light:
            reader = _opened(light, path)
            if reader is not None:
                return _read(reader, path, name, channel)
        return _read(_open(path, start), path, name, channel)


def _opened(reader: type[Any] | None, path: Path) -> Any:
    """The file in a reader; None where it is of another format than its suffix says."""
    try:
        return reader(str(path)) if reader else None
    except Exception:  # readers of foreign formats fail in many ways
        return None


def _read(reader: Any, path: Path, name: str | None, channel: str | None) -> Scan:
    try:
        info, note = _height_channel(path, list(reader.channels), channel)
        return _scan(path, name or path.stem, info, note)
    finally:
        close = getattr(reader, "close", None)
        if close:
            close()


def _open(path: Path, start: bytes) -> Any:
    """The file in the first of all readers that understands it."""
    with needs("scans"):
        from SurfaceTopography.IO import readers
        from SurfaceTopography.IO.Reader import MagicMatch

    reasons = []
    for reader in readers:
        match = reader.can_read(start)
        if reader.format() in REFUSED_FORMATS:
            if match == MagicMatch.YES and reader.format() == "npy":
                raise InputError(
                    f"{path}: NumPy files are refused (they carry no physical size and may carry code); "
                    "export the scan to Gwyddion (.gwy) or keep the instrument's format"
                )
            continue
        if match == MagicMatch.NO:
            continue
        try:
            return reader(str(path))
        except Exception as error:  # readers of foreign formats fail in many ways
            if match == MagicMatch.YES:
                reasons.append(f"{reader.name()}: {_first_line(error)}")
    detail = f" ({reasons[0]})" if reasons else ""
    raise InputError(
        f"{path}: no reader understands this file{detail}; accepted are the formats of SurfaceTopography "
        "(gwy, ibw, di, jpk, mi, nid, ps tiff, ...) except NumPy files"
    )


def _first_line(error: Exception) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[0][:120]


def _height_channel(path: Path, channels: list[Any], wanted: str | None) -> tuple[Any, str]:
    """The height channel and a note when there was a choice."""
    # some readers call a phase a height, but then its unit is no length
    heights = [c for c in channels if c.is_height_channel and (c.unit is None or isinstance(c.unit, str))]
    names = ", ".join(dict.fromkeys(str(c.name) for c in heights)) or "none"
    if wanted is not None:
        heights = [c for c in heights if str(c.name) == wanted]
        if not heights:
            raise InputError(f"{path}: no height channel {wanted!r} (topography.channel); the file has: {names}")
    if not heights:
        raise InputError(f"{path}: no height channel in this file; save the topography channel too")
    if len({str(c.name) for c in heights}) > 1:
        raise InputError(f"{path}: several height channels: {names}; name one in topography.channel")
    if len(heights) > 1:
        return heights[0], f"took the first of {len(heights)} channels named {heights[0].name}"
    return heights[0], ""


def _scan(path: Path, name: str, info: Any, note: str) -> Scan:
    sizes, unit, grid = info.physical_sizes, info.unit, info.nb_grid_pts
    if info.dim != 2 or (grid is not None and len(grid) != 2):
        raise InputError(f"{path}: not a two-dimensional map; give a scan, not a line profile")
    if sizes is None or len(sizes) != 2 or not all(np.isfinite(s) and s > 0 for s in sizes):
        raise InputError(f"{path}: has no physical size; save it in a format that carries size and unit (.gwy)")
    if not unit:
        raise InputError(f"{path}: has no length unit; save it in a format that carries size and unit (.gwy)")
    if grid is not None and int(np.prod(grid)) > MAX_PIXELS:
        raise InputError(f"{path}: {grid[0]} x {grid[1]} pixels; at most {MAX_PIXELS} pixels are accepted")
    try:
        topography = info.topography()
    except Exception as error:
        raise InputError(f"{path}: heights cannot be read ({_first_line(error)}); is the file complete?") from None
    if not getattr(topography, "is_uniform", True):
        raise InputError(f"{path}: points are not on a regular grid; give a scan on a grid")
    try:
        topography = topography.to_unit("nm")
    except Exception:
        raise InputError(f"{path}: unit {unit!r} is not a length; save heights and size in nm, um or m") from None
    heights = np.ma.filled(np.ma.asarray(topography.heights(), dtype=float), np.nan)
    if min(heights.shape) < MIN_SIDE:
        raise InputError(f"{path}: {heights.shape[0]} x {heights.shape[1]} pixels; at least {MIN_SIDE} a side")
    lengths = tuple(float(s) for s in topography.physical_sizes)
    steps = (f"read channel {info.name}", note) if note else (f"read channel {info.name}",)
    return Scan(heights, (lengths[0], lengths[1]), name, steps)


def write_gwy(path: str | Path, scan: Scan) -> None:
    """Write heights to a Gwyddion file, in metres as Gwyddion wants them; missing pixels as its mask."""
    with needs("scans"):
        from gwyfile.objects import GwyContainer, GwyDataField

    metre = 1e-9
    x, y = (length * metre for length in scan.lengths_nm)

    def field(values: np.ndarray, unit: str) -> GwyDataField:
        rows = np.ascontiguousarray(values.T)  # Gwyddion stores scan lines as rows
        return GwyDataField(rows, xreal=x, yreal=y, si_unit_xy="m", si_unit_z=unit)

    missing = ~np.isfinite(scan.heights_nm)
    content = GwyContainer()
    content["/0/data/title"] = "Height"
    content["/0/data"] = field(np.where(missing, 0.0, scan.heights_nm) * metre, "m")
    if missing.any():
        content["/0/mask"] = field(missing.astype(float), "")
    content.tofile(str(path))
