"""Compare two folders of results: `asperity compare results/before results/after`.

Prints what each scene says of its switch and one line for each file that differs; exits 1 if any
does. Provenance (versions, input hashes, git commit) and machine times do not count. Logs, work
folders and the report page, which is drawn from the other files and shows their times, are left
out. Without the command: `python -m workflow.compare`.
"""

import argparse
import csv
import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from asperity.guards.foreign_text import shown
from asperity.guards.foreign_yaml import load_mapping
from workflow.files.checksums import is_damaged, recorded
from workflow.files.results import checked_items, is_length_alone
from workflow.report.available import results_in
from workflow.report.verdict import verdict
from workflow.run.job import without_machine_times

PROVENANCE = {"provenance", "schema_version", "rule", "inputs_hash", "versions", "git_commit"}


def differences(first: Path, second: Path) -> Iterator[str]:
    """One line for each result file that two folders do not share, or share with other content."""
    names = [_result_files(folder) for folder in (first, second)]
    for name in sorted(names[0] | names[1]):
        if name not in names[1]:
            yield f"{name}: only in {first}"
            continue
        if name not in names[0]:
            yield f"{name}: only in {second}"
            continue
        try:
            difference = first_difference(*(content(folder / name) for folder in (first, second)))
        except Exception as error:  # a stranger's files may hold anything
            difference = (
                f"cannot be read ({' '.join(f'{type(error).__name__}: {error}'.split())[:200]})"
            )
        if difference:
            damaged = [
                f"; damaged in {folder}" for folder in (first, second) if is_damaged(folder / name)
            ]
            yield f"{name}: {difference}{''.join(damaged)}"


def _result_files(folder: Path) -> set[str]:
    files = (path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    # drawn from other results, or none
    left_out = ("logs", "work", "report.html", "figures")
    # hidden are locks and files that are being written
    return {
        str(path)
        for path in files
        if path.parts[0] not in left_out and not path.name.startswith(".")
    }


def content(path: Path) -> Any:
    """What a result file says, as nested mappings and lists, less its provenance and machine
    times.
    """
    if path.suffix == ".h5":
        return _h5_content(path)
    if path.suffix == ".csv":
        with path.open(encoding="utf-8", newline="") as stream:
            return without_machine_times(list(csv.DictReader(stream)))
    if path.suffix == ".json":
        return _without_provenance(
            without_machine_times(json.loads(path.read_text(encoding="utf-8")))
        )
    if path.suffix == ".yaml":
        return _without_provenance(load_mapping(path, "record of a run"))
    return path.read_bytes()


def _h5_content(path: Path) -> dict[str, Any]:
    with h5py.File(path, "r") as file:
        values: dict[str, Any] = {}
        attributes = {"root": _without_provenance(_attributes(file))}
        for name, item in checked_items(file).items():
            if is_length_alone(item):
                continue
            attributes[name] = _attributes(item)
            if isinstance(item, h5py.Dataset):
                values[name] = item[()]
    # values first: the first difference is the one that is named
    return {"values": values, "attributes": attributes}


def _attributes(item: Any) -> dict[str, Any]:
    """Attributes, those that hold settings as mappings, without addresses inside the file."""
    links = {"DIMENSION_LIST", "REFERENCE_LIST"}
    known = {key: value for key, value in item.attrs.items() if key not in links}
    return {
        key: json.loads(value) if isinstance(value, str) and value.startswith("{") else value
        for key, value in known.items()
    }


def _without_provenance(mapping: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in mapping.items() if key not in PROVENANCE}


def first_difference(first: Any, second: Any, place: str = "") -> str:
    """Where two contents differ first and how, in words; empty where they are the same."""
    if isinstance(first, dict) and isinstance(second, dict):
        if list(first) != list(second):
            gone = ", ".join(sorted(first.keys() - second.keys()))
            new = ", ".join(sorted(second.keys() - first.keys()))
            if not gone and not new:
                return f"{place} keys in another order"
            return f"{place} keys gone: {gone:.99}; new: {new:.99}"
        pairs = ((f"{place}/{key}", first[key], second[key]) for key in first)
    elif isinstance(first, list) and isinstance(second, list):
        if len(first) != len(second):
            return f"{place} {len(first)} entries | {len(second)} entries".strip()
        pairs = (
            (f"{place}[{k}]", *items) for k, items in enumerate(zip(first, second, strict=True))
        )
    else:
        return _value_difference(first, second, place)
    return next(filter(None, (first_difference(a, b, where) for where, a, b in pairs)), "")


def _value_difference(first: Any, second: Any, place: str) -> str:
    if isinstance(first, bytes) and isinstance(second, bytes) and first != second:
        return f"{place} other bytes".strip()
    a = np.asarray(first)
    b = np.asarray(second)
    if (a.dtype, a.shape) == (b.dtype, b.shape) and _same_values(a, b):
        return ""
    if a.dtype.kind == b.dtype.kind == "f" and a.shape == b.shape and a.ndim:
        return f"{place} differs by up to {np.nanmax(np.abs(a - b), initial=0):.3g}"
    return f"{place} {first!r:.60} | {second!r:.60}"


def _same_values(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether two arrays of one type and shape are the same to the bit."""
    if a.dtype == object:  # of which the bytes are addresses
        return a.tolist() == b.tolist()
    return a.tobytes() == b.tobytes()


def _said(folder: Path) -> str:
    """What a folder says of its switch, with its name; a stranger's files may hold anything."""
    try:
        answer = verdict(results_in(folder))
    except Exception as error:
        return (
            f"{folder.name}: its switch cannot be read ({type(error).__name__}): damaged, or of"
            " another version"
        )
    if answer is None:
        return f"{folder.name}: no switch on a pad"
    return f"{folder.name}: {answer.sentence}".replace("\u00a0", " ")


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(
        prog="asperity compare", description=(__doc__ or "").splitlines()[2]
    )
    parser.add_argument("first", type=Path)
    parser.add_argument("second", type=Path)
    chosen = parser.parse_args()
    for folder in (chosen.first, chosen.second):
        finished = os.path.isfile(folder / "scene.yaml")
        # a stranger's folder may hold a file that is named as a record is
        if not finished and all(is_damaged(result) for result in recorded(folder)):
            reason = "no results of a scene are there"
            if not os.path.isdir(folder):
                reason = "no such folder"
            print(
                f"ERROR {shown(str(folder))}: {reason}; give two folders such as results/ci",
                file=sys.stderr,
            )
            sys.exit(2)
        print(shown(_said(folder)))
    lines = list(differences(chosen.first, chosen.second))
    for line in lines or ["no difference beyond provenance and machine times"]:
        print(shown(line))
    sys.exit(bool(lines))


if __name__ == "__main__":
    main()
