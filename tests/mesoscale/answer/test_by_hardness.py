"""Harder and softer contacts: which hardness is scaled, and that pads differ by it alone."""

import numpy as np
import pytest

from mesoscale.answer.other_devices import harder, release_by_hardness
from mesoscale.answer.points import Point
from mesoscale.answer.switches import press_pad, surfaces_of
from mesoscale.settings import ContactSettings
from mesoscale.studies.answer_stability import published_beam
from mesoscale.switch import release_or_nan_V

VALUES = {
    "hamaker": 0.1, "e_star": 91.0, "h_macro": 2.0, "h_prime": 8.0, "q0": 0.1, "hurst": 0.8,
    "rms": 2.0,
}  # fmt: skip
BODY = Point(VALUES, 0.6, published_beam(hold_voltage_V=90.0))
FILM = Point(
    {**VALUES, "h_film": 10.0, "t_film": 5.0, "k_film": 0.3, "m_film": 1.2, "h_prime": 0.0},
    0.3,
    BODY.device,
)
CONTACT = ContactSettings(mechanics="coupled", attraction="offset", pixels=64, length_nm=250.0)


def test_a_body_is_harder_throughout():
    """Eq. 4 with both constants doubled is twice as hard at every area."""
    usual, doubled = (point.contact_of(CONTACT)[0].hardness for point in (BODY, harder(BODY, 2.0)))
    areas = np.array([1.0, 10.0, 1e4])
    np.testing.assert_allclose(doubled.pressure(areas), 2 * usual.pressure(areas))


def test_a_film_is_harder_and_its_base_stays():
    usual, doubled = (point.contact_of(CONTACT)[0].hardness for point in (FILM, harder(FILM, 2.0)))
    # L/t of 2e-4: the film alone
    assert doubled.pressure(1e-6) == pytest.approx(2 * usual.pressure(1e-6), rel=1e-2)
    # 10⁶ nm wide: the base alone
    assert doubled.pressure(1e12) == pytest.approx(usual.pressure(1e12), rel=1e-2)


def test_pads_of_all_factors_have_the_same_surfaces():
    """The pad of factor 1 is that of the point itself, bit for bit; a softer one closes farther."""
    found = release_by_hardness(BODY, CONTACT, 2, [0.5])
    pad = press_pad(BODY, CONTACT, 2, surfaces_of(0))
    assert found[1.0] == release_or_nan_V(BODY.device, pad.curves)
    soft = press_pad(harder(BODY, 0.5), CONTACT, 2, surfaces_of(0))
    np.testing.assert_array_equal(soft.first_contact_nm, pad.first_contact_nm)
    assert found[0.5] != found[1.0]


def test_a_film_softer_than_its_base_has_no_answer():
    assert np.isnan(release_by_hardness(FILM, CONTACT, 2, [0.1])[0.1])
