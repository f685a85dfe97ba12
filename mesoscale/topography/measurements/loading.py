"""Scans and line profiles from files, through the readers of SurfaceTopography; Gwyddion files for synthetic scans.

Files come from strangers: each is read in a process with limits (`guarded`), and readers that may run code (pickles
inside NumPy files) are never tried.
"""

import re
import struct
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import numpy as np

from mesoscale.errors import InputError
from mesoscale.extras import needs
from mesoscale.settings import InstrumentSettings, TopographySettings
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.containers import is_container, stated_radius, unpacked
from mesoscale.topography.measurements.guarded import guarded
from mesoscale.topography.measurements.profiles import Profile, profile_of
from mesoscale.topography.measurements.text_units import column_units

REFUSED_FORMATS = frozenset({"npy", "npz"})  # NumPy files hold no physical size and may hold pickles
MAGIC_BYTES = 512
MAX_PIXELS = 16384**2
MIN_SIDE = 32
FILE_NM = (10.0, 1e8)  # plausible sizes: the largest real map at hand has 12 mm; beyond, a reader mistakes the unit
NM = {"m": 1e9, "mm": 1e6, "um": 1e3, "µm": 1e3, "μm": 1e3, "nm": 1.0, "Å": 0.1, "pm": 1e-3}


@dataclass(frozen=True)
class Measurement:
    """A scan or a line profile with the limits of its instrument.

    Attributes
    ----------
    data : as loaded, before levelling.
    tip_radius_nm : 0 for an instrument without tip.
    radius_stated : whether the scene or the file states the radius; otherwise it is the scene's default.
    shortest_wave_nm, noise_nm : further limits; None where nothing is stated.
    """

    data: Scan | Profile
    tip_radius_nm: float
    radius_stated: bool
    shortest_wave_nm: float | None = None
    noise_nm: float | None = None


def load_measurements(
    path: str | Path, name: str | None = None, settings: TopographySettings | None = None
) -> list[Measurement]:
    """Everything that a file holds of one surface, in nm: a scan, a line profile, or all of a container.

    Parameters
    ----------
    path : file of any format that SurfaceTopography reads, NumPy's own excepted, or a container (.zip).
    name : what to call it; by default the file's name. Measurements of a container add their own.
    settings : the channel to take, and the limits of the instruments.

    Raises
    ------
    InputError : file missing, unreadable or of unknown format; no or several height channels; no physical size or
        unit; pixels not on a regular grid; a container that cannot be trusted.
    """
    path, settings = Path(path), settings or TopographySettings()
    _check_present(path)
    _import_readers()
    return guarded(path, lambda: _measurements(path, name, settings))


def _measurements(path: Path, name: str | None, settings: TopographySettings) -> list[Measurement]:
    if not is_container(path):
        instrument = _instrument(path.name, settings)
        data = _load(path, name or path.stem, instrument.channel or settings.channel, instrument.unit)
        return [with_limits(data, settings, instrument)]
    measurements = []
    with unpacked(path) as members:
        for number, member in enumerate(members):
            instrument = _instrument(member.name, settings)
            label = re.sub(r"[^\w.-]+", "_", f"{name or path.stem}_{number + 1}_{Path(member.name).stem}")
            unit, channel = instrument.unit or member.unit, instrument.channel or settings.channel
            try:
                data = _load(member.path, label, channel, unit, member.sizes)
            except InputError as error:
                raise InputError(str(error).replace(str(member.path), f"{path}: {member.name}")) from None
            if isinstance(data, Profile):
                data = replace(data, bow=member.bow, tip_radius_nm=data.tip_radius_nm or member.tip_radius_nm)
            measurements.append(with_limits(data, settings, instrument))
    if not measurements:
        raise InputError(f"{path}: its list of measurements is empty")
    return measurements


def _instrument(name: str, settings: TopographySettings) -> InstrumentSettings:
    """The instrument that the scene states for a name; one without limits where it states none."""
    fits = (item for item in settings.instruments if fnmatch(name, item.files))
    return next(fits, NO_LIMITS)


NO_LIMITS = InstrumentSettings(files="*")


def with_limits(
    data: Scan | Profile, settings: TopographySettings, instrument: InstrumentSettings = NO_LIMITS
) -> Measurement:
    """A scan or line profile with the limits of its instrument; what that leaves open is the settings'."""
    radius = instrument.tip_radius_nm
    if radius is None and isinstance(data, Profile):
        radius = data.tip_radius_nm
    stated = radius is not None or isinstance(data, Scan)  # topography.tip_radius_nm is a scanning probe's
    used = settings.tip_radius_nm if radius is None else radius
    return Measurement(data, used, stated, instrument.shortest_wave_nm, instrument.noise_nm)


def _import_readers() -> None:
    """Import the readers here, so that the process that reads, a fork of this one, has them."""
    with needs("scans"):
        import SurfaceTopography.IO  # noqa: F401  4 s, because it loads all of that library


def _check_present(path: Path) -> bytes:
    """The first bytes of a file that is there and can be read."""
    if not path.is_file():
        raise InputError(f"{path}: no such scan; correct topography.scans in the scene")
    try:
        with path.open("rb") as stream:
            return stream.read(MAGIC_BYTES)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); make the file readable") from None


def _load(
    path: Path,
    name: str,
    channel: str | None,
    unit: str | None,
    sizes: tuple[float, ...] | None = None,
) -> Scan | Profile:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # readers warn of metadata that nothing here uses
        reader = _open(path, _check_present(path))
        try:
            channels = _heights(path, lambda: list(reader.channels))
            info, note = _height_channel(path, channels, channel)
            if info.dim == 1:
                return _profile(path, name, info, unit)
            return _scan(path, name, info, note, unit, sizes)
        finally:
            close = getattr(reader, "close", None)
            if close:
                close()


def _open(path: Path, start: bytes) -> Any:
    """The file in the first of all readers that understands it."""
    with needs("scans"):
        from SurfaceTopography.IO import readers
        from SurfaceTopography.IO.Reader import MagicMatch
        from SurfaceTopography.IO.XYZ import XYZReader

        from mesoscale.topography.measurements.text_reader import QuickXYZReader

    _check_pages(path, start)
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
            return (QuickXYZReader if reader is XYZReader else reader)(str(path))
        except Exception as error:  # readers of foreign formats fail in many ways
            if match == MagicMatch.YES:
                reasons.append(f"{reader.name()}: {_first_line(error)}")
    detail = f" ({reasons[0]})" if reasons else ""
    raise InputError(
        f"{path}: no reader understands this file{detail}; accepted are the formats of SurfaceTopography "
        "(gwy, ibw, di, jpk, mi, nid, ps tiff, ...; all 40: docs/topography.md, Formats) except NumPy files"
    )


def _check_pages(path: Path, start: bytes) -> None:
    """Refuse a TIFF file whose list of pages leads back to itself: the reader would follow it without end."""
    order = {b"II*\0": "<", b"MM\0*": ">"}.get(start[:4])
    if order is None or len(start) < 8:
        return
    (page,), seen = struct.unpack_from(f"{order}I", start, 4), set[int]()
    with path.open("rb") as stream:
        while page:
            if page in seen:
                raise InputError(f"{path}: its list of pages leads back to itself; save the file again (.gwy)")
            seen.add(page)
            stream.seek(page)
            count = int.from_bytes(stream.read(2), "little" if order == "<" else "big")
            stream.seek(12 * count, 1)  # tags of 12 bytes
            following = stream.read(4)
            page = struct.unpack(f"{order}I", following)[0] if len(following) == 4 else 0


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


def _scan(
    path: Path, name: str, info: Any, note: str, stated_unit: str | None, stated_sizes: tuple[float, ...] | None
) -> Scan:
    sizes, unit, grid = info.physical_sizes, info.unit, info.nb_grid_pts
    if info.dim != 2 or (grid is not None and len(grid) != 2):
        raise InputError(f"{path}: not a two-dimensional map; give a scan, not a line profile")
    given: dict[str, Any] = {}
    if sizes is None and stated_sizes is not None:
        sizes = given["physical_sizes"] = stated_sizes
    if not unit and stated_unit is not None:
        unit = given["unit"] = stated_unit
    sized = sizes is not None and len(sizes) == 2 and all(np.isfinite(s) and s > 0 for s in sizes)
    if lacks := " and no ".join(["physical size"] * (not sized) + ["length unit"] * (not unit)):
        raise InputError(f"{path}: has no {lacks}; save it in a format that carries size and unit (.gwy)")
    if grid is not None and int(np.prod(grid)) > MAX_PIXELS:
        raise InputError(f"{path}: {grid[0]} x {grid[1]} pixels; at most {MAX_PIXELS} pixels are accepted")
    topography = _heights(path, lambda: info.topography(**given))
    if not getattr(topography, "is_uniform", True):
        raise InputError(f"{path}: points are not on a regular grid; give a scan on a grid")
    try:
        topography = topography.to_unit("nm")
    except Exception:  # the library raises what its table of units happens to: one line for the user either way
        raise InputError(f"{path}: unit {unit!r} is not a length; save heights and size in nm, um or m") from None
    heights = np.ma.filled(np.ma.asarray(topography.heights(), dtype=float), np.nan)
    _check_heights(path, heights)
    if min(heights.shape) < MIN_SIDE:
        raise InputError(f"{path}: {heights.shape[0]} x {heights.shape[1]} pixels; at least {MIN_SIDE} a side")
    lengths = tuple(float(s) for s in topography.physical_sizes)
    _check_size(path, *lengths)
    steps = (f"read channel {info.name}", note) if note else (f"read channel {info.name}",)
    return Scan(heights, (lengths[0], lengths[1]), name, steps)


def _profile(path: Path, name: str, info: Any, stated_unit: str | None) -> Profile:
    """Positions and heights of a line, by the unit of the file, of its columns, or of the scene."""
    unit = info.unit or stated_unit
    factors = (NM[unit], NM[unit]) if unit in NM else column_units(path, NM)
    if factors is None:
        raise InputError(
            f"{path}: a profile without length unit; state it in topography.instruments "
            f"(files: {path.name!r}, unit: um; tip_radius_nm, too) or in the heads of its columns"
        )

    def points() -> list[np.ndarray]:
        x, z = info.topography().positions_and_heights()
        return [np.ma.filled(np.ma.asarray(v, dtype=float), np.nan) for v in (x, z)]

    x, z = _heights(path, points)
    try:
        profile = profile_of(x * factors[0], z * factors[1], name)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    _check_size(path, profile.length_nm)
    _check_heights(path, profile.heights_nm)
    radius = stated_radius(info.info.get("instrument", {}).get("parameters", {}).get("tip_radius"))
    return replace(profile, tip_radius_nm=radius, steps=(f"read channel {info.name}", *profile.steps))


def _check_size(path: Path, *lengths_nm: float) -> None:
    low, high = FILE_NM
    if not all(low <= length <= high for length in lengths_nm):
        raise InputError(
            f"{path}: a size of {' x '.join(f'{length:.4g}' for length in lengths_nm)} nm; plausible is {low:g} .. "
            f"{high:g} nm, so its unit may be mistaken: save it again with the size in nm or um (.gwy)"
        )


def _check_heights(path: Path, heights_nm: np.ndarray) -> None:
    if not np.isfinite(heights_nm).any():
        raise InputError(f"{path}: no pixel has a height; measure again")
    largest = float(np.nanmax(np.abs(heights_nm - np.nanmedian(heights_nm))))  # some instruments count from far away
    if largest > FILE_NM[1]:
        raise InputError(
            f"{path}: a height of {largest:.3g} nm; plausible is up to {FILE_NM[1]:g} nm about the median, so the file "
            "may be damaged or its unit mistaken: save it again (.gwy)"
        )


def _heights(path: Path, read: Callable[[], Any]) -> Any:
    try:
        return read()
    except Exception as error:
        raise InputError(f"{path}: heights cannot be read ({_first_line(error)}); is the file complete?") from None


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
