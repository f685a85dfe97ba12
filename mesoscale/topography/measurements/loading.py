"""Scans and line profiles from files and published containers, through the readers of SurfaceTopography.

Files come from strangers: each is read in a process with limits (`guarded`). The list of a container, which its reader
takes by PyYAML's full loader, must hold plain values and tuples alone.
"""

import os
import re
import tempfile
import warnings
import zipfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import numpy as np

from asperity.guards.foreign_yaml import MistakenYaml, parse
from mesoscale.errors import InputError
from mesoscale.extras import needs
from mesoscale.settings import InstrumentSettings, TopographySettings
from mesoscale.topography.measurements.cleaning import MARKED, Scan
from mesoscale.topography.measurements.guarded import guarded
from mesoscale.topography.measurements.profiles import Profile, profile_of

MIN_SIDE = 32
FILE_NM = (10.0, 1e8)  # plausible sizes: the largest real map at hand has 12 mm; beyond, a reader mistakes the unit
HEAD_BYTES = 8192  # of a text file, in which the heads of its columns stand
MOST_NAMES = 10  # of channels in a message: a file may have hundreds
NO_HEIGHT = re.compile(r"deflection|amplitude|error|phase|friction|lateral|thumb|preview|current|potential", re.I)
DIRECTION = re.compile(r"\W*\b(forward|backward|fwd|bwd|trace|retrace|left|right)\b\W*", re.I)
BACKWARD = re.compile(r"\b(backward|bwd|retrace|left)\b", re.I)
"""Names of channels: what is no height, and the directions of one height."""
NO_LIMITS = InstrumentSettings(files="*")


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
    path : file of any format that SurfaceTopography reads, or a container of contact.engineering (.zip).
    name : what to call it; by default the file's name. Measurements of a container add their own.
    settings : the channel to take, and the limits of the instruments.

    Raises
    ------
    InputError : file missing, unreadable or of unknown format; no or several height channels; no physical size or
        unit; a container of several surfaces.
    """
    path, settings = Path(path), settings or TopographySettings()
    if not os.path.isfile(path):  # unlike Path.is_file, False for a name that is too long
        raise InputError(f"{path}: no such scan; correct topography.scans in the scene")
    with needs("scans"):  # imported here, so that the process that reads, a fork of this one, has the readers
        import SurfaceTopography.Container.IO
        import SurfaceTopography.IO  # noqa: F401  4 s, because it loads all of that library

    def read() -> list[Measurement]:
        _teach_units()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # readers warn of metadata that nothing here uses
            if path.suffix.lower() == ".zip":
                return list(_contained(path, name or path.stem, settings))
            return [_alone(path, name or path.stem, settings)]

    return guarded(path, read)


def _teach_units() -> None:
    """Add spellings of lengths that instruments write and SurfaceTopography's table lacks."""
    from SurfaceTopography.Support.UnitConversion import length_units

    # the last one is UTF-8 that was read as Latin-1
    length_units |= dict.fromkeys(("\u03bcm", "micron", "microns", "micrometer", "\u339b", "\u00c2\u00b5m"), 1e-6)
    length_units |= dict.fromkeys(("Angstrom", "angstrom", "\u212b", "\u00c5ngstr\u00f6m", "Ang"), 1e-10)


def with_limits(
    data: Scan | Profile,
    settings: TopographySettings,
    instrument: InstrumentSettings = NO_LIMITS,
    file_radius_nm: float | None = None,
) -> Measurement:
    """A scan or line profile with the limits of its instrument; what it leaves open is the file's or the settings'."""
    radius = file_radius_nm if instrument.tip_radius_nm is None else instrument.tip_radius_nm
    used = settings.tip_nm if radius is None else radius
    return Measurement(
        data,
        used,
        radius is not None or settings.tip_radius_nm is not None,
        instrument.shortest_wave_nm,
        instrument.noise_nm,
    )


def _instrument(name: str, settings: TopographySettings) -> InstrumentSettings:
    """The instrument that the scene states for a name; one without limits where it states none."""
    return next((item for item in settings.instruments if fnmatch(name, item.files)), NO_LIMITS)


def _alone(path: Path, name: str, settings: TopographySettings) -> Measurement:
    """The measurement of a file."""
    from SurfaceTopography.IO import open_topography

    instrument = _instrument(path.name, settings)
    try:
        with path.open("rb") as stream:
            head = stream.read(HEAD_BYTES)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); make the file readable") from None
    read = plain_text(path, head)
    head = head if read == path else read.read_bytes()[:HEAD_BYTES]
    reader = _tried(str(path), lambda: open_topography(str(read)), head)
    channels = _tried(str(path), lambda: list(reader.channels))
    channel, note = _height_channel(path, channels, instrument, settings.channel)
    given = _given(str(path), channel, instrument)
    _check_sized(str(path), channel, instrument)
    topography = _tried(str(path), lambda: channel.topography(**given))
    marked = None
    if masks := getattr(reader, "_masks", None):  # Gwyddion's mask is over what is missing, and over grains
        lost = np.ma.getmaskarray(_tried(str(path), topography.heights))
        masks.clear()
        whole = _tried(str(path), lambda: channel.topography(**given))
        below = np.asarray(_tried(str(path), whole.heights))[lost]
        if len(np.unique(below[np.isfinite(below)])) > 1:  # what is missing has one value
            topography, marked = whole, f"{MARKED} {lost.mean():.1%} of the pixels, which have heights: kept them"
    steps = (f"read channel {channel.name}", *note, *([marked] if marked else []))
    return _measurement(str(path), name, topography, head, steps, settings, instrument)


def plain_text(path: Path, head: bytes) -> Path:
    """The file, or a copy with decimal points, tabs and UTF-8, of text as programs of many countries export it.

    Text is what begins without signs that do not print, and has no byte 0.
    """
    if not head or any(byte < 9 or 13 < byte < 32 for byte in head) or b"\0" in (raw := path.read_bytes()):
        return path
    try:
        text = raw.decode("utf-8")
        encoded = False
    except UnicodeDecodeError:
        text, encoded = raw.decode("latin-1"), True
    start = text[:HEAD_BYTES]
    commas = re.search(r"(?<![\d.,])-?\d+,\d+(?:[eE][-+]?\d+)?[\t; ]+-?\d", start)
    commas = commas and not re.search(r"\d\.\d", start)
    if commas:
        text = re.sub(r"(?<=\d),(?=\d)", ".", text)
    if ";" in start:
        text = text.replace(";", "\t")
    if not (commas or encoded) and (";" not in start or _is_understood(path)):
        return path
    copy = Path(tempfile.mkdtemp()) / path.name
    copy.write_text(text, encoding="utf-8")
    return copy


def _is_understood(path: Path) -> bool:
    """Whether a reader takes the file as it is: some instruments write semicolons."""
    from SurfaceTopography.IO import open_topography

    with suppress(Exception):  # readers of foreign formats fail in many ways
        return bool(open_topography(str(path)).channels)
    return False


def _given(where: str, channel: Any, instrument: InstrumentSettings) -> dict[str, Any]:
    """What the user adds of size and unit to a channel that lacks them, as its reader takes them.

    Raises
    ------
    InputError : the file states it itself.
    """
    given: dict[str, Any] = {}
    sized = channel.dim == 1 or channel.physical_sizes is not None
    for name, stated, added in (
        ("a unit", channel.unit, instrument.unit),
        ("a size", channel.physical_sizes if channel.dim == 2 else True, instrument.size),
    ):
        if stated and added:
            raise InputError(
                f"{where}: states {name} itself; leave out that of topography.instruments (--unit, --size)"
            )
    if not sized and instrument.size:
        given["physical_sizes"] = instrument.size
    return given


def _contained(path: Path, name: str, settings: TopographySettings) -> Iterator[Measurement]:
    """The measurements of the one surface in a container, as they were taken: filters of its list are not applied."""
    from SurfaceTopography.Container.IO import CEReader

    try:
        with zipfile.ZipFile(path) as archive:
            if "meta.yml" in archive.namelist():
                parse(archive.read("meta.yml"), tuples=True)
        container = CEReader(str(path), ignore_filters=True)
    except MistakenYaml as error:
        raise InputError(f"{path}: meta.yml holds more than plain values ({error}); nothing was executed") from None
    except Exception as error:  # of damaged, encrypted and foreign archives, and of strange lists
        raise InputError(f"{path}: this container cannot be read ({_first_line(error)}); get it again") from None
    if container.nb_containers != 1:
        raise InputError(f"{path}: holds {container.nb_containers} surfaces; give a container of one surface")
    if not container.members():
        raise InputError(f"{path}: its list of measurements is empty")
    for number, member in enumerate(container.members()):
        where = f"{path}: {member.name[:80]}"
        label = re.sub(r"[^\w.-]+", "_", f"{name}_{number + 1}_{Path(member.name[:80]).stem}")
        head = _tried(where, lambda item=member: item.open().read(HEAD_BYTES))
        topography = _tried(where, lambda k=number: container.container()[k], head)
        steps = (f"read channel {topography.info.get('data_source', 0)}",)
        yield _measurement(where, label, topography, head, steps, settings, _instrument(member.name, settings))


def _measurement(
    where: str,
    name: str,
    topography: Any,
    head: bytes,
    steps: tuple[str, ...],
    settings: TopographySettings,
    instrument: InstrumentSettings,
) -> Measurement:
    """A topography of SurfaceTopography in nm, by the unit of the file, of its columns, or of the scene."""
    unit = topography.unit or instrument.unit
    factors = (_nm(where, unit),) * 2 if unit else _column_units(head)
    if factors is None:
        raise InputError(
            f"{where}: a {'profile' if topography.dim == 1 else 'map'} without length unit; state it in "
            f"topography.instruments (files: {Path(where).name!r}, unit: um, height_unit: nm; --unit um,nm) or in the "
            "heads of its columns"
        )
    if instrument.height_unit and not topography.unit:
        factors = factors[0], _nm(where, instrument.height_unit)
    if topography.dim == 1:
        x, z = _tried(where, lambda: _points(*topography.positions_and_heights()))
        data: Scan | Profile = _profile(where, name, x * factors[0], z * factors[1])
        data = replace(data, bow=topography.info.get("detrend_mode") == "curvature")
    else:
        _check_sized(where, topography, instrument)
        heights = factors[1] * _tried(where, lambda: _filled(topography.heights()))
        if min(heights.shape) < MIN_SIDE:
            raise InputError(f"{where}: {heights.shape[0]} x {heights.shape[1]} pixels; at least {MIN_SIDE} a side")
        x_nm, y_nm = (factors[0] * float(size) for size in topography.physical_sizes)
        _check_plausible(where, heights, x_nm, y_nm)
        data = Scan(heights, (x_nm, y_nm), name)
    data = replace(data, steps=(*steps, *data.steps))
    return with_limits(data, settings, instrument, _stated_radius(where, topography.info))


def _profile(where: str, name: str, x_nm: np.ndarray, z_nm: np.ndarray) -> Profile:
    try:
        profile = profile_of(x_nm, z_nm, name)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    _check_plausible(where, profile.heights_nm, profile.length_nm)
    return profile


def _no_reader(where: str, head: bytes, tried: str) -> str:
    """Why no reader takes a file: the reason of one that its first bytes or its name mean."""
    from SurfaceTopography.IO import MagicMatch, readers

    said = dict(re.findall(r"tried (\w+): \n (.*\S)", tried))
    suffix = Path(where).suffix.lower().lstrip(".")
    meant = [reader for reader in readers if reader.can_read(head) == MagicMatch.YES]
    meant += [reader for reader in readers if suffix in (reader.file_extensions() or ())]
    reasons = (f" ({item.name()}: {said[item.__name__][:120]})" for item in meant if item.__name__ in said)
    return (
        f"{where}: no reader understands this file{next(reasons, '')}; accepted are the formats of SurfaceTopography "
        "(gwy, ibw, di, jpk, mi, nid, ps tiff, ...; all 40: docs/topography.md, Formats)"
    )


def _height_channel(
    path: Path, channels: list[Any], instrument: InstrumentSettings, channel: str | None
) -> tuple[Any, tuple[str, ...]]:
    """The height channel, and a note when there was a choice."""
    wanted = instrument.channel or channel
    # some readers call a phase a height, but then its unit is no length
    lengths = [c for c in channels if c.is_height_channel and (c.unit is None or isinstance(c.unit, str))]
    pixels = {id(c): int(np.prod(getattr(c, "nb_grid_pts", None) or 1)) for c in lengths}
    most = max(pixels.values(), default=0) / 16  # of a thumbnail
    heights = [c for c in lengths if not NO_HEIGHT.search(str(c.name)) and pixels[id(c)] > most]
    names = list(dict.fromkeys(str(c.name) for c in heights))
    listed = ", ".join(names[:MOST_NAMES]) or "none"
    listed += f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    if wanted is not None:
        heights = [c for c in heights if str(c.name) == wanted]
        if not heights and wanted in (str(c.name) for c in channels):
            raise InputError(f"{path}: channel {wanted!r} holds no heights; those that do (--channel): {listed}")
        if not heights:
            raise InputError(f"{path}: no height channel {wanted!r} (--channel, topography.channel); it has: {listed}")
    elif len({DIRECTION.sub("", name).strip() for name in names}) > 1:
        lacks, keys = _lacking(path.name, heights[0], instrument)
        also = f"; they have no {lacks}: state them, too, in topography.instruments {keys}" if lacks else ""
        raise InputError(f"{path}: several height channels: {listed}; name one in topography.channel (--channel){also}")
    if not heights:
        raise InputError(
            f"{path}: no channel of heights in a unit of length (m, um, nm, Å); save the topography too, or calibrate "
            "heights that are in V"
        )
    forward = next((c for c in heights if not BACKWARD.search(str(c.name))), heights[0])
    others = len(heights) - 1
    return forward, (f"took {forward.name}, one of {others + 1} channels of heights",) if others else ()


def _nm(where: str, unit: str) -> float:
    """Length of a unit in nm."""
    from SurfaceTopography.Support.UnitConversion import get_unit_conversion_factor, mangle_length_unit_utf8

    try:
        return float(get_unit_conversion_factor(mangle_length_unit_utf8(unit), "nm"))
    except ValueError:
        raise InputError(f"{where}: unit {unit!r} is not a length; save heights and size in nm, um or m") from None


def _column_units(head: bytes) -> tuple[float, float] | None:
    """Factors to nm of the last two columns, position and height, by the heads of a text's columns; None without."""
    from SurfaceTopography.Support.UnitConversion import find_length_unit_in_string

    encoding = "utf-16" if head[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8"
    for line in head[: len(head) // 2 * 2].decode(encoding, errors="replace").splitlines():
        units = [find_length_unit_in_string(column) for column in re.split(r"[,;\t]", line.strip())]
        if len(units) >= 2 and units[-2] and units[-1]:
            return _nm(line, units[-2]), _nm(line, units[-1])
    return None


def _stated_radius(where: str, info: Any) -> float | None:
    """Radius of the tip in nm, as files and containers state it with their instrument; None where they do not."""
    for key in ("instrument", "parameters", "tip_radius"):
        info = info.get(key) if isinstance(info, dict) else None
    if not isinstance(info, dict) or not isinstance(info.get("value"), (int, float)) or info["value"] <= 0:
        return None
    return float(info["value"]) * _nm(f"{where}: tip_radius", str(info.get("unit")))


def _points(x: Any, z: Any) -> tuple[np.ndarray, np.ndarray]:
    return _filled(x), _filled(z)


def _filled(values: Any) -> np.ndarray:
    return np.ma.filled(np.ma.asarray(values, dtype=float), np.nan)


def _check_sized(where: str, item: Any, instrument: InstrumentSettings) -> None:
    lacks, keys = _lacking(Path(where).name, item, instrument)
    if "size" in lacks:
        raise InputError(
            f"{where}: has no {lacks}; state them in topography.instruments {keys}, or save it with both (.gwy)"
        )


def _lacking(name: str, item: Any, instrument: InstrumentSettings) -> tuple[str, str]:
    """What neither a file nor its user says of the size and unit of a map, and the keys and options to fill."""
    sizes = item.physical_sizes or instrument.size
    sized = item.dim == 1 or (sizes is not None and all(np.isfinite(size) and size > 0 for size in sizes))
    named = item.unit or instrument.unit
    asked = [
        words
        for words, stated in (
            (("physical size", "size: [1, 1]", "--size 1x1"), sized),
            (("length unit", "unit: um", "--unit um"), named),
        )
        if not stated
    ]
    lacks, keys, options = ([words[k] for words in asked] for k in range(3))
    return " and no ".join(lacks), f"({', '.join([f'files: {name!r}', *keys])}; {' '.join(options)})"


def _check_plausible(where: str, heights_nm: np.ndarray, *lengths_nm: float) -> None:
    """Refuse sizes and heights that no instrument measures."""
    low, high = FILE_NM
    if not all(low <= length <= high for length in lengths_nm):
        raise InputError(
            f"{where}: a size of {' x '.join(f'{length:.4g}' for length in lengths_nm)} nm; plausible is {low:g} .. "
            f"{high:g} nm, so its unit may be mistaken: save it again with the size in nm or um (.gwy)"
        )
    if not np.isfinite(heights_nm).any():
        raise InputError(f"{where}: no pixel has a height; measure again")
    largest = float(np.nanmax(np.abs(heights_nm - np.nanmedian(heights_nm))))  # some instruments count from far away
    if largest > high:
        raise InputError(
            f"{where}: a height of {largest:.3g} nm; plausible is up to {high:g} nm about the median, so the file "
            "may be damaged or its unit mistaken: save it again (.gwy)"
        )


def _tried(where: str, read: Callable[[], Any], head: bytes = b"") -> Any:
    """What a reader gives; readers of foreign formats fail in many ways."""
    from SurfaceTopography.IO import CannotDetectFileFormat

    try:
        return read()
    except CannotDetectFileFormat as error:
        raise InputError(_no_reader(where, head, str(error))) from None
    except Exception as error:
        raise InputError(f"{where}: heights cannot be read ({_first_line(error)}); is the file complete?") from None


def _first_line(error: Exception) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[0][:120]


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
