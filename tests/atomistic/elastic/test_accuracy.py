"""Error of B against run time: known energies stand for the engine, so that every error is
known.
"""

import numpy as np
import pytest
from ase import Atoms
from ase.calculators.calculator import CalculationFailed, Calculator, all_changes

from asperity.guards.errors import InputError
from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.elastic import accuracy
from atomistic.elastic.accuracy import ScannedGlass, modulus_of_polynomial, variations
from atomistic.elastic.energy_scans import STRAINS
from atomistic.elastic.equation_of_state import vinet
from atomistic.settings import DftSettings

V0_A3 = 160.0
B_GPA = 220.0


class Solid(Calculator):
    """Energies of Vinet; the modulus rises by 1 % from 50 to 70 Ha; ions are at rest."""

    implemented_properties = ["energy", "forces"]  # noqa: RUF012

    def __init__(self, dft, *_, **__):
        super().__init__()
        self.history = []
        self.B_GPa = B_GPA * (1 + 0.01 * (dft.cutoff_Ha - 50) / 20)

    def calculate(self, atoms=None, properties=("energy",), system_changes=all_changes):
        super().calculate(atoms, properties, system_changes)
        assert self.atoms is not None
        energy = vinet(self.atoms.get_volume(), V0_A3, -100.0, self.B_GPa / EV_PER_A3_IN_GPA, 4.0)
        self.results = {"energy": float(energy), "forces": np.zeros((len(self.atoms), 3))}


@pytest.fixture
def glasses(monkeypatch):
    monkeypatch.setattr(accuracy, "make_calculator", Solid)
    edge = V0_A3 ** (1 / 3)
    cells = [
        Atoms("Si3", positions=np.random.default_rng(seed).uniform(0, 5, (3, 3))) for seed in (1, 2)
    ]
    for cell, factor in zip(cells, (1.0, 1.005), strict=True):
        cell.set_cell([factor * edge] * 3)
        cell.pbc = True
    return [ScannedGlass(cell, DftSettings(cutoff_Ha=50, relaxation_steps=3)) for cell in cells]


def errors_of(found, name):
    """Deviations by value, and the value in use."""
    [variation] = [one for one in found if one.name == name]
    return {value: compute() for value, compute in variation.values}, variation.shipped


def test_the_error_of_the_strains_rises_with_their_width(glasses):
    """The fit is not the solid's own form, so that wider strains miss more of it."""
    found = variations(glasses, [220.0], 1.0)
    by_width, shipped = errors_of(found, "largest strain")
    errors = [np.abs(by_width[width].values).max() for width in sorted(by_width)]
    assert errors == sorted(errors)
    assert errors[0] < 0.05 < errors[-1] < 1.0  # per cent
    assert shipped == max(STRAINS)


def test_the_error_of_a_cut_off_is_that_of_its_modulus(glasses):
    by_cutoff, shipped = errors_of(variations(glasses, [220.0], 1.0), "cut-off of the density, Ha")
    assert shipped == 50
    assert by_cutoff[50].values == pytest.approx(np.full((2, 1), 100 * (1 / 1.01 - 1)), rel=1e-3)
    assert by_cutoff[40].values == pytest.approx(
        np.full((2, 1), 100 * (0.995 / 1.01 - 1)), rel=1e-3
    )
    assert by_cutoff[50].cpu_s > 0


def test_ions_at_rest_have_no_error_of_relaxation(glasses):
    by_steps, shipped = errors_of(variations(glasses, [220.0], 1.0), "most ionic steps")
    assert shipped == 3
    assert by_steps[3].values[0, 0] == pytest.approx(0, abs=1e-9)


def test_energies_of_the_scan_are_not_computed_again(glasses):
    [glass, _] = glasses
    glass.curve(STRAINS)
    computed = len(glass.seconds)
    glass.curve(accuracy.five_strains(max(STRAINS)))
    assert len(glass.seconds) == computed == len(STRAINS)


def test_a_strain_whose_calculation_fails_leaves_its_width_without_an_error(glasses, monkeypatch):
    class Fails(Solid):
        def calculate(self, atoms=None, properties=("energy",), system_changes=all_changes):
            assert atoms is not None
            if atoms.get_volume() > 1.12 * V0_A3:
                raise CalculationFailed("not converged")
            super().calculate(atoms, properties, system_changes)

    monkeypatch.setattr(accuracy, "make_calculator", Fails)
    by_width, _ = errors_of(variations(glasses, [220.0], 1.0), "largest strain")
    assert np.isnan(by_width[0.05].values).all()
    assert np.abs(by_width[0.03].values).max() < 1.0


def test_the_error_of_the_mean_falls_with_the_number_of_glasses(glasses):
    by_number, shipped = errors_of(variations(glasses, [200.0, 210.0, 190.0], 30.0), "glasses")
    errors = [by_number[count].values[0, 0] for count in (1, 2, 3)]
    assert errors[0] > errors[1] > errors[2] > 0
    assert errors[2] == pytest.approx(100 * 10 / 200 / 3**0.5)
    assert (shipped, by_number[3].cpu_s) == (3, 90.0)
    assert "glasses" not in [one.name for one in variations(glasses, [200.0], 30.0)]


def test_the_reference_is_the_modulus_of_the_curve():
    volumes = np.linspace(140, 185, 15)
    energies = vinet(volumes, V0_A3, -100.0, B_GPA / EV_PER_A3_IN_GPA, 4.0)
    assert modulus_of_polynomial(volumes, energies, 5) == pytest.approx(B_GPA, rel=1e-4)
    with pytest.raises(InputError, match="no minimum"):
        modulus_of_polynomial(volumes, -volumes, 5)


def test_a_scene_without_a_sound_glass_is_told_so():
    with pytest.raises(InputError, match="no glass of the scene has a whole scan"):
        variations([], [], 0.0)
