"""Scans and line profiles from files and containers, by the readers of SurfaceTopography.

Files come from strangers: each is read in a process with limits (`guarded`). The list of a
container, which its reader takes by PyYAML's full loader, must hold plain values and tuples alone.
"""

import os
import re
import warnings
import zipfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import numpy as np

from asperity.guards.foreign_files import is_of_the_system
from asperity.guards.foreign_yaml import MistakenYaml, parse
from mesoscale.errors import InputError
from mesoscale.extras import needs
from mesoscale.settings import InstrumentSettings, TopographySettings
from mesoscale.topography.measurements.channels import height_channel, holds_heights
from mesoscale.topography.measurements.cleaning import MARKED, STAND_INS, Scan, without_missing
from mesoscale.topography.measurements.columns import Columns, columns_of
from mesoscale.topography.measurements.guarded import guarded
from mesoscale.topography.measurements.missing import cropped
from mesoscale.topography.measurements.opening import (
    converted,
    first_line,
    foreign,
    opened,
    unpacked,
    why_not_read,
    with_unit,
    without_unit,
    write_channels,
)
from mesoscale.topography.measurements.points import on_grid
from mesoscale.topography.measurements.profiles import Profile, profile_of
from mesoscale.topography.measurements.text import BROADEST_TABLE, Text, decoded, text_of
from mesoscale.topography.measurements.units import nm_of, teach_units

MIN_SIDE = 32
FILE_NM = (10.0, 1e8)
"""Plausible sizes: the largest real map at hand has 12 mm; beyond, a reader mistakes the unit."""
HEAD_BYTES = 8192  # of a file, by which its format is told
OWN_HEADS = (b"X;Y;valid", b"Scan Parameters")
"""How tables begin whose heads a reader of SurfaceTopography knows: HFM and Dektak."""
PLAIN_WORDS = ("nan", "bad")
"""Words that say themselves that a value is missing."""
NO_LIMITS = InstrumentSettings(files="*")


@dataclass(frozen=True)
class Measurement:
    """A scan or a line profile with the limits of its instrument.

    Attributes
    ----------
    data : as loaded, before levelling; missing points are NaN, also those that a number stood for.
    tip_radius_nm : 0 for an instrument without tip.
    radius_stated : whether the scene or the file states the radius; otherwise it is the scene's
        default.
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
    """All that a file holds of one surface, in nm: a scan, a line profile, or a whole container.

    Parameters
    ----------
    path : file of any format that SurfaceTopography reads, packed or not, or a container of
        contact.engineering (.zip).
    name : what to call it; by default the file's name. Measurements of a container add their own.
    settings : the channel to take, and the limits of the instruments.

    Raises
    ------
    InputError : file missing, unreadable or of unknown format; no or several height channels; no
        physical size or unit; a container of several surfaces.
    """
    path = Path(path)
    settings = settings or TopographySettings()
    if not os.path.isfile(path):  # unlike Path.is_file, False for a name that is too long
        raise InputError(f"{path}: no such scan; correct topography.scans in the scene")
    if is_of_the_system(path):
        raise InputError(f"{path}: of the system, not of data; copy what you need of it")
    # imported here, so that the process that reads, a fork of this one, has the readers
    with needs("scans"):
        import SurfaceTopography.Container.IO
        import SurfaceTopography.IO  # noqa: F401  loads all of that library

    def read() -> list[Measurement]:
        teach_units()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # readers warn of metadata that nothing here uses
            file = unpacked(path, _head_of(path))
            if file.suffix.lower() == ".zip":
                return list(_contained(path, name or path.stem, settings))
            return [_alone(path, file, name or path.stem, settings)]

    return guarded(path, read)


def with_limits(
    data: Scan | Profile,
    settings: TopographySettings,
    instrument: InstrumentSettings = NO_LIMITS,
    file_radius_nm: float | None = None,
) -> Measurement:
    """A scan or profile with its instrument's limits; what is open comes from file or settings."""
    radius = instrument.tip_radius_nm
    if radius is None:
        radius = file_radius_nm
    stated = radius is not None or settings.tip_radius_nm is not None
    if radius is None:
        radius = settings.tip_nm
    return Measurement(data, radius, stated, instrument.shortest_wave_nm, instrument.noise_nm)


def _instrument(name: str, settings: TopographySettings) -> InstrumentSettings:
    """The instrument that the scene states for a name; one without limits where it states none."""
    return next((item for item in settings.instruments if fnmatch(name, item.files)), NO_LIMITS)


def _head_of(path: Path) -> bytes:
    try:
        with path.open("rb") as stream:
            return stream.read(HEAD_BYTES)
    except OSError as error:
        raise InputError(
            f"{path}: cannot be read ({error.strerror}); make the file readable"
        ) from None


def _alone(path: Path, file: Path, name: str, settings: TopographySettings) -> Measurement:
    """The measurement of a file.

    Parameters
    ----------
    path : what the user gave, for messages and for the instrument's limits.
    file : what is read: the same, or what was packed in it.
    """
    instrument = _instrument(path.name, settings)
    where = str(path)
    head = _head_of(file)
    text = _text_in(where, file, head)
    if text is not None and _is_table(text):
        columns = columns_of(where, text, instrument.channel or settings.channel)
        return _of_table(where, name, columns, _word_steps(text), settings, instrument)
    if instrument.points is not None:
        raise InputError(_no_points(where))
    if text is not None and not text.plain:
        file = text.copy(file.name)
    file = converted(file, head)
    if instrument.unit and _lacks_a_unit(where, file):
        file = with_unit(file, instrument.height_unit or instrument.unit)
        instrument = instrument.model_copy(update={"unit": None})
    return _of_channels(path, file, name, text, settings, instrument)


def _text_in(where: str, file: Path, head: bytes) -> Text | None:
    """The text of a file that no reader knows; None where it is another format.

    Raises
    ------
    InputError : a format that nobody reads, told by its content, or, where it is no text, by its
        name.
    """
    refusal = foreign(file, head, by_name=False)
    text = None
    if not refusal and not _is_known(head) and decoded(head) is not None:
        text = text_of(file.read_bytes())
    if not refusal and text is None:
        refusal = foreign(file, head, by_name=True)
    if refusal:
        raise InputError(refusal.replace(str(file), where, 1))
    return text


def _lacks_a_unit(where: str, file: Path) -> bool:
    """Whether a Gwyddion file has channels without a unit."""
    return file.suffix.lower() == ".gwy" and bool(_tried(where, lambda: without_unit(file)))


def _no_points(where: str) -> str:
    return (
        f"{where}: is no list of points x, y, z; leave out --points (topography.instruments,"
        " points)"
    )


def _is_known(head: bytes) -> bool:
    """Does a reader know the format by the first bytes, so that its text is no plain table?"""
    from SurfaceTopography.IO import MagicMatch, readers

    return head.startswith(OWN_HEADS) or any(
        reader.can_read(head) == MagicMatch.YES for reader in readers
    )


def _is_table(text: Text) -> bool:
    """Are these columns of positions and heights? A map has 32 a side or a size."""
    stated = any(re.search(r"[=:]", line) and re.search(r"\d", line) for line in text.header)
    if text.width == 1:
        return not stated
    if stated and not text.heads:
        return text.width <= 3
    return text.width <= BROADEST_TABLE


def _of_channels(
    path: Path,
    file: Path,
    name: str,
    text: Text | None,
    settings: TopographySettings,
    instrument: InstrumentSettings,
) -> Measurement:
    """The measurement of the channel of heights that a reader of SurfaceTopography finds."""
    where = str(path)
    head = _head_of(file)
    try:
        reader = opened(file, head)
    except InputError as error:
        raise InputError(str(error).replace(str(file), where, 1)) from None
    channels = _tried(where, lambda: list(reader.channels))
    _check_unit_of(where, file, channels, instrument)
    in_length = [item for item in channels if not _is_ampere(text, item)]
    channel, note = height_channel(
        where,
        in_length,
        reader.format(),
        instrument.channel or settings.channel,
        lambda item: _also(path.name, item, instrument),
    )
    sites = getattr(channel, "nb_grid_pts", None) or [MIN_SIDE]
    if channel.dim == 2 and min(sites) < MIN_SIDE:
        raise InputError(_too_small(where, channel.nb_grid_pts))
    user_values = _given(where, channel, instrument)
    # uneven lines have positions instead of a size
    if channel.dim == 2 or getattr(channel, "is_uniform", False):
        _check_sized(where, channel, instrument)
    topography = _tried(where, lambda: channel.topography(**user_values))
    _check_whole(where, text, topography, channels)
    steps = (f"read channel {channel.name}", *note)
    masks = getattr(reader, "_masks", None)
    if masks:
        lost = np.ma.getmaskarray(_tried(where, topography.heights))
        masks.clear()
        unmasked = _tried(where, lambda: channel.topography(**user_values))
        if _has_heights(_tried(where, unmasked.heights), lost):
            topography = unmasked
            marked = f"{MARKED} {lost.mean():.1%} of the pixels, which have heights: kept them"
            steps = (*steps, marked)
    steps = (*steps, *_word_steps(text))
    return _measurement(where, name, topography, head, steps, settings, instrument)


def _has_heights(heights: Any, masked: np.ndarray) -> bool:
    """Whether there are heights below a mask: Gwyddion masks what is missing, and grains, too.

    What is missing has one value.
    """
    below = np.asarray(heights)[masked]
    return len(np.unique(below[np.isfinite(below)])) > 1


def _word_steps(text: Text | None) -> tuple[str, ...]:
    """What words among the numbers of a text stand for; NaN and BAD say it themselves."""
    if text is None:
        return ()
    counts = {word: n for word, n in text.words.items() if word.lower() not in PLAIN_WORDS}
    if not counts:
        return ()
    commonest = max(counts, key=lambda word: counts[word])
    count = sum(counts.values())
    share = count / (len(text.rows) * text.width)
    example = repr(commonest[:20])
    return (f"{STAND_INS} {share:.2%} of the values ({count}), which are words such as {example}",)


def _is_ampere(text: Text | None, channel: Any) -> bool:
    """Is a channel of a text that Gwyddion exported in A, which is its ampere?"""
    if text is None:
        return False
    raw = (getattr(channel, "info", None) or {}).get("raw_metadata", {})
    exported = any(re.match(r"#\s*\S+\s*[:\uff1a]", line) for line in text.header)
    return exported and raw.get("zunit") == "A"


def _check_unit_of(
    where: str, file: Path, channels: Sequence[Any], instrument: InstrumentSettings
) -> None:
    """Ask for a unit where a Gwyddion file has channels without one, and no other."""
    if channels or file.suffix.lower() != ".gwy" or instrument.unit:
        return
    if names := [name for name in without_unit(file) if holds_heights(name)]:
        raise InputError(
            f"{where}: channel {names[0]} has no unit; state it in topography.instruments (files: "
            f"{Path(where).name!r}, unit: nm; --unit nm), or save it with a unit of length"
        )


def _check_whole(where: str, text: Text | None, topography: Any, channels: Sequence[Any]) -> None:
    """Refuse a map of a text of which a reader lost lines."""
    if text is None or topography.dim != 2 or len(channels) != 1:
        return
    lines = topography.nb_grid_pts[1]
    if text.odd or lines != len(text.rows):
        raise InputError(
            f"{where}: {lines} of {len(text.rows) + text.odd} lines of numbers were read; a map has"
            " as many values in each line: save it again (.gwy)"
        )


def _of_table(
    where: str,
    name: str,
    columns: Columns,
    steps: tuple[str, ...],
    settings: TopographySettings,
    instrument: InstrumentSettings,
) -> Measurement:
    """A line or a map from columns of positions and heights."""
    factors = _factors(where, columns, instrument)
    taken = "read columns by their order"
    if columns.names:
        taken = f"read columns {', '.join(columns.names)}"
    steps = (taken, *steps)
    places = columns.positions.shape[1]
    if instrument.points is not None and places != 2:
        raise InputError(_no_points(where))
    if instrument.size and places:
        raise InputError(
            f"{where}: states a size itself; leave out that of topography.instruments (--size)"
        )
    if places == 2:
        x, y = columns.positions.T
        grid, lengths, step = on_grid(where, x, y, columns.heights, instrument.points)
        lengths_nm = (factors[0] * lengths[0], factors[0] * lengths[1])
        heights_nm = factors[1] * grid
        return _scan(where, name, heights_nm, lengths_nm, (*steps, step), settings, instrument)
    heights = columns.heights
    if places == 1:
        positions = columns.positions[:, 0]
    else:
        if not instrument.size:
            raise InputError(
                f"{where}: {len(heights)} heights alone, without positions; state the length of the"
                f" line in topography.instruments (files: {Path(where).name!r}, size: [1], unit:"
                " um, height_unit: nm; --size 1 --unit um,nm)"
            )
        positions = np.arange(len(heights)) * (instrument.size[0] / len(heights))
    profile = _profile(where, name, factors[0] * positions, factors[1] * heights)
    return with_limits(replace(profile, steps=(*steps, *profile.steps)), settings, instrument)


def _factors(where: str, columns: Columns, instrument: InstrumentSettings) -> tuple[float, float]:
    """Factors to nm of positions and heights, by the heads of the columns or by the user."""
    across, up = columns.units
    stated_units = instrument.unit, instrument.height_unit or instrument.unit
    if across and up and (instrument.unit or instrument.height_unit):
        stated = [nm_of(where, unit) for unit in (across, up)]
        if stated != [nm_of(where, unit or "nm") for unit in stated_units]:
            raise InputError(
                f"{where}: states a unit itself, {across} and {up}; leave out that of"
                " topography.instruments (--unit)"
            )
    heights_alone = not columns.positions.shape[1]
    across = across or stated_units[0]
    if not across and heights_alone:
        across = up
    up = up or stated_units[1]
    if not across or not up:
        size = ""
        option = ""
        if heights_alone and not instrument.size:
            size = "size: [1], "
            option = "--size 1 "
        kind = "points" if columns.positions.shape[1] == 2 else "a profile"
        raise InputError(
            f"{where}: {kind} without length unit; state it in topography.instruments (files:"
            f" {Path(where).name!r}, {size}unit: um, height_unit: nm; {option}--unit um,nm) or in"
            " the heads of its columns"
        )
    return nm_of(where, across), nm_of(where, up)


def _given(where: str, channel: Any, instrument: InstrumentSettings) -> dict[str, Any]:
    """What the user adds of size and unit to a channel that lacks them, as its reader takes them.

    Raises
    ------
    InputError : the file states it itself.
    """
    sized = channel.physical_sizes is not None
    twice_stated = [("a unit", channel.unit, instrument.unit), ("a size", sized, instrument.size)]
    for name, stated, added in twice_stated:
        if stated and added:
            raise InputError(
                f"{where}: states {name} itself; leave out that of topography.instruments (--unit,"
                " --size), or state it of the others alone (--size other.txt=10)"
            )
    if sized or not instrument.size:
        return {}
    if channel.dim == 2:
        return {"physical_sizes": (instrument.size[0], instrument.size[-1])}
    return {"physical_sizes": instrument.size[0]}


def _contained(path: Path, name: str, settings: TopographySettings) -> Iterator[Measurement]:
    """Measurements of the one surface in a container; its filters do not act."""
    from SurfaceTopography.Container.IO import CEReader

    try:
        with zipfile.ZipFile(path) as archive:
            if "meta.yml" in archive.namelist():
                parse(archive.read("meta.yml"), tuples=True)
        container = CEReader(str(path), ignore_filters=True)
    except MistakenYaml as error:
        raise InputError(
            f"{path}: meta.yml holds more than plain values ({error}); nothing was executed"
        ) from None
    except Exception as error:  # of damaged, encrypted and foreign archives, and of strange lists
        raise InputError(
            f"{path}: this container cannot be read ({first_line(error)}); get it again"
        ) from None
    if container.nb_containers != 1:
        raise InputError(
            f"{path}: holds {container.nb_containers} surfaces; give a container of one surface"
        )
    if not container.members():
        raise InputError(f"{path}: its list of measurements is empty")
    for number, member in enumerate(container.members()):
        where = f"{path}: {member.name[:80]}"
        label = re.sub(r"[^\w.-]+", "_", f"{name}_{number + 1}_{Path(member.name[:80]).stem}")
        head = _tried(where, lambda item=member: item.open().read(HEAD_BYTES))
        topography = _tried(
            where, lambda k=number: container.container()[k], Path(member.name), head
        )
        source = topography.info.get("data_source", 0)
        _check_member(where, member, source, head)
        steps = (f"read channel {source}",)
        yield _measurement(
            where, label, topography, head, steps, settings, _instrument(member.name, settings)
        )


def _check_member(where: str, member: Any, source: Any, head: bytes) -> None:
    """Refuse a measurement of a container whose channel or column holds no heights."""
    from SurfaceTopography.IO import open_topography

    channels = _tried(where, lambda: list(open_topography(member.open).channels))
    called = ""
    if isinstance(source, int) and source < len(channels):
        called = str(channels[source].name)
    if called and not holds_heights(called):
        raise InputError(
            f"{where}: takes channel {called!r}, which holds no heights; remove it from the"
            " container"
        )
    text = text_of(head)
    if text is not None and 1 < text.width <= BROADEST_TABLE and text.heads and not _is_known(head):
        columns_of(where, replace(text, odd=0), None)


def _measurement(
    where: str,
    name: str,
    topography: Any,
    head: bytes,
    steps: tuple[str, ...],
    settings: TopographySettings,
    instrument: InstrumentSettings,
) -> Measurement:
    """A topography of SurfaceTopography in nm, by the unit of file, columns or scene."""
    unit = topography.unit or instrument.unit
    factors = _factors_to_nm(where, unit, head)
    if factors is None:
        kind = "profile" if topography.dim == 1 else "map"
        raise InputError(
            f"{where}: a {kind} without length unit; state it in topography.instruments (files:"
            f" {Path(where).name!r}, unit: um, height_unit: nm; --unit um,nm) or in the heads of"
            " its columns"
        )
    if instrument.height_unit and not topography.unit:
        factors = factors[0], nm_of(where, instrument.height_unit)
    radius = _stated_radius(where, topography.info)
    if topography.dim == 1:
        x, z = _tried(where, lambda: _points(*topography.positions_and_heights()))
        data = _profile(where, name, x * factors[0], z * factors[1])
        bow = topography.info.get("detrend_mode") == "curvature"
        data = replace(data, bow=bow, steps=(*steps, *data.steps))
        return with_limits(data, settings, instrument, radius)
    _check_sized(where, topography, instrument)
    heights = factors[1] * _tried(where, lambda: _filled(topography.heights()))
    x_nm, y_nm = (factors[0] * float(size) for size in topography.physical_sizes)
    return _scan(where, name, heights, (x_nm, y_nm), steps, settings, instrument, radius)


def _scan(
    where: str,
    name: str,
    heights_nm: np.ndarray,
    lengths_nm: tuple[float, float],
    steps: tuple[str, ...],
    settings: TopographySettings,
    instrument: InstrumentSettings,
    radius_nm: float | None = None,
) -> Measurement:
    """A map with its instrument's limits, cut as asked; missing points are NaN."""
    if min(heights_nm.shape) < MIN_SIDE:
        raise InputError(_too_small(where, heights_nm.shape))
    _check_size(where, *lengths_nm)
    scan = without_missing(Scan(heights_nm, lengths_nm, name, steps))
    if instrument.crop is not None:
        scan = _cut(where, scan, instrument.crop)
    _check_heights(where, scan.heights_nm)
    return with_limits(scan, settings, instrument, radius_nm)


def _cut(where: str, scan: Scan, crop: Any) -> Scan:
    """The part of a map that the user asks for."""
    heights, window = cropped(where, scan.heights_nm, crop)
    if min(heights.shape) < MIN_SIDE:
        raise InputError(_too_small(where, heights.shape))
    pixels = scan.pixel_nm
    lengths = heights.shape[0] * pixels[0], heights.shape[1] * pixels[1]
    ranges = ", ".join(f"{side.start}:{side.stop}" for side in window)
    step = f"cut to the pixels {ranges} of {scan.heights_nm.shape[0]} x {scan.heights_nm.shape[1]}"
    steps = (*scan.steps, step)
    heights = np.ascontiguousarray(heights)
    return replace(scan, heights_nm=heights, lengths_nm=lengths, steps=steps)


def _too_small(where: str, shape: Sequence[int]) -> str:
    return f"{where}: {shape[0]} x {shape[1]} pixels; at least {MIN_SIDE} a side"


def _profile(where: str, name: str, x_nm: np.ndarray, z_nm: np.ndarray) -> Profile:
    try:
        profile = profile_of(x_nm, z_nm, name)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    _check_size(where, profile.length_nm)
    _check_heights(where, profile.heights_nm)
    return profile


def _factors_to_nm(where: str, unit: str | None, head: bytes) -> tuple[float, float] | None:
    """Factors to nm of positions and heights by a unit, or else by column heads; None without."""
    if unit:
        return nm_of(where, unit), nm_of(where, unit)
    text = text_of(head)
    if text is None or not 1 < text.width <= BROADEST_TABLE or not text.heads:
        return None
    across, up = columns_of(where, replace(text, odd=0), None).units
    if not across or not up:
        return None
    return nm_of(where, across), nm_of(where, up)


def _stated_radius(where: str, info: Any) -> float | None:
    """Radius of the tip in nm as files and containers state it with their instrument; else None."""
    for key in ("instrument", "parameters", "tip_radius"):
        if not isinstance(info, dict):
            return None
        info = info.get(key)
    if not isinstance(info, dict):
        return None
    radius = info.get("value")
    if not isinstance(radius, (int, float)) or radius <= 0:
        return None
    return float(radius) * nm_of(f"{where}: tip_radius", str(info.get("unit")))


def _points(x: Any, z: Any) -> tuple[np.ndarray, np.ndarray]:
    return _filled(x), _filled(z)


def _filled(values: Any) -> np.ndarray:
    return np.ma.filled(np.ma.asarray(values, dtype=float), np.nan)


def _check_sized(where: str, item: Any, instrument: InstrumentSettings) -> None:
    lacks, keys = _lacking(Path(where).name, item, instrument)
    if "--size" in keys:
        raise InputError(
            f"{where}: has no {lacks}; state them in topography.instruments {keys}, or save it with"
            " both (.gwy)"
        )


def _also(name: str, item: Any, instrument: InstrumentSettings) -> str:
    """What a file leaves open besides its channel, in words for a message."""
    lacks, keys = _lacking(name, item, instrument)
    if not lacks:
        return ""
    return f"; they have no {lacks}: state them, too, in topography.instruments {keys}"


def _lacking(name: str, item: Any, instrument: InstrumentSettings) -> tuple[str, str]:
    """Size and unit that neither file nor user states, with keys and options."""
    sizes = item.physical_sizes or instrument.size
    sized = sizes is not None and all(
        np.isfinite(size) and size > 0 for size in np.atleast_1d(sizes)
    )
    named = item.unit or instrument.unit
    size_words = ("physical size", "size: [1, 1]", "--size 1x1")
    if item.dim == 1:
        size_words = ("length", "size: [1]", "--size 1")
    missing = []
    if not sized:
        missing.append(size_words)
    if not named:
        missing.append(("length unit", "unit: um, height_unit: nm", "--unit um,nm"))
    lacks = " and no ".join(words for words, _, _ in missing)
    keys = ", ".join([f"files: {name!r}", *(key for _, key, _ in missing)])
    options = " ".join(option for _, _, option in missing)
    return lacks, f"({keys}; {options})"


def _check_size(where: str, *lengths_nm: float) -> None:
    """Refuse sizes that no instrument measures."""
    low, high = FILE_NM
    if not all(low <= length <= high for length in lengths_nm):
        size = " x ".join(f"{length:.4g}" for length in lengths_nm)
        raise InputError(
            f"{where}: a size of {size} nm; plausible is {low:g} .. {high:g} nm, so its unit may be"
            " mistaken: save it again with the size in nm or um (.gwy)"
        )


def _check_heights(where: str, heights_nm: np.ndarray) -> None:
    """Refuse heights that no surface has."""
    high = FILE_NM[1]
    if not np.isfinite(heights_nm).any():
        raise InputError(f"{where}: no pixel has a height; measure again")
    # about the median, since some instruments count from far away
    largest = float(np.nanmax(np.abs(heights_nm - np.nanmedian(heights_nm))))
    if largest > high:
        raise InputError(
            f"{where}: a height of {largest:.3g} nm; plausible is up to {high:g} nm about the"
            " median, so the file may be damaged or its unit mistaken: save it again (.gwy)"
        )


def _tried(where: str, read: Callable[[], Any], file: Path | None = None, head: bytes = b"") -> Any:
    """What a reader gives; readers of foreign formats fail in many ways."""
    from SurfaceTopography.IO import CannotDetectFileFormat

    try:
        return read()
    except CannotDetectFileFormat as error:
        file = file or Path(where)
        raise InputError(
            why_not_read(file, head, str(error)).replace(str(file), where, 1)
        ) from None
    except Exception as error:
        raise InputError(
            f"{where}: heights cannot be read ({first_line(error)}); is the file complete?"
        ) from None


def write_gwy(path: str | Path, scan: Scan) -> None:
    """Write heights to a Gwyddion file in metres; missing pixels become its mask."""
    metre = 1e-9
    x, y = (length * metre for length in scan.lengths_nm)
    write_channels(path, {"Height": (scan.heights_nm * metre, "m")}, (x, y))
