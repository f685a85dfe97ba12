"""Stated intervals of the law's numbers hold them as often as they say."""

import numpy as np
import pytest

from mesoscale.law.compact import Law, force
from mesoscale.law.fit import fit_branch
from mesoscale.law.wells import SHARES

AREA = 1e6
LOAD_GPa = 7e-3
CURVES = 1000


def noisy_curve(rng, points, noise, constant):
    """A law drawn at random, its curve in `points` equal steps of force, and that curve with noise."""
    law = Law(rng.uniform(20, 40), rng.uniform(5, 40) * 1e-5, 10 ** rng.uniform(-4, -3), rng.uniform(1.5, 4), 0.215)
    loads = LOAD_GPa * np.arange(1, points + 1) / points
    near = law.d_c_nm - law.rho_r_nm * np.log1p(loads / law.C_r_GPa)
    h = np.sort(np.concatenate([near, law.d_c_nm + np.geomspace(0.05, 30, 20)]))
    attractive, repulsive = force(h, law, AREA)
    size = repulsive.max() * (repulsive > 0) if constant else repulsive
    return (
        law,
        h,
        repulsive + noise * size * rng.normal(size=h.size),
        attractive * (1 + noise * rng.normal(size=h.size)),
    )


@pytest.mark.parametrize("noise", [0.002, 0.01, 0.05])
def test_intervals_cover_made_up_curves(noise):
    """Half of the curves have noise of one size, half in proportion to the force; within 5 points."""
    rng = np.random.default_rng(int(1e4 * noise))
    hits = np.zeros((3, len(SHARES)))
    for number in range(CURVES):
        law, h, repulsive, attractive = noisy_curve(rng, 40, noise, number % 2 == 0)
        fit = fit_branch(h, repulsive, attractive, AREA, law.hamaker, law.d_c_nm)
        truths = (law.C_a_GPa_nm, law.C_r_GPa, law.rho_r_nm)
        for place, (known, truth) in enumerate(zip(fit.estimates, truths, strict=True)):
            for column, share in enumerate(SHARES):
                low, high = known.interval(share)
                hits[place, column] += low <= truth <= high
    np.testing.assert_allclose(hits / CURVES, np.broadcast_to(SHARES, hits.shape), atol=0.05)


def test_an_exact_curve_has_narrow_intervals_around_its_numbers():
    law = Law(32.0, 15e-5, 6e-4, 3.3, 0.215)
    h = np.linspace(23.0, 60.0, 400)
    attractive, repulsive = force(h, law, AREA)
    fit = fit_branch(h, repulsive, attractive, AREA, 0.215, 32.0)
    for known, truth in zip(fit.estimates, (law.C_a_GPa_nm, law.C_r_GPa, law.rho_r_nm), strict=True):
        low, high = known.interval(0.9)
        assert low <= high
        # resampling between points 0.09 nm apart, (0.09 / 3.3)^2 / 8, is taken off to first order
        assert known.value == pytest.approx(truth, rel=1e-5)
        assert high - low < 1e-3 * truth
