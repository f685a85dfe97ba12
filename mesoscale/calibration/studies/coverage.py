"""Simulation-based calibration: do intervals of posteriors hold the truth as often as they say?

Truths are drawn from the prior, data from the engine's own surfaces at these truths, and every posterior is that of the
product's responses and likelihood, by importance sampling of prior draws. Ranks of the truths are uniform if all is
well (Talts et al., arXiv 1804.06788). `python -m mesoscale.calibration.studies.coverage` prints the table.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import kstest

from mesoscale.calibration.likelihood import posterior_of
from mesoscale.calibration.measurements import ON_SURFACES, Measurements
from mesoscale.calibration.observables import CURVES, LEVELS, NAMES, curve_names, force_levels_nN
from mesoscale.calibration.posterior import Cycles, cycles_of_rows, expected_of, observe_runs, responses_of
from mesoscale.calibration.surfaces import SCALAR_COLUMNS
from mesoscale.calibration.switches import SwitchModel
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.table import input_table
from mesoscale.settings import ContactSettings, DeviceSettings, LawSettings, UncertaintySettings
from mesoscale.uncertainty.designs import Run, random_runs

Array = NDArray[np.float64]

SETS = 250
"""Made-up data sets per kind; coverage is then known to 1.9 %."""
POOL = 20000
"""Draws of the prior that are weighed for every set."""
FEWEST_EFFECTIVE = 50.0
"""A posterior with fewer effective draws is counted and left out."""
FIRST_SET_SEED = 1_900_000_000
FORCE_POINTS = 20


def table_of(
    kind: str,
    values: Array,
    x: Array,
    names: Sequence[str],
    max_force_nN: float,
    discrepancy: float,
    rng: np.random.Generator,
) -> Measurements:
    """Data of one kind with drawn errors from observables (surfaces, k) at inputs x (n,)."""
    count = len(values)
    specimens = tuple(f"s{k}" for k in range(count))
    named = dict(zip(names, x.tolist(), strict=True))
    if kind in ("pull_off", "contact_begin"):
        truth = values[:, NAMES.index("pull_off_nN" if kind == "pull_off" else "contact_begin_nm")]
        error = 0.1 * truth if kind == "pull_off" else np.full(count, 0.5)
        columns = {kind: truth + error * rng.standard_normal(count), f"{kind}_error": error}
    elif kind == "hardness":
        area = np.geomspace(40, 4000, count)
        columns = {"area": area, "hardness_error": np.full(count, 0.3)}
        columns["hardness"] = named["h_macro"] + named["h_prime"] * area**-0.25 + 0.3 * rng.standard_normal(count)
    elif kind == "modulus":
        columns = {"e_star": named["e_star"] + 3 * rng.standard_normal(count), "e_star_error": np.full(count, 3.0)}
    else:
        branch = kind.partition("_")[0]
        first = NAMES.index(curve_names(branch)[0])
        levels = values[:, first : first + 1] - np.column_stack(
            [np.zeros(count), np.cumsum(values[:, first + 1 : first + LEVELS], axis=1)]
        )
        forces = force_levels_nN(max_force_nN)
        points = np.geomspace(forces[0], forces[-1], FORCE_POINTS)
        curves = [np.interp(np.log(points), np.log(forces), row) + rng.uniform(-20, 20) for row in levels]
        columns = {
            "separation": np.concatenate(curves) + 0.2 * rng.standard_normal(count * FORCE_POINTS),
            "force": np.tile(points, count),
            "separation_error": np.full(count * FORCE_POINTS, 0.2),
        }
        specimens = tuple(np.repeat(specimens, FORCE_POINTS).tolist())
    return Measurements(kind, columns, specimens, False, discrepancy, "made up")


def coverage_rows(
    contact: ContactSettings, sets: int = SETS, cutoffs: tuple[float, float] | None = None
) -> list[dict[str, Any]]:
    """Coverage of central 90 % intervals and uniformity of ranks, one row per kind.

    Parameters
    ----------
    cutoffs : range from which the surfaces of every set take their D0 (nm), a law of attraction that the responses do
        not know; then pull-off forces alone, without and with a discrepancy.
    """
    table, law = input_table(), LawSettings()
    rng = np.random.default_rng(np.random.SeedSequence([0x5BC]))
    runs = random_runs(table, UncertaintySettings(sample_seed=11), 0, 800, first_surface=FIRST_SET_SEED)
    cycles = cycles_of_rows(observe_runs(runs, contact, law), table.names)
    responses, laws = responses_of(table, cycles)
    expected = expected_of(cycles)
    switch = SwitchModel.of(DeviceSettings(), law, contact.length_nm**2)
    pool = table.sample(POOL, 5)
    cases = [("closing_curves", 1, 0.0), ("opening_curves", 1, 0.0), ("contact_begin", 1, 0.0), ("pull_off", 1, 0.0)]
    cases += [("pull_off", 10, 0.0), ("hardness", 3, 0.0), ("modulus", 1, 0.0)]
    if cutoffs is not None:
        cases = [("pull_off", 10, 0.0), ("pull_off", 10, 0.3)]
    rows = []
    for kind, count, discrepancy in cases:
        ranks, effective = [], []
        truths = table.sample(sets, 17)
        for number, truth in enumerate(truths):
            values = np.zeros((count, len(NAMES)))
            if kind in ON_SURFACES:
                values = _surfaces(table, truth, contact, law, count, number, cutoffs)
            if not np.isfinite(values[:, _needed(kind)]).all():
                continue  # a surface that never pushes with the largest measured force
            data = table_of(kind, values, truth, table.names, contact.max_force_nN, discrepancy, rng)
            posterior = posterior_of(table, [data], responses, laws, switch, contact.max_force_nN, expected)
            logs = np.concatenate([posterior.log_likelihood(part) for part in np.array_split(pool, 20)])
            weights = np.exp(logs - logs.max())
            weights /= weights.sum()
            effective.append(1 / (weights**2).sum())
            if effective[-1] > FEWEST_EFFECTIVE:
                ranks.append([weights[pool[:, k] < truth[k]].sum() for k in range(len(truth))])
        inside = np.abs(np.array(ranks) - 0.5) < 0.45
        uniform = [kstest(column, "uniform").pvalue for column in np.array(ranks).T]
        rows.append(
            {
                "kind": kind,
                "data": count,
                "discrepancy": discrepancy,
                "sets": len(ranks),
                "left_out": sets - len(ranks),
                "effective": float(np.median(effective)),
                "coverage": dict(zip(table.names, inside.mean(axis=0).round(3).tolist(), strict=True)),
                "uniform_p": dict(zip(table.names, np.round(uniform, 3).tolist(), strict=True)),
            }
        )
    return rows


def _needed(kind: str) -> list[int]:
    """Places of the observables behind data of a kind."""
    if kind in CURVES:
        return [NAMES.index(name) for name in curve_names(CURVES[kind])]
    return [NAMES.index(SCALAR_COLUMNS[kind])] if kind in SCALAR_COLUMNS else []


def _surfaces(
    table: InputTable,
    truth: Array,
    contact: ContactSettings,
    law: LawSettings,
    count: int,
    number: int,
    cutoffs: tuple[float, float] | None,
) -> Array:
    """Observables of surfaces at one truth, shape (count, k)."""
    if cutoffs is not None:
        drawn = np.random.default_rng(np.random.SeedSequence([0xD0, number])).uniform(*cutoffs)
        contact = contact.model_copy(update={"gap_cutoff_nm": float(drawn)})
    inputs = dict(zip(table.names, truth.tolist(), strict=True))
    runs = [Run(k, -1, FIRST_SET_SEED + 10_000 + 100 * number + k, inputs) for k in range(count)]
    cycles: Cycles = cycles_of_rows(observe_runs(runs, contact, law), table.names)
    return cycles.y


if __name__ == "__main__":
    settings = ContactSettings(pixels=128)
    for line in (*coverage_rows(settings), *coverage_rows(settings, cutoffs=(0.12, 0.3))):
        print(line, flush=True)
