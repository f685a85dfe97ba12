"""What a file is: packed files are unpacked, two formats converted, others named with a remedy."""

import bz2
import gzip
import lzma
import re
import shutil
import tempfile
import zipfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from asperity.guards.bundle import ROOT
from asperity.guards.foreign_yaml import parse
from mesoscale.errors import InputError
from mesoscale.extras import needs
from mesoscale.topography.measurements.channels import listed

FORMATS = ROOT / "config" / "formats.yaml"
PACKED = {b"\x1f\x8b": gzip.open, b"BZh": bz2.open, b"\xfd7zXZ\x00": lzma.open}
LISTS = ("meta.yml", "index.json")  # of a container of contact.engineering
WITHOUT_MARK = ("hgt", "nms")
"""Formats whose readers take files of others, because they have no first bytes of their own."""
LONGEST = 160  # characters of a reader's reason


def foreign(path: Path, head: bytes, by_name: bool) -> str | None:
    """Name of a format that nothing here reads (config/formats.yaml), and a remedy; else None.

    Parameters
    ----------
    by_name : the end of its name counts, too; else its first bytes alone.
    """
    if not head:
        return f"{path}: the file is empty; get it again"
    for item in _formats():
        begins = [text.encode() for text in item.get("begins", ())]
        begins += [bytes.fromhex(text) for text in item.get("hex", ())]
        if begins and head.startswith(tuple(begins)):
            return _named(path, item)
    if not by_name:
        return None
    name = path.name.lower()
    by_ending = (item for item in _formats() if name.endswith(tuple(item.get("ends", ("\0",)))))
    return next((_named(path, item) for item in by_ending), None)


def _named(path: Path, item: Mapping[str, Any]) -> str:
    return f"{path}: is {item['name']}, which is not read; {item['way']}"


@cache
def _formats() -> list[dict[str, Any]]:
    return parse(FORMATS.read_text(encoding="utf-8"))


def unpacked(path: Path, head: bytes) -> Path:
    """The file, or the only file in an archive; a container of contact.engineering stays.

    Raises
    ------
    InputError : an archive of several files or of none, or one that cannot be unpacked.
    """
    opens = next((opens for begins, opens in PACKED.items() if head.startswith(begins)), None)
    if opens is not None:
        name = path.name
        if path.suffix.lower() in (".gz", ".bz2", ".xz"):
            name = path.stem
        if Path(name).suffix == ".tar":
            raise InputError(f"{path}: is an archive of files; unpack it and give them")
        try:
            with opens(path, "rb") as packed:
                return _copied(packed, name)
        except (OSError, EOFError, lzma.LZMAError) as error:
            raise InputError(
                f"{path}: cannot be unpacked ({error}); is the file complete?"
            ) from None
    if path.suffix.lower() != ".zip":
        return path
    try:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
            inside = [name for name in names if not name.endswith("/") and not _hidden(name)]
            if set(LISTS) & set(names):
                return path
            if len(inside) == 1:
                with archive.open(inside[0]) as packed:
                    return _copied(packed, Path(inside[0]).name)
    except Exception as error:  # of damaged, encrypted and foreign archives
        raise InputError(
            f"{path}: this archive cannot be read ({first_line(error)}); get it again"
        ) from None
    raise InputError(
        f"{path}: neither a container of contact.engineering nor one file alone, it holds"
        f" {listed(inside)}; unpack it and give its files, or the folder"
    )


def _hidden(name: str) -> bool:
    return any(folder.startswith((".", "__MACOSX")) for folder in Path(name).parts)


def _copied(stream: Any, name: str) -> Path:
    path = Path(tempfile.mkdtemp()) / (name or "file")
    with path.open("wb") as copy:
        shutil.copyfileobj(stream, copy)
    return path


def converted(path: Path, head: bytes) -> Path:
    """The file, or a Gwyddion file made of a Gwyddion Simple Field or a scan of Nanonis.

    Raises
    ------
    InputError : the file is damaged.
    """
    if head.startswith(b"Gwyddion Simple Field"):
        read = _simple_field
    elif head.startswith(b":NANONIS_VERSION:"):
        read = _nanonis
    else:
        return path
    try:
        channels, lengths_m = read(path)
    except Exception as error:  # readers of foreign formats fail in many ways
        raise InputError(
            f"{path}: cannot be read ({first_line(error)}); is the file complete?"
        ) from None
    copy = Path(tempfile.mkdtemp()) / f"{path.stem}.gwy"
    write_channels(copy, channels, lengths_m)
    return copy


Channels = dict[str, tuple[np.ndarray, str]]
"""Heights (nx, ny), or what else was measured, and their unit, by name."""


def _simple_field(path: Path) -> tuple[Channels, tuple[float, float]]:
    with needs("scans"):
        from gsffile import read_gsf
    data, head = read_gsf(path)
    if head.get("XYUnits", "m") != "m":
        raise InputError(f"lateral unit {head['XYUnits']}; accepted is m")
    lengths = float(head.get("XReal", 1.0)), float(head.get("YReal", 1.0))
    heights = data.T.astype(float)
    return {head.get("Title", "Height"): (heights, head.get("ZUnits", ""))}, lengths


def _nanonis(path: Path) -> tuple[Channels, tuple[float, float]]:
    with needs("scans"):
        from nanonispy2.read import Scan as NanonisScan
    if path.suffix != ".sxm":  # its reader goes by the name
        copy = Path(tempfile.mkdtemp()) / f"{path.stem}.sxm"
        copy.symlink_to(path.resolve())
        path = copy
    scan = NanonisScan(str(path))
    info = scan.header["data_info"]
    units = dict(zip(info["Name"], info["Unit"], strict=True))
    channels = {}
    for name, both in scan.signals.items():
        for direction, values in both.items():
            heights = np.asarray(values, dtype=float).T
            channels[f"{name} ({direction})"] = (heights, units[name])
    x_m, y_m = (float(length) for length in scan.header["scan_range"])
    return channels, (x_m, y_m)


def write_channels(
    path: str | Path, channels: Mapping[str, tuple[np.ndarray, str]], lengths_m: tuple[float, float]
) -> None:
    """Write channels (nx, ny) in their units to a Gwyddion file; missing pixels as its mask."""
    with needs("scans"):
        from gwyfile.objects import GwyContainer, GwyDataField

    def field(values: np.ndarray, unit: str) -> GwyDataField:
        rows = np.ascontiguousarray(values.T)  # Gwyddion stores scan lines as rows
        return GwyDataField(
            rows, xreal=lengths_m[0], yreal=lengths_m[1], si_unit_xy="m", si_unit_z=unit
        )

    content = GwyContainer()
    for number, (name, (values, unit)) in enumerate(channels.items()):
        missing = ~np.isfinite(values)
        content[f"/{number}/data/title"] = name
        content[f"/{number}/data"] = field(np.where(missing, 0.0, values), unit)
        if missing.any():
            content[f"/{number}/mask"] = field(missing.astype(float), "")
    content.tofile(str(path))


def with_unit(path: Path, unit: str) -> Path:
    """A Gwyddion file whose channels without unit have this one."""
    with needs("scans"):
        from gwyfile.objects import GwySIUnit

    content, keys = _fields(path)
    for key in keys:
        for entry in ("si_unit_xy", "si_unit_z"):
            if not _unit(content[key], entry):
                content[key][entry] = GwySIUnit(unitstr=unit)
    copy = Path(tempfile.mkdtemp()) / path.name
    content.tofile(str(copy))
    return copy


def without_unit(path: Path) -> list[str]:
    """Names of the channels of a Gwyddion file that have no unit."""
    content, keys = _fields(path)
    return [
        str(content.get(f"{key}/title", key))
        for key in keys
        if not _unit(content[key], "si_unit_z")
    ]


def _fields(path: Path) -> tuple[Any, list[str]]:
    """The content of a Gwyddion file, and the keys of its channels."""
    with needs("scans"):
        import gwyfile

    content: Any = gwyfile.load(str(path))
    return content, [key for key in content if re.fullmatch(r"/\d+/data", key)]


def _unit(field: Any, entry: str) -> str:
    return str((field.get(entry) or {}).get("unitstr") or "")


def opened(path: Path, head: bytes) -> Any:
    """The reader of SurfaceTopography that takes a file.

    Where the first bytes mean a format, no other reader is asked: some take any file for theirs.

    Raises
    ------
    InputError : none takes it.
    """
    from SurfaceTopography.IO import CannotDetectFileFormat, MagicMatch, open_topography, readers

    meant = [reader for reader in readers if reader.can_read(head) == MagicMatch.YES]
    try:
        if head.startswith(b"\x93NUMPY"):  # its reader fills what is cut off
            np.lib.format.open_memmap(path, mode="r")
    except ValueError as error:
        raise InputError(
            f"{path}: cannot be read ({first_line(error)}); is the file complete?"
        ) from None
    reasons = []
    for reader in meant:
        try:
            return open_topography(str(path), format=reader.format())
        except Exception as error:  # readers of foreign formats fail in many ways
            reasons.append(f"tried {reader.__name__}: \n {error}\n\n")
    try:
        if meant:
            raise CannotDetectFileFormat("".join(reasons))
        reader = open_topography(str(path))
        if reader.format() in WITHOUT_MARK and path.suffix.lower() != f".{reader.format()}":
            raise CannotDetectFileFormat("")
    except CannotDetectFileFormat as error:
        raise InputError(why_not_read(path, head, str(error))) from None
    return reader


def why_not_read(path: Path, head: bytes, tried: str) -> str:
    """Why no reader takes a file: its known format, else the reason of the most likely reader.

    Parameters
    ----------
    tried : what SurfaceTopography says of all the readers that it tried.
    """
    from SurfaceTopography.IO import MagicMatch, readers

    if named := foreign(path, head, by_name=True):
        return named
    reasons = re.split(r"tried (\w+): *\n", tried)
    readers_and_reasons = zip(reasons[1::2], reasons[2::2], strict=False)
    reason_by_reader = {name: " ".join(text.split()) for name, text in readers_and_reasons}
    suffix = path.suffix.lower().lstrip(".")
    by_bytes = [item for item in readers if item.can_read(head) == MagicMatch.YES]
    by_name = [item for item in readers if suffix and suffix in (item.file_extensions() or ())]
    first = [item for item in (*by_bytes, *by_name) if item.__name__ in reason_by_reader]
    reason = _begins(head)
    if first:
        said = reason_by_reader[first[0].__name__]
        reason = f" ({first[0].name()}: {said[:LONGEST]})"
    return (
        f"{path}: no reader understands this file{reason}; accepted are the formats of"
        " SurfaceTopography (gwy, ibw, di, jpk, mi, nid, ps tiff, ...; all: docs/topography.md,"
        " Formats): save it as one of these, such as .gwy"
    )


def _begins(head: bytes) -> str:
    start = head[:16]
    words = start[:8].hex(" ")
    if start.isascii() and start.decode("ascii").isprintable():
        words = start.decode("ascii")
    return f" (it begins with {words!r})"


def first_line(error: Exception) -> str:
    """What an error says, in its first line."""
    lines = str(error).strip().splitlines() or [type(error).__name__]
    return lines[0][:LONGEST]
