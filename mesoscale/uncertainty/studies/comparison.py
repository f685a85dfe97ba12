"""Every way to propagate the uncertainty beside direct cycles as truth: all tables of the study."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.inputs.distributions import InputTable
from mesoscale.law.parameters import LAW_OUTPUTS, OUTPUTS
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.collocation import elementary_effects
from mesoscale.uncertainty.propagation import NodeOutputs
from mesoscale.uncertainty.reference import reference
from mesoscale.uncertainty.studies.brute_force import Direct, bias_rows, index_rows, morris_rows
from mesoscale.uncertainty.studies.overhead import engine_s_per_cycle
from mesoscale.uncertainty.studies.precision import accuracy_points, precision_rows

Array = NDArray[np.float64]


def compare_with_direct_runs(
    nodes: NodeOutputs,
    direct: Direct,
    replicates: Array,
    trajectories: Array,
    timings: Sequence[Mapping[str, str]],
    table: InputTable,
    settings: UncertaintySettings,
    paper: Mapping[str, Mapping[str, float]],
    progress: Callable[[float, str], None],
) -> dict[str, list[dict[str, Any]]]:
    """Rows of the study's tables by name: bias, indices, morris, precision, and the points of accuracy.

    Parameters
    ----------
    direct : inputs, shape (runs, n), and the law of both branches, shape (runs, len(FITTED)), of the true runs.
    replicates : law of the same first inputs on other surfaces, shape (replicates, len(FITTED)).
    trajectories : law along Morris' trajectories, shape (t (n + 1), len(FITTED)).
    timings : of the jobs that made the direct runs.
    paper : mu* of the paper's Table 3 by output and input.
    """
    truth = reference(*direct, replicates)
    precision = precision_rows(nodes, direct, truth, table, settings, engine_s_per_cycle(timings), progress)
    known = {(row.name, name): mu for row in LAW_OUTPUTS for name, mu in paper.get(row.short, {}).items()}
    tables = {
        "bias": bias_rows(nodes, direct, truth, table, settings),
        "indices": index_rows(nodes, direct, truth, table, settings),
        "morris": morris_rows(trajectories, table, settings, one_star_effects(nodes, table), known),
        "precision": precision,
    }
    return {**tables, "accuracy": list(accuracy_points(precision, truth))}


def one_star_effects(nodes: NodeOutputs, table: InputTable) -> dict[tuple[str, str], float]:
    """The paper's mu* by output and input: effects on the star of level 1, averaged over random surfaces."""
    inputs = len(table.rows)
    stars = nodes.paper_outputs[:, : 2 * inputs + 1]
    effects = np.array([[elementary_effects(star, inputs) for star in stars[:, :, k]] for k in range(len(OUTPUTS))])
    means = np.nanmean(effects, axis=1)
    return {
        (output, name): float(means[k, i]) for k, output in enumerate(OUTPUTS) for i, name in enumerate(table.names)
    }
