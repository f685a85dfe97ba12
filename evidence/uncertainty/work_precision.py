"""How wrong is each way to propagate the uncertainty, for the engine calls that it takes?

The truth is many direct runs of the paper's Table 1 without any response (`evidence.uncertainty.truth`). A response is
averaged over random surfaces, so its deviation is compared with that of the inputs alone, sqrt(Var(E[Y|X])), that of
plain sampling with sqrt(Var(Y)). Quantiles are those of single cells; responses from nodes know no scatter and give
those of the mean. The error is the root mean square over repeats with other runs or surfaces: of mean and quantiles in
true deviations, of the deviation relative, of first-order indices the largest over inputs. An error near `floor` cannot
be told from that of the truth.

The rows at hand are of 256² surfaces and were cut short: regressions of degree 4, and all with 1600 runs, are missing.
Rows `level-2 polynomial`, the interpolation through 113 nodes, are of a version that had it.
Their commit was written by hand, because the one that made them was rebased; the two differ by dropped columns only.
"""

import argparse
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any
from unittest import mock

import numpy as np
from numpy.typing import NDArray

from evidence.uncertainty.truth import Truth, explained_by, of_outputs, truth_of
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.table import input_table
from mesoscale.law.parameters import FITTED, OUTPUTS
from mesoscale.settings import ContactSettings, UncertaintySettings
from mesoscale.uncertainty import regression
from mesoscale.uncertainty.collocation import level1_response
from mesoscale.uncertainty.designs import SAMPLE_SEED, Run, collocation_runs, random_runs
from mesoscale.uncertainty.propagation import (
    SAMPLES,
    NodeOutputs,
    exported_responses,
    output_responses,
    to_paper_outputs,
)
from mesoscale.uncertainty.runs import compute_rows
from mesoscale.uncertainty.sensitivity import SOBOL_SAMPLES, pick_freeze, response_indices
from mesoscale.uncertainty.surrogate import evaluate, with_scatter
from mesoscale.uncertainty.validation import STATISTICS

Array = NDArray[np.float64]
Direct = tuple[Array, Array]

FIRST_REPLICATE_SEED = 500_000_000
"""Surfaces of the runs with equal inputs differ from those of the direct runs."""
SIZES = (200, 800, 1600)
MOST_REPEATS = 8
REGRESSION = UncertaintySettings()
SHOWN = ("mean", "dev", "q95", "sobol_first")


def arguments(parser: argparse.ArgumentParser) -> None:
    """How many runs."""
    parser.add_argument("--runs", type=int, default=10000, help="direct runs that are the truth (default 10000)")
    parser.add_argument("--replicates", type=int, default=1000, help="of them repeated on another surface")
    parser.add_argument("--seeds", type=int, default=8, help="surfaces at the nodes")
    parser.add_argument("--pixels", type=int, default=1024)


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Each method at each cost: median and largest error over the outputs, one row for each statistic."""
    table = input_table()
    runs = random_runs(table, 0, given.runs)
    again = random_runs(table, 0, given.replicates, first_surface=FIRST_REPLICATE_SEED)
    at_nodes = collocation_runs(table, 0, (2 * len(table.rows) + 1) * given.seeds)
    every = [*runs, *again, *at_nodes]
    law = partial(
        laws_of_runs, contact=ContactSettings(mechanics="asperity", pixels=given.pixels, attraction="clamped")
    )
    with ProcessPoolExecutor() as pool:
        y = np.concatenate(list(pool.map(law, [every[k : k + 100] for k in range(0, len(every), 100)])))
    direct = (np.array([list(run.values.values()) for run in runs]), y[: len(runs)])
    nodes = NodeOutputs(list(range(given.seeds)), y[-len(at_nodes) :].reshape(given.seeds, -1, len(FITTED)))
    yield from precision_rows(nodes, direct, truth_of(*direct, y[len(runs) : len(runs) + len(again)]), table)


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Errors of the paper's method and of the default response, in percent."""
    of = {(row["method"], int(row["engine_calls"]), row["statistic"]): float(row["error"]) for row in rows}
    chosen = {"paper": ("level-1 linear", 15), "paper_seeds": ("level-1 linear", 120)}
    chosen |= {"default": ("regression, degree 3", 800), "few": ("regression, degree 3", 200)}
    return {
        f"{name}_{statistic}": f"{100 * of[*key, statistic]:.0f} %"
        for name, key in chosen.items()
        for statistic in SHOWN
        if (*key, statistic) in of
    }


def laws_of_runs(runs: Sequence[Run], contact: ContactSettings) -> Array:
    """Closing and opening parameters of runs, shape (m, len(FITTED)); NaN where missing."""
    return np.array([[float(row[name] or "nan") for name in FITTED] for row in compute_rows(runs, contact)])


@dataclass(frozen=True)
class Method:
    """One way to come from engine calls to statistics; `repeats` are its nodes, or numbers of direct runs.

    Attributes
    ----------
    degree : of a regression; 0: of the paper's response, through the nodes; None: statistics of the runs themselves.
    """

    name: str
    calls: int
    repeats: tuple[Any, ...]
    degree: int | None = 0


def methods(nodes: NodeOutputs, runs: int, inputs: int) -> Iterator[Method]:
    """The paper's response on one surface and on all, regressions and plain sampling."""
    star, seeds = 2 * inputs + 1, len(nodes.seeds)
    yield Method("level-1 linear", star, tuple(NodeOutputs([s], nodes.values[s : s + 1]) for s in range(seeds)))
    yield Method("level-1 linear", star * seeds, (nodes,))
    for used in (size for size in SIZES if 2 * size <= runs):
        blocks = tuple(np.arange(k * used, (k + 1) * used) for k in range(min(MOST_REPEATS, runs // used)))
        for degree in (1, 2, 3, 4):
            yield Method(f"regression, degree {degree}", used, blocks, degree)
        yield Method("plain sampling", used, blocks, None)


def precision_rows(nodes: NodeOutputs, direct: Direct, truth: Truth, table: InputTable) -> Iterator[dict[str, Any]]:
    """Rows of the table."""
    deviation, inputs = truth.statistics["dev"].value, np.sqrt(np.maximum(truth.input_variance.value, 0.0))
    for method in methods(nodes, len(direct[0]), len(table.rows)):
        started = time.process_time()
        results = [_statistics(method, repeat, direct, table) for repeat in method.repeats]
        fit_s = (time.process_time() - started) / len(results)
        for name in SHOWN:
            values = np.array([result[name] for result in results])
            if name == "sobol_first":
                share = inputs**2 / deviation**2 if method.degree is None else np.ones(len(inputs))
                off = np.abs(values - truth.first.value * share[:, None]).max(axis=2)
                floor = truth.first.error.max(axis=1)
            elif name == "dev" and method.degree is not None:
                off, floor = (values - inputs) / inputs, truth.input_variance.error / (2 * inputs**2)
            else:
                off = (values - truth.statistics[name].value) / deviation
                floor = truth.statistics[name].error / deviation
            errors = np.sqrt(np.mean(np.square(off), axis=0))
            known = np.isfinite(errors) & (floor < 0.5)  # else the truth knows nothing
            worst = int(np.nanargmax(np.where(known, errors, np.nan)))
            yield {
                "method": method.name,
                "engine_calls": method.calls,
                "repeats": len(results),
                "statistic": name,
                "error": float(np.median(errors[known])),
                "worst_error": errors[worst],
                "worst_output": OUTPUTS[worst],
                "floor": float(np.median(floor[known])),
                "outputs": int(known.sum()),
                "truth_runs": truth.runs,
                "fit_cpu_s": fit_s,
            }


def _statistics(method: Method, repeat: Any, direct: Direct, table: InputTable) -> dict[str, Array]:
    """Statistics of the outputs of Table 2 by one repeat of a method, and their first-order indices."""
    x, y = direct
    if method.degree is None:
        values = to_paper_outputs(y[repeat])
        first = np.array([[explained_by(x[repeat, i], column) for i in range(x.shape[1])] for column in values.T])
        return {name: of_outputs(f, values) for name, f in STATISTICS.items()} | {"sobol_first": first}
    ranges, samples = table.ranges(), table.sample(SAMPLES, SAMPLE_SEED)
    if method.degree:
        known = x[repeat], y[repeat]
        with mock.patch.object(regression, "sparse_chaos", partial(regression.sparse_chaos, degree=method.degree)):
            responses = exported_responses(known, ranges, REGRESSION)
            per_output = output_responses(responses, known, ranges)
        outputs = evaluate(responses, samples)
        values = to_paper_outputs(outputs)
        cells = to_paper_outputs(with_scatter(outputs, responses, known, SAMPLE_SEED))
    else:
        per_output = [level1_response(nodes, ranges) for nodes in to_paper_outputs(repeat.over_seeds).T]
        values = cells = evaluate(per_output, samples)
    first = response_indices(pick_freeze(table, SOBOL_SAMPLES, SAMPLE_SEED), per_output)[0]
    found = {name: of_outputs(f, cells if name[0] == "q" else values) for name, f in STATISTICS.items()}
    return found | {"sobol_first": first}
