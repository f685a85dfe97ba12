"""Which cycles are computed: nodes of the collocation design, and direct runs.

A run depends on its index alone, so that more runs extend those that are there.
"""

from dataclasses import dataclass

import numpy as np

from mesoscale.inputs.distributions import InputTable
from mesoscale.uncertainty.collocation import nodes, to_values

FIRST_RANDOM_SEED = 1_000_000
"""Surfaces of the direct runs differ from those of the collocation."""
FIRST_SECOND_SURFACE = 2_000_000
"""Second surfaces of the direct runs that are repeated at equal inputs."""
SAMPLE_SEED = 1
"""Seed of all samples of the inputs."""


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


def collocation_runs(table: InputTable, first: int, last: int) -> list[Run]:
    """Runs first .. last-1 of the collocation: all nodes of surface 0, then all of the next one."""
    grid = nodes(len(table.rows))
    values = to_values(grid, table.ranges())
    runs = []
    for index in range(first, last):
        surface, node = divmod(index, len(grid))
        inputs = dict(zip(table.names, values[node].tolist(), strict=True))
        runs.append(Run(index, node, surface, inputs))
    return runs


def random_runs(
    table: InputTable,
    first: int,
    last: int,
    seed: int = SAMPLE_SEED,
    first_surface: int = FIRST_RANDOM_SEED,
) -> list[Run]:
    """Direct runs first .. last-1: every run has its own inputs and its own surface."""
    units = []
    for index in range(first, last):
        rng = np.random.default_rng(np.random.SeedSequence([seed, index]))
        units.append(rng.random(len(table.rows)))
    values = table.transform(np.array(units))
    runs = []
    for index, row in zip(range(first, last), values, strict=True):
        inputs = dict(zip(table.names, row.tolist(), strict=True))
        runs.append(Run(index, -1, first_surface + index, inputs))
    return runs
