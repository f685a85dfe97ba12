"""The adhesion well of a law beside that of its curve."""

import numpy as np
import pytest

from mesoscale.law.compact import Law, force, pressure
from mesoscale.law.wells import attraction_status, missed_wells, well_of, well_of_law, well_row

AREA = 1e6
LAW = Law(d_c_nm=32.0, C_a_GPa_nm=15e-5, C_r_GPa=6e-4, rho_r_nm=3.3, hamaker=0.215)


def test_a_triangular_well_has_its_depth_and_energy():
    at = np.linspace(0.0, 10.0, 1001)
    well = well_of(at, np.where(at < 2.0, 5.0, -3.0 * np.maximum(1.0 - np.abs(at - 4.0) / 2.0, 0.0)))
    assert well.depth_GPa == pytest.approx(3.0)
    assert well.at_nm == pytest.approx(4.0)
    assert well.energy_GPa_nm == pytest.approx(6.0, rel=1e-3)


def test_the_well_of_a_law_is_its_kink_at_contact():
    """Below d_c the repulsion rises faster than the attraction, by C_r / rho_r > C_a; above, the attraction falls."""
    well = well_of_law(LAW, 20.0, 60.0)
    assert well.at_nm == 32.0
    assert well.depth_GPa == pytest.approx(-float(pressure(32.0, LAW)[0]))


@pytest.mark.parametrize(("factor", "status"), [(1.0, "ok"), (1.24, "ok"), (1.3, "misses_well"), (0.6, "misses_well")])
def test_a_well_missed_by_more_than_a_quarter_says_so(factor, status):
    at = np.linspace(0.0, 10.0, 101)
    net = -np.exp(-((at - 5.0) ** 2))
    assert attraction_status(well_of(at, factor * net), well_of(at, net)).startswith(status)


def rows_of(factor):
    """Rows of a curve whose attraction is the law's times a factor near contact only."""
    h = np.linspace(23.0, 60.0, 200)
    attractive, repulsive = force(h, LAW, AREA)
    true = factor * attractive / AREA
    return {"branch": "opening", "node": "0"} | {
        key: value if isinstance(value, str) else repr(value)
        for key, value in well_row(LAW, (h, repulsive / AREA, true)).items()
    }


def test_an_exact_law_is_ok_and_a_wrong_one_is_named_in_the_note():
    right, wrong = rows_of(1.0), rows_of(0.2)
    assert right["attraction_status"] == "ok"
    # the curve is taken linear between points 0.19 nm apart
    assert float(right["attraction_residual"]) < 1e-3
    assert missed_wells([right, wrong]) == (1, 2)


def test_a_missing_curve_leaves_the_row_empty():
    assert well_row(None, None)["attraction_status"] == "no_curve"
