"""The one writer of result files: each appears whole or not at all, with its checksum beside it
(`checksums`).

A file is written under a temporary name in its own directory, synced to disk and renamed, so that
the existence of a result means that it is complete (a half-written HDF5 file opens without
complaint).
"""

import csv
import io
import json
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asperity.guards.foreign_text import as_cell
from workflow.files.checksums import UNFINISHED, record
from workflow.schemas import UnfitTable, schema_of

SCHEMA_VERSION = 1


@dataclass(frozen=True)
class Dataset:
    """Values of an HDF5 dataset with the facts a reader needs.

    `dims` names one dimension per axis of `values`; `unit` is "1" where there is none.
    """

    values: Any
    unit: str
    long_name: str
    dims: tuple[str, ...]


@contextmanager
def atomic_path(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path beside `path`; on success sync it and rename it to `path`.

    The temporary name keeps the suffix, because foreign writers choose their format by it.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=UNFINISHED, suffix=path.suffix)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        umask = os.umask(0)
        os.umask(umask)
        # mkstemp makes private files; results follow the user's umask
        temporary.chmod(0o666 & ~umask)
        with temporary.open("rb") as stream:
            os.fsync(stream.fileno())
        # before the result: killed in between, the record waits for a file that is made again
        record(path, temporary)
        temporary.replace(path)
    except OSError as error:
        error.filename = error.filename or str(path)  # "disk full" alone would not say where
        raise
    finally:
        temporary.unlink(missing_ok=True)


def write_bytes(path: str | Path, content: bytes) -> None:
    """Write a binary result file."""
    with atomic_path(path) as temporary:
        temporary.write_bytes(content)


def write_text(path: str | Path, content: str) -> None:
    """Write a text result file (UTF-8)."""
    write_bytes(path, content.encode())


def write_csv(path: str | Path, rows: Iterable[Mapping[str, Any]]) -> None:
    """Write rows as CSV; floats keep every digit, so that reading gives back the same number.

    Parameters
    ----------
    rows : mappings from column name (with its unit as suffix) to value; a missing value is an empty
        cell. The order of the columns is that of the table's schema, of a file outside results/
        that of the first row.

    Raises
    ------
    ValueError : the table does not fit its schema (`workflow.schemas`), which every file under
        results/ has; or, elsewhere, a row has a column that the first has not.
    """
    path = Path(path)
    rows = [{key: _cell(value) for key, value in row.items()} for row in rows]
    schema = schema_of(path)
    if schema is None and "results" in path.parts:
        raise ValueError(f"{path}: no table of workflow/schemas/ is for this file")
    columns = schema.header(rows) if schema is not None else list(rows[0])
    if schema is not None and (
        misfit := schema.misfit(columns, [dict.fromkeys(columns, "") | row for row in rows])
    ):
        raise ValueError(f"{path}: {misfit}; see workflow/schemas/")
    with (
        atomic_path(path) as temporary,
        temporary.open("w", newline="", encoding="utf-8") as stream,
    ):
        writer = csv.DictWriter(stream, columns, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, str):
        return as_cell(value)
    return repr(value) if isinstance(value, float) else str(value)


def load_csv(path: str | Path) -> list[dict[str, str]]:
    """Read a CSV result file as one mapping per row (all values text).

    Raises
    ------
    UnfitTable : the file does not fit its schema (`workflow.schemas`).
    """
    path = Path(path)
    with path.open(newline="", encoding="utf-8") as stream:
        reader = csv.DictReader(stream)
        header = reader.fieldnames or ()
        rows = list(reader)
    schema = schema_of(path)
    if schema is not None and (misfit := schema.misfit(header, rows)):
        raise UnfitTable(
            f"{path}: {misfit}; damaged or of another version: delete it and run again"
        )
    return rows


def has_other_columns(path: Path) -> bool:
    """Whether a CSV result file has not the columns of this version; its rows are not read."""
    schema = schema_of(path)
    if schema is None or path.suffix != ".csv":
        return False
    with path.open(newline="", encoding="utf-8", errors="replace") as stream:
        header = next(csv.reader(stream), [])
    return bool(schema.misfit(header, ()))


def load_numbers(path: str | Path) -> list[dict[str, float]]:
    """Read a CSV result file of numbers alone; an empty cell is NaN."""
    return [{name: float(value or "nan") for name, value in row.items()} for row in load_csv(path)]


def write_json(
    path: str | Path, data: Mapping[str, Any], provenance: Mapping[str, Any] | None = None
) -> None:
    """Write a JSON result file; NaN and infinities become null, arrays become lists."""
    content = dict(data)
    if provenance is not None:
        content["provenance"] = {"schema_version": SCHEMA_VERSION, **provenance}
    write_text(
        path, json.dumps(_plain(content), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    )


def _plain(value: Any) -> Any:
    """Numpy and non-finite values as JSON has them."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value


def load_json(path: str | Path) -> dict[str, Any]:
    """Read a JSON result file."""
    return json.loads(Path(path).read_text(encoding="utf-8"))


def write_h5(
    path: str | Path,
    groups: Mapping[str, Mapping[str, Dataset]],
    attributes: Mapping[str, Any],
    provenance: Mapping[str, Any],
    group_attributes: Mapping[str, Mapping[str, Any]] | None = None,
) -> None:
    """Write an HDF5 result file.

    Parameters
    ----------
    groups : datasets by group name ("/" for the root) and dataset name.
    attributes, group_attributes : scalars, text or arrays, on the root and by group name.
    provenance : `Job.provenance`; stored on the root beside `schema_version` and `complete`.
    """
    import h5py

    # in memory first, because HDF5 floods the console where the disk is full;
    # libver and track_times: the same content gives the same bytes
    image = io.BytesIO()
    with h5py.File(image, "w", libver="latest") as file:
        for group_name, datasets in groups.items():
            group = file.require_group(group_name)
            for name, dataset in datasets.items():
                values = np.asarray(dataset.values)
                if values.ndim != len(dataset.dims):
                    raise ValueError(
                        f"{path}: {group_name}/{name} has {values.ndim} axes, not {dataset.dims}"
                    )
                options = {"compression": "gzip", "shuffle": True} if values.size > 4096 else {}
                stored = group.create_dataset(name, data=values, track_times=False, **options)
                stored.attrs["units"] = dataset.unit
                stored.attrs["long_name"] = dataset.long_name
                for axis, dim in enumerate(dataset.dims):
                    stored.dims[axis].label = dim
            _attach_scales(group, datasets)
        for group_name, values in (group_attributes or {}).items():
            file.require_group(group_name).attrs.update(_attributes(values))
        file.attrs.update(_attributes(attributes))
        file.attrs.update(_attributes({"schema_version": SCHEMA_VERSION, **provenance}))
        file.attrs["complete"] = True
    write_bytes(path, image.getvalue())


LENGTH_ALONE = "This is a netCDF dimension but not a netCDF variable."
"""Begins the name of a scale that only tells the length of a dimension (netCDF-4 format)."""


def is_length_alone(dataset: Any) -> bool:
    """Whether a dataset only tells the length of a dimension."""
    name = dataset.attrs.get("NAME", b"")
    return isinstance(name, bytes) and name.startswith(LENGTH_ALONE.encode())


def _attach_scales(group: Any, datasets: Mapping[str, Dataset]) -> None:
    """Give each dimension its scale, as netCDF readers expect.

    A dataset named like its one dimension is its coordinate. A dimension without one has a scale
    that only tells its length, marked as the netCDF library marks it.
    """
    for name, dataset in datasets.items():
        if dataset.dims == (name,):
            group[name].make_scale(name)
    lengths = {
        dim: length
        for dataset in datasets.values()
        for dim, length in zip(dataset.dims, np.shape(dataset.values), strict=True)
    }
    for dim in sorted(lengths.keys() - datasets.keys()):
        scale = group.create_dataset(dim, (lengths[dim],), ">f4", track_times=False)
        scale.make_scale(f"{LENGTH_ALONE}{lengths[dim]:10d}")
    for name, dataset in datasets.items():
        for axis, dim in enumerate(dataset.dims):
            if dim != name and (dim not in datasets or datasets[dim].dims == (dim,)):
                group[name].dims[axis].attach_scale(group[dim])


def _attributes(values: Mapping[str, Any]) -> dict[str, Any]:
    """Attributes as HDF5 stores them: nested mappings as JSON text."""
    return {
        key: json.dumps(_plain(value)) if isinstance(value, Mapping) else value
        for key, value in values.items()
        if value is not None
    }


DEEPEST = 4
"""Groups in each other in a result; the time to visit them grows with their depth squared: 3,000
take half a minute.
"""


def load_h5(
    path: str | Path,
) -> tuple[dict[str, dict[str, np.ndarray]], dict[str, Any], dict[str, dict[str, Any]]]:
    """Read an HDF5 result file: datasets by group, root attributes, attributes by group.

    Raises
    ------
    ValueError : the file is not a complete result file, or its datasets are too large or lie in
        other files.
    """
    import h5py

    groups: dict[str, dict[str, np.ndarray]] = {}
    group_attributes: dict[str, dict[str, Any]] = {}
    with h5py.File(path, "r") as file:
        if not file.attrs.get("complete", False):
            raise ValueError(f"{path}: not a complete result file; delete it and run again")
        for name, item in checked_items(file).items():
            parent, _, leaf = name.rpartition("/")
            if isinstance(item, h5py.Dataset):
                if is_length_alone(item):
                    continue
                groups.setdefault(parent or "/", {})[leaf] = item[()]
            elif item.attrs:
                group_attributes[name] = dict(item.attrs)
        return groups, dict(file.attrs), group_attributes


def checked_items(file: Any) -> dict[str, Any]:
    """Groups and datasets of an open HDF5 file, which may be a stranger's, by name; nothing is read
    of them.

    Raises
    ------
    ValueError : its datasets are too large or lie in other files.
    """
    items: dict[str, Any] = {}

    def kept(name: str, item: Any) -> bool | None:
        items[name] = item
        return True if name.count("/") > DEEPEST else None

    if file.visititems(kept):
        raise ValueError(
            f"{file.filename}: groups in groups, which no result has; delete it and run again"
        )
    datasets = [item for item in items.values() if hasattr(item, "nbytes")]
    size = sum(dataset.nbytes for dataset in datasets)
    # the largest result that ships has 18 MB; deflate packs 1032 times at most, what is not written
    # takes nothing
    if size > min(2**30, 1100 * Path(file.filename).stat().st_size):
        raise ValueError(
            f"{file.filename}: datasets of {size} bytes, more than a result has; delete it and run"
            " again"
        )
    if any(dataset.is_virtual or dataset.external for dataset in datasets):
        raise ValueError(
            f"{file.filename}: datasets that lie in other files; delete it and run again"
        )
    return items
