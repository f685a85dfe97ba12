"""Energy and pull-off of pads."""

import numpy as np
import pytest

from mesoscale.contact import ContactInputs
from mesoscale.pad.adhesion import adhesion_of
from mesoscale.pad.cells import sample_cells
from mesoscale.pad.closing import press_cells
from mesoscale.pad.curves import Flats, PadCurves
from mesoscale.pad.pilots import plan_grid
from mesoscale.settings import ContactSettings

INPUTS = ContactInputs(
    hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=4.4
)
SMALL = ContactSettings(mechanics="asperity", pixels=128, q1_per_nm=0.2)


def adhesion(mechanics: str = "asperity", cells: int = 2, **changes: float):
    """Adhesion of a pad pressed with some 5 MPa."""
    contact = SMALL.model_copy(update={"mechanics": mechanics, **changes})
    sampled = sample_cells(INPUTS, cells)
    grid = plan_grid(INPUTS, contact, sampled, 0.005)
    return adhesion_of(press_cells(INPUTS, contact, grid, sampled).curves)


def test_flats_that_touch_nowhere_have_hamakers_energy():
    separation, flats = np.geomspace(10.0, 200.0, 4000), Flats(INPUTS.hamaker, 0.3)
    closing = np.stack([0.0 * separation, -flats.pull_GPa(separation)])
    (opened,) = adhesion_of(PadCurves(separation, closing, separation[:1], closing[None], flats))
    assert opened.energy_uJ_m2 == pytest.approx(opened.flats_uJ_m2, rel=1e-5)
    assert opened.flats_uJ_m2 == pytest.approx(1e6 * INPUTS.hamaker / (12.0 * np.pi * 10.3**2))
    assert opened.pull_off_kPa == pytest.approx(1e6 * float(flats.pull_GPa(10.0)))


def test_work_begins_where_the_force_is_zero():
    """Without a pull beyond the table: the triangle from 30 nm, where the net pressure changes its
    sign.
    """
    separation = np.linspace(20.0, 60.0, 401)
    net = np.interp(separation, [20.0, 30.0, 40.0, 60.0], [1e-3, 0.0, -1e-4, 0.0])
    branch = np.stack([np.maximum(net, 0.0), np.minimum(net, 0.0)])
    (opened,) = adhesion_of(
        PadCurves(separation, branch, separation[:1], branch[None], Flats(0.0, 0.0))
    )
    assert opened.zero_force_nm == pytest.approx(30.0)
    assert opened.load_MPa == pytest.approx(1.0)
    assert opened.energy_uJ_m2 == pytest.approx(1e6 * 0.5 * 30.0 * 1e-4, rel=1e-3)
    assert opened.pull_off_kPa == pytest.approx(100.0)


@pytest.mark.parametrize("mechanics", ["asperity", "coupled", "adhesive"])
def test_pads_pull_more_than_flats_and_the_more_the_harder_they_were_pressed(mechanics):
    opened = adhesion(mechanics, gap_cutoff_nm=0.3)
    assert all(
        row.pull_off_kPa > 0.0 and row.energy_uJ_m2 > 0.9 * row.flats_uJ_m2 for row in opened
    )
    loads = [row.load_MPa for row in opened]
    assert loads == sorted(loads, reverse=True)
    assert opened[0].energy_uJ_m2 >= opened[-1].energy_uJ_m2


def test_a_larger_D0_lowers_the_energy():
    energies = [adhesion(gap_cutoff_nm=cutoff)[0].energy_uJ_m2 for cutoff in (0.165, 0.3, 1.0)]
    assert energies == sorted(energies, reverse=True)
