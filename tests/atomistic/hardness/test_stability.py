"""Stiff and extreme cases of the hardness stage: those of the target `stability`."""

from pathlib import Path

import numpy as np
import pytest

from atomistic.hardness.glass import make_glass
from atomistic.hardness.stability import hard_cases
from atomistic.lammps import Atoms
from atomistic.materials import load_material
from atomistic.potentials import load_potential
from atomistic.settings import GlassSettings

CONFIG = Path(__file__).parents[3] / "config"
SILICA = load_material(CONFIG / "materials" / "silicon_dioxide.yaml")
PMMCS = load_potential(CONFIG / "potentials" / "pmmcs.yaml")
GLASS = GlassSettings(atoms=150, melt_ps=1, quench_rate_K_ps=1000, rest_ps=1)
ANY_GLASS = Atoms(("Si", "O"), np.ones(150, dtype=int), np.zeros((150, 3)), np.full(3, 13.0))
NAMES = [case.name for case in hard_cases(SILICA, PMMCS, ANY_GLASS, Path("unused"))]


@pytest.fixture(scope="module")
def glass(tmp_path_factory):
    return make_glass(SILICA, PMMCS, GLASS, 1, tmp_path_factory.mktemp("glass") / "work")


@pytest.mark.parametrize("name", NAMES)
def test_a_hard_case_is_computed_flagged_or_refused(name, glass, tmp_path):
    [case] = [case for case in hard_cases(SILICA, PMMCS, glass, tmp_path) if case.name == name]
    passed, detail = case.judge()
    assert passed, detail


def test_cases_have_names_of_their_own():
    assert len(NAMES) == len(set(NAMES)) >= 15
