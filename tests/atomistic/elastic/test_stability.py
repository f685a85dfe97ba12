"""Stiff and extreme cases of the elastic stage: those of the target `stability`."""

from pathlib import Path

import pytest

from atomistic.elastic.networks import crystal
from atomistic.elastic.stability import hard_cases, no_energy
from atomistic.materials import load_material

NITRIDE = load_material(Path(__file__).parents[3] / "config" / "materials" / "silicon_nitride.yaml")
CASES = hard_cases(NITRIDE)


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_a_hard_case_is_computed_flagged_or_refused(case):
    passed, detail = case.judge()
    assert passed, detail


def test_cases_have_names_of_their_own():
    assert len(CASES) == len({case.name for case in CASES}) >= 15


def test_a_sound_insulator_fails_the_judge_of_conductors():
    """A judge that passes whatever comes would say nothing."""
    passed, detail = no_energy(crystal(NITRIDE, "beta", (1, 1, 1)), NITRIDE.part("network_glass"))
    assert not passed, detail
