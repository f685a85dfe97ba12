"""Do pads and spheres pull as measured: diamond films (Thimons et al., 2021), and the trends of DelRio et al. (2005)?

Rows are those of scenes `diamond` and `adhesion` with coupled mechanics. On diamond films a ruby sphere of 0.5 mm was
measured to pull with 0.08 to 7.15 mJ/m².
"""

from argparse import Namespace
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from evidence.pad.runs import results_of
from mesoscale.tables import load_table

COLUMNS = (
    "varied", "rms_nm", "gap_cutoff_nm", "load_MPa", "energy_uJ_m2", "energy_uJ_m2_error", "flats_uJ_m2",
    "sphere_work_mJ_m2", "sphere_work_mJ_m2_lowest", "sphere_work_mJ_m2_highest",
)  # fmt: skip


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """The rows of both scenes."""
    for scene in ("diamond", "adhesion"):
        with results_of(scene, "adhesion") as results:
            for row in load_table(results / "adhesion" / "summary.csv"):
                if row["mechanics"] == "coupled":
                    yield {"scene": scene, **{name: _number(row[name]) for name in COLUMNS}}


def _number(text: str) -> Any:
    return float(text) if text[:1].isdigit() else text


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """The work on the diamond film by both attractions, and energies over those of flats on smooth and rough films."""

    def work(*varied: str) -> str:
        kept = [row for row in rows if row["scene"] == "diamond" and row["varied"] in varied]
        low = min(float(row["sphere_work_mJ_m2_lowest"]) for row in kept)
        high = max(float(row["sphere_work_mJ_m2_highest"]) for row in kept)
        return f"{low:.2g} to {high:.2g} mJ/m²"

    def over_flats(rms: float, load: float) -> str:
        (row,) = (
            row for row in rows
            if (row["scene"], row["varied"]) == ("adhesion", "rms")
            and (float(row["rms_nm"]), float(row["load_MPa"])) == (rms, load)
        )  # fmt: skip
        return f"{float(row['energy_uJ_m2']) / float(row['flats_uJ_m2']):.1f}"

    return {
        "hamaker": work("none", "gap_cutoff"),
        "fitted": work("work"),
        "smooth": over_flats(2.6, 0.05),
        "rough": over_flats(10.3, 2.0),
    }
