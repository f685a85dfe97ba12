"""Cells with extreme attractions: energy is never gained, and far away they are two flats."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.contact import ContactInputs
from mesoscale.contact.coupled import dense
from mesoscale.errors import InputError
from mesoscale.inputs.contact import FilmInputs
from mesoscale.pad.cells import Cell, PadGrid, close_cells, plan_grid, sample_cells
from mesoscale.pad.curves import press_cells
from mesoscale.pad.memory import flats_of, law_of
from mesoscale.settings import ContactSettings

MIDDLE = ContactInputs(hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5)
# steps of 0.1 nm miss wells of 0.05 nm
SEPARATION = np.concatenate([np.geomspace(1000.0, 50.0, 40)[:-1], np.arange(50.0, 22.0, -0.05)])
GRID = PadGrid(SEPARATION, np.array([SEPARATION.size - 1]))
CELLS = [Cell(1000, 0.0, 0.0, 1.0)]
CASES = [(0.215, 0.05), (0.215, 2.0), (0.0, 0.165), (1e-6, 30.0), (2.0, 0.3)]
"""Hamaker constant (aJ) and D0 (nm)."""


def work_J_m2(curve, contact):
    """Work that the contact does from the deepest closing outwards (nN/nm), positive: pushed."""
    return -np.trapezoid(curve.sum(axis=0), SEPARATION) / contact.length_nm**2


@pytest.mark.parametrize("mechanics", ["asperity", "coupled"])
@pytest.mark.parametrize(("hamaker", "gap_cutoff_nm"), CASES)
def test_a_cycle_under_attraction_gains_no_energy(mechanics, hamaker, gap_cutoff_nm):
    """A plastic cycle dissipates; an elastic one gives all of its work back."""
    inputs = replace(MIDDLE, hamaker=hamaker)
    given = {"mechanics": mechanics, "pixels": 64, "gap_cutoff_nm": gap_cutoff_nm}
    for model in ("plastic", "elastic"):
        contact = ContactSettings.model_validate(given | {"model": model})
        (cell,) = close_cells(inputs, contact, GRID, CELLS)
        spent, returned = (work_J_m2(curve, contact) for curve in (cell.closing, cell.opening[0]))
        assert cell.closing[0, -1] > 0, "not in contact"
        if model == "elastic":
            assert returned == pytest.approx(spent, rel=1e-9)
        else:
            assert returned < spent


@pytest.mark.parametrize("mechanics", ["asperity", "coupled"])
@pytest.mark.parametrize(("hamaker", "gap_cutoff_nm"), CASES)
def test_cells_of_extreme_attraction_join_the_flats_beyond_their_curves(mechanics, hamaker, gap_cutoff_nm):
    inputs = replace(MIDDLE, hamaker=hamaker)
    given = {"mechanics": mechanics, "pixels": 64, "gap_cutoff_nm": gap_cutoff_nm}
    contact = ContactSettings.model_validate(given)
    law = law_of(press_cells(inputs, contact, GRID, CELLS), flats_of(inputs, contact))
    ends = float(law.separation_nm[-1])
    inside, beyond = law.closing_GPa(np.array([ends, ends * (1 + 1e-9)]))
    # 1 + 6 (rms / separation)^2 is 4e-4
    assert inside == pytest.approx(beyond, rel=1e-3, abs=0)
    assert beyond == pytest.approx(-hamaker / (6 * np.pi * (ends + gap_cutoff_nm) ** 3), rel=1e-6, abs=0)


def test_soft_cells_are_solved_with_the_blocks_of_their_own_sites(monkeypatch):
    """The sets of one change in a step that has settled: the block at hand is then of other sites."""
    inputs = FilmInputs(
        hamaker=0.23430521548187047,
        e_star=87.33645149865933,
        h_macro=1.3514625286680215,
        h_prime=0.0,
        q0=0.024611629023254433,
        hurst=0.414520185165477,
        rms=5.611248889630058,
        h_film=12.005406156058228,
        t_film=4.981708320199124,
        k_film=0.012690575388624947,
        m_film=2.8674830766657347,
        rms_scatter=0.41774411004146894,
    )
    contact = ContactSettings(
        mechanics="coupled",
        attraction="offset",
        pixels=128,
        q1_per_nm=0.3394476182237757,
        gap_cutoff_nm=0.27372814778958604,
    )
    close_gaps, sizes = dense.close_gaps, []

    def noted(block, around, stencil, gap, goal, share):
        sizes.append({len(block), len(around), len(gap)})
        return close_gaps(block, around, stencil, gap, goal, share)

    monkeypatch.setattr(dense, "close_gaps", noted)
    plan_grid(inputs, contact, sample_cells(inputs, 64, 5_000_017_001_000, 6e4), lambda nm: np.full_like(nm, 0.04))
    assert sizes
    assert all(len(of) == 1 for of in sizes)


def test_a_smooth_film_whose_asperities_merge_needs_coupled_mechanics():
    inputs = replace(MIDDLE, q0=0.018, rms=2.2)
    cells = sample_cells(inputs, 4)

    def planned(mechanics):
        contact = ContactSettings.model_validate({"mechanics": mechanics, "pixels": 64})
        return plan_grid(inputs, contact, cells, lambda separation: np.full_like(separation, 0.2))

    with pytest.raises(InputError, match=r"asperities merge .*; take mechanics: coupled"):
        planned("asperity")
    assert planned("coupled").depths.size > 0
