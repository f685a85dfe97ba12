"""What to measure next: by how much one more measurement of each kind is expected to narrow the release voltage.

Data are made up at draws of what is known, and the draws are weighed by their likelihood (pre-posterior analysis:
Raiffa and Schlaifer, Applied Statistical Decision Theory, 1961).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.calibration.likelihood import SWITCH_KINDS, Posterior
from mesoscale.calibration.measurements import CURVES, Measurements
from mesoscale.calibration.observables import force_levels_nN
from mesoscale.calibration.posterior import Calibration
from mesoscale.calibration.responses import ResponseFits
from mesoscale.calibration.sampling import SEED

Array = NDArray[np.float64]
MadeUp = Callable[[int, np.random.Generator], Array]
"""Logarithms of the likelihoods of all draws, shape (m,), with data made up at one of them."""

DRAWS = 500
REPLICATES, SHUFFLES = 100, 4
"""Made-up data sets of each kind, and for each how often its weights are shuffled."""
RELEASE_ERROR_V = 0.5
"""Of a release voltage that is measured next."""


def candidates(max_force_nN: float, contact_begin_nm: float) -> dict[str, tuple[str, Measurements]]:
    """What could be measured next, by kind: in words, and as a table whose values are made up later.

    Parameters
    ----------
    contact_begin_nm : where contact is expected to begin, which makes its error in nm a relative one.
    """
    levels = force_levels_nN(max_force_nN)
    forces = np.geomspace(levels[0], levels[-1], 30)
    curve = {"separation": np.linspace(10, 0, 30), "force": forces, "separation_error": np.full(30, 0.2)}
    one, ten = np.ones(1), np.ones(10)

    def table(kind: str, columns: dict[str, Array]) -> Measurements:
        rows = len(next(iter(columns.values())))
        names = ("next",) * rows if kind in CURVES else tuple(f"next {k}" for k in range(rows))
        return Measurements(kind, columns, names, False, 0.0, "next")

    return {
        "closing_curves": ("one curve, 30 points to 0.2 nm", table("closing_curves", curve)),
        "opening_curves": ("one curve, 30 points to 0.2 nm", table("opening_curves", curve)),
        "contact_begin": (
            "ten surfaces to 0.5 nm",
            table("contact_begin", {"contact_begin": contact_begin_nm * ten, "contact_begin_error": 0.5 * ten}),
        ),
        "pull_off": ("ten surfaces to 10 %", table("pull_off", {"pull_off": 100 * ten, "pull_off_error": 10 * ten})),
        "hardness": (
            "one indent of 100 nm2 to 5 %",
            table("hardness", {"area": 100 * one, "hardness": 4 * one, "hardness_error": 0.2 * one}),
        ),
        "modulus": ("one to 3 GPa", table("modulus", {"e_star": 90 * one, "e_star_error": 3 * one})),
        "release": (
            f"one switch to {RELEASE_ERROR_V} V",
            table("release", {"release": 20 * one, "release_error": RELEASE_ERROR_V * one}),
        ),
        "sticking": ("twenty switches", table("sticking", {"stuck": 10 * one, "switches": 20 * one})),
    }


def next_measurements(result: Calibration, max_force_nN: float) -> list[dict[str, Any]]:
    """Rows of calibration/next.csv: for the lumped switch on the law of a cell.

    A switch that sticks counts with a negative voltage (`mesoscale.calibration.switches`).
    """
    rng = np.random.default_rng(np.random.SeedSequence([SEED, 0xCD]))
    x = result.x[rng.integers(len(result.x), size=DRAWS)]
    hamaker = x[:, result.posterior.table.names.index("hamaker")]
    with_switch = replace(result.posterior, switch=result.switch, law_responses=result.laws)
    volts = with_switch.switch_voltages(x, hamaker)["release"][0]
    further = {
        kind: (words, _made_up(result.given([data], max_force_nN), x))
        for kind, (words, data) in candidates(max_force_nN, _begin_nm(result.responses, x)).items()
    }
    return _ranked(volts, further, rng)


def next_on_pad(
    given: Callable[[Sequence[Measurements]], Posterior],
    responses: ResponseFits,
    x: Array,
    volts: Array,
    max_force_nN: float,
) -> list[dict[str, Any]]:
    """Rows of calibration/next_on_pad.csv: for the switch on the pad.

    Parameters
    ----------
    given : the posterior given some tables.
    x, volts : inputs of solved switches, shape (m, n), and their release voltages; 0 where one sticks.
    """
    rng = np.random.default_rng(np.random.SeedSequence([SEED, 0xCF]))

    def released(point: int, rng: np.random.Generator) -> Array:
        measured = volts[point] + RELEASE_ERROR_V * rng.standard_normal()
        return -0.5 * ((volts - measured) / RELEASE_ERROR_V) ** 2

    possible = candidates(max_force_nN, _begin_nm(responses, x))
    further = {
        kind: (words, _made_up(given([data]), x))
        for kind, (words, data) in possible.items()
        if kind not in SWITCH_KINDS  # their likelihood is that of the lumped switch
    }
    further["release"] = (possible["release"][0], released)
    return _ranked(volts, further, rng)


def _begin_nm(responses: ResponseFits, x: Array) -> float:
    """Where contact begins, averaged over draws."""
    return float((1 / responses.pick(["contact_begin_nm"])(x).mean).mean())


def _made_up(posterior: Posterior, x: Array) -> MadeUp:
    predicted = posterior.predict(x)
    return lambda point, rng: posterior.simulated(predicted.at(point), rng).likelihood_of(predicted)


def _ranked(volts: Array, further: Mapping[str, tuple[str, MadeUp]], rng: np.random.Generator) -> list[dict[str, Any]]:
    """Expected width of the central 90 % of the release voltages after each measurement, the most useful first.

    Few draws of large weight span less than all of them, whatever was learned. So the width that weights give counts
    beside the width that the same weights give on shuffled draws.
    """
    now = _width(volts, np.full(len(volts), 1 / len(volts)))
    rows = []
    for kind, (words, made_up) in further.items():
        widths, shuffled, effective = [], [], []
        for point in rng.integers(len(volts), size=REPLICATES).tolist():
            logs = made_up(point, rng)
            weights = np.exp(logs - logs.max())
            weights /= weights.sum()
            effective.append(1 / (weights**2).sum())
            widths.append(_width(volts, weights))
            shuffled.append(np.mean([_width(volts, weights[rng.permutation(len(weights))]) for _ in range(SHUFFLES)]))
        whole = np.mean(shuffled)
        left = np.mean(widths) / whole if whole > 0 else 1.0  # all stick: nothing to narrow
        error = np.std(widths - left * np.array(shuffled)) / whole if whole > 0 else 0.0
        rows.append(
            {
                "kind": kind,
                "measurement": words,
                "width_now_V": now,
                "width_then_V": left * now,
                "reduction": 1 - left,
                "standard_error": error / np.sqrt(REPLICATES),
                "effective_samples": float(np.median(effective)),
            }
        )
    return sorted(rows, key=lambda row: -row["reduction"])


def _width(values: Array, weights: Array) -> float:
    """Width of the central 90 % of weighted values."""
    order = np.argsort(values)
    shares = np.cumsum(weights[order]) - 0.5 * weights[order]
    low, high = np.interp([0.05, 0.95], shares, values[order])
    return float(high - low)
