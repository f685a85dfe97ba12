"""The accuracy table of the topography stage, on small scans."""

import numpy as np
import pytest

from mesoscale.settings import TopographySettings
from mesoscale.settings.topography import SyntheticScanSettings
from mesoscale.studies import topography_accuracy
from mesoscale.studies.topography_accuracy import MISSED, accuracy_points

SCENE = TopographySettings(
    synthetic=SyntheticScanSettings(pixels=128, small_scans=3, large_scans=2)
)


@pytest.fixture(scope="module")
def rows():
    """The table, of two surfaces to save time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(topography_accuracy, "SURFACES", 2)
        return list(accuracy_points(SCENE, {"slope": -0.2}))


def errors(rows, knob, quantity):
    return {
        row["value"]: row["error"]
        for row in rows
        if row["knob"] == knob and row["case"] == quantity
    }


def test_every_choice_has_errors_of_three_quantities_and_their_cost(rows):
    tried = {(row["knob"], row["value"]) for row in rows}
    assert len(rows) == 3 * len(tried)
    assert all(np.isfinite(row["error"]) and row["cpu_s"] > 0 for row in rows)


def test_volts_are_those_of_the_quantity(rows):
    for row in rows:
        wanted = 0.2 * row["error"] if row["case"] == "slope" else None
        assert row["release_V"] == pytest.approx(wanted)


def test_the_scenes_own_pixels_and_defaults_are_marked(rows):
    shipped = {row["knob"]: row["value"] for row in rows if row["shipped"]}
    assert shipped["pixels a side"] == 128
    assert shipped["sections"] == 25
    assert shipped["told over true tip radius"] == 1.0
    # 5 scans are none of the tried numbers
    assert "scans" not in shipped


def test_scans_too_coarse_to_tell_count_as_missed(rows):
    assert errors(rows, "pixels a side", "q0")[64] == 100 * MISSED


def test_more_time_is_told_for_more_scans(rows):
    costs = {row["value"]: row["cpu_s"] for row in rows if row["knob"] == "scans"}
    assert costs[2] < costs[11]
