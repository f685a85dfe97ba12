"""Repeated closing and creep: shakedown, relaxation laws, volume, and no trace where they are not
asked for.
"""

import itertools

import numpy as np
import pytest

from evidence.contact.draws import MIDDLE
from mesoscale.errors import InputError
from mesoscale.history.creep import follow, hardness_factor
from mesoscale.settings import ContactSettings, HistorySettings
from mesoscale.studies.contact_stability import violations

# smoother surfaces have fewer asperities, and the force jumps where they merge
CONTACT = ContactSettings(mechanics="asperity", pixels=128, reading={"convention": "profile"})
CREEP = HistorySettings(cycles=3, dwell_s=1e4, creep_exponent=20)


@pytest.fixture(scope="module")
def crept():
    return list(follow(MIDDLE, CONTACT, CREEP, seed=1))


def test_without_creep_the_second_cycle_is_nearly_elastic():
    first, second, third = follow(MIDDLE, CONTACT, HistorySettings(cycles=3), seed=1)

    def lost(held):
        work = [
            np.trapezoid(b.repulsive_nN, b.separation_nm)
            for b in (held.cycle.closing, held.cycle.opening)
        ]
        return -sum(work)

    assert lost(second) < 0.1 * lost(first)
    assert lost(third) < 0.01 * lost(first)
    assert (
        abs(third.cycle.closing.separation_nm[-1] - second.cycle.closing.separation_nm[-1]) < 0.02
    )
    assert not first.hold


def test_no_cycle_breaks_an_invariant(crept):
    for held in crept:
        assert violations(held.cycle, MIDDLE, CONTACT) == []
        assert held.missed == 0


def test_force_is_held_while_the_flat_sinks_and_the_contact_grows(crept):
    rows = crept[0].hold
    assert np.allclose([row.force for row in rows], CONTACT.max_force_nN, rtol=1e-3)
    assert np.all(np.diff([row.separation for row in rows]) < 0)
    assert rows[-1].sites > rows[0].sites


def test_mean_pressure_follows_the_creep_law(crept):
    # yield-limited contact: the area grows as 1/H; not quite, because H itself falls with the area
    # of an asperity
    rows = crept[0].hold
    grown = rows[-1].sites / rows[0].sites
    expected = 1 / hardness_factor(CREEP.dwell_s, CREEP)
    assert 1 < grown < 1.3 * expected
    assert grown > 0.5 * expected


def test_time_under_load_adds_up_and_the_surface_keeps_its_volume(crept):
    assert [held.held_s[-1] for held in crept] == [1e4, 2e4, 3e4]
    assert all(first.held_s[-1] == second.held_s[0] for first, second in itertools.pairwise(crept))
    heights = crept[-1].cycle.heights
    assert abs(heights.mean()) < 1e-12 * np.abs(heights).mean()


def test_relaxation_solves_nortons_law():
    settings = HistorySettings(cycles=1, dwell_s=1, creep_exponent=7)
    time = np.linspace(0, 50, 200001)
    p = hardness_factor(time, settings)
    rate = np.gradient(p, time, edge_order=2)
    assert np.allclose(rate, -(p**8), rtol=1e-4, atol=1e-9)
    assert p[0] == 1


def test_logarithmic_creep_has_its_strength_per_e_fold():
    settings = HistorySettings(cycles=1, dwell_s=1, creep_strength=0.02)
    assert 1 / hardness_factor(np.e - 1, settings) == pytest.approx(1.02)


@pytest.mark.parametrize(
    ("cycles", "model", "word"),
    [(0, "plastic", "history.cycles = 0"), (1, "elastic", "contact.model = elastic")],
)
def test_no_history_is_refused(cycles, model, word):
    with pytest.raises(InputError, match=word):
        next(
            follow(
                MIDDLE,
                ContactSettings(mechanics="asperity", model=model),
                HistorySettings(cycles=cycles),
                seed=1,
            )
        )
