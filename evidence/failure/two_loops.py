"""Is the share of devices that fail, by what is not known, and are the bands of the release those
of brute force?

A plate on pads of a known closed form. E* and D0 are common to all plates, A_H and the RMS height
are of each. `truth`: for draws of what is common, the share that fails by quadrature in A_H and
bisection in the RMS height, and the releases of plates that are solved one by one. `stated`: the
same by the response of the failure rate, and by the sum that is fitted to the answer's points; each
again with new random numbers.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from time import process_time
from typing import Any

import numpy as np
from scipy.special import ndtr, ndtri
from scipy.stats import qmc

from evidence.failure.rare_failures import (
    ATTRACTIONS,
    CUTOFFS_NM,
    PLATE,
    TABLE,
    known_pad,
    population,
)
from mesoscale.answer.known import ENDS, fit_additive, known
from mesoscale.answer.points import point_of, values_at
from mesoscale.failure.population import Population
from mesoscale.failure.rate import learn
from mesoscale.inputs.distributions import InputTable
from mesoscale.switch import switch_of
from mesoscale.switch.reserve import Attracted
from mesoscale.uncertainty.rare_events import LEAST, quantiles_of

EACH = ("hamaker", "rms")
VARIED = InputTable(
    tuple(replace(row, varies="each" if row.name in EACH else "common") for row in TABLE.rows),
    np.eye(3),
)
NODES, STEPS = 8, 14
"""Of the quadrature in A_H, and of the bisection in the RMS height, within 7 deviations."""
POINTS = 96
"""Switches behind the bands of the release."""


@cache
def plates() -> Population:
    """The plates of the study."""
    return replace(population(), table=VARIED)


def arguments(parser: ArgumentParser) -> None:
    """Options on the command line."""
    parser.add_argument("--repeats", type=int, default=20)
    parser.add_argument(
        "--draws",
        type=int,
        default=200,
        help="of what is common, by brute force; 0: those before stand",
    )


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """Rows of the truth, then of each repetition."""
    drawn = np.random.default_rng(3).normal(size=(given.draws, 4))
    if given.draws:
        for name, times in ATTRACTIONS.items():
            started = process_time()
            yield from _rows(
                f"rate_{name}", "truth", 0, quantiles_of(shares_that_fail(drawn, times)), started
            )
        for kind, chosen in (("unknown", plates().common), ("between", ~plates().common)):
            started, units = process_time(), np.where(chosen, ndtr(drawn), 0.5)
            yield from _rows(kind, "truth", 0, quantiles_of(releases_V(units)), started)
    for seed in range(given.repeats):
        started = process_time()
        units = qmc.LatinHypercube(4, rng=seed).random(POINTS)
        bands = known(fit_additive(units, releases_V(units)), plates().common, 0.0)
        for kind in ("unknown", "between"):
            ends = {
                q: {
                    "value": row["value"],
                    "low": row["value"] - 1.96 * row["error"],
                    "high": row["value"] + 1.96 * row["error"],
                }
                for q, row in bands[f"{kind}_V"].items()
            }
            yield from _rows(kind, "stated", seed, ends, started)
        response = learn(plates(), lambda *_: None, seed)
        for name, times in ATTRACTIONS.items():
            started = process_time()
            rates = response.rates(times, plates().hold_V, seed=seed)
            yield from _rows(f"rate_{name}", "stated", seed, quantiles_of(rates), started)


def shares_that_fail(z: np.ndarray, times: float) -> np.ndarray:
    """Shares by draws of what is common; the places of A_H and RMS height in z (m, 4) are not
    used.
    """
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    shares = np.zeros(len(z))
    for k, row in enumerate(z):
        for node, weight in zip(nodes, weights, strict=True):
            low, high = -7.0, 7.0
            for _ in range(STEPS):
                middle = 0.5 * (low + high)
                (point,) = plates().points(
                    np.array([[ndtri(0.5 + 0.5 * node), row[1], middle, row[3]]]), plates().hold_V
                )
                fails = Attracted(point.device, known_pad(point).curves, 0.0, coarse=True).fails(
                    times
                )
                low, high = (middle, high) if fails else (low, middle)  # smoother films fail
            shares[k] += 0.5 * weight * ndtr(0.5 * (low + high))
    return shares


def releases_V(units: np.ndarray) -> np.ndarray:
    """Releases of plates at probabilities (m, 4)."""
    points = [
        point_of(row, TABLE.names, PLATE) for row in values_at(units, TABLE, PLATE, CUTOFFS_NM)
    ]
    return np.array(
        [switch_of(PLATE).states_on(known_pad(point).curves).release_V for point in points]
    )


def _rows(
    kind: str, method: str, seed: int, ends: Mapping[str, Mapping[str, float]], started: float
) -> Iterator[dict[str, Any]]:
    for q, row in ends.items():
        yield {
            "kind": kind,
            "method": method,
            "seed": seed,
            "quantile": q,
            **row,
            "cpu_s": process_time() - started,
        }


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """In how many repetitions the interval meets that of brute force; rates below `LEAST` are
    alike.
    """
    shown = {}
    for kind in ("unknown", "between", *(f"rate_{name}" for name in ATTRACTIONS)):
        for q in map(str, ENDS):
            of = [row for row in table if (row["kind"], row["quantile"]) == (kind, q)]
            truth = [row for row in of if row["method"] == "truth"][-1]
            stated = [row for row in of if row["method"] == "stated"]
            low, high = (
                [max(float(row[end]), LEAST) for row in (truth, *stated)] for end in ("low", "high")
            )
            held = [low[k] <= high[0] and low[0] <= high[k] for k in range(1, len(low))]
            name = f"{kind.replace('-', '_')}_{q[2:]}"
            shown[f"{name}_held"], shown[f"{name}_truth"] = (
                f"{sum(held)} of {len(held)}",
                f"{float(truth['value']):.2g}",
            )
    return shown
