"""Cells with extreme attractions: energy is never gained, and far away they are two flats."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.contact import ContactInputs
from mesoscale.pad.cells import Cell, PadGrid, close_cells
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
