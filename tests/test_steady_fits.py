"""Rounding moves no result: inputs changed by 1e-12 move what fits of the code say by less than
1e-6.

Processors with other instructions round otherwise. A fit that stops before it has settled, or that
chooses its terms by the last digits, makes visible differences of that.
"""

from dataclasses import replace

import numpy as np
import pytest

from atomistic.elastic.equation_of_state import fit_equation_of_state
from atomistic.hardness import film_law
from evidence.pad.closed_form import ClosedForm
from mesoscale.answer.known import fit_additive
from mesoscale.law.fit import fit_branch
from mesoscale.settings import TopographySettings
from mesoscale.topography.description.likelihood import fit, q0_interval
from mesoscale.topography.description.line_fits import fit_lines
from mesoscale.topography.description.parameters import analyse
from mesoscale.uncertainty.censored import censored_chaos
from mesoscale.uncertainty.regression import sparse_chaos
from tests.atomistic.hardness.test_film_law import made_up
from tests.mesoscale.topography.description.test_parameters import spectra

ROUNDED, MOVED = 1e-12, 1e-6
RANGES = np.array([[0.0, 1.0]] * 4)
POINTS = np.random.default_rng(5).random((160, 4))
VOLTS = 6.0 + 8.0 * POINTS[:, 0] - 9.0 * POINTS[:, 1] + 3.0 * POINTS[:, 0] * POINTS[:, 2]
VOLTS += 0.4 * np.random.default_rng(6).normal(size=160)
STUCK = VOLTS <= 4.0
"""A third of the switches."""


def rounded(values, turn):
    """Values that another processor may have made."""
    values = np.asarray(values, float)
    return values * (1.0 + ROUNDED * np.random.default_rng(turn).uniform(-1.0, 1.0, values.shape))


def by_name(fitted):
    """Numbers of a response by its terms."""
    return dict(zip(map(tuple, fitted.degrees.tolist()), fitted.coefficients.tolist(), strict=True))


def responses(change):
    chosen = sparse_chaos(POINTS, change(VOLTS), RANGES, degree=2)
    return by_name(chosen)


def sticking(change):
    known = np.where(STUCK, 0.0, change(VOLTS))
    chosen, scatter = censored_chaos(POINTS, known, STUCK, RANGES)
    return by_name(chosen) | {"scatter": scatter}


def causes(change):
    """Shares of the variance, and the release in the middle."""
    fitted = fit_additive(POINTS, np.where(STUCK, 0.0, change(VOLTS)))
    return dict(enumerate(fitted.shares().tolist())) | {"explained": fitted.explained}


def roughness(change):
    changed = [
        replace(item, spectrum=replace(item.spectrum, psd=change(item.spectrum.psd)))
        for item in spectra()
    ]
    fitted = fit(changed)
    low, high = q0_interval(changed, fitted, 2.0)
    lines = fit_lines(changed)
    estimates = analyse(changed, TopographySettings()).estimates
    return {
        "plateau": fitted.plateau,
        "q0": fitted.q0,
        "slope": fitted.slope,
        "low": low,
        "high": high,
        **{
            f"line {name}": getattr(lines, name)
            for name in ("plateau", "q0", "slope", "slope_low", "slope_high")
        },
        **{name: estimate.value for name, estimate in estimates.items()},
    }


def law(change):
    """Of a branch of a contact."""
    form = ClosedForm(-2.9, 0.25, 0.003, -0.35, 0.04, 0.02, 0.078, 0.97, 0.5, 2.0, 0.215, 0.3)
    separation = np.arange(19.0, 80.0, 0.5)
    push, pull = form.curves(separation, np.array([20.0])).closing
    fitted = fit_branch(separation, change(1e6 * push), change(1e6 * pull), 1e6, 0.215)
    return {name: getattr(fitted, name) for name in ("d_c_nm", "C_a_GPa_nm", "C_r_GPa", "rho_r_nm")}


def films(change):
    points, curves = made_up(noise=0.02)
    data = film_law.points_of(points, curves)
    changed = data._replace(stress_GPa=change(data.stress_GPa))
    return {
        (name, k): value
        for name in film_law.LAWS
        for k, value in enumerate(film_law.fit(name, changed))
    }


def equation_of_state(change):
    volume = np.linspace(90.0, 110.0, 9)
    energy = 1e-3 * (volume - 100.0) ** 2 - 1e-5 * (volume - 100.0) ** 3 - 50.0
    # a total energy is known to 1e-12 of itself, what differs by volume to 1e-12 of that
    fitted = fit_equation_of_state(volume, change(energy + 50.0) - 50.0)
    return {name: getattr(fitted, name) for name in ("V0_A3", "B_GPa", "B_prime", "B_vinet_GPa")}


@pytest.mark.parametrize(
    "of", [responses, sticking, causes, roughness, law, films, equation_of_state]
)
def test_rounding_moves_no_result_of_a_fit(of):
    """And chooses no other terms."""
    exact = of(np.asarray)
    for turn in range(6):
        other = of(lambda values, turn=turn: rounded(values, turn))
        assert other.keys() == exact.keys()
        for name, value in exact.items():
            assert other[name] == pytest.approx(
                value, rel=MOVED, abs=MOVED * max(map(abs, exact.values()))
            ), name
