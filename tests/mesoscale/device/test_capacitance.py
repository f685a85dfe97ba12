"""Capacitance of the rough contact."""

import numpy as np
import pytest

from mesoscale.device.switch import rough_capacitance_F, switch_from_settings
from mesoscale.settings import DeviceSettings

SWITCH = switch_from_settings(DeviceSettings())


def test_without_roughness_it_is_the_plate():
    s = np.array([5.0, 30.0, 3490.0])
    np.testing.assert_allclose(rough_capacitance_F(SWITCH, s, np.zeros(3)), SWITCH.capacitance_F(s), rtol=1e-12)


def test_roughness_raises_it_by_its_second_moment():
    # <1/(s + t/eps + h)> = 1/g (1 + (rms/g)^2 + 3 (rms/g)^4 + ...) far from contact
    s, rms = 300.0, 3.0
    g = s + SWITCH.dielectric_nm
    expected = SWITCH.capacitance_F(s) * (1 + (rms / g) ** 2 + 3 * (rms / g) ** 4)
    assert rough_capacitance_F(SWITCH, s, rms)[0] == pytest.approx(expected, rel=1e-9)


def test_contact_bounds_it_by_the_dielectric_alone():
    pressed = rough_capacitance_F(SWITCH, np.array([-100.0]), np.array([5.0]))[0]
    assert pressed == pytest.approx(SWITCH.capacitance_F(0.0), rel=1e-9)
