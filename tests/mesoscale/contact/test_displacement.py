"""Closing by separation meets closing by force, and openings in between change nothing."""

import numpy as np
import pytest

from mesoscale.contact import ContactInputs, run_cycle
from mesoscale.contact.displacement import close_by_separation
from mesoscale.contact.surface import random_surface
from mesoscale.errors import InputError
from mesoscale.settings import ContactSettings

MIDDLE = ContactInputs(
    hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5
)
SMALL = ContactSettings(mechanics="asperity", pixels=128)
SEPARATIONS = np.arange(45.0, 24.0, -0.1)
DEEPEST = np.array([SEPARATIONS.size - 1])


def closed(settings=SMALL, separations=SEPARATIONS, depths=DEEPEST, inputs=MIDDLE, seed=3):
    heights = random_surface(inputs, settings, seed)
    return close_by_separation(inputs, settings, heights, separations, depths)


@pytest.mark.parametrize("mechanics", ["asperity", "coupled"])
def test_elastic_forces_are_those_of_closing_by_force(mechanics):
    settings = SMALL.model_copy(update={"model": "elastic", "mechanics": mechanics})
    found = closed(settings)
    cycle = run_cycle(
        MIDDLE, settings, 3, max_force_nN=float(found.closing[0, -1]), keep_surface=False
    )
    # the force of an elastic contact depends on the separation alone
    again = closed(settings, np.asarray(cycle.closing.separation_nm[-20:]), np.empty(0, int))
    np.testing.assert_allclose(again.closing[0], cycle.closing.repulsive_nN[-20:], rtol=1e-8)
    np.testing.assert_allclose(again.closing[1], cycle.closing.attractive_nN[-20:], rtol=1e-6)


def test_an_elastic_surface_opens_as_it_closed():
    found = closed(SMALL.model_copy(update={"model": "elastic"}))
    np.testing.assert_array_equal(found.opening[0], found.closing)


@pytest.mark.parametrize("mechanics", ["asperity", "coupled"])
def test_plastic_opening_ends_where_closing_ended_and_loses_contact_nearer(mechanics):
    found = closed(SMALL.model_copy(update={"mechanics": mechanics}))
    assert found.settled
    assert found.opening[0, 0, -1] == found.closing[0, -1] > 0
    assert (found.opening[0, 0] <= found.closing[0] * (1 + 1e-9)).mean() > 0.9
    touching = np.flatnonzero(found.opening[0, 0] > 0)
    assert SEPARATIONS[touching[0]] < found.first_contact_nm


def test_openings_on_the_way_change_nothing():
    alone, often = closed(), closed(depths=np.arange(120, SEPARATIONS.size, 15))
    np.testing.assert_allclose(often.closing, alone.closing, rtol=1e-9, atol=1e-9)
    assert np.isnan(often.opening[0, 0, 121:]).all()


def test_finer_steps_converge():
    """Plastic flow depends on the path; the mean over surfaces at full depth does so by less with
    smaller steps.
    """
    ends = {}
    for step in (0.4, 0.1, 0.025):
        separations = np.arange(45.0, 24.99, -step)
        ends[step] = np.mean(
            [closed(SMALL, separations, np.empty(0, int), seed=s).closing[0, -1] for s in range(12)]
        )
    assert abs(ends[0.1] / ends[0.025] - 1) < 0.02
    assert abs(ends[0.1] - ends[0.025]) <= abs(ends[0.4] - ends[0.025])


def test_rising_separations_are_refused():
    with pytest.raises(InputError, match="falling"):
        closed(separations=SEPARATIONS[::-1])
