"""Curves of one pad at other inputs: what is known of both comes back."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.pad.carried import CarriedPad, factors_of
from mesoscale.pad.compact import CompactPad
from mesoscale.pad.memory import PadLaw

FORM = CompactPad(-4.0, 0.3, 0.006, 0.28, 0.002, 0.01, 0.05, 0.95, 0.5, 2.0, 0.2, 0.3)
OTHER = replace(FORM, c0=-3.6, c1_per_nm=0.36, b0_per_nm=0.33, beta=0.08, hamaker=0.25, offset_nm=0.2)
"""At other inputs."""
S = np.concatenate([np.arange(12.0, 60.0, 0.05), np.geomspace(60.0, 200.0, 20)[1:]])
DEPTHS = S[[0, 40, 80, 120, 160, 200]]


def true_opening(form, s, depth):
    """A pad whose repulsion and attraction differ from the closed form by what load and decay decide."""
    pushes, pulls = form.opening_GPa(s, depth)
    load, decay = form.log_load(depth), form.decay(s, depth)
    return pushes * np.exp(0.05 * load - 0.3 * decay), pulls * np.exp(-0.1 * load) * (1.0 + np.tanh(decay))


def true_law(form):
    opening = np.full((DEPTHS.size, 2, S.size), np.nan)
    for k, depth in enumerate(DEPTHS):
        opening[k][:, depth <= S] = true_opening(form, S[depth <= S], depth)
    closing = np.transpose([np.concatenate(true_opening(form, np.array([s]), s)) for s in S])
    return PadLaw(S, closing, DEPTHS, opening, form.flats)


@pytest.mark.parametrize(("form", "tolerance"), [(FORM, 1e-9), (OTHER, 5e-3)])
def test_carried_curves_are_those_of_the_pad_there(form, tolerance):
    carried = CarriedPad(form, factors_of(true_law(FORM), FORM))
    for depth in (DEPTHS[1], DEPTHS[3]) if form is FORM else (15.3, 18.1):
        s = depth + np.arange(0.0, 12.0, 0.05)
        for ours, true in zip(carried.opening_GPa(s, depth), true_opening(form, s, depth), strict=True):
            # linear between separations 0.05 nm apart, and the floor of a repulsion that counts as none
            np.testing.assert_allclose(ours, true, rtol=tolerance, atol=1e-12)
    start = 14.0
    for opened, closed in zip(carried.opening_GPa(np.array([start]), start), carried.closing_GPa(start), strict=True):
        assert opened[0] == pytest.approx(closed, rel=1e-2)


def test_beyond_the_curves_the_closed_form_goes_on_in_proportion():
    factors = factors_of(true_law(FORM), FORM)
    deep = CarriedPad(FORM, factors)
    ratio = deep.closing_GPa(11.0)[0] / FORM.closing_GPa(11.0)[0]
    assert ratio == pytest.approx(deep.closing_GPa(12.0)[0] / FORM.closing_GPa(12.0)[0])
    assert np.isfinite(deep.opening_GPa(np.linspace(10.0, 300.0, 100), 10.0)).all()


def test_without_attraction_there_is_none():
    law = true_law(replace(FORM, hamaker=0.0, beta=0.0))
    form = replace(FORM, hamaker=0.0, beta=0.0)
    assert not np.any(CarriedPad(form, factors_of(law, form)).opening_GPa(S, 12.0)[1])
