"""Error of the calibration against its run time: cycles behind the responses, length of the chain, cycles added.

All cycles are the engine's on 128 x 128 points; the data are pull-off forces of twelve surfaces of known inputs.
"""

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.calibration.likelihood import posterior_of
from mesoscale.calibration.observables import NAMES
from mesoscale.calibration.posterior import (
    Cycles,
    calibrate,
    cycles_of_rows,
    expected_of,
    observe_runs,
    responses_of,
)
from mesoscale.calibration.sampling import advanced, diagnose, started
from mesoscale.calibration.studies.stability import CONTACT, SURFACES, TRUTH, pull_offs
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.table import input_table
from mesoscale.settings import DeviceSettings, LawSettings, MeasurementsSettings, UncertaintySettings
from mesoscale.uncertainty.designs import Run, random_runs

Array = NDArray[np.float64]
Progress = Callable[[float, str], None]

RUNS = (100, 200, 400)
REFERENCE_RUNS = 800
"""Other surfaces than those of RUNS."""
RESPONSES = ("contact_begin_nm", "pull_off_nN")
STEPS = (200, 400, 800, 1600)
POOL, PARTS = 40000, 80
"""Draws of the prior whose weighed mean is the reference of the chains, and in how many parts they are predicted."""
LOCAL_RUNS = 150
ROUNDS = (0, 1, 2)
FIRST_SURFACE = 2_110_000_000


def accuracy_points(progress: Progress | None = None) -> Iterator[dict[str, Any]]:
    """Every value of every knob with its error and cost."""
    table = input_table()
    cycles, seconds = _cycles(table, 0, max(RUNS))
    others, _ = _cycles(table, max(RUNS), max(RUNS) + REFERENCE_RUNS)
    at_truth = [Run(k, -1, FIRST_SURFACE - 1 - k, TRUTH) for k in range(SURFACES)]
    values = cycles_of_rows(observe_runs(at_truth, CONTACT, LawSettings()), table.names).y
    values = values[:, NAMES.index("pull_off_nN")]
    if progress:
        progress(0.5, "cycles")
    yield from _responses(table, cycles, others, seconds)
    yield from _chains(table, cycles, values)
    if progress:
        progress(0.8, "chains")
    yield from _rounds(table, cycles, values)


def _point(case: str, knob: str, value: int, error: float, metric: str, reference: str, cost: Array) -> dict[str, Any]:
    wall, cpu = cost.tolist()
    return {
        "case": case,
        "knob": knob,
        "value": value,
        "error": error,
        "error_metric": metric,
        "reference": reference,
        "wall_s": wall,
        "cpu_s": cpu,
    }


def _clock() -> Array:
    return np.array([time.perf_counter(), time.process_time()])


def _cycles(table: InputTable, first: int, last: int) -> tuple[Cycles, Array]:
    """Cycles over the prior with their wall and processor time."""
    start = _clock()
    runs = random_runs(table, UncertaintySettings(sample_seed=7), first, last, first_surface=FIRST_SURFACE)
    return cycles_of_rows(observe_runs(runs, CONTACT, LawSettings()), table.names), _clock() - start


def _responses(table: InputTable, cycles: Cycles, others: Cycles, seconds: Array) -> Iterator[dict[str, Any]]:
    """Responses of few cycles against those of many other ones, over the prior."""
    x = table.sample(2000, 5)
    finest = responses_of(table, others)[0]
    for count in RUNS:
        start = _clock()
        fits = responses_of(table, Cycles(cycles.x[:count], cycles.y[:count]))[0]
        for name in RESPONSES:
            known, seen = finest.pick([name])(x), fits.pick([name])(x)
            off = (seen.mean - known.mean)[:, 0] / np.sqrt(known.scatter[:, 0, 0])
            yield _point(
                name,
                "runs",
                count,
                float(np.sqrt((off**2).mean())),
                "rms difference of the mean response over the prior, in deviations of one surface",
                f"responses of {REFERENCE_RUNS} other cycles",
                _clock() - start + seconds * count / max(RUNS),
            )


def _chains(table: InputTable, cycles: Cycles, values: Array) -> Iterator[dict[str, Any]]:
    """Means of the inputs by chains of some length against those of weighed draws of the prior."""
    fits, laws = responses_of(table, cycles)
    data = pull_offs(values[np.isfinite(values)])
    posterior = posterior_of(table, [data], fits, laws, None, CONTACT.max_force_nN, expected_of(cycles))

    def log_likelihood(z: Array) -> Array:
        return posterior.log_likelihood(posterior.inputs(z))

    pool = np.random.default_rng(3).standard_normal((POOL, len(posterior.free)))
    logs = np.concatenate([log_likelihood(part) for part in np.array_split(pool, PARTS)])
    weights = np.exp(logs - logs.max())
    weights /= weights.sum()
    mean = weights @ pool
    sd = np.sqrt(weights @ (pool - mean) ** 2)
    start, done = _clock(), 0
    ensembles = started(log_likelihood, len(posterior.free), MeasurementsSettings().walkers, 2)
    for count in STEPS:
        ensembles = advanced(ensembles, count - done)
        done = count
        chains = np.stack([sampler.get_chain(discard=count // 2) for sampler, *_ in ensembles])
        r_hat, effective, _ = diagnose(chains)
        for case, error, metric, reference in (
            (
                "mean of an input",
                float(np.abs((chains.mean(axis=(0, 1, 2)) - mean) / sd).max()),
                "largest difference of a mean over the inputs, in posterior deviations",
                f"{POOL} weighed draws of the prior, known to {np.sqrt((weights**2).sum()):.2g}",
            ),
            ("independent draws", float(1 / np.sqrt(effective)), "error of a mean that the chain states", ""),
            ("nested R-hat", r_hat - 1, "above 1; converged below 0.01 with an error of a mean below 0.05", ""),
        ):
            yield _point(case, "steps", count, error, metric, reference, _clock() - start)


def _rounds(table: InputTable, cycles: Cycles, values: Array) -> Iterator[dict[str, Any]]:
    """The responses' error where the posterior lies, with cycles added there."""
    data = pull_offs(values[np.isfinite(values)])
    few = Cycles(cycles.x[: RUNS[1]], cycles.y[: RUNS[1]])
    for rounds in ROUNDS:
        start = _clock()
        settings = MeasurementsSettings(rounds=rounds, local_runs=LOCAL_RUNS, response_error=0.01)
        result = calibrate(table, [data], few, CONTACT, LawSettings(), DeviceSettings(), settings)
        last = [row["error_share"] for row in result.checks if row["round"] == rounds]
        yield _point(
            "responses where the posterior lies",
            "cycles added",
            rounds * LOCAL_RUNS,
            max(last),
            "largest error of a response the data use, in posterior deviations of it",
            "",
            _clock() - start,
        )
