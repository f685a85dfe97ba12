"""The law's equations, its fit to curves with known parameters, and its refusals."""

import numpy as np
import pytest

from mesoscale.errors import InputError
from mesoscale.law.compact import Law, force, pressure
from mesoscale.law.fit import contact_separation, fit_branch, row_of

AREA = 1e6
TRUE = Law(d_c_nm=32.0, C_a_GPa_nm=15e-5, C_r_GPa=6e-4, rho_r_nm=3.3, hamaker=0.215)


def curve(law=TRUE, low=23.0, high=60.0, points=80):
    separation = np.linspace(low, high, points)
    attractive, repulsive = force(separation, law, AREA)
    return separation, repulsive, attractive


def test_flat_plates_attract_as_hamaker():
    """Eq. 10 beyond contact, A_H/(6 pi h^3): 0.215e-18 J at 10 nm over 1 um^2; the shield fades as
    (alpha/h)^3.
    """
    attractive, repulsive = force(10.0, Law(0.0, 1e-4, 1e-4, 1.0, 0.215, shield_nm=1e-3), AREA)
    assert attractive == pytest.approx(-11.406, rel=1e-3)
    assert repulsive == 0


def test_shield_keeps_the_attraction_finite_and_negative_at_and_below_zero():
    attractive, _ = pressure(np.array([-5.0, 0.0]), Law(-10.0, 0.0, 0.0, 1.0, 0.215, shield_nm=2.0))
    assert attractive == pytest.approx(-0.215 / (6 * np.pi * 8.0))


def test_both_forces_are_continuous_at_contact():
    below, above = np.array([32.0 - 1e-9, 32.0 + 1e-9]), np.array([34.0 - 1e-9, 34.0 + 1e-9])
    for x in (below, above):
        attractive, repulsive = pressure(x, TRUE)
        assert abs(np.diff(attractive)[0]) < 1e-11
        assert abs(np.diff(repulsive)[0]) < 1e-11


def test_pressure_broadcasts_samples_of_the_law():
    law = Law(np.full((5, 1), 32.0), np.linspace(1, 2, 5)[:, None] * 1e-4, 6e-4, 3.3, 0.215)
    attractive, repulsive = pressure(np.linspace(25, 40, 7), law)
    assert attractive.shape == (5, 7)
    assert repulsive.shape == (1, 7) or repulsive.shape == (5, 7)


@pytest.mark.parametrize("rho", [0.5, 3.3, 9.0])
def test_fit_returns_the_parameters_of_an_exact_curve(rho):
    law = Law(32.0, 15e-5, 6e-4, rho, 0.215)
    fit = fit_branch(*curve(law, points=2000), AREA, 0.215, 32.0)
    assert fit.status == "ok"
    # linear interpolation of a curve with 2000 points: (step/rho)^2/8
    assert fit.C_a_GPa_nm == pytest.approx(15e-5, rel=1e-3)
    assert fit.C_r_GPa == pytest.approx(6e-4, rel=5e-3)
    assert fit.rho_r_nm == pytest.approx(rho, rel=2e-3)
    assert fit.residual < 1e-3


def test_fit_does_not_depend_on_the_order_or_density_of_points():
    sparse, dense = curve(points=60), curve(points=600)
    uneven = np.unique(np.concatenate([np.arange(0, 300), np.arange(300, 600, 3)]))
    first = fit_branch(*dense, AREA, 0.215, 32.0)
    second = fit_branch(*(x[uneven][::-1] for x in dense), AREA, 0.215, 32.0)
    third = fit_branch(*sparse, AREA, 0.215, 32.0)
    assert second.parameters == pytest.approx(first.parameters, rel=1e-3)
    assert third.parameters == pytest.approx(first.parameters, rel=0.05)


def test_forces_scale_with_the_prefactors():
    separation, repulsive, attractive = curve()
    once = fit_branch(separation, repulsive, attractive, AREA, 0.215, 32.0)
    twice = fit_branch(separation, 2 * repulsive, 2 * attractive, AREA, 0.43, 32.0)
    assert twice.C_r_GPa == pytest.approx(2 * once.C_r_GPa, rel=1e-9)
    assert twice.C_a_GPa_nm == pytest.approx(2 * once.C_a_GPa_nm, rel=1e-9)
    assert twice.rho_r_nm == pytest.approx(once.rho_r_nm, rel=1e-9)


def test_degeneracy_shifting_contact_moves_the_prefactor_by_the_exponential():
    """Far from contact the curve only determines C_r exp(d_c / rho_r): hence d_c must come from the
    curve.
    """
    law = Law(40.0, 0.0, 1e-6, 2.0, 0.215)
    deep = curve(law, low=18.0, high=26.0)
    here, there = (fit_branch(*deep, AREA, 0.215, d_c) for d_c in (40.0, 44.0))
    assert there.rho_r_nm == pytest.approx(here.rho_r_nm, rel=0.02)
    assert there.C_r_GPa / here.C_r_GPa == pytest.approx(np.exp(-4.0 / 2.0), rel=0.3)


def test_contact_is_the_separation_at_first_touch():
    separation, repulsive, _ = curve(points=371)
    step = separation[1] - separation[0]
    assert contact_separation(separation, repulsive) == pytest.approx(32.0, abs=step)
    assert contact_separation(separation, repulsive, 31.5) == 31.5


def test_noise_is_covered_by_the_covariance():
    rng = np.random.default_rng(1)
    separation, repulsive, attractive = curve(points=400)
    fits = []
    for _ in range(100):
        noisy = np.maximum(
            repulsive + rng.normal(0, 0.02 * repulsive.max(), 400) * (repulsive > 0), 0
        )
        fits.append(fit_branch(separation, noisy, attractive, AREA, 0.215, 32.0))
    rho = np.array([fit.rho_r_nm for fit in fits])
    claimed = np.sqrt(np.mean([fit.covariance[2, 2] for fit in fits]))
    # clipping at zero and interpolation correlate the noise: right within a factor of two
    assert 0.5 < claimed / rho.std() < 2.0


def test_no_contact_gives_no_numbers():
    fit = fit_branch([10.0, 20.0], [0.0, 0.0], [-1.0, -0.1], AREA, 0.215)
    assert fit.status == "no_contact"
    assert np.isnan(fit.parameters).all()


def test_few_points_give_no_numbers_but_contact():
    fit = fit_branch([8.0, 9.0, 10.0], [5.0, 1.0, 0.0], [-3.0, -2.0, -1.0], AREA, 0.215, 10.0)
    assert fit.status == "few_points"
    assert fit.d_c_nm == 10.0
    assert np.isnan([fit.C_r_GPa, fit.rho_r_nm]).all()


def test_a_straight_line_is_not_identifiable():
    separation = np.linspace(20, 40, 60)
    fit = fit_branch(separation, np.maximum(30 - separation, 0), -np.ones(60), AREA, 0.215, 30.0)
    assert fit.status.startswith("not_identifiable")
    assert np.isnan([fit.C_r_GPa, fit.rho_r_nm]).all()
    assert np.isfinite(fit.C_a_GPa_nm)


def test_a_curve_of_another_shape_is_marked_poor():
    separation = np.linspace(20, 40, 200)
    depth = np.maximum(35 - separation, 0)
    wavy = depth * (1.2 + np.sin(depth)) ** 2
    fit = fit_branch(separation, wavy, -np.zeros(200), AREA, 0.0, 35.0)
    assert fit.status == "poor_fit"
    assert np.isfinite(fit.parameters).all()


def test_not_finite_or_unequal_arrays_are_refused():
    with pytest.raises(InputError, match="not finite"):
        fit_branch([1.0, 2.0], [np.nan, 0.0], [0.0, 0.0], AREA, 0.2)
    with pytest.raises(InputError, match="shapes"):
        fit_branch([1.0, 2.0], [0.0], [0.0, 0.0], AREA, 0.2)


def test_row_of_a_missing_fit_holds_no_number_in_the_covariance():
    row = row_of(fit_branch([10.0, 20.0], [0.0, 0.0], [0.0, 0.0], AREA, 0.215))
    assert row["covariance"] == "[[null, null, null], [null, null, null], [null, null, null]]"
