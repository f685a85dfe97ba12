"""The closed form of a pad: what it was made of comes back, and its well is the one its formula says."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.errors import InputError
from mesoscale.pad.compact import CompactPad, fit_compact, well_status
from mesoscale.pad.memory import PadLaw
from tests.mesoscale.closed_form import tabulated

TRUE = CompactPad(-2.9, 0.25, 0.003, -0.35, 0.04, 0.02, 0.078, 0.97, 0.5, 0.0, 0.215, 0.3)
FLATTENED = replace(TRUE, lifted=6.0)


def curves(depths=(20.0, 22.0, 24.0, 26.0, 28.0), true=TRUE):
    s = np.arange(19.0, 60.0, 0.1)
    shape = PadLaw(s, np.zeros((2, s.size)), np.array(depths), np.zeros((len(depths), 2, s.size)), TRUE.flats)
    return tabulated(true, shape)


@pytest.mark.parametrize("true", [TRUE, FLATTENED])
def test_the_fit_returns_what_the_curves_were_made_of(true):
    fitted, residuals = fit_compact(curves(true=true))
    for name, value in vars(true).items():
        assert getattr(fitted, name) == pytest.approx(value, rel=1e-6, abs=1e-6), name
    assert max(vars(residuals).values()) < 1e-6


def test_flattened_places_attract_most_when_they_have_lifted():
    at = np.linspace(22.0, 32.0, 200)
    pulls = -FLATTENED.opening_GPa(at, 22.0)[1]
    assert pulls.argmax() not in (0, at.size - 1)
    assert pulls.max() > 1.5 * pulls[0]
    assert FLATTENED.well_kPa(22.0) > 2.0 * TRUE.well_kPa(22.0)


def test_opening_starts_where_closing_ended_and_falls():
    at = np.linspace(22.0, 40.0, 200)
    repulsive, attractive = TRUE.opening_GPa(at, 22.0)
    assert repulsive[0] == pytest.approx(float(TRUE.closing_GPa(22.0)[0]))
    assert attractive[0] == pytest.approx(float(TRUE.closing_GPa(22.0)[1]))
    assert (np.diff(repulsive) < 0).all()
    assert (np.diff(attractive) > 0).all()


def test_the_well_without_far_attraction_is_a_quarter_of_the_square_of_the_attraction():
    near = CompactPad(**{**vars(TRUE), "hamaker": 0.0})
    load, pull = (abs(float(x)) for x in near.closing_GPa(22.0))
    # 3001 separations 0.01 nm apart around a smooth minimum
    assert near.well_kPa(22.0) == pytest.approx(pull**2 / load / 4 * 1e6, rel=1e-4)


def test_too_few_depths_are_refused():
    with pytest.raises(InputError, match=r"pad\.grid\.depths"):
        fit_compact(curves(depths=(20.0, 24.0)))


def test_a_closed_form_that_misses_the_well_says_so():
    near = {"well_compact_kPa": 10.0, "well_curve_kPa": 9.0}
    assert well_status([near, {"well_compact_kPa": 1.0, "well_curve_kPa": 0.0}]) == "ok"
    assert well_status([near, {"well_compact_kPa": 4.0, "well_curve_kPa": 9.0}]).startswith(
        "misses_well: 0.44 to 0.44 times the curves' at 1 of 2 depths"
    )
