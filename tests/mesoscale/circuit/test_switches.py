"""The switch for circuits: its corners and its slow loop."""

from dataclasses import replace

import numpy as np
import pytest

from evidence.failure.rare_failures import CUTOFFS_NM, known_pad
from mesoscale.answer import switches as answer_switches
from mesoscale.circuit import switches
from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.circuit.switches import CORNERS, central_switch, loops, spread_switches
from mesoscale.errors import InputError
from mesoscale.settings import ContactSettings
from mesoscale.studies.answer_stability import published_beam
from mesoscale.switch.beam import beam_of
from mesoscale.switch.beam_switch import BeamSwitch
from tests.mesoscale.answer.test_release import TABLE, model_of, pad_of_two
from tests.mesoscale.circuit.test_tables import pad

BEAM = published_beam()


def test_corners_lie_beyond_the_draws_in_their_direction(monkeypatch):
    def press_pad(point, contact, cells, first_seed, **_):
        law = known_pad(point).curves
        return pad_of_two(law, 0.0)

    for module in (switches, answer_switches):
        monkeypatch.setattr(module, "press_pad", press_pad)
    contact = ContactSettings(mechanics="asperity")
    made = {
        of.row["switch"]: of.row
        for of in spread_switches(model_of(BEAM, 24), TABLE, contact, CUTOFFS_NM, 16)
    }
    assert set(made) == {*CORNERS, *(name for name in made if name.startswith("draw_"))}
    assert len(made) == len(CORNERS) + CIRCUIT.draws
    drawn = [row for name, row in made.items() if name.startswith("draw_")]
    for fewer, more, answer in (("fast", "slow", "pull_in_V"), ("sticky", "loose", "release_V")):
        middle = np.median([row[answer] for row in drawn])
        assert made[fewer][answer] <= middle <= made[more][answer]
        assert made[fewer][answer] < made[more][answer]


def test_the_slow_loop_jumps_at_pull_in_and_release():
    law = pad()
    states = BeamSwitch(BEAM).states_on(law)
    volts = np.linspace(0.0, 1.01 * states.pull_in_V, 101)
    up, down = BeamSwitch(BEAM, beam_of(BEAM, 128)).loop_fF(law, volts)
    open_fF = 8.8541878128e-12 * 510e-6 * 123e-6 / (3490e-9 + 200e-9 / 7.9) * 1e15
    gap = 3490e-9 + 200e-9 / 7.9
    sides = BEAM.fringe * gap / 123e-6 * np.log(np.pi * 123e-6 / gap)  # of a thin strip (Palmer)
    assert up[0] == pytest.approx(open_fF * (1.0 + sides), rel=1e-3)
    assert volts[np.argmax(np.diff(up)) + 1] == pytest.approx(states.pull_in_V, abs=volts[1])
    closed = volts[down > 1.1 * up]
    assert closed[0] == pytest.approx(states.release_V, abs=volts[1])
    assert (np.diff(up) > 0).all()


def test_draws_make_the_band_of_the_slow_loop():
    central, _ = central_switch(BEAM, pad())
    softer = replace(central, settings=BEAM.model_copy(update={"thickness_um": 3.9}))
    rows = loops(central, [softer] * 4)
    assert rows[-1]["voltage_V"] == pytest.approx(CIRCUIT.loop_top * central.row["pull_in_V"])
    assert all(row["up_q05_fF"] <= row["up_q95_fF"] for row in rows)
    # it closes earlier
    assert sum(row["up_q05_fF"] for row in rows) > sum(row["up_central_fF"] for row in rows)


def test_a_plate_on_a_spring_has_no_circuit():
    with pytest.raises(InputError, match="circuits are made of bending electrodes"):
        central_switch(published_beam(spring_N_per_m=10.0), pad())


def test_even_charge_shifts_the_slow_loop_of_both_polarities():
    law = pad()
    plain, _ = central_switch(BEAM, law)
    charged, _ = central_switch(published_beam(shift_V=6.0), law)
    assert charged.row["pull_in_V"] == pytest.approx(plain.row["pull_in_V"] + 6.0)
    assert charged.row["release_V"] == pytest.approx(plain.row["release_V"] + 6.0)
    rows = loops(charged, [charged] * 2)
    volts = np.array([row["voltage_V"] for row in rows])
    up = np.array([row["up_central_fF"] for row in rows])
    assert (np.diff(volts) > 0).all()
    closed = volts[up > 2.0 * up.min()]
    step = np.diff(volts).max()
    assert closed[closed > 0].min() == pytest.approx(charged.row["pull_in_V"], abs=step)
    assert closed[closed < 0].max() == pytest.approx(6.0 - plain.row["pull_in_V"], abs=step)
