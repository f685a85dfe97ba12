"""A small campaign of `evidence.attacks.inputs`, its seed stated before the first run: 741128.

The same 200 of each kind, and more, are run by `python -m evidence attacks.inputs`.
"""

import numpy as np
import pytest

from evidence.attacks.inputs import _cycled, contacts, devices, presses, stresses
from mesoscale.errors import InputError

SEED = 741128
CAMPAIGNS = {
    "maps": lambda: presses(SEED, 100),
    "switches": lambda: devices(SEED, 40),
    "stresses": lambda: stresses(SEED, 1),
    "asperity": lambda: contacts(SEED, 100, "asperity"),
    "coupled": lambda: contacts(SEED, 100, "coupled"),
    "adhesive": lambda: contacts(SEED, 40, "adhesive"),
}


@pytest.mark.parametrize("name", CAMPAIGNS)
def test_random_inputs_are_solved_soundly_or_refused_for_a_reason(name):
    attacks = list(CAMPAIGNS[name]())
    faults = [attack.words for attack in attacks if attack.outcome == "fault"]
    assert not faults, "\n".join(faults)
    solved = sum(attack.outcome == "used" for attack in attacks)
    assert solved >= len(attacks) / 4  # else it shows little


def test_a_flattened_contact_whose_way_back_is_not_found_is_refused():
    """Contact 65 of seed 20261130 had infinite forces, and was only said not to have converged."""
    rng = np.random.default_rng([20261130, 4, 65])
    with pytest.raises(InputError, match="almost the whole cell touches"):
        _cycled(rng, "adhesive", 32)
