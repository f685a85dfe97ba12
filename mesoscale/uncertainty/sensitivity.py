"""Which input matters: elementary effects (Table 3) and Sobol' indices with intervals."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.extras import needs
from mesoscale.inputs.distributions import InputTable
from mesoscale.law.parameters import LAW_OUTPUTS, OUTPUTS
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.collocation import elementary_effects
from mesoscale.uncertainty.designs import SAMPLE_SEED
from mesoscale.uncertainty.propagation import (
    Direct,
    NodeOutputs,
    exported_responses,
    output_responses,
    to_paper_outputs,
)
from mesoscale.uncertainty.regression import refit
from mesoscale.uncertainty.surrogate import Response, Surrogate, evaluate, scaled

Array = NDArray[np.float64]

SOBOL_SAMPLES = 2048
"""Size of each of the n + 2 samples behind the Sobol' indices."""
SOBOL_RESAMPLES = 40
"""Resamplings for the intervals of Sobol' indices; each refits the response."""


def sobol_indices(y_a: Array, y_b: Array, y_ab: Array) -> tuple[Array, Array]:
    """First-order (Saltelli 2010) and total (Jansen 1999) Sobol' indices.

    Parameters
    ----------
    y_a, y_b : output on two independent samples A and B, shape (m,).
    y_ab : output on A with column i taken from B, shape (n, m).

    Returns
    -------
    first, total : shape (n,); NaN for a constant output.
    """
    variance = np.concatenate([y_a, y_b]).var()
    if not variance > 1e-28 * np.square(y_a).mean():
        return np.full(len(y_ab), np.nan), np.full(len(y_ab), np.nan)
    centre = (y_a.mean() + y_b.mean()) / 2  # else the mean's square swamps small indices
    first = ((y_b - centre) * (y_ab - y_a)).mean(axis=1) / variance
    total = ((y_a - y_ab) ** 2).mean(axis=1) / (2 * variance)
    return first, total


def pick_freeze(table: InputTable, count: int, seed: int) -> Array:
    """Samples A, B and A with one column from B, shape (n + 2, count, n).

    Columns are exchanged before the correlation is put in: with correlated inputs the indices are
    those of the independent variables behind them, in the order of the table (Rosenblatt's order).
    """
    inputs = len(table.rows)
    with needs("uncertainty"):
        import openturns  # a second to import, needed here alone

    # OpenTURNS' SobolIndicesExperiment is shifted by its global generator: other samples, whatever
    # the seed
    shift = np.random.default_rng(np.random.SeedSequence([seed, 0x50])).random(2 * inputs)
    unit = (np.asarray(openturns.SobolSequence(2 * inputs).generate(count)) + shift) % 1.0
    a = unit[:, :inputs]
    b = unit[:, inputs:]
    mixed = []
    for k in range(inputs):
        column = a.copy()
        column[:, k] = b[:, k]
        mixed.append(column)
    return np.stack([table.transform(points) for points in (a, b, *mixed)])


def sensitivity_rows(
    nodes: NodeOutputs,
    table: InputTable,
    settings: UncertaintySettings,
    seed_share: Array,
    paper: Mapping[str, Mapping[str, float]],
    paper_as_printed: Mapping[str, Mapping[str, float]],
    direct: Direct,
) -> list[dict[str, Any]]:
    """Rows of uncertainty/sensitivity.csv: every output with every input.

    mu* is the mean over seeds of every seed's own value on the nodes of level 1 (the paper's one
    star), beside its scatter. Sobol' indices are those of the exported responses, averaged over
    random surfaces; their intervals (5 to 95 %) come from resampling the samples behind them
    together with the direct runs.
    """
    y = nodes.paper_outputs
    ranges = table.ranges()
    inputs = len(table.rows)
    responses = output_responses(exported_responses(direct, ranges, settings), direct, ranges)
    first, total = index_intervals(responses, direct, table)
    rows = []
    for k, output in enumerate(LAW_OUTPUTS):
        lines = y[np.isfinite(y[:, :, k]).all(axis=1), :, k]
        effects = np.array([elementary_effects(line) for line in lines]).reshape(-1, inputs)
        for i, row in enumerate(table.rows):
            mu_star = np.nan
            scatter = np.nan
            if len(effects):
                mu_star = effects[:, i].mean()
            if len(effects) > 1:
                scatter = effects[:, i].std(ddof=1)
            line = {"output": output.name, "input": row.name, "unit": output.unit}
            line |= {"mu_star": mu_star, "mu_star_seed_sd": scatter}
            for label, tables in (("", paper), ("_as_printed", paper_as_printed)):
                theirs = tables.get(output.short, {}).get(row.name, np.nan)
                line[f"paper_mu_star{label}"] = theirs
                difference = np.nan
                if scatter:
                    difference = (mu_star - theirs) / scatter
                line[f"difference_in_seed_sd{label}"] = difference
            for name, indices in (("sobol_first", first), ("sobol_total", total)):
                estimate, low, high = indices[:, k, i]
                line |= {name: estimate, f"{name}_low": low, f"{name}_high": high}
            rows.append({**line, "seed_share": seed_share[k], "seeds_used": len(lines)})
    return rows


def index_intervals(
    responses: Sequence[Response | None], direct: Direct, table: InputTable
) -> tuple[Array, Array]:
    """First-order and total indices: estimate, lower and upper end, (3, len(OUTPUTS), n).

    Parameters
    ----------
    responses : of the outputs; the direct runs behind them are resampled for the ends.
    """
    points = pick_freeze(table, SOBOL_SAMPLES, SAMPLE_SEED)
    rng = np.random.default_rng(np.random.SeedSequence([SAMPLE_SEED, 0xB0]))
    estimate = response_indices(points, responses)
    outputs = to_paper_outputs(direct[1])
    resampled = []
    for _ in range(SOBOL_RESAMPLES):
        # other samples as well: heavy tails make the estimators themselves uncertain
        again = points[:, rng.integers(points.shape[1], size=points.shape[1])]
        picks = np.empty(0, int)
        if len(direct[0]):
            picks = rng.integers(len(direct[0]), size=len(direct[0]))
        refitted = _refitted(responses, direct[0][picks], outputs[picks])
        resampled.append(response_indices(again, refitted))
    bounds = np.full((2, *estimate.shape), np.nan)
    draws = np.array(resampled)
    known = np.isfinite(draws).all(axis=0)
    bounds[:, known] = np.quantile(draws[:, known], [0.05, 0.95], axis=0)
    first = np.stack([estimate[0], bounds[0, 0], bounds[1, 0]])
    total = np.stack([estimate[1], bounds[0, 1], bounds[1, 1]])
    return first, total


def response_indices(points: Array, responses: Sequence[Response | None]) -> Array:
    """First-order and total indices of the outputs by their responses, shape (2, len(OUTPUTS), n).

    Parameters
    ----------
    points : of `pick_freeze`, shape (n + 2, count, n).
    """
    inputs = points.shape[2]
    y = evaluate(responses, points.reshape(-1, inputs))
    y = y.reshape(inputs + 2, -1, len(OUTPUTS))
    indices = [sobol_indices(y[0, :, k], y[1, :, k], y[2:, :, k]) for k in range(len(OUTPUTS))]
    return np.stack(indices, axis=1)


def _refitted(responses: Sequence[Response | None], x: Array, y: Array) -> list[Surrogate | None]:
    """The regression responses with their terms and coefficients fitted to other runs."""
    again: list[Surrogate | None] = []
    for k, response in enumerate(responses):
        if not isinstance(response, Surrogate):
            again.append(None)
            continue
        positive = (y[:, k] > 0) | (response.transform == "identity")
        usable = np.isfinite(y[:, k]) & positive
        u = np.clip(scaled(x[usable], response.ranges), -1, 1)
        target = y[usable, k]
        if response.transform == "log":
            target = np.log(target)
        again.append(refit(u, target, response.ranges, response.degrees, response.transform))
    return again
