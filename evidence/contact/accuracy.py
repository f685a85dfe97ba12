"""What error does each numerical choice of a contact curve leave at the middle of Table 1?

The product's own study (`snakemake accuracy`) by both engines: single asperities on 1024^2 sites down to the grid, and
coupled ones on 512^2 with the cut-off of the predictive scenes. The attraction is the paper's.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from evidence.contact.draws import MIDDLE
from mesoscale.settings import ContactSettings
from mesoscale.studies.contact_accuracy import accuracy_points

SETTINGS = {
    "asperity": ContactSettings(mechanics="asperity", attraction="clamped"),
    "coupled": ContactSettings(mechanics="coupled", attraction="clamped", pixels=512, q1_per_nm=0.29),
}


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """The rows of accuracy/contact.csv of both engines."""
    for mechanics, settings in SETTINGS.items():
        for point in accuracy_points(MIDDLE, settings):
            yield {"mechanics": mechanics, **point}


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Errors (per cent) of the choices that scenes have, of outputs that matter."""

    def error(mechanics: str, knob: str, value: str, case: str) -> str:
        found = [
            row
            for row in rows
            if (row["mechanics"], row["knob"], row["value"], row["case"]) == (mechanics, knob, value, case)
        ]
        return f"{100 * float(found[-1]['error']):.2g} %"

    chosen = {"steps": ("force_steps", "40"), "grid": ("pixels", "")}
    own = {"asperity": "1024", "coupled": "512"}
    return {
        f"{mechanics}_{name}_{case.replace('-', '_').lower()}": error(mechanics, knob, value or own[mechanics], case)
        for mechanics in SETTINGS
        for name, (knob, value) in chosen.items()
        for case in ("d_c", "C_a", "C_r", "pull-off")
    }
