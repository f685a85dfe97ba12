"""The responses beside brute force: bias of mean and deviation, Sobol' indices, Morris' effects."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.inputs.distributions import InputTable
from mesoscale.law.parameters import LAW_OUTPUTS, OUTPUTS
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.morris import trajectory_effects, trajectory_points
from mesoscale.uncertainty.propagation import (
    OUTPUT_TRANSFORMS,
    NodeOutputs,
    exported_responses,
    output_responses,
    propagate,
    to_paper_outputs,
)
from mesoscale.uncertainty.reference import TWO_SIDED_90, Estimate, Reference, jackknife
from mesoscale.uncertainty.regression import full_chaos
from mesoscale.uncertainty.sensitivity import index_intervals, pick_freeze, response_indices

Array = NDArray[np.float64]
Direct = tuple[Array, Array]

TOLERANCE = 0.02
"""Difference of Sobol' indices that counts as agreement."""
DEGREE_OF_ALL = 4


def bias_rows(
    nodes: NodeOutputs, direct: Direct, truth: Reference, table: InputTable, settings: UncertaintySettings
) -> list[dict[str, Any]]:
    """Rows of uq/bias.csv: mean and deviation by the paper's level 1 and by the default response beside the truth.

    Biases are estimate - truth, the mean's in units of the true deviation, the deviation's relative to it; their
    90 % intervals hold the errors of the truth and of the seeds behind level 1.
    """
    result = propagate(nodes, table, settings, _training(direct, settings))
    response = to_paper_outputs(result.outputs)
    rows = []
    for k, output in enumerate(LAW_OUTPUTS):
        row: dict[str, Any] = {
            "output": output.name,
            "unit": output.unit,
            "runs": truth.runs,
            "missing": truth.missing[k],
            "replicates": truth.replicates,
        }
        rows.append(row)
        for name in ("mean", "dev"):
            estimate = truth.statistics[name]
            row[f"{name}_direct"], row[f"{name}_direct_low"] = estimate.value[k], estimate.low[k]
            row[f"{name}_direct_high"] = estimate.high[k]
        for name, variance in (("input", truth.input_variance), ("surface", truth.surface_variance)):
            ends = np.array([variance.value[k], variance.low[k], variance.high[k]])
            row[f"{name}_dev"], row[f"{name}_dev_low"], row[f"{name}_dev_high"] = np.sqrt(np.maximum(ends, 0.0))
        row["surface_share"] = truth.surface_variance.value[k] / row["dev_direct"] ** 2
        by_seed = result.by_seed[np.isfinite(result.by_seed[:, 0, k]), :, k]
        seeds = len(by_seed)
        row["level1_seeds"] = seeds
        level1 = by_seed.mean(axis=0) if seeds else np.full(2, np.nan)
        error = by_seed.std(axis=0, ddof=1) / np.sqrt(seeds) if seeds > 1 else np.full(2, np.nan)
        for j, name in enumerate(("mean", "dev")):
            row[f"{name}_level1"] = level1[j]
            row |= _bias(f"{name}_level1", level1[j], error[j], truth, name, k)
            estimate = response[:, k].mean() if name == "mean" else response[:, k].std()
            row[f"{name}_response"] = estimate
            row |= _bias(f"{name}_response", estimate, 0.0, truth, name, k)
    return rows


def _bias(label: str, value: float, error: float, truth: Reference, name: str, k: int) -> dict[str, float]:
    scale = truth.statistics["dev"].value[k]
    off = (value - truth.statistics[name].value[k]) / scale
    width = TWO_SIDED_90 * float(np.hypot(error, truth.statistics[name].error[k])) / scale
    return {f"{label}_bias": off, f"{label}_bias_low": off - width, f"{label}_bias_high": off + width}


def _training(direct: Direct, settings: UncertaintySettings) -> Direct:
    """The runs that the default response is fitted to."""
    return direct[0][: settings.direct_runs], direct[1][: settings.direct_runs]


def index_rows(
    nodes: NodeOutputs, direct: Direct, truth: Reference, table: InputTable, settings: UncertaintySettings
) -> list[dict[str, Any]]:
    """Rows of uq/indices.csv: Sobol' indices of the default response beside brute force.

    First-order ones are compared with those of the runs themselves; total ones with a response of all terms to
    degree 4 fitted to all runs, because scattered runs alone do not give them.
    """
    training, ranges = _training(direct, settings), table.ranges(settings.central_share)
    responses = output_responses(exported_responses(nodes, training, ranges, settings), training, ranges, settings)
    first, total = index_intervals(responses, nodes, training, table, settings)
    of_all = _total_of_all(direct, table, settings)
    rows = []
    for k, output in enumerate(OUTPUTS):
        for i, name in enumerate(table.names):
            row: dict[str, Any] = {"output": output, "input": name}
            for kind, response, brute in (("first", first, truth.first), ("total", total, of_all)):
                row[f"{kind}_response"], row[f"{kind}_response_low"], row[f"{kind}_response_high"] = response[:, k, i]
                row[f"{kind}_direct"], row[f"{kind}_direct_low"] = brute.value[k, i], brute.low[k, i]
                row[f"{kind}_direct_high"] = brute.high[k, i]
                off = response[0, k, i] - brute.value[k, i]
                row[f"{kind}_difference"] = off
                inside = brute.low[k, i] <= response[0, k, i] <= brute.high[k, i]
                row[f"{kind}_agrees"] = bool(inside or abs(off) <= TOLERANCE) if np.isfinite(off) else ""
            rows.append(row)
    return rows


def _total_of_all(direct: Direct, table: InputTable, settings: UncertaintySettings) -> Estimate:
    """Total indices, shape (len(OUTPUTS), n), by responses with all terms fitted to all runs."""
    x, y = direct
    ranges = table.ranges(settings.central_share)
    points = pick_freeze(table, settings.sobol_samples, settings.sample_seed)
    outputs = to_paper_outputs(y)

    def indices(chosen: NDArray[np.int_]) -> Array:
        responses = [
            full_chaos(x[chosen], outputs[chosen, k], ranges, DEGREE_OF_ALL, transform)
            for k, transform in enumerate(OUTPUT_TRANSFORMS)
        ]
        return response_indices(points, responses)[1]

    return jackknife(indices, len(x))


def morris_rows(
    y: Array,
    table: InputTable,
    settings: UncertaintySettings,
    one_star: Mapping[tuple[str, str], float],
    paper: Mapping[tuple[str, str], float],
) -> list[dict[str, Any]]:
    """Rows of uq/morris.csv: elementary effects through the engine beside the one-star mu* and the paper's.

    Parameters
    ----------
    y : closing and opening parameters along the trajectories, shape (t (n + 1), len(FITTED)).
    one_star, paper : mu* by output and input.
    """
    inputs = len(table.rows)
    trajectories = len(y) // (inputs + 1)
    points = trajectory_points(inputs, trajectories, settings.sample_seed)
    values = to_paper_outputs(y).reshape(trajectories, inputs + 1, len(OUTPUTS))
    rows = []
    for k, output in enumerate(LAW_OUTPUTS):
        effects = trajectory_effects(points, values[:, :, k], settings.sample_seed)
        for i, name in enumerate(table.names):
            rows.append(
                {
                    "output": output.name,
                    "input": name,
                    "unit": output.unit,
                    "morris_mu_star": effects.mu_star[i],
                    "morris_mu_star_low": effects.mu_star[i] - effects.half_width[i],
                    "morris_mu_star_high": effects.mu_star[i] + effects.half_width[i],
                    "morris_sigma": effects.sigma[i],
                    "trajectories": effects.trajectories,
                    "one_star_mu_star": one_star.get((output.name, name), np.nan),
                    "paper_mu_star": paper.get((output.name, name), np.nan),
                }
            )
    return rows
