"""A small campaign of `evidence.attacks.inputs`, its seed stated before the first run: 741128."""

import warnings

import numpy as np
import pytest

from evidence.attacks.inputs import _cycled, contacts, devices, presses, stresses

SEED = 741128
CAMPAIGNS = {
    "maps": lambda: presses(SEED, 200),
    "switches": lambda: devices(SEED, 150),
    "stresses": lambda: stresses(SEED, 1),
    "asperity": lambda: contacts(SEED, 200, "asperity"),
    "coupled": lambda: contacts(SEED, 200, "coupled"),
    # 200 take a minute and more: python -m evidence attacks.inputs
    "adhesive": lambda: contacts(SEED, 60, "adhesive"),
}


@pytest.mark.parametrize("name", CAMPAIGNS)
def test_random_inputs_are_solved_soundly_or_refused_for_a_reason(name):
    attacks = list(CAMPAIGNS[name]())
    faults = [attack.words for attack in attacks if attack.outcome == "fault"]
    assert not faults, "\n".join(faults)
    solved = sum(attack.outcome == "used" for attack in attacks)
    assert solved >= len(attacks) / 4  # else it shows little


def test_gaps_that_are_closed_to_the_last_digit_are_left():
    """Contact 82 of seed 20261129 divided by what was left of its gaps: nothing."""
    rng = np.random.default_rng([20261129, 4, 82])
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        assert _cycled(rng, "adhesive", 64) == ""
