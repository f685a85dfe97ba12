"""Where the flat has reached the surface, for the picture of the report."""

import numpy as np
import pytest

from mesoscale.contact.cycle import run_cycle
from mesoscale.contact.spots import STEPS, spots_under
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.settings.contact import NOMINAL_SEED

INPUTS = ContactInputs(
    hamaker=0.2, e_star=91.0, h_macro=2.0, h_prime=8.0, q0=0.025, hurst=0.75, rms=8.5
)


def _spots(pixels, model):
    settings = ContactSettings(mechanics="asperity", pixels=pixels, model=model)
    cycle = run_cycle(INPUTS, settings, NOMINAL_SEED, 1e4)
    return spots_under(INPUTS, settings, cycle), cycle


@pytest.mark.parametrize("pixels", [128, 512])
def test_an_elastic_contact_is_where_the_flat_cuts_the_surface(pixels):
    """The engine counts the sites above the flat, so both shares of the area are one number."""
    spots, cycle = _spots(pixels, "elastic")
    for separation, share in zip(spots.separation_nm, spots.cut_share, strict=True):
        step = int(np.flatnonzero(cycle.closing.separation_nm == separation)[0])
        assert share == pytest.approx(
            cycle.closing.contact_area_nm2[step] / cycle.cell_area_nm2, rel=1e-12
        )


def test_a_plastic_contact_differs_by_what_flows():
    spots, cycle = _spots(128, "plastic")
    step = int(np.flatnonzero(cycle.closing.separation_nm == spots.separation_nm[-1])[0])
    assert spots.cut_share[-1] == pytest.approx(
        cycle.closing.contact_area_nm2[step] / cycle.cell_area_nm2, rel=0.1
    )


def test_pictures_are_small_and_lose_no_spot():
    spots, _ = _spots(512, "elastic")
    assert spots.step.shape == spots.towards_flat_nm.shape == (256, 256)
    assert len(spots.separation_nm) <= STEPS
    assert (np.diff(spots.separation_nm) < 0).all()
    assert (spots.step == 0).any(), "first contact is a spot"
    pixels = [(spots.step >= 0) & (spots.step <= k) for k in range(len(spots.separation_nm))]
    assert all(pixel.mean() >= share for pixel, share in zip(pixels, spots.cut_share, strict=True))
