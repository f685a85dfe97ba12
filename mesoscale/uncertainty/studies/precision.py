"""Work and precision: error of every way to propagate the uncertainty against the engine calls it takes."""

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.inputs.distributions import InputTable
from mesoscale.law.parameters import FITTED, LAW_OUTPUTS, OUTPUTS
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.propagation import NodeOutputs, exported_responses, output_responses, to_paper_outputs
from mesoscale.uncertainty.reference import STATISTICS, Reference, explained_by, of_outputs
from mesoscale.uncertainty.sensitivity import pick_freeze, response_indices
from mesoscale.uncertainty.surrogate import evaluate, with_scatter

Array = NDArray[np.float64]
Direct = tuple[Array, Array]

SMALLEST_TRAINING = 25
MOST_REPEATS = 8
TESTED = 2000
"""Independent runs behind Q2, at most."""
METRICS = {
    "mean": "of the mean, in deviations",
    "dev": "of the deviation, relative",
    "q05": "of the 5 % quantile, in deviations",
    "q50": "of the median, in deviations",
    "q95": "of the 95 % quantile, in deviations",
    "sobol_first": "of the first-order indices, largest over inputs",
    "q2": "1 - Q2 on independent runs, irreducible part, given in `floor`",
}


@dataclass(frozen=True)
class Method:
    """One way to come from engine calls to statistics.

    Attributes
    ----------
    nodes : one per repeat, for responses from nodes.
    blocks : direct runs in use, one array per repeat.
    response : false: statistics of the runs themselves.
    """

    name: str
    calls: int
    settings: UncertaintySettings
    nodes: tuple[NodeOutputs, ...] = ()
    blocks: tuple[NDArray[np.int_], ...] = ()
    response: bool = True


@dataclass(frozen=True)
class MethodResult:
    """Statistics of the outputs by one repeat of a method.

    Attributes
    ----------
    statistics : by name of STATISTICS, shape (len(OUTPUTS),).
    first : first-order indices, shape (len(OUTPUTS), n).
    q2 : shape (len(OUTPUTS),).
    """

    statistics: dict[str, Array]
    first: Array
    q2: Array
    fit_s: float


def methods(nodes: NodeOutputs, runs: int, inputs: int, settings: UncertaintySettings) -> Iterator[Method]:
    """The paper's response, polynomials through nodes, regressions and plain sampling, at growing cost."""
    seeds = len(nodes.seeds)
    first_level = 2 * inputs + 1
    grids = [("level-1 linear (the paper's)", "level1", "linear"), ("level-1 polynomial", "level1", "polynomial")]
    if nodes.values.shape[1] > first_level:
        grids.append(("level-2 polynomial", "level2", "polynomial"))
    for name, level, response in grids:
        changed = settings.model_copy(update={"surrogate": level, "response": response})
        count = first_level if level == "level1" else nodes.values.shape[1]
        for used in _doublings(1, seeds):
            parts = [range(start, start + used) for start in range(0, seeds - used + 1, used)]
            taken = tuple(
                NodeOutputs([nodes.seeds[s] for s in part], nodes.values[list(part), :count]) for part in parts
            )
            yield Method(name, used * count, changed, nodes=taken)
    for degree in (1, 2, 3, 4):
        changed = settings.model_copy(update={"response": "regression", "chaos_degree": degree})
        # the highest degree is dear to fit, and no better with few runs
        most = min(runs // 2, 800 if degree == 4 else 3200)
        for used in _doublings(SMALLEST_TRAINING, most):
            yield Method(f"regression, degree {degree}", used, changed, blocks=_blocks(runs, used))
    for used in _doublings(SMALLEST_TRAINING, runs // 2):
        yield Method("plain sampling", used, settings, blocks=_blocks(runs, used), response=False)


def _doublings(first: int, most: int) -> Iterator[int]:
    while first <= most:
        yield first
        first *= 2


def _blocks(runs: int, used: int) -> tuple[NDArray[np.int_], ...]:
    repeats = min(MOST_REPEATS, runs // used)
    return tuple(np.arange(k * used, (k + 1) * used) for k in range(repeats))


def run_method(method: Method, direct: Direct, table: InputTable) -> list[MethodResult]:
    """Statistics of every repeat of a method."""
    x, y = direct
    settings = method.settings
    ranges = table.ranges(settings.central_share)
    samples = table.sample(settings.samples, settings.sample_seed)
    points = pick_freeze(table, settings.sobol_samples, settings.sample_seed)
    nothing = np.empty((0, x.shape[1])), np.empty((0, y.shape[1]))
    results = []
    for repeat in range(max(len(method.nodes), len(method.blocks))):
        before = time.process_time()
        training = method.blocks[repeat] if method.blocks else np.empty(0, int)
        unseen = np.setdiff1d(np.arange(len(x)), training)[-TESTED:]
        truth = to_paper_outputs(y[unseen])
        if not method.response:
            values = to_paper_outputs(y[training])
            shares = [[explained_by(x[training, i], column) for i in range(x.shape[1])] for column in values.T]
            unknown = np.full(len(OUTPUTS), np.nan)
            results.append(MethodResult(_statistics(values, values), np.array(shares), unknown, 0.0))
            continue
        nodes = method.nodes[repeat] if method.nodes else NodeOutputs([], np.empty((0, 0, len(FITTED))))
        known = (x[training], y[training]) if method.blocks else nothing
        responses = exported_responses(nodes, known, ranges, settings)
        per_output = output_responses(responses, known, ranges, settings)
        fit_s = time.process_time() - before
        outputs = evaluate(responses, samples)
        values, cells = to_paper_outputs(outputs), to_paper_outputs(outputs)
        if method.blocks:
            cells = to_paper_outputs(with_scatter(outputs, responses, known, True, settings.sample_seed))
        errors = to_paper_outputs(evaluate(responses, x[unseen])) - truth
        q2 = 1 - np.nanmean(errors**2, axis=0) / np.nanvar(truth, axis=0)
        results.append(MethodResult(_statistics(values, cells), response_indices(points, per_output)[0], q2, fit_s))
    return results


def _statistics(values: Array, cells: Array) -> dict[str, Array]:
    """Mean and deviation of `values`, quantiles of `cells`."""
    return {name: of_outputs(f, cells if name.startswith("q") else values) for name, f in STATISTICS.items()}


def precision_rows(
    nodes: NodeOutputs,
    direct: Direct,
    truth: Reference,
    table: InputTable,
    settings: UncertaintySettings,
    seconds_per_call: float,
    progress: Callable[[float, str], None] | None = None,
) -> list[dict[str, Any]]:
    """Rows of uq/work_precision.csv: method, cost, output and statistic with its error.

    The error is the root mean square over repeats with other runs (or surfaces), against all direct runs; an
    error near `floor` cannot be told from that truth's own. A response is averaged over random surfaces,
    so its deviation is compared with sqrt(Var(E[Y|X])), that of plain sampling with sqrt(Var(Y)).
    Quantiles are those of single cells; responses from nodes know no scatter and give those of the mean.
    """
    rows = []
    plan = list(methods(nodes, len(direct[0]), len(table.rows), settings))
    deviation = truth.statistics["dev"].value
    variance = truth.input_variance.value + truth.surface_variance.value
    for done, method in enumerate(plan):
        repeats = run_method(method, direct, table)
        cost = {
            "method": method.name,
            "engine_calls": method.calls,
            "engine_cpu_s": method.calls * seconds_per_call,
            "fit_cpu_s": float(np.mean([result.fit_s for result in repeats])),
            "repeats": len(repeats),
        }
        for k, output in enumerate(LAW_OUTPUTS):
            entries = {}
            for name, estimate in truth.statistics.items():
                target, floor, scale = estimate.value[k], estimate.error[k], deviation[k]
                if name == "dev" and method.response:
                    target = np.sqrt(max(truth.input_variance.value[k], 0.0))
                    floor = truth.input_variance.error[k] / (2 * target) if target else np.nan
                    scale = target
                values = np.array([result.statistics[name][k] for result in repeats])
                entries[name] = (values.mean(), target, _rms(values - target) / scale, floor / scale)
            indices = np.array([result.first[k] for result in repeats])
            off = np.abs(indices - (truth.first.value[k] if method.response else _of_all(truth, k)))
            entries["sobol_first"] = (np.nan, np.nan, _rms(off.max(axis=1)), truth.first.error[k].max())
            if method.response:
                q2 = np.array([result.q2[k] for result in repeats])
                entries["q2"] = (q2.mean(), np.nan, (1 - q2).mean(), truth.surface_variance.value[k] / variance[k])
            for name, (value, target, error, floor) in entries.items():
                rows.append(
                    {**cost, "output": output.name, "unit": output.unit, "statistic": name}
                    | {"value": value, "truth": target, "error": error, "floor": floor}
                )
        if progress:
            progress((done + 1) / len(plan), method.name)
    return rows


def _of_all(truth: Reference, k: int) -> Array:
    """First-order indices as shares of the whole variance, that of the surface included."""
    inputs, surface = truth.input_variance.value[k], truth.surface_variance.value[k]
    return truth.first.value[k] * inputs / (inputs + surface)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def accuracy_points(rows: list[dict[str, Any]], truth: Reference) -> Iterator[dict[str, Any]]:
    """Accuracy points: every method at every cost, its median error over the outputs."""
    groups: dict[tuple[str, int, str], list[Mapping[str, Any]]] = {}
    for row in rows:
        groups.setdefault((row["method"], row["engine_calls"], row["statistic"]), []).append(row)
    for (method, calls, statistic), members in groups.items():
        errors = [row["error"] for row in members if np.isfinite(row["error"])]
        floors = [row["floor"] for row in members if np.isfinite(row["floor"])]
        seconds = members[0]["engine_cpu_s"] + members[0]["fit_cpu_s"]
        yield {
            "case": method,
            "knob": "engine calls",
            "value": calls,
            "error": float(np.median(errors)) if errors else np.nan,
            "error_metric": f"median over outputs of the error {METRICS[statistic]}"
            if statistic != "q2"
            else f"median over outputs of {METRICS[statistic]}",
            "reference": f"{truth.runs} direct cycles (known to {np.median(floors):.2g})" if floors else "",
            "wall_s": seconds,
            "cpu_s": seconds,
        }
