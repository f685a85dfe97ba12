"""What cut-off and grid do to the outputs: cycles that are known, and the test that judges a grid."""

import numpy as np
import pytest

from evidence.contact.cutoff import NAMES, grid_error, passes, summary
from evidence.contact.draws import MIDDLE


def test_a_grid_passes_by_its_error_or_by_the_scatter_of_the_surfaces():
    few, some, much = 0.01, 0.05, 0.5
    assert passes(np.full(3, few), np.full(3, much))
    assert passes(np.array([few, some]), np.array([much, 0.1]))
    assert not passes(np.array([few, some]), np.array([much, 0.3]))


def test_the_error_of_a_grid_compares_the_surfaces_of_both():
    ones = np.ones(len(NAMES))
    coarse = {1: 1.1 * ones, 2: 1.3 * ones, 3: 9.0 * ones}
    relative, scatter = grid_error("middle", coarse, {1: ones, 2: ones})
    assert relative[NAMES.index("pull_off_nN")] == pytest.approx(0.2)
    assert relative[NAMES.index("d_c_nm")] == pytest.approx(0.2 / MIDDLE.rms)
    assert scatter[0] == pytest.approx(0.2 / np.std([1.1, 1.3, 9.0], ddof=1))
    cycles = [
        {"inputs": "middle", "mechanics": "coupled", "length_nm": "1000", "q1_per_nm": "0.4", "pixels": str(pixels)}
        | {"seed": str(seed), **{name: str(value) for name, value in zip(NAMES, values, strict=True)}}
        for pixels, surfaces in ((64, coarse), (128, {1: ones, 2: ones}))
        for seed, values in surfaces.items()
    ]
    first, second = summary(cycles)
    assert (first["pixels"], first["surfaces"], first["passes"]) == (64, 3, True)
    assert first["change_pull_off_nN"] == pytest.approx(0.2)
    assert second["passes"] == ""
