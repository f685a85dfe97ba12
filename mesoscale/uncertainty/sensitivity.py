"""Which input matters: elementary effects (the paper's Table 3) and Sobol' indices with intervals."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.collocation import elementary_effects
from mesoscale.uncertainty.distributions import InputTable
from mesoscale.uncertainty.paper_tables import short_name
from mesoscale.uncertainty.propagation import NodeOutputs, fit_surface, to_paper_outputs
from mesoscale.uncertainty.runs import OUTPUT_UNITS, OUTPUTS

Array = NDArray[np.float64]


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

    Columns are exchanged before the correlation is put in: with correlated inputs the indices are those of
    the independent variables behind them, in the order of the table (Rosenblatt's order).
    """
    inputs = len(table.rows)
    import openturns  # a second to import, needed here alone

    shift = np.random.default_rng(np.random.SeedSequence([seed, 0x50])).random(2 * inputs)
    unit = (np.asarray(openturns.SobolSequence(2 * inputs).generate(count)) + shift) % 1.0
    a, b = unit[:, :inputs], unit[:, inputs:]
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
) -> list[dict[str, Any]]:
    """Rows of uq/sensitivity.csv: every output with every input.

    mu* is the mean over seeds of every seed's own value, beside its scatter. Sobol' indices are those of the
    mean surface over seeds; their intervals (5 to 95 %) come from resampling the seeds.
    """
    y = nodes.paper_outputs
    ranges = table.ranges(settings.central_share)
    points = pick_freeze(table, settings.sobol_samples, settings.sample_seed)
    inputs, count = len(table.rows), points.shape[1]
    flat = points.reshape(-1, inputs)
    rng = np.random.default_rng(np.random.SeedSequence([settings.sample_seed, 0xB0]))
    rows = []
    for k, (output, unit) in enumerate(zip(OUTPUTS, OUTPUT_UNITS, strict=True)):
        complete = np.isfinite(y[:, :, k]).all(axis=1)
        lines = y[complete, :, k]
        effects = np.array([elementary_effects(line, inputs) for line in lines]).reshape(-1, inputs)
        first, total = _index_intervals(nodes.values[complete], k, ranges, settings, flat, count, rng)
        name = short_name(output)
        for i, row in enumerate(table.rows):
            rows.append(
                {
                    "output": output,
                    "input": row.name,
                    "unit": unit,
                    "mu_star": effects[:, i].mean() if len(effects) else np.nan,
                    "mu_star_seed_sd": effects[:, i].std(ddof=1) if len(effects) > 1 else np.nan,
                    "paper_mu_star": paper.get(name, {}).get(row.name, np.nan),
                    "paper_mu_star_as_printed": paper_as_printed.get(name, {}).get(row.name, np.nan),
                    "sobol_first": first[0, i],
                    "sobol_first_low": first[1, i],
                    "sobol_first_high": first[2, i],
                    "sobol_total": total[0, i],
                    "sobol_total_low": total[1, i],
                    "sobol_total_high": total[2, i],
                    "seed_share": seed_share[k],
                    "seeds_used": int(complete.sum()),
                }
            )
    return rows


def _index_intervals(
    values: Array,
    output: int,
    ranges: Array,
    settings: UncertaintySettings,
    points: Array,
    count: int,
    rng: np.random.Generator,
) -> tuple[Array, Array]:
    """Estimate, lower and upper end of the indices of one output of Table 2, shape (3, n) each."""
    inputs, seeds = len(ranges), len(values)
    if seeds == 0:
        missing = np.full((3, inputs), np.nan)
        return missing, missing
    # every seed's own surface once; the mean surface over any resample of seeds is then a mean of these
    columns = sorted({output % 4, output})
    surfaces = np.stack(
        [
            to_paper_outputs(
                np.stack(
                    [
                        fit_surface(line[:, j], ranges, settings)(points)
                        if j in columns
                        else np.zeros(len(points))
                        for j in range(8)
                    ],
                    axis=-1,
                )
            )[:, output]
            for line in values
        ]
    )

    def indices(weights: Array) -> Array:
        mean = (weights @ surfaces).reshape(-1, count)
        return np.stack(sobol_indices(mean[0], mean[1], mean[2:]))

    estimate = indices(np.full(seeds, 1 / seeds))
    resampled = [
        indices(np.bincount(rng.integers(seeds, size=seeds), minlength=seeds) / seeds)
        for _ in range(settings.bootstrap if seeds > 1 else 0)
    ]
    low, high = np.full_like(estimate, np.nan), np.full_like(estimate, np.nan)
    if resampled and np.isfinite(estimate).all():
        low, high = np.nanquantile(resampled, [0.05, 0.95], axis=0)
    return (np.stack([estimate[0], low[0], high[0]]), np.stack([estimate[1], low[1], high[1]]))
