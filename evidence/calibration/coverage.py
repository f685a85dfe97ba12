"""Do intervals of posteriors hold the truth as often as they say (simulation-based calibration)?

Truths are drawn from the prior, data from the engine's own surfaces at these truths, and every
posterior is that of the product's responses and likelihood, by importance sampling of prior draws.
Ranks of the truths are uniform if all is well (Talts et al., arXiv 1804.06788). A set is left out
only where its own datum is missing: a surface that never pushes that much. That depends on the data
alone, and so keeps ranks uniform.
"""

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import kstest

from mesoscale.calibration.measurements import Measurements
from mesoscale.calibration.observables import (
    CURVES,
    LEVELS,
    NAMES,
    SCALARS,
    Cycles,
    curve_names,
    cycles_of_rows,
    force_levels_nN,
    observe_runs,
)
from mesoscale.calibration.posterior import Model
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.table import input_table
from mesoscale.settings import ContactSettings
from mesoscale.uncertainty.designs import Run, random_runs

Array = NDArray[np.float64]

SETS, SURFACES = 250, 10
"""Made-up truths, and surfaces at each; coverage is then known to 1.9 %."""
POOL = 4000
"""Draws of the prior that are weighed for every set."""
FEWEST_EFFECTIVE = 50.0
"""A posterior with fewer effective draws is counted and left out: its ranks would be too coarse."""
FIRST_SET_SEED = 1_900_000_000
FORCE_POINTS = 20
RUNS = 3200
"""Cycles behind the responses: their error is shared by all sets and would shift all ranks
together.
"""
CONTACT = ContactSettings(mechanics="asperity", pixels=128, attraction="clamped")
SIGNIFICANCE = 0.05
"""Chance that any of the tests of uniform ranks fails although all are uniform."""
D0_SPREAD = 0.15
"""Standard deviation of ln D0 between sets whose law of attraction the responses do not know; they
have 0.165 nm.
"""
PULL_OFF_SPREAD = 2.8 * D0_SPREAD
"""What that is in ln of the pull-off force: on 830 surfaces with D0 from 0.12 to 0.3 nm it went as
D0^-2.8.
"""


@dataclass(frozen=True)
class Case:
    """Data of one kind.

    Attributes
    ----------
    count : surfaces or values.
    wrong : whether the surfaces have another law of attraction than the responses.
    """

    kind: str
    count: int
    discrepancy: float = 0.0
    wrong: bool = False


CASES = (
    Case("closing_curves", 1),
    Case("opening_curves", 1),
    Case("contact_begin", 1),
    Case("contact_begin", 10),
    Case("pull_off", 1),
    Case("pull_off", 10),
    Case("hardness", 3),
    Case("modulus", 1),
    Case("pull_off", 10, wrong=True),
    Case("pull_off", 10, discrepancy=PULL_OFF_SPREAD, wrong=True),
)


def rows(given: Any) -> Iterator[dict[str, Any]]:
    """One row for each case."""
    table = input_table()
    truths, pool = table.sample(SETS, 17), table.sample(POOL, 5)
    over_prior = [
        random_runs(table, first, first + 100, seed=11, first_surface=FIRST_SET_SEED)
        for first in range(0, RUNS, 100)
    ]
    drawn = CONTACT.gap_cutoff_nm * np.exp(
        D0_SPREAD * np.random.default_rng(np.random.SeedSequence([0xD0])).standard_normal(SETS)
    )
    with ProcessPoolExecutor() as workers:
        parts = list(workers.map(_observed, over_prior, [CONTACT] * len(over_prior)))
        known = {}
        for wrong in (False, True):
            at_truths = [
                [
                    Run(
                        k,
                        -1,
                        FIRST_SET_SEED + 10_000 + 100 * number + k,
                        dict(zip(table.names, truth, strict=True)),
                    )
                    for k in range(SURFACES)
                ]
                for number, truth in enumerate(truths.tolist())
            ]
            contacts = [
                CONTACT.model_copy(update={"gap_cutoff_nm": d0} if wrong else {})
                for d0 in drawn.tolist()
            ]
            known[wrong] = np.array(
                [cycles.y for cycles in workers.map(_observed, at_truths, contacts)]
            )
    cycles = Cycles(np.vstack([part.x for part in parts]), np.vstack([part.y for part in parts]))
    with ProcessPoolExecutor() as workers:
        asked = [
            workers.submit(coverage_row, case, table, cycles, truths, known[case.wrong], pool)
            for case in CASES
        ]
        yield from (one.result() for one in asked)


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """What 90 % intervals hold, and whether ranks are uniform (Kolmogorov and Smirnov's test,
    Bonferroni's bound).
    """

    def held(some: Sequence[Mapping[str, str]]) -> str:
        shares = [float(row[key]) for row in some for key in row if key.startswith("coverage_")]
        return f"{100 * min(shares):.0f} to {100 * max(shares):.0f} %"

    known = [row for row in rows if row["wrong_d0"] == "False"]
    wrong = [row for row in rows if row["wrong_d0"] == "True"]
    tests = [float(row[key]) for row in known for key in row if key.startswith("uniform_p_")]
    return {
        "kinds": str(len({row["kind"] for row in known})),
        "sets": str(min(int(row["sets"]) for row in known)),
        "held": held(known),
        "smallest_p": f"{min(tests):.4f}",
        "bound_p": f"{SIGNIFICANCE / len(tests):.4f}",
        "not_uniform": str(sum(p < SIGNIFICANCE / len(tests) for p in tests)),
        "held_wrong": held([row for row in wrong if float(row["discrepancy"]) == 0]),
        "held_stated": held([row for row in wrong if float(row["discrepancy"]) > 0]),
    }


def table_of(
    case: Case, y: Array, x: Array, names: Sequence[str], rng: np.random.Generator
) -> Measurements | None:
    """Data with drawn errors from the surfaces y (SURFACES, k) at inputs x (n,); None where a datum
    is missing.
    """
    kind, count = case.kind, case.count
    named = dict(zip(names, x.tolist(), strict=True))
    specimens = tuple(f"s{k}" for k in range(count))
    noise = rng.standard_normal(count)
    if kind in SCALARS:
        truth = y[:count, NAMES.index(SCALARS[kind])]
        error = 0.1 * truth if kind == "pull_off" else np.full(count, 0.5)
        columns = {kind: truth + error * noise, f"{kind}_error": error}
    elif kind == "hardness":
        area = np.geomspace(40, 4000, count)
        truth = named["h_macro"] + named["h_prime"] * area**-0.25
        columns = {
            "area": area,
            "hardness": truth + 0.3 * noise,
            "hardness_error": np.full(count, 0.3),
        }
    elif kind == "modulus":
        columns = {"e_star": named["e_star"] + 3 * noise, "e_star_error": np.full(count, 3.0)}
    else:
        columns = _curves(kind, y[:count], rng)
        specimens = tuple(np.repeat(specimens, FORCE_POINTS).tolist())
    if not all(np.isfinite(values).all() for values in columns.values()):
        return None
    return Measurements(kind, columns, specimens, False, case.discrepancy, "made up")


def _curves(kind: str, y: Array, rng: np.random.Generator) -> dict[str, Array]:
    """Points of curves, each with its own unknown zero."""
    first = NAMES.index(curve_names(CURVES[kind])[0])
    steps = np.column_stack([np.zeros(len(y)), np.cumsum(y[:, first + 1 : first + LEVELS], axis=1)])
    forces = force_levels_nN(CONTACT.max_force_nN)
    points = np.geomspace(forces[0], forces[-1], FORCE_POINTS)
    curves = [
        np.interp(np.log(points), np.log(forces), row) + rng.uniform(-20, 20)
        for row in y[:, first : first + 1] - steps
    ]
    size = len(y) * FORCE_POINTS
    return {
        "separation": np.concatenate(curves) + 0.2 * rng.standard_normal(size),
        "force": np.tile(points, len(y)),
        "separation_error": np.full(size, 0.2),
    }


def coverage_row(
    case: Case, table: InputTable, cycles: Cycles, truths: Array, surfaces: Array, pool: Array
) -> dict[str, Any]:
    """Coverage of central 90 % intervals and uniformity of ranks for one kind of data.

    Parameters
    ----------
    cycles : behind the responses.
    truths : inputs, shape (sets, n).
    surfaces : observables at each, shape (sets, SURFACES, k).
    pool : draws of the prior, shape (p, n).
    """
    model = Model(table, cycles, {}, CONTACT.max_force_nN)
    rng = np.random.default_rng(np.random.SeedSequence([0x5BC, CASES.index(case)]))
    ranks, effective, missing = [], [], 0
    for truth, y in zip(truths, surfaces, strict=True):
        data = table_of(case, y, truth, table.names, rng)
        if data is None:
            missing += 1
            continue
        logs = np.concatenate(
            [model.posterior([data]).log_likelihood(part) for part in np.array_split(pool, 8)]
        )
        weights = np.exp(logs - logs.max())
        weights /= weights.sum()
        effective.append(1 / (weights**2).sum())
        if effective[-1] > FEWEST_EFFECTIVE:
            ranks.append((weights[:, None] * (pool < truth)).sum(axis=0))
    inside = np.abs(np.array(ranks) - 0.5) < 0.45
    row: dict[str, Any] = {
        "kind": case.kind,
        "data": case.count,
        "wrong_d0": case.wrong,
        "discrepancy": round(case.discrepancy, 3),
        "sets": len(ranks),
        "without_datum": missing,
        "too_few_draws": len(effective) - len(ranks),
        "effective_draws": round(float(np.median(effective)), 1),
    }
    for k, name in enumerate(table.names):
        row[f"coverage_{name}"] = round(float(inside[:, k].mean()), 3)
    for k, name in enumerate(table.names):
        row[f"uniform_p_{name}"] = round(float(kstest(np.array(ranks)[:, k], "uniform").pvalue), 4)
    return row


def _observed(runs: Sequence[Run], contact: ContactSettings) -> Cycles:
    return cycles_of_rows(observe_runs(runs, contact), list(runs[0].values))
