"""From the law at the nodes to the distribution of its parameters (the paper's Table 2)."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.inputs.distributions import InputTable
from mesoscale.law.parameters import CLOSING, FITTED, LAW, LAW_OUTPUTS, OPENING, OUTPUTS, PARAMETERS
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.collocation import level1_response
from mesoscale.uncertainty.designs import SAMPLE_SEED
from mesoscale.uncertainty.surrogate import Below, Response, Surrogate, evaluate, to_json

Array = NDArray[np.float64]
Direct = tuple[Array, Array]
"""Inputs (m, n) of direct runs, and their closing and opening parameters (m, len(FITTED)), NaN
where missing.
"""
SAMPLES = 10_000
"""Samples of the inputs sent through the responses: their quantiles are then known to 0.5 % in
probability.
"""


@dataclass(frozen=True)
class NodeOutputs:
    """The law at every node for every surface seed.

    Attributes
    ----------
    values : shape (seeds, nodes, len(FITTED)): the closing parameters, then the opening ones; NaN
        where missing.
    """

    seeds: list[int]
    values: Array

    @property
    def paper_outputs(self) -> Array:
        """The outputs of Table 2: closing, and opening minus closing; same shape."""
        return to_paper_outputs(self.values)


def to_paper_outputs(parameters: Array) -> Array:
    """Closing and opening parameters (..., len(FITTED)) to closing ones and their change."""
    closing = parameters[..., CLOSING]
    opening = parameters[..., OPENING]
    return np.concatenate([closing, opening - closing], axis=-1)


def nodes_of_rows(rows: Iterable[Mapping[str, str]]) -> NodeOutputs:
    """Arrange the rows of law/parameters.csv by seed and node."""
    rows = list(rows)
    seeds = sorted({int(row["seed"]) for row in rows})
    count = max(int(row["node"]) for row in rows) + 1
    values = np.full((len(seeds), count, len(FITTED)), np.nan)
    position = {seed: k for k, seed in enumerate(seeds)}
    for row in rows:
        place = CLOSING if row["branch"] == "closing" else OPENING
        numbers = [float(row[name]) if row[name] else np.nan for name in PARAMETERS]
        values[position[int(row["seed"])], int(row["node"]), place] = numbers
    return NodeOutputs(seeds, values)


def exported_responses(
    direct: Direct, ranges: Array, settings: UncertaintySettings
) -> list[Response | None]:
    """The regressions behind samples, Sobol' indices and surrogate.json, one per entry of FITTED.

    Returns
    -------
    None for an output that too few runs determine; nothing is filled in.
    """
    x, y = direct
    signs = [row.any_sign for row in LAW] * 2
    responses: list[Response | None] = [
        _regression(x, y[:, k], ranges, any_sign) for k, any_sign in enumerate(signs)
    ]
    first = FITTED.index("closing_d_c_nm")
    last = FITTED.index("opening_d_c_nm")
    above = responses[first]
    if settings.opening_contact == "below_closing" and isinstance(above, Surrogate):
        # at least 0.01 nm, so that there is a logarithm
        fell = np.maximum(y[:, first] - y[:, last], 0.01)
        drop = _regression(x, fell, ranges, any_sign=False)
        responses[last] = None
        if drop is not None:
            responses[last] = Below(FITTED[first], above, drop)
    return responses


def output_responses(
    exported: Sequence[Response | None], direct: Direct, ranges: Array
) -> list[Response | None]:
    """Responses of the outputs of Table 2, behind indices and effects, from the exported ones.

    A change on opening has a response of its own: as a small difference of two large numbers it
    would inherit the errors of both.
    """
    changes = to_paper_outputs(direct[1])[:, OPENING]
    inputs = direct[0]
    on_change = [_regression(inputs, change, ranges, any_sign=True) for change in changes.T]
    return [*exported[CLOSING], *on_change]


def _regression(x: Array, y: Array, ranges: Array, any_sign: bool) -> Surrogate | None:
    from mesoscale.uncertainty.regression import sparse_chaos

    try:
        return sparse_chaos(x, y, ranges, transform="identity" if any_sign else "log")
    except ValueError:
        # too few usable runs; the count of missing ones is in uncertainty/validation.csv
        return None


@dataclass(frozen=True)
class Propagation:
    """Responses and what the samples of the inputs become through them.

    Attributes
    ----------
    samples : samples of the inputs, shape (m, n).
    outputs : closing and opening parameters of every sample through the exported responses, shape
        (m, len(FITTED)).
    responses : one per entry of FITTED; None where too few direct runs determine it.
    by_seed : mean and deviation of the outputs of Table 2 of every seed's own response, shape
        (seeds, 2, len(OUTPUTS)).
    variances : var(E[Y|X]), of the inputs, and E[Var(Y|X)], of the seeds, by the linear responses,
        shape (2, len(OUTPUTS)).
    """

    samples: Array
    outputs: Array
    responses: list[Response | None]
    by_seed: Array
    variances: Array

    @property
    def seed_share(self) -> Array:
        """Share of seeds' scatter in the variance of each output of Table 2, (len(OUTPUTS),)."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return self.variances[1] / self.variances.sum(axis=0)


def propagate(
    nodes: NodeOutputs, table: InputTable, settings: UncertaintySettings, direct: Direct
) -> Propagation:
    """Send samples of the inputs through every seed's linear response and through the regressions.

    A seed with a missing node has no linear response for that output; nothing is filled in.
    """
    ranges = table.ranges()
    samples = table.sample(SAMPLES, SAMPLE_SEED)
    seeds = len(nodes.seeds)
    total, total_squares = np.zeros((2, len(samples), len(OUTPUTS)))
    by_seed = np.full((seeds, 2, len(OUTPUTS)), np.nan)
    for s in range(seeds):
        y = to_paper_outputs(linear_outputs(nodes.values[s], ranges, samples))
        by_seed[s] = y.mean(axis=0), y.std(axis=0)
        usable = np.isfinite(by_seed[s, 0])
        total[:, usable] += y[:, usable]
        total_squares[:, usable] += y[:, usable] ** 2
    used = np.isfinite(by_seed[:, 0]).sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = total / used
        variance = np.maximum(total_squares / used - mean**2, 0)
        within = variance.mean(axis=0) * used / (used - 1)
        between = np.maximum(mean.var(axis=0) - within / used, 0)
        variances = np.where(used > 1, np.stack([between, within]), np.nan)
    responses = exported_responses(direct, ranges, settings)
    return Propagation(samples, evaluate(responses, samples), responses, by_seed, variances)


def linear_outputs(values: Array, ranges: Array, x: Array) -> Array:
    """Closing and opening parameters at x (m, n) by the paper's linear responses, (m, len(FITTED)).

    Parameters
    ----------
    values : the parameters at the nodes, shape (2n + 1, len(FITTED)); one that a node lacks is NaN
        everywhere.
    """
    responses = []
    for y in values.T:
        responses.append(level1_response(y, ranges) if np.isfinite(y).all() else None)
    return evaluate(responses, x)


def output_rows(
    nodes: NodeOutputs,
    result: Propagation,
    direct: Direct,
    paper: Mapping[str, tuple[float, float]],
    paper_exchanged: Mapping[str, tuple[float, float]],
) -> list[dict[str, Any]]:
    """Rows of uncertainty/outputs.csv: Table 2 beside the paper's, in units of seeds' scatter.

    mean and dev are the paper's method; response_* are those of the exported responses, averaged
    over random surfaces; cell_* those of the direct runs, each a cell of its own.
    """
    y = nodes.paper_outputs
    propagated = to_paper_outputs(result.outputs)
    cells = to_paper_outputs(direct[1])
    rows = []
    for k, output in enumerate(LAW_OUTPUTS):
        complete = np.isfinite(result.by_seed[:, 0, k])
        mean, dev = (_center_and_scatter(result.by_seed[complete, j, k]) for j in (0, 1))
        centre = _center_and_scatter(y[complete, 0, k])
        row: dict[str, Any] = {"output": output.name, "unit": output.unit}
        row["response_mean"] = propagated[:, k].mean()
        for name, (value, scatter) in {"mean": mean, "dev": dev, "centre": centre}.items():
            row |= {name: value, f"{name}_seed_sd": scatter}
        for label, tables in (("", paper), ("_exchanged", paper_exchanged)):
            paper_mean, paper_dev = tables.get(output.short, (np.nan, np.nan))
            row |= _beside_the_paper("mean", label, mean, paper_mean)
            row |= _beside_the_paper("dev", label, dev, paper_dev)
        row |= _quantiles("response", propagated[:, k])
        row |= _quantiles("cell", cells[np.isfinite(cells[:, k]), k])
        row["seed_share"] = result.seed_share[k]
        row["seeds_used"] = int(complete.sum())
        row["seeds"] = len(nodes.seeds)
        row["runs"] = y.shape[0] * y.shape[1]
        row["missing"] = int(np.isnan(y[:, :, k]).sum())
        rows.append(row)
    return rows


def _beside_the_paper(
    name: str, label: str, ours: tuple[float, float], paper: float
) -> dict[str, float]:
    """The paper's value, and the difference of ours from it in units of its scatter over seeds."""
    value, scatter = ours
    difference = np.nan
    if scatter:
        difference = (value - paper) / scatter
    return {f"paper_{name}{label}": paper, f"{name}_difference_in_seed_sd{label}": difference}


def _quantiles(name: str, values: Array) -> dict[str, float]:
    """Deviation and quantiles of values; NaN without any."""
    if not values.size:
        values = np.array([np.nan])
    low, middle, high = np.quantile(values, [0.05, 0.5, 0.95])
    deviation = values.std()
    return {
        f"{name}_dev": deviation,
        f"{name}_q05": low,
        f"{name}_q50": middle,
        f"{name}_q95": high,
    }


def _center_and_scatter(values: Array) -> tuple[float, float]:
    """Mean over seeds and standard deviation of one seed."""
    if len(values) == 0:
        return np.nan, np.nan
    scatter = np.nan
    if len(values) > 1:
        scatter = values.std(ddof=1)
    return float(values.mean()), float(scatter)


def surrogate_json(
    result: Propagation, table: InputTable, law: Mapping[str, float]
) -> dict[str, Any]:
    """Content of uncertainty/surrogate.json: usable without this code (docs/uncertainty.md)."""
    inputs = []
    for row, (low, high) in zip(table.rows, table.ranges().tolist(), strict=True):
        distribution = row.distribution
        inputs.append(
            {
                "name": row.name,
                "unit": row.unit,
                "distribution": distribution.kind,
                "a": distribution.a,
                "b": distribution.b,
                "low": low,
                "high": high,
            }
        )
    outputs = []
    for name, parameter, response in zip(FITTED, (*LAW, *LAW), result.responses, strict=True):
        if response is not None:
            outputs.append({"name": name, "unit": parameter.unit, **to_json(response)})
    about = (
        "value = transform(sum of coefficient * product of Legendre P_degree(u)), u = 2 (x -"
        " low) / (high - low) - 1; valid for low <= x <= high; the mean over random surfaces"
    )
    if any("below" in output for output in outputs):
        about += "; with `below`: the output of that name less this"
    return {"about": about, "inputs": inputs, "law": dict(law), "outputs": outputs}
