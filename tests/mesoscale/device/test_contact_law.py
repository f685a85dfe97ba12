"""Total pressure, its slope and the handling of many samples."""

import numpy as np
import pytest

from mesoscale.device.contact_law import physical, pressure_GPa, samples_of, scale_adhesion, slope_GPa_nm
from mesoscale.law.compact import Law, pressure

LAW = Law(31.8, 15.1e-5, 6.4e-4, 3.31, hamaker=0.215)


def test_slope_is_the_derivative_of_the_pressure():
    s = np.concatenate([np.linspace(1, 31.7, 50), np.linspace(31.9, 33.7, 10), np.linspace(33.9, 300, 50)])
    step = 1e-5
    numeric = (pressure_GPa(s + step, LAW) - pressure_GPa(s - step, LAW)) / (2 * step)
    # central differences of values near 1e-4 GPa in double precision: 1e-15 / 1e-5
    np.testing.assert_allclose(slope_GPa_nm(s, LAW), numeric, rtol=1e-7, atol=1e-10)


def test_scaled_adhesion_leaves_the_repulsion():
    s = np.linspace(0, 60, 61)
    attraction, repulsion = pressure(s, LAW)
    np.testing.assert_allclose(pressure_GPa(s, scale_adhesion(LAW, 0)), repulsion, rtol=1e-15)
    np.testing.assert_allclose(pressure_GPa(s, scale_adhesion(LAW, 0.1)), repulsion + 0.1 * attraction, rtol=1e-12)


def test_unphysical_samples_are_found():
    law = Law(np.full(4, 30.0), 1e-4, np.array([1e-4, -1e-4, 1e-4, np.nan]), np.array([2, 2, 0, 2]), hamaker=0.2)
    assert samples_of(law) == 4
    assert physical(law).tolist() == [True, False, False, False]
    assert samples_of(LAW) == 1
    assert physical(LAW).tolist() == [True]
    assert pytest.approx(-0.215 / (6 * np.pi * (1e6 + 8))) == float(pressure_GPa(100.0, LAW))
