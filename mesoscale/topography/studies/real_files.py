"""Every real file of a folder: how its surface is described, the doubts, and what pressing the scan itself gives.

python -m mesoscale.topography.studies.real_files FOLDER TABLE NUMBERS writes one row per file to TABLE and one per map
and pressed quantity to NUMBERS, and prints the shares inside the stated 90 % intervals (2 min on one core): with and
without the loads that press more than half of a scan into contact, which a scene does not ask for. With
`made-up:COUNT` as FOLDER the files are single maps of surfaces of known kind: with and without a plateau, normal and
grainy.
"""

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.law.judged_scans import MOST_CONTACT, judge
from mesoscale.settings import ContactSettings, TopographySettings
from mesoscale.tables import write_table
from mesoscale.topography.description.heights import common_heights
from mesoscale.topography.height_synthesis import Z, synthesize_heights
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.loading import Measurement, load_measurements
from mesoscale.topography.pooling import pool
from mesoscale.topography.pressing import has_square_pixels
from mesoscale.topography.records import record, trusted_record
from mesoscale.topography.roughness_spectrum import RoughSpectrum

# what a scene would state for these files: channels where there are several, units where there are none, instruments
STATED: dict[str, dict[str, Any]] = {
    "di-3.di": {"channel": "Height"},
    "nid-1.nid": {"channel": "Scan forward (Z-Axis)"},
    "opdx-3.txt": {"instruments": [{"files": "*", "unit": "m"}]},
    "csv-1.csv": {"instruments": [{"files": "*", "unit": "um"}]},
    "uncd-diamond.zip": {
        "line_alignment": "none",
        "instruments": [
            {"files": "gain_control*", "tip_radius_nm": 21.5},
            {"files": "*stylus*", "tip_radius_nm": 5000},
            {"files": "80_Scale*", "tip_radius_nm": 0, "noise_nm": 0.29},
        ],
    },
}
INPUTS = ContactInputs(hamaker=0.2, e_star=91, h_macro=2, h_prime=8, q0=0.05, hurst=0.5, rms=4)
CELL_NM, SITES = 1000.0, 128
FILE_COLUMNS = (
    *("file", "measurements", "description", "doubts", "length_nm", "first_contact_nm", "described_nm"),
    *("low_nm", "high_nm", "inside", "numbers_inside", "all_loads_inside", "refused"),
)
NUMBER_COLUMNS = ("file", "quantity", "unit", "in_contact", "pressed", "median", "low", "high", "inside")


def examined(path: Path) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """The rows of one file."""
    settings = TopographySettings.model_validate({"scans": ["file"], **STATED.get(path.name, {})})
    try:
        return _examined(path.name, load_measurements(path, settings=settings), settings)
    except InputError as error:
        return {"file": path.name, "refused": str(error).replace(f"{path.parent}/", "")}, []


def _examined(
    name: str, measured: Sequence[Measurement], settings: TopographySettings
) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    arrays, attributes = {}, {}
    for item in measured:
        arrays[item.data.name], attributes[item.data.name] = record(item, settings)
    pooled = pool(arrays, attributes, settings, CELL_NM)
    maps = [item.data for item in measured if isinstance(item.data, Scan) and has_square_pixels(item.data)]
    row: dict[str, Any] = {
        "file": name,
        "measurements": len(measured),
        "description": pooled.choice.name,
        "doubts": " ".join(doubt.code for doubt in pooled.doubts),
        "length_nm": max(float(values["length_x_nm"]) for values in attributes.values()),
    }
    images = [trusted_record(key, data, attributes[key], settings) for key, data in arrays.items()]
    judged = list(judge(maps, images, pooled.choice.name, INPUTS, settings, ContactSettings(), most_contact=1.0))
    first = next((item for item in judged if item["quantity"] == "first_contact"), None)
    if first is not None:
        names = ("pressed", "median", "low", "high", "inside")
        row |= dict(zip(FILE_COLUMNS[5:10], (first[name] for name in names), strict=True))
        row["numbers_inside"] = inside_of(item for item in judged if item["in_contact"] <= MOST_CONTACT)
        row["all_loads_inside"] = inside_of(judged)
    return row, [{"file": name, **item} for item in judged]


def inside_of(rows: Iterable[Mapping[str, Any]]) -> str:
    """How many numbers are inside their intervals, in words."""
    inside = [bool(row["inside"]) for row in rows]
    return f"{sum(inside)} of {len(inside)}"


def made_up(count: int) -> Iterator[tuple[dict[str, Any], list[dict[str, Any]]]]:
    """The rows of single maps of random surfaces: each judges the description made from itself."""
    for number in range(count):
        rng = np.random.default_rng(np.random.SeedSequence(17, spawn_key=(number,)))
        slope, roll_off = float(rng.uniform(2.3, 4.0)), 2 * np.pi / CELL_NM * float(np.exp(rng.uniform(-2, 2)))
        rms = float(np.exp(rng.uniform(0, 2)))
        psd = RoughSpectrum.from_rms(rms, roll_off, slope, 10.0).psd
        heights = common_heights([np.exp(float(rng.uniform(0.01, 0.3)) * Z)])
        larger = synthesize_heights(6 * SITES, 6 * CELL_NM, psd, heights, rms, int(rng.integers(2**31)))
        scan = Scan(larger[:SITES, :SITES], (CELL_NM, CELL_NM), f"made_up_{number}")
        settings = TopographySettings(scans=("file",), line_alignment="none", tip_radius_nm=0)
        yield _examined(scan.name, [Measurement(scan, 0.0, True)], settings)


def study(folder: Path) -> Iterator[tuple[dict[str, Any], list[dict[str, Any]]]]:
    """The rows of every file below a folder."""
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            yield examined(path)


def main(folder: str, table: str, numbers: str) -> None:
    """Write both tables after every file, so that a run cut short leaves what it has."""
    files, judged = [], []
    for row, rows in made_up(int(folder.split(":")[1])) if folder.startswith("made-up:") else study(Path(folder)):
        files.append(row)
        judged += rows
        write_table(Path(table), files, 4, FILE_COLUMNS)
        write_table(Path(numbers), judged, 4, NUMBER_COLUMNS)
        print(*(f"{key} {value}" for key, value in row.items()), sep="; ", flush=True)
    first = [row["inside"] for row in files if "inside" in row]
    print(f"files {len(files)}, refused {sum('refused' in row for row in files)}, maps pressed {len(first)}")
    print(f"first contact inside {sum(first)} of {len(first)}")
    asked = [row for row in judged if row["in_contact"] <= MOST_CONTACT]
    print(f"numbers inside {inside_of(asked)}; with loads that press more than half into contact {inside_of(judged)}")
    width = [row["high"] / row["low"] for row in judged if row["quantity"] == "first_contact"]
    print(f"upper over lower end of first contact: median {np.median(width):.3g}, largest {max(width):.3g}")


if __name__ == "__main__":
    main(*sys.argv[1:])
