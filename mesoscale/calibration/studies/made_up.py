"""Made-up measurements of known truth: the engine's surfaces with drawn errors.

`python -m mesoscale.calibration.studies.made_up FOLDER` writes the tables of the shipped example, scene `made_up`.
`python -m mesoscale.calibration.studies.made_up release` prints the release voltage that its truth has.
"""

import csv
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from mesoscale.calibration.observables import LAWS, force_levels_nN, observe, separations_at
from mesoscale.calibration.switches import SwitchModel
from mesoscale.contact import run_cycle
from mesoscale.inputs.contact import contact_of
from mesoscale.settings import ContactSettings, DeviceSettings, LawSettings

TRUTH = {
    "hamaker": 0.21,
    "e_star": 93.0,
    "h_macro": 1.5,
    "h_prime": 8.0,
    "q0": 0.022,
    "hurst": 0.8,
    "rms": 5.0,
}
"""Inputs behind the shipped example, in the units of Table 1; inside its ranges and away from their middle."""
EXAMPLE_SEED = 77_000_000
SEPARATION_ERROR_NM, PULL_OFF_ERROR, HARDNESS_ERROR, MODULUS_ERROR_GPA = 0.2, 0.1, 0.05, 3.0
"""Standard deviations of the errors, those of pull-off and hardness as shares."""
POINTS = 25
"""Of a curve."""
INDENTS_NM2 = (40.0, 100.0, 400.0, 1000.0, 4000.0)
CONTACT = ContactSettings(pixels=256)
RELEASE_SURFACES, RELEASE_SEED, RESAMPLES = 400, 78_000_000, 200
"""Surfaces whose mean law gives the release at the truth, the first of them, and resampled sets for its error."""

Rows = list[dict[str, float | str]]


def made_up(truth: Mapping[str, float], contact: ContactSettings, curves: int, seed: int) -> dict[str, Rows]:
    """Tables by kind: closing curves and pull-off forces of the same surfaces, hardness points, a modulus.

    Parameters
    ----------
    truth : inputs by name.
    curves : surfaces that are measured.
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 0xDA]))
    inputs, chosen = contact_of(truth, contact)
    levels = force_levels_nN(contact.max_force_nN)
    forces = np.geomspace(levels[0], levels[-1], POINTS)
    closing: Rows = []
    pull_off: Rows = []
    for k in range(curves):
        cycle = run_cycle(inputs, chosen, seed + k)
        zero = rng.uniform(-20.0, 20.0)
        separations = separations_at(cycle.closing, forces) + zero
        for force, separation in zip(
            forces, separations + SEPARATION_ERROR_NM * rng.standard_normal(POINTS), strict=True
        ):
            if np.isfinite(separation):
                closing.append(
                    {
                        "specimen": f"film {k + 1}",
                        "separation_nm": separation,
                        "force_nN": force,
                        "separation_error_nm": SEPARATION_ERROR_NM,
                    }
                )
        deepest = -cycle.opening.net_nN.min()
        measured = deepest * (1 + PULL_OFF_ERROR * rng.standard_normal())
        pull_off.append(
            {"specimen": f"film {k + 1}", "pull_off_nN": measured, "pull_off_error_nN": PULL_OFF_ERROR * measured}
        )
    hardness: Rows = []
    for area in INDENTS_NM2:
        value = (inputs.h_macro + inputs.h_prime * area**-0.25) * (1 + HARDNESS_ERROR * rng.standard_normal())
        hardness.append({"area_nm2": area, "hardness_GPa": value, "hardness_error_GPa": HARDNESS_ERROR * value})
    stiffness = inputs.e_star + MODULUS_ERROR_GPA * rng.standard_normal()
    modulus: Rows = [{"e_star_GPa": stiffness, "e_star_error_GPa": MODULUS_ERROR_GPA}]
    return {"closing_curves": closing, "pull_off": pull_off, "hardness": hardness, "modulus": modulus}


def release_at_truth(surfaces: int) -> tuple[float, float]:
    """Release voltage (V) of the default switch on the mean law of surfaces at TRUTH, and its standard error."""
    inputs, chosen = contact_of(TRUTH, CONTACT)
    rows = [
        observe(run_cycle(inputs, chosen, RELEASE_SEED + k), LawSettings(), CONTACT.max_force_nN)
        for k in range(surfaces)
    ]
    laws = np.array([[row[law.name] for law in LAWS] for row in rows])
    laws = laws[np.isfinite(laws).all(axis=1)]
    picks = np.random.default_rng(1).integers(len(laws), size=(RESAMPLES, len(laws)))
    means = np.vstack([laws.mean(axis=0), laws[picks].mean(axis=1)])
    switch = SwitchModel.of(DeviceSettings(), LawSettings(), CONTACT.length_nm**2)
    volts = switch.release_V(switch.laws(means, np.full(len(means), TRUTH["hamaker"]))[1])
    return float(volts[0]), float(volts[1:].std())


def main(folder: str) -> None:
    """Write the tables of the shipped example, or print its release voltage."""
    if folder == "release":
        print("release at the truth: {:.3f} +- {:.3f} V".format(*release_at_truth(RELEASE_SURFACES)))
        return
    for kind, rows in made_up(TRUTH, CONTACT, 20, EXAMPLE_SEED).items():
        with (Path(folder) / f"{kind}.csv").open("w", newline="", encoding="utf-8") as stream:
            stream.write("# made up by mesoscale.calibration.studies.made_up, with known truth: no measurement\n")
            writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            for row in rows:
                writer.writerow({key: f"{x:.6g}" if isinstance(x, float) else x for key, x in row.items()})


if __name__ == "__main__":
    main(sys.argv[1])
