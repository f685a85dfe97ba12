"""Does the shipped example of a calibration (scene `made_up`) find its known truth?

Its tables in config/measurements/made_up were made by `tables(TRUTH, CONTACT, 20, EXAMPLE_SEED)`:
the engine's surfaces with drawn errors. Results are those of target `calibration`.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mesoscale.calibration.observables import force_levels_nN, separations_at
from mesoscale.contact import run_cycle
from mesoscale.inputs.contact import contact_of
from mesoscale.settings import ContactSettings
from workflow.files.results import load_csv

TRUTH = {
    "hamaker": 0.21,
    "e_star": 93.0,
    "h_macro": 1.5,
    "h_prime": 8.0,
    "q0": 0.022,
    "hurst": 0.8,
    "rms": 5.0,
}
EXAMPLE_SEED = 77_000_000
# two of them as shares
SEPARATION_ERROR_NM, PULL_OFF_ERROR, HARDNESS_ERROR, MODULUS_ERROR_GPA = (0.2, 0.1, 0.05, 3.0)
POINTS = 25  # of a curve
INDENTS_NM2 = (40.0, 100.0, 400.0, 1000.0, 4000.0)
CONTACT = ContactSettings(mechanics="asperity", pixels=256, attraction="clamped")


def arguments(parser: ArgumentParser) -> None:
    """Results of the scene."""
    parser.add_argument("results", type=Path)


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each input."""
    for row in load_csv(given.results / "calibration/summary.csv"):
        ends = {name: float(row[name]) for name in row if name.endswith(("q05", "q50", "q95"))}
        yield {
            "input": row["parameter"],
            "unit": row["unit"],
            "truth": TRUTH[row["parameter"]],
            **ends,
        }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """How many truths the intervals hold, and how far the narrowest goes."""
    last = rows[-len(TRUTH) :]
    held = [
        float(row["posterior_q05"]) < float(row["truth"]) < float(row["posterior_q95"])
        for row in last
    ]
    widths = [
        (float(row["posterior_q95"]) - float(row["posterior_q05"]))
        / (float(row["prior_q95"]) - float(row["prior_q05"]))
        for row in last
    ]
    return {"held": f"{sum(held)} of {len(held)}", "narrowest": f"{100 * min(widths):.0f} %"}


def tables(
    truth: Mapping[str, float], contact: ContactSettings, curves: int, seed: int
) -> dict[str, list[dict[str, float | str]]]:
    """Tables by kind: closing curves and pull-off forces of the same surfaces, hardness points, a
    modulus.
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 0xDA]))
    inputs, chosen = contact_of(truth, contact)
    levels = force_levels_nN(contact.max_force_nN)
    forces = np.geomspace(levels[0], levels[-1], POINTS)
    made: dict[str, list[dict[str, float | str]]] = {
        "closing_curves": [],
        "pull_off": [],
        "hardness": [],
    }
    for k in range(curves):
        cycle, specimen = run_cycle(inputs, chosen, seed + k), f"film {k + 1}"
        # the zero is not known
        separations = separations_at(cycle.closing, forces) + rng.uniform(-20.0, 20.0)
        noisy = separations + SEPARATION_ERROR_NM * rng.standard_normal(POINTS)
        made["closing_curves"] += [
            {
                "specimen": specimen,
                "separation_nm": at,
                "force_nN": force,
                "separation_error_nm": SEPARATION_ERROR_NM,
            }
            for force, at in zip(forces.tolist(), noisy.tolist(), strict=True)
            if np.isfinite(at)
        ]
        force = -cycle.opening.net_nN.min() * (1 + PULL_OFF_ERROR * rng.standard_normal())
        made["pull_off"].append(
            {
                "specimen": specimen,
                "pull_off_nN": force,
                "pull_off_error_nN": PULL_OFF_ERROR * force,
            }
        )
    for area in INDENTS_NM2:
        value = (inputs.h_macro + inputs.h_prime * area**-0.25) * (
            1 + HARDNESS_ERROR * rng.standard_normal()
        )
        made["hardness"].append(
            {"area_nm2": area, "hardness_GPa": value, "hardness_error_GPa": HARDNESS_ERROR * value}
        )
    modulus = inputs.e_star + MODULUS_ERROR_GPA * rng.standard_normal()
    return {**made, "modulus": [{"e_star_GPa": modulus, "e_star_error_GPa": MODULUS_ERROR_GPA}]}
