"""What cut-off and grid do to the outputs: the same surfaces, and the test that judges a grid."""

import numpy as np
import pytest

from mesoscale.contact.studies.stability import MIDDLE
from mesoscale.settings import ContactSettings, LawSettings
from mesoscale.uncertainty.studies.cutoff import NAMES, cycle_rows, grid_error, passes, plan, scene_rows, show


def test_a_scene_sees_other_cutoffs_on_its_grid_and_other_grids_at_its_cutoff():
    settings = ContactSettings(pixels=128, q1_per_nm=0.15, study_seeds=2)  # the grid resolves 0.402 /nm
    rows = list(scene_rows(MIDDLE, settings, LawSettings()))
    cases = {(round(row["q1_per_nm"], 6), row["pixels"]) for row in rows}
    assert cases == {(0.0375, 128), (0.075, 128), (0.15, 128), (0.3, 128), (0.15, 64), (0.15, 256)}
    assert all(row["converged"] == row["cycles"] == 2 for row in rows)
    by_case = {(round(row["q1_per_nm"], 6), row["pixels"]): row for row in rows}
    # first contact is the lowest site: finer waves and finer grids only lower it
    assert by_case[0.3, 128]["d_c_nm"] > by_case[0.15, 128]["d_c_nm"]
    assert by_case[0.15, 256]["d_c_nm"] == pytest.approx(by_case[0.15, 128]["d_c_nm"], abs=0.02 * MIDDLE.rms)


def test_known_cycles_are_not_computed_again():
    known = [
        {"inputs": case.inputs, "mechanics": case.mechanics, "length_nm": str(case.length)}
        | {"q1_per_nm": str(case.q1), "pixels": str(case.pixels), "seed": str(seed)}
        for case in plan()
        for seed in range(1, case.seeds + 1)
    ]
    missing = known.pop(0)
    (row,) = cycle_rows(known)
    assert {key: str(row[key]) for key in missing} == missing
    assert row["status"] == "ok"


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
    rows = [
        {"inputs": "middle", "mechanics": "coupled", "length_nm": "1000", "q1_per_nm": "0.4", "pixels": str(pixels)}
        | {"seed": str(seed), "cpu_s": "0.1", **{name: str(value) for name, value in zip(NAMES, values, strict=True)}}
        for pixels, surfaces in ((64, coarse), (128, {1: ones, 2: ones}))
        for seed, values in surfaces.items()
    ]
    assert any("64 to  128 (2)" in line and line.endswith("passes") for line in show(rows))
