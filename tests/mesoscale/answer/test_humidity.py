"""The switch from dry to humid air."""

import numpy as np
import pytest

from mesoscale.answer.humidity import HALVINGS, humidity_rows, levels, sticking_between
from mesoscale.answer.points import central_point, plan_points
from mesoscale.answer.switches import PadModel, press_pad, solve_point, solve_points, surfaces_of
from mesoscale.contact.menisci import menisci_of, reach_nm
from mesoscale.failure.population import Population
from mesoscale.inputs.table import input_table
from mesoscale.settings import ContactSettings, InputRow
from mesoscale.settings.contact import AirSettings
from mesoscale.studies.answer_stability import published_beam

CONTACT = ContactSettings(
    mechanics="coupled", pixels=64, q1_per_nm=0.15, attraction="offset", gap_cutoff_nm=0.3
)
SWITCH = published_beam(spring_N_per_m=1000.0)


def fixed(value: float) -> InputRow:
    return InputRow(distribution="fixed", values=(value,))


HARD = {"h_macro": fixed(9.0), "h_prime": fixed(0.0), "rms": fixed(4.0), "gap_cutoff": fixed(0.3)}


def test_the_humidities_span_the_input_or_are_that_of_the_air():
    table = input_table(**HARD, humidity=InputRow(values=(0.1, 0.8)))
    found = levels(table, CONTACT)
    assert found[0] == pytest.approx(0.1)
    assert found[-1] == pytest.approx(0.8)
    assert (np.diff(found) > 0).all()
    assert levels(input_table(**HARD, humidity=fixed(0.4)), CONTACT).tolist() == [0.4]
    stated = CONTACT.model_copy(update={"air": AirSettings(humidity=0.4)})
    assert levels(input_table(**HARD), stated).tolist() == [0.4]


def test_humid_air_sticks_what_lets_go_in_dry_air():
    table = input_table(**HARD, humidity=InputRow(values=(0.0, 0.8)))
    central = solve_point(central_point(table, CONTACT, SWITCH), CONTACT, 4, 1000)
    design = plan_points(table, CONTACT, SWITCH, 6)
    model = PadModel(
        central, design, tuple(solve_points(list(enumerate(design.points, 1)), CONTACT, 2))
    )
    rows = humidity_rows(model, table, CONTACT, 2)
    balance, volume = (
        [row for row in rows if row["opening"] == name] for name in ("balance", "volume")
    )
    assert balance[0]["release_V"] == volume[0]["release_V"] > 1.0  # dry: the limits are one
    assert balance[-1]["release_V"] == volume[-1]["release_V"] == 0.0
    assert balance[-1]["energy_mJ_m2"] > 3.0 * balance[0]["energy_mJ_m2"]
    assert volume[-1]["energy_mJ_m2"] > balance[-1]["energy_mJ_m2"]
    assert sum(row.get("points", 0) for row in balance) == 6
    assert "stuck" not in volume[0]
    humidities = [row["humidity"] for row in balance]
    assert humidities == sorted(humidities)
    free, stuck = sticking_between(balance)
    coarse = levels(table, CONTACT)
    assert len(balance) == len(coarse) + HALVINGS
    # its step is halved
    assert stuck - free < 0.2 * np.diff(coarse)[np.searchsorted(coarse, stuck) - 1]
    assert reach_nm(AirSettings(humidity=stuck), 0.2) > 0.31


def test_the_step_in_which_it_begins_to_stick():
    rows = [
        {"humidity": h, "release_V": r}
        for h, r in ((0.8, 0.0), (0.0, 5.0), (0.4, None), (0.2, 3.0))
    ]
    assert sticking_between(rows) == (0.2, 0.8)
    assert sticking_between(rows[1:]) is None
    assert sticking_between(rows[:1]) is None


def test_humidity_enters_the_rate_of_failure():
    table = input_table(**HARD, humidity=InputRow(values=(0.0, 0.8)))

    def press(point, times, number):
        return press_pad(point, CONTACT, 4 * times, surfaces_of(number))

    plates = Population(table, SWITCH, (0.3, 0.3), 0.0, press, (np.empty((0, 0)), []))
    z = np.zeros((2, plates.dimension))
    z[:, plates.names.index("humidity")] = -4.0, 2.0  # 0.003 and 78 %
    assert [point.values["humidity"] for point in plates.points(z, 70.0)] == pytest.approx(
        [0.0, 0.782], abs=1e-3
    )
    dry, humid = plates.reserves(z, plates.hold_V)
    assert humid < dry - 0.3  # nearer to sticking


def test_a_pad_is_computed_as_far_as_liquid_reaches():
    table = input_table(**HARD)
    air = AirSettings(humidity=0.9)
    pads = [
        solve_point(central_point(table, contact, SWITCH), contact, 4, 1000).pressed
        for contact in (CONTACT, CONTACT.model_copy(update={"air": air}))
    ]
    dry, humid = (pad.curves for pad in pads)
    # cells stand for some that touch first farther out
    touching = pads[1].first_contact_nm.max() + 5.0
    beyond = humid.separation_nm > touching + menisci_of(air, 0.0).reach_nm
    assert beyond.sum() > 20
    wanted = np.interp(humid.separation_nm[beyond], dry.separation_nm, dry.closing[1])
    assert humid.closing[1][beyond] == pytest.approx(wanted, rel=0.05)  # both are interpolated
    assert humid.closing[1].min() < 2.0 * dry.closing[1].min()
