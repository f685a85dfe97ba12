"""Does what pressing a quarter of a real map gives lie inside the 90 % interval that the other
three quarters give?

Every map with square pixels below a folder, cut into four. The description, of the kind that all
four choose, is made from three quarters and judged by pressing the fourth, as a scene judges the
scans of a film. A map has one place of a film only, and its quarters are small: they see few long
waves.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from evidence.record import load
from evidence.topography.real_files import INPUTS, STATED
from mesoscale.errors import InputError
from mesoscale.scan_checks.judged import judge
from mesoscale.scan_checks.surface import has_square_pixels
from mesoscale.settings import ContactSettings, TopographySettings
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.loading import Measurement, load_measurements
from mesoscale.topography.pooling import pool
from mesoscale.topography.records import record, trusted_record

FEWEST_PIXELS = 64  # a side of a quarter


def arguments(parser: argparse.ArgumentParser) -> None:
    """Where the files lie."""
    parser.add_argument("folder", type=Path)


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """One row for each number that a quarter is judged by, of maps that the table does not have."""
    present = {(row["file"], row["map"]) for row in load("topography.quarters")}
    for path in sorted(path for path in given.folder.rglob("*") if path.is_file()):
        settings = TopographySettings.model_validate(
            {"scans": ["file"], **STATED.get(path.name, {})}
        )
        try:
            measured = load_measurements(path, path.stem, settings)
        except InputError:  # `real_files` has the refusals
            continue
        for item in measured:
            if not has_square_pixels(item.data) or (path.name, item.data.name) in present:
                continue
            if min(item.data.heights_nm.shape) >= 2 * FEWEST_PIXELS:
                for row in judged(item, cut(item.data), settings):
                    yield {"file": path.name, "map": item.data.name, **row}


def judged(
    measured: Measurement, scans: Sequence[Scan], settings: TopographySettings
) -> Iterator[dict[str, Any]]:
    """Each quarter of a map pressed beside surfaces of the other three; nothing where they cannot
    be described.
    """
    arrays, attributes = {}, {}
    try:
        for scan in scans:
            arrays[scan.name], attributes[scan.name] = record(
                replace(measured, data=scan), settings
            )
            attributes[scan.name] |= {"file": scan.name, "sha256": ""}
        name = pool(arrays, attributes, settings, cell_nm=None).choice.name
    except InputError:
        return
    spectra = [trusted_record(key, data, attributes[key]) for key, data in arrays.items()]
    for row in judge(scans, spectra, name, INPUTS, settings, ContactSettings(mechanics="asperity")):
        yield {
            key: row[key]
            for key in (
                "scan",
                "description",
                "quantity",
                "pressed",
                "median",
                "low",
                "high",
                "inside",
            )
        }


def cut(scan: Scan) -> list[Scan]:
    """The quarters of a map."""
    nx, ny = (side // 2 for side in scan.heights_nm.shape)
    quarters = []
    for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
        heights = np.ascontiguousarray(
            scan.heights_nm[i * nx : (i + 1) * nx, j * ny : (j + 1) * ny]
        )
        sides = nx * scan.pixel_nm[0], ny * scan.pixel_nm[1]
        quarters.append(Scan(heights, sides, f"{scan.name}_{2 * i + j + 1}"))
    return quarters


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Maps, and the share inside: of all numbers, of RMS heights and of first contacts."""
    found = {"maps": str(len({row["map"] for row in rows}))}
    for name in ("numbers", "rms", "first_contact"):
        mine = [row["inside"] == "True" for row in rows if name in ("numbers", row["quantity"])]
        found[name], found[f"{name}_inside"] = f"{sum(mine)} of {len(mine)}", f"{np.mean(mine):.0%}"
    return found
