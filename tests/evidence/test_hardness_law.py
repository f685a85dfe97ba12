"""The study of hardness laws compares the same surfaces, and its hysteresis is the area between the curves."""

from dataclasses import replace

import numpy as np
import pytest

from evidence.contact.hardness_law import DIFFERENCE, MEASURED, measures
from evidence.record import load
from mesoscale.contact import run_cycle
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings

EQ_4 = ContactInputs(hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5)
FILM = replace(EQ_4, h_prime=0.0, h_film=7.6, t_film=5.0, k_film=0.24, m_film=1.2)


@pytest.mark.parametrize("inputs", [EQ_4, FILM])
def test_hysteresis_is_the_area_between_the_curves_of_net_pressure(inputs):
    cycle = run_cycle(inputs, ContactSettings(mechanics="coupled", pixels=64), 1)
    closing, opening = cycle.closing, cycle.opening
    separation = np.linspace(closing.separation_nm.min(), opening.separation_nm.max(), 200_001)
    closed = np.interp(separation, closing.separation_nm[::-1], closing.net_nN[::-1])
    area = np.trapezoid(closed - np.interp(separation, opening.separation_nm, opening.net_nN), separation)
    found = dict(zip(MEASURED, measures(cycle), strict=True))
    # nN nm over nm^2 are J/m^2; the curves end at different separations, where they pull with less than 1 % of the work
    assert found["hysteresis_mJ_m2"] == pytest.approx(area / cycle.cell_area_nm2 * 1e3, rel=0.01)
    assert found["pull_off_kPa"] == pytest.approx(-opening.net_nN.min() / cycle.cell_area_nm2 * 1e6)


def test_both_laws_had_the_same_surfaces_and_all_cells_converged():
    rows = load("contact.hardness_law")
    assert rows
    for row in rows:
        assert row["both_converged"] == row["surfaces"]
        if row["law"] == DIFFERENCE:
            assert float(row["d_c_nm"]) == float(row["d_c_nm_error"]) == 0.0
