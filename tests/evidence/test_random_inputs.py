"""A small campaign of `evidence.attacks.inputs`, its seed stated before the first run: 741128."""

import pytest

from evidence.attacks.inputs import contacts, devices, presses, stresses

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
