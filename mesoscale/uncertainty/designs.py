"""Which cycles are computed: nodes of the collocation design, and the designs of direct runs.

A run depends on its index alone, so that more runs extend those that are there.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mesoscale.extras import needs
from mesoscale.inputs.distributions import InputTable
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.chunks import collocation_level
from mesoscale.uncertainty.collocation import nodes, to_values

FIRST_RANDOM_SEED = 1_000_000
"""Surfaces of the direct runs differ from those of the collocation."""
FIRST_REPLICATE_SEED = 500_000_000
FIRST_TRAJECTORY_SEED = 1_000_000_000
MORRIS_LEVELS = 8
"""Levels of an input that trajectories visit; steps are 4/7 of its range."""


@dataclass(frozen=True)
class Run:
    """One cycle to compute.

    Attributes
    ----------
    node : node of the collocation grid; -1 elsewhere.
    values : inputs by name.
    """

    index: int
    node: int
    seed: int
    values: dict[str, float]


def collocation_runs(table: InputTable, settings: UncertaintySettings, first: int, last: int) -> list[Run]:
    """Runs first .. last-1 of the collocation: all nodes of one seed, then all of the next."""
    grid = nodes(len(table.rows), collocation_level(settings))
    values = to_values(grid, table.ranges(settings.central_share))
    return [
        Run(
            index,
            index % len(grid),
            settings.first_seed + index // len(grid),
            dict(zip(table.names, values[index % len(grid)].tolist(), strict=True)),
        )
        for index in range(first, last)
    ]


def random_runs(
    table: InputTable, settings: UncertaintySettings, first: int, last: int, first_surface: int = FIRST_RANDOM_SEED
) -> list[Run]:
    """Runs first .. last-1 of the brute-force sample: every run has its own inputs and its own surface."""
    units = [
        np.random.default_rng(np.random.SeedSequence([settings.sample_seed, index])).random(len(table.rows))
        for index in range(first, last)
    ]
    values = table.transform(np.array(units))
    return [
        Run(index, -1, settings.first_seed + first_surface + index, dict(zip(table.names, row.tolist(), strict=True)))
        for index, row in zip(range(first, last), values, strict=True)
    ]


def replicate_runs(table: InputTable, settings: UncertaintySettings, first: int, last: int) -> list[Run]:
    """The inputs of `random_runs` on other surfaces: what differs is the surface's share of the variance."""
    return random_runs(table, settings, first, last, FIRST_REPLICATE_SEED)


def morris_runs(table: InputTable, settings: UncertaintySettings, first: int, last: int) -> list[Run]:
    """Morris' trajectories, n + 1 runs each, in which one input after the other steps; one surface each.

    Morris, Technometrics 33, 161 (1991), as sampled by SALib. The steps leave correlations out.
    """
    inputs = len(table.rows)
    ranges = table.ranges(settings.central_share)
    runs = []
    for trajectory in range(first // (inputs + 1), -(-last // (inputs + 1))):
        values = to_values(2 * morris_points(inputs, trajectory, settings.sample_seed) - 1, ranges)
        start = trajectory * (inputs + 1)
        runs += [
            Run(
                start + k,
                -1,
                settings.first_seed + FIRST_TRAJECTORY_SEED + trajectory,
                dict(zip(table.names, row.tolist(), strict=True)),
            )
            for k, row in enumerate(values)
        ]
    return [run for run in runs if first <= run.index < last]


def morris_points(inputs: int, trajectory: int, seed: int) -> np.ndarray:
    """One trajectory in the unit cube, shape (n + 1, n)."""
    with needs("uncertainty"):
        from SALib.sample import morris  # 2 s to import, needed here alone

    trajectory_seed = int(np.random.SeedSequence([seed, 0x3E, trajectory]).generate_state(1)[0])
    return np.asarray(morris.sample(morris_problem(inputs), 1, num_levels=MORRIS_LEVELS, seed=trajectory_seed), float)


def morris_problem(inputs: int) -> dict[str, object]:
    """The unit cube as SALib describes it."""
    return {"num_vars": inputs, "names": [f"x{k}" for k in range(inputs)], "bounds": [[0.0, 1.0]] * inputs}


DESIGNS: dict[str, Callable[[InputTable, UncertaintySettings, int, int], list[Run]]] = {
    "direct": random_runs,
    "replicate": replicate_runs,
    "morris": morris_runs,
}
"""Designs of direct runs by the folder of their results."""
