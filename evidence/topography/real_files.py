"""Does what pressing a real scan gives lie inside the 90 % interval that its description gives?

Every file below a folder: the test data of SurfaceTopography, and the diamond film of
`config/measurements`. Each map with square pixels judges the description made from itself. Loads
that press more than half of a scan into contact are counted apart: a scene does not ask for them.
Outside are an interferometer map of 1.8 mm with dust, and numbers of two ridged maps (doubt
`anisotropic`).
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.scan_checks.judged import MOST_CONTACT, judge
from mesoscale.scan_checks.surface import has_square_pixels
from mesoscale.settings import ContactSettings, TopographySettings
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.loading import load_measurements
from mesoscale.topography.pooling import pool
from mesoscale.topography.records import record, trusted_record

# what a scene would state for these files: channels where there are several, units where there are
# none, instruments
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
FIRST_CONTACT = {
    "pressed": "first_contact_nm",
    "median": "described_nm",
    "low": "low_nm",
    "high": "high_nm",
}
COLUMNS = (
    *(
        "file",
        "measurements",
        "description",
        "doubts",
        "cell_nm",
        "length_nm",
        *FIRST_CONTACT.values(),
        "inside",
    ),
    *("numbers_inside", "all_loads_inside", "refused"),
)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Where the files lie."""
    parser.add_argument("folder", type=Path)


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """One row for each file."""
    for path in sorted(path for path in given.folder.rglob("*") if path.is_file()):
        try:
            found = described(path)
        except InputError as error:
            found = {"refused": str(error).replace(f"{path.parent}/", "")}
        yield {**dict.fromkeys(COLUMNS, ""), "file": path.name, **found}


def described(path: Path) -> dict[str, Any]:
    """The description of one file, and what pressing its maps says of it."""
    settings = TopographySettings.model_validate({"scans": ["file"], **STATED.get(path.name, {})})
    measured = load_measurements(path, settings=settings)
    arrays, attributes = {}, {}
    for item in measured:
        arrays[item.data.name], attributes[item.data.name] = record(item, settings)
    images = [trusted_record(key, data, attributes[key]) for key, data in arrays.items()]
    pooled = pool(arrays, attributes, settings, cell_nm=None)
    found: dict[str, Any] = {
        "measurements": len(measured),
        "description": pooled.choice.name,
        "doubts": " ".join(doubt.code for doubt in pooled.doubts),
        "cell_nm": pooled.cell_nm,
        "length_nm": max(float(values["length_x_nm"]) for values in attributes.values()),
    }
    maps = [
        item.data
        for item in measured
        if isinstance(item.data, Scan) and has_square_pixels(item.data)
    ]
    judged = list(
        judge(
            maps,
            images,
            pooled.choice.name,
            INPUTS,
            settings,
            ContactSettings(mechanics="asperity"),
            most_contact=1.0,
        )
    )
    for first in [item for item in judged if item["quantity"] == "first_contact"][:1]:
        found |= {name: first[key] for key, name in FIRST_CONTACT.items()} | {
            "inside": first["inside"]
        }
        asked = [item["inside"] for item in judged if item["in_contact"] <= MOST_CONTACT]
        found["numbers_inside"] = f"{sum(asked)} of {len(asked)}"
        found["all_loads_inside"] = f"{sum(item['inside'] for item in judged)} of {len(judged)}"
    return found


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Files, refusals, and numbers inside their intervals."""
    pressed = [row for row in rows if row["inside"]]
    found = {
        "files": str(len(rows)),
        "refused": str(sum(bool(row["refused"]) for row in rows)),
        "maps": str(len(pressed)),
        "first_contact": str(sum(row["inside"] == "True" for row in pressed)),
    }
    for column, name in (("numbers_inside", "numbers"), ("all_loads_inside", "with_all_loads")):
        inside, asked = (sum(int(row[column].split()[k]) for row in pressed) for k in (0, 2))
        found[name] = f"{inside} of {asked}"
    return found
