"""The budget: what the central switch says where one property is another, formulas, and rows that
are refused.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from asperity.guards.foreign_yaml import load_mapping
from mesoscale.answer.budget import (
    NUMERICAL,
    OF_RUNS,
    TWIN,
    _moved_V,
    _Pressed,
    budget,
    effects_of,
    left_open,
    with_twins,
)
from mesoscale.answer.points import Point
from mesoscale.answer.switches import Solved
from mesoscale.errors import InputError
from mesoscale.settings.definitions import BY_NAME
from mesoscale.studies.answer_stability import made_up_pad, published_beam
from mesoscale.switch import switch_of

SHIPPED = load_mapping(Path(__file__).parents[3] / "config" / "effects.yaml", "table of effects")
ROW = {
    "how": "condition",
    "about": "10 °C more",
    "held": False,
    "settle": "heat it",
    "source": "a paper",
    "volts": 1.0,
}
SWITCH_CONTENT = {
    "by_attraction": [{"times": 1.0, "release_V": 7.0}, {"times": 3.0, "release_V": 0.0}],
    "answer": None,
}


class KnownPad:
    curves = made_up_pad(40.0)


def central(device):
    states = switch_of(device).states(KnownPad.curves)
    return Solved(Point({}, 0.2, device), KnownPad, states, (0.0, 0.0))


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"source": " "}, "humid air: .*a row without source"),
        ({"volts": None}, "humid air: .*state one of volts"),
        ({"share": 0.5}, "humid air: .*state one of volts"),
        ({"changes": "colour", "volts": None}, "humid air: .*no property of the device"),
        ({"how": "guessed"}, "humid air: .*how = 'guessed'"),
        ({"stated_as": "device.colour"}, "humid air: .*no key that stands for an effect"),
    ],
)
def test_rows_without_source_or_with_no_or_two_statements_are_one_line(change, line):
    with pytest.raises(InputError, match=line) as refused:
        effects_of({"humid air": ROW | change})
    assert "\n" not in str(refused.value)


def test_what_the_literature_names_stands_in_the_budget_or_is_small_for_a_reason():
    """Twenty effects, listed before the table was opened (evidence/data/effects_named.yaml)."""
    path = Path(__file__).parents[3] / "evidence" / "data" / "effects_named.yaml"
    named = load_mapping(path, "effects")["effects"]
    known = {
        *effects_of(SHIPPED),
        *published_beam().varied,
        *BY_NAME,
        "gap_cutoff_nm",
        "law of attraction",
        NUMERICAL,
    }
    assert len(named) == 20
    for row in named:
        assert row["source"]
        assert set(row.get("in", [])) <= known, row["effect"]
        assert row.get("in") or row["below"]


def test_every_number_is_that_of_its_own_calculation():
    device = published_beam(hold_voltage_V=80.0)
    switch = central(device)
    rows = {row["effect"]: row for row in budget(effects_of(SHIPPED), SWITCH_CONTENT, switch)}
    release = switch.states.release_V
    hot = central(device.model_copy(update={"temperature_C": 30.0})).states.release_V
    assert rows["temperature"]["volts"] == pytest.approx(abs(hot - release))
    # 10¹¹ e/cm², 200 nm, 7.9
    assert rows["charge in the dielectric, even"]["volts"] == pytest.approx(0.458, abs=0.001)
    power = rows["power of the signal"]["volts"]
    assert (release - power) ** 2 == pytest.approx(release**2 - 5.0)
    assert rows["law of attraction"]["volts"] == 7.0
    assert "may stick" in rows["law of attraction"]["about"]
    tilt = rows["tilt_nm"]  # alike to both sides, and still not nothing
    assert tilt["volts"] > 0.0
    assert tilt["held"]
    volts = [row["volts"] for row in rows.values()]
    known = [value for value in volts if value is not None]
    assert known == sorted(known, reverse=True)
    assert volts[len(known) :] == [None] * (len(volts) - len(known))
    assert np.isfinite(known).all()


def test_what_a_scene_states_is_no_open_effect():
    """Also a stress of 0, and by keys of the data file alone."""
    effects = effects_of(SHIPPED)
    left = left_open(effects, {"device.residual_stress_MPa", "contact.air"})
    assert set(effects) - set(left) == {"mean stress of the film", "humid air"}
    assert left_open(effects, {"device.gap_um"}) == effects


def test_a_plate_has_no_stress_and_a_switch_that_sticks_has_no_budget():
    plate = published_beam(spring_N_per_m=1e3, hold_voltage_V=160.0)
    names = {row["effect"] for row in budget(effects_of(SHIPPED), SWITCH_CONTENT, central(plate))}
    assert "hold voltage" in names
    assert not {"temperature", "stress by the package", "curl of the beam"} & names
    stuck = central(plate)
    assert (
        budget(
            {},
            SWITCH_CONTENT,
            Solved(stuck.point, KnownPad, replace(stuck.states, release_V=0.0), (0.0, 0.0)),
        )
        == []
    )


def test_the_factor_of_half_the_energies_is_that_of_the_scenes_twins():
    effects = effects_of(SHIPPED)
    ratio = {"median": 0.52, "low": 0.46, "high": 0.58}
    told = with_twins(effects, [{"energy_scale": 0.5, "ratio": ratio}])
    assert told[TWIN].hardness == 0.52
    assert told[TWIN].about == "0.52 [0.46, 0.58] of the hardness, by twins of this scene"
    assert with_twins(effects, []) == effects
    switch = central(published_beam(hold_voltage_V=80.0))
    rows = {
        row["effect"]: row
        for row in budget(told, SWITCH_CONTENT, switch, {1.0: 7.0, 0.52: 0.0, 1.37: 7.5, 1.36: 7.4})
    }
    assert rows[TWIN]["volts"] == 7.0
    assert rows[TWIN]["about"].endswith("; it may stick")
    assert rows["asperities that meet asperities"]["volts"] == 0.5
    without = {row["effect"] for row in budget(told, SWITCH_CONTENT, switch)}
    assert set(rows) - without == {*OF_RUNS, "asperities that meet asperities"}


def test_numerical_errors_of_the_scene_stand_in_quadrature():
    switch = central(published_beam(hold_voltage_V=80.0))
    rows = budget(
        {},
        SWITCH_CONTENT,
        switch,
        errors_V={"sites a side": 0.3, "steps of separation, nm": 0.4, "x": np.nan},
    )
    (row,) = [row for row in rows if row["effect"] == NUMERICAL]
    assert row["volts"] == pytest.approx(0.5)
    assert row["about"] == "sites a side 0.3 V, steps of separation 0.4 V, x nan V"


def test_an_input_of_the_scene_takes_the_place_of_its_row():
    switch = central(published_beam(hold_voltage_V=80.0))
    humid = Solved(
        Point({"humidity": 0.4}, 0.2, switch.point.device), KnownPad, switch.states, (0.0, 0.0)
    )
    names = [
        {row["effect"] for row in budget(effects_of(SHIPPED), SWITCH_CONTENT, one)}
        for one in (switch, humid)
    ]
    assert names[0] - names[1] == {"humid air"}


def volts_of(effect, switch):
    """Volts of one shipped effect on a switch."""
    pressed = _Pressed(switch.point.device, KnownPad.curves, switch.states)
    return _moved_V(effects_of(SHIPPED)[effect], pressed, {})[0]


OTHER = published_beam(length_um=400.0, thickness_um=3.0, gap_um=2.5, hold_voltage_V=110.0)


@pytest.mark.parametrize(
    ("effect", "changes"),
    [
        # each change stated in words by `about`, here by hand of another beam than the default
        ("anchors that give way", {"anchor_um_per_N": 0.1 * 400e3 / (89.3 * 123.0 * 3.0)}),
        (
            "anchors that turn",
            {"anchor_rad_per_uN_m": 0.01 * 400e3 / (89.3 / 0.91 * 123.0 * 3.0**3 / 12.0)},
        ),
        ("stress by the package", {"residual_stress_MPa": 5.0 / 0.7}),
        ("mean stress of the film", {"residual_stress_MPa": 75.0}),
        # stiffness and the load of its own weight scale by 0.75, area by 1 - pi/4 (10/40)^2
        ("etch holes", {"youngs_modulus_GPa": 89.3 * 0.75 / (1.0 - np.pi / 64.0)}),
    ],
)
def test_what_a_row_is_about_is_what_its_change_does(effect, changes):
    """The row of the anchors said a tenth and changed a ten-thousandth."""
    switch = central(OTHER)
    changed_V = central(OTHER.model_copy(update=changes)).states.release_V
    moved_V = abs(changed_V - switch.states.release_V)
    assert volts_of(effect, switch) == pytest.approx(moved_V, rel=0.03, abs=0.01)
    assert moved_V > 0.02


def test_a_length_may_be_longer_or_shorter():
    releases = [
        central(OTHER.model_copy(update={"length_um": length})).states.release_V
        for length in (395.0, 400.0, 405.0)
    ]
    assert volts_of("length and undercut of the beam", central(OTHER)) == pytest.approx(
        releases[0] - releases[2], rel=1e-6
    )


def test_the_contact_potential_is_the_difference_of_two_work_functions():
    """Michaelson (1977), from memory: aluminium 4.28 eV, gold 5.1 eV. It adds as it is."""
    assert SHIPPED["contact potential of the two metals"]["volts"] == pytest.approx(
        5.1 - 4.28, 0.05
    )


def rows_of(device):
    solved = central(device)
    return {row["effect"]: row for row in budget(effects_of(SHIPPED), SWITCH_CONTENT, solved)}


def test_a_scene_that_states_charge_has_its_row_in_place_of_the_conditions():
    plain = rows_of(published_beam())
    charged = rows_of(published_beam(shift_V=-1.0, uneven={"patch_nm": 1e6, "e_cm2": 1e11}))
    conditions = {"charge in the dielectric, even", "charge in the dielectric, uneven"}
    assert conditions <= plain.keys()
    assert not conditions & charged.keys()
    stated = charged["charge that the scene states"]
    assert "charge that the scene states" not in plain
    assert stated["held"]
    # V_s and the square of U, 1 V and 0.21 V^2
    release_V = switch_of(published_beam()).states(KnownPad.curves).release_V
    lost_V = release_V - np.sqrt(release_V**2 - 0.21)
    assert stated["volts"] == pytest.approx(1.0 + lost_V, abs=0.02)


def test_the_row_of_even_charge_is_the_shift_that_the_switch_has():
    row = rows_of(published_beam())["charge in the dielectric, even"]
    charged = switch_of(published_beam(charge_e_cm2=1e11)).states(KnownPad.curves)
    plain = switch_of(published_beam()).states(KnownPad.curves)
    assert row["volts"] == pytest.approx(charged.release_V - plain.release_V, rel=1e-9)
