"""Published surfaces: the ZIP containers of contact.engineering, opened without trusting them.

A container comes from a stranger. Nothing in it is executed: its metadata are read by a loader that knows plain values
and tuples only, its files are unpacked into a temporary folder under names of our own, and sizes are counted while
they are unpacked, not believed.
"""

import json
import tempfile
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from asperity.foreign_yaml import MistakenYaml, parse
from mesoscale.errors import InputError

MAX_FILES = 2000
MAX_META_BYTES = 4 * 2**20
MAX_MEMBER_BYTES = 512 * 2**20
MAX_TOTAL_BYTES = 2 * 2**30
MAX_RATIO = 200  # unpacked over packed; heights compress to a tenth, bombs to a thousandth
META_FILES = ("index.json", "meta.yml")
# what zipfile and zlib raise for damaged, encrypted or foreign archives
UNREADABLE = (
    zipfile.BadZipFile,
    zipfile.LargeZipFile,
    zlib.error,
    NotImplementedError,
    RuntimeError,
    EOFError,
    OSError,
)


@dataclass(frozen=True)
class Member:
    """One measurement of a container.

    Attributes
    ----------
    name : as the container calls it.
    path : where its data file lies unpacked.
    unit : length unit of positions and heights that the container states; None where it does not.
    sizes : physical size along each axis in that unit; None where it is not stated.
    bow : the container says that curvature belongs to the instrument.
    tip_radius_nm : None where the container does not state it.
    """

    name: str
    path: Path
    unit: str | None
    sizes: tuple[float, ...] | None
    bow: bool
    tip_radius_nm: float | None


def is_container(path: str | Path) -> bool:
    """Does the file's name say that it is a container?"""
    return Path(path).suffix.lower() == ".zip"


@contextmanager
def unpacked(path: str | Path) -> Iterator[list[Member]]:
    """The measurements of the one surface in a container, in a temporary folder that ends with the context.

    Raises
    ------
    InputError : no container, metadata that are more than plain values, several surfaces, or files that are missing
        or too large.
    """
    path = Path(path)
    with tempfile.TemporaryDirectory(prefix="asperity-") as folder:
        try:
            with zipfile.ZipFile(path) as archive:
                members = list(_members(path, archive, Path(folder)))
        except UNREADABLE as error:
            raise InputError(f"{path}: this container cannot be unpacked ({_line(error)}); get it again") from None
        yield members


def _members(path: Path, archive: zipfile.ZipFile, folder: Path) -> Iterator[Member]:
    entries = {entry.filename: entry for entry in archive.infolist()}
    if len(entries) > MAX_FILES:
        raise InputError(f"{path}: {len(entries)} files in the container; at most {MAX_FILES} are accepted")
    total = 0
    for number, description in enumerate(_descriptions(path, archive, entries)):
        file = _data_file(path, description)
        if file not in entries:
            raise InputError(f"{path}: its list names {file[:60]!r}, which the container lacks; get it again")
        data = _bytes(path, archive, entries[file], MAX_MEMBER_BYTES)
        total += len(data)
        if total > MAX_TOTAL_BYTES:
            raise InputError(f"{path}: holds more than {MAX_TOTAL_BYTES >> 20} MB; give fewer measurements")
        # the name is ours: one of the container could leave the folder
        suffix = PurePosixPath(file).suffix
        target = folder / f"{number:04d}{suffix if suffix[1:].isalnum() else ''}"
        target.write_bytes(data)
        name = str(description.get("name") or PurePosixPath(file).name)[:80]
        unit = description.get("unit")
        yield Member(
            name,
            target,
            unit if isinstance(unit, str) else None,
            _sizes(path, name, description.get("size")),
            description.get("detrend_mode") == "curvature",
            _tip_radius(description),
        )


def _descriptions(path: Path, archive: zipfile.ZipFile, entries: Mapping[str, zipfile.ZipInfo]) -> list[dict[str, Any]]:
    """What the container says about each measurement of its surface."""
    name = next((name for name in META_FILES if name in entries), None)
    if name is None:
        raise InputError(
            f"{path}: this archive has neither {' nor '.join(META_FILES)}; accepted are containers "
            "of contact.engineering"
        )
    text = _bytes(path, archive, entries[name], MAX_META_BYTES)
    content = _plain(path, name, text)
    surfaces = content.get("surfaces") if isinstance(content, dict) else None
    if not isinstance(surfaces, list) or not all(isinstance(surface, dict) for surface in surfaces) or not surfaces:
        raise InputError(f"{path}: {name} lists no surfaces; accepted are containers of contact.engineering")
    if len(surfaces) > 1:
        names = ", ".join(
            str(surface.get("name") or surface.get("description") or "?")[:30] for surface in surfaces[:5]
        )
        raise InputError(f"{path}: holds {len(surfaces)} surfaces ({names}); give a container of one surface")
    measurements = surfaces[0].get("topographies")
    if not isinstance(measurements, list) or not all(isinstance(item, dict) for item in measurements):
        raise InputError(f"{path}: {name} lists no measurements of its surface")
    return measurements


def _plain(path: Path, name: str, text: bytes) -> Any:
    """Metadata as plain values; a tag that would build anything else is refused."""
    if name.endswith(".json"):
        try:
            return json.loads(text)
        except (ValueError, RecursionError) as error:
            raise InputError(f"{path}: {name} cannot be read ({_line(error)})") from None
    try:
        return parse(text, tuples=True)
    except MistakenYaml as error:
        raise InputError(
            f"{path}: {name} holds more than plain values ({_line(error)}); it is not read, nothing was executed"
        ) from None


def _data_file(path: Path, description: Mapping[str, Any]) -> str:
    files = description.get("datafile")
    file = files.get("original") if isinstance(files, dict) else None
    if isinstance(file, dict):  # newer containers: name and checksum
        file = file.get("filename") or file.get("name")
    if not isinstance(file, str):
        raise InputError(f"{path}: a measurement without an original data file; export the container with its files")
    return file


def _bytes(path: Path, archive: zipfile.ZipFile, entry: zipfile.ZipInfo, most: int) -> bytes:
    """A file of the archive; what it unpacks to is counted, whatever its header says."""
    limit = min(most, max(entry.compress_size * MAX_RATIO, 2**16))
    with archive.open(entry) as stream:
        data = stream.read(limit + 1)
    if len(data) > limit:
        raise InputError(
            f"{path}: {entry.filename[:60]!r} unpacks to more than {limit / 2**20:.3g} MB from "
            f"{entry.compress_size / 2**20:.3g} MB; accepted is a factor of {MAX_RATIO} and {most >> 20} MB"
        )
    return data


def _sizes(path: Path, name: str, value: Any) -> tuple[float, ...] | None:
    if value is None:
        return None
    sizes = value if isinstance(value, (list, tuple)) else (value,)
    if not 1 <= len(sizes) <= 2 or not all(isinstance(s, (int, float)) and 0 < s < float("inf") for s in sizes):
        raise InputError(f"{path}: {name}: size = {str(value)[:60]}; accepted are one or two positive numbers")
    return tuple(float(size) for size in sizes)


def _tip_radius(description: Mapping[str, Any]) -> float | None:
    """Radius that newer containers state with their instrument."""
    result: Any = description
    for key in ("instrument", "parameters", "tip_radius"):
        result = result.get(key) if isinstance(result, dict) else None
    return stated_radius(result)


def stated_radius(stated: Any) -> float | None:
    """Radius in nm of a mapping of `value` and `unit`, as files and containers state it; None where it is not one."""
    metres = {"m": 1.0, "mm": 1e-3, "µm": 1e-6, "um": 1e-6, "nm": 1e-9, "Å": 1e-10, "pm": 1e-12}
    if not isinstance(stated, dict) or stated.get("unit") not in metres:
        return None
    value = stated.get("value")
    return float(value) * metres[stated["unit"]] / 1e-9 if isinstance(value, (int, float)) and value > 0 else None


def _line(error: Exception) -> str:
    return " ".join(str(error).split())[:120] or type(error).__name__
