"""The readings that mend the asperity model: `unloading_radius: flattened`, `merge: not_less`, and the drop's flag."""

import numpy as np
import pytest

from mesoscale.contact import ContactInputs, run_cycle
from mesoscale.contact.asperity.engine import Contact
from mesoscale.contact.path import trace
from mesoscale.contact.studies.draws import draw_inputs
from mesoscale.contact.studies.stability import violations
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings

INPUTS = ContactInputs(hamaker=0.0, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5)
MENDED = (
    {"unloading_radius": "flattened"},
    {"merge": "not_less"},
    {"unloading_radius": "flattened", "merge": "not_less"},
)


def caps(pixels: int, spacing: float, radius: float, *centres: float) -> np.ndarray:
    """Equal spherical caps (minima at height 0), centred on a row at distances from the cell's middle."""
    x = (np.arange(pixels) - pixels // 2) * spacing
    squared = np.min([x[:, None] ** 2 + (x[None, :] - centre) ** 2 for centre in centres], axis=0)
    return radius - np.sqrt(radius**2 - np.minimum(squared, 0.99 * radius**2))


def settings_for(pixels: int, spacing: float, **changes) -> ContactSettings:
    return ContactSettings(**{"pixels": pixels, "length_nm": pixels * spacing, **changes})


def test_two_equal_caps_merge_without_a_loss():
    """They touch each other at a depth of 10^2 / (2 R); one asperity of both carries about half of two."""
    heights = caps(128, 0.5, 50.0, -10.0, 10.0)
    levels = np.linspace(0.05, 2.0, 79)
    forces = {}
    for merge in ("as_one", "not_less"):
        contact = Contact(heights, INPUTS, settings_for(128, 0.5, model="elastic", merge=merge))
        states = [contact.move_to(-level, False) for level in levels]
        forces[merge] = np.array([state.force for state in states])
    merged = np.array([state.asperities for state in states]) == 1
    assert levels[merged][0] == pytest.approx(10.0**2 / (2 * 50.0), abs=0.05)
    assert np.diff(forces["as_one"]).min() < -0.3 * forces["as_one"][~merged][-1]
    assert np.diff(forces["not_less"]).min() >= 0.0
    np.testing.assert_array_equal(forces["not_less"][~merged], forces["as_one"][~merged])
    assert np.all(forces["not_less"] >= forces["as_one"])


@pytest.mark.parametrize("seed", range(1, 9))
def test_elastic_repulsion_never_falls_with_not_less(seed):
    drops = [
        run_cycle(INPUTS, ContactSettings(pixels=128, model="elastic", merge=merge), seed).flags["repulsion_drop"]
        for merge in ("as_one", "not_less")
    ]
    assert drops[1] == 0.0
    assert drops[0] >= drops[1]


def test_the_flag_is_the_largest_fall_below_an_earlier_value():
    cycle = run_cycle(INPUTS, ContactSettings(pixels=128), 2)
    force = cycle.closing.repulsive_nN
    worst = max(force[:k].max() - force[k] for k in range(1, len(force))) / force.max()
    assert worst > 0.01  # this surface loses repulsion
    assert cycle.flags["repulsion_drop"] == pytest.approx(worst)


def test_a_flattened_cap_unloads_nearly_as_stiffly_as_its_area():
    """dF/d(delta) = 2 E* sqrt(A/pi) for any elastic contact of area A.

    With R = A/(pi delta) the model's share of it is 1 where A falls with delta, as on a paraboloid, and 2/3 where A
    stays; a flattened top is between. The mean curvature, set by the rim, gives less.
    """
    ratios = {}
    for reading in ("curvature", "flattened"):
        settings = settings_for(128, 0.5, unloading_radius=reading)
        contact = Contact(caps(128, 0.5, 20.0, 0.0), INPUTS, settings)
        turn = trace(contact, 40, True, stop_force=1000.0).rows[-1]
        stiffness = (turn.force - contact_force(contact, turn.separation + 0.1)) / 0.1
        ratios[reading] = stiffness / (2 * INPUTS.e_star * np.sqrt(turn.sites * 0.25 / np.pi))
    assert ratios["curvature"] < 0.65
    assert 0.75 < ratios["flattened"] < 1.0


def contact_force(contact: Contact, separation: float) -> float:
    contact.adopt_changes()
    return contact.move_to(separation, False).force


@pytest.mark.parametrize("reading", MENDED)
@pytest.mark.parametrize("number", [0, 1, 2, 5])
def test_mended_cycles_keep_the_invariants(reading, number):
    inputs = draw_inputs(number)
    settings = ContactSettings(pixels=(64, 128)[number % 2], **reading)
    heights = random_surface(inputs, settings, 1)
    cycle = run_cycle(inputs, settings, 1, heights=heights, keep_surface=True)
    assert violations(cycle, inputs, settings, heights) == []
    assert cycle.converged


def test_flattened_tops_are_remembered_by_the_next_cycle():
    """Shakedown: closed to the same load again, a surface dissipates little, if its flattened tops are known."""
    settings = ContactSettings(pixels=128, unloading_radius="flattened")
    first = run_cycle(INPUTS, settings, 1, keep_surface=True)
    again = run_cycle(INPUTS, settings, 1, heights=first.heights, flattened=first.flattened, keep_surface=True)
    fresh = run_cycle(INPUTS, settings, 1, heights=first.heights, keep_surface=True)
    assert first.flattened is not None
    assert first.flattened.any()
    assert again.first_contact_nm == pytest.approx(first.last_contact_nm, abs=1e-9)
    on_the_way = np.interp(-first.opening.separation_nm, -again.closing.separation_nm, again.closing.repulsive_nN)
    close = np.abs(on_the_way - first.opening.repulsive_nN).max()
    assert close < 0.02 * first.opening.repulsive_nN.max()
    assert fresh.flags["changed_sites"] > again.flags["changed_sites"]


def test_an_undone_step_forgets_what_it_flattened():
    contact = Contact(caps(64, 0.5, 20.0, 0.0), INPUTS, settings_for(64, 0.5, unloading_radius="flattened"))
    contact.move_to(-0.05, True)
    before = contact.flattened
    contact.move_to(-2.0, True)
    assert contact.flattened.sum() > before.sum()
    contact.back()
    np.testing.assert_array_equal(contact.flattened, before)
