"""What cut-off and grid do to the outputs: the same surfaces, and the test that judges a grid."""

import pytest

from mesoscale.contact.studies.stability import MIDDLE
from mesoscale.settings import ContactSettings, LawSettings
from mesoscale.uncertainty.cutoff import scene_rows


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
