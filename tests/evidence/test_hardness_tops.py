"""Atoms beside a slab of finer and finer grains are attracted by the 9-3 potential that the slab sums up to."""

import numpy as np
import pytest

from atomistic.hardness.top_attraction import attract_top
from evidence.hardness.tops import beside

DENSITY, SIDE_A = 0.0668, 40.0


def test_fine_grains_are_a_smooth_body():
    atoms = np.column_stack([SIDE_A * np.random.default_rng(0).random((12, 2)), np.full(12, 20.0)])
    smooth = attract_top(np.zeros(12), np.ones(12), 6.0, DENSITY)

    def summed(count: int) -> np.ndarray:
        grain = SIDE_A / count
        across = (np.arange(count) + 0.5) * grain
        grains = np.stack(np.meshgrid(across, across, across[: count // 2], indexing="ij"), -1).reshape(-1, 3)
        found = beside(atoms, np.ones(12), grains, SIDE_A, 6.0, DENSITY, grain=DENSITY * grain**3)
        return np.array([found.force_per_A / smooth.force_per_A, found.work / smooth.work])

    coarse, fine = summed(66), summed(100)
    assert coarse == pytest.approx(1.0, abs=0.1)
    factor = (100 / 66) ** 2  # the error falls with the square of the grains
    assert (factor * fine - coarse) / (factor - 1) == pytest.approx(1.0, abs=0.01)
