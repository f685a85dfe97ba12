"""Stiff and extreme beams: each is solved with numbers that can be, or refused in one line that says why."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.device.beam import euler_MPa, lumped_beam
from mesoscale.device.beam_switch import solve_beam
from mesoscale.device.electrode import with_pad
from mesoscale.device.spread import check_spread
from mesoscale.errors import InputError
from mesoscale.pad.memory import PadLaw
from mesoscale.settings import DeviceSettings
from tests.mesoscale.device.test_beam import made_up_law

EULER = euler_MPa(DeviceSettings()) / 0.7
TIP = {"ends": "cantilever", "length_um": 250.0, "thickness_um": 3.0}
BESIDE = {"electrode": (0.3, 0.8), "contact": (0.93, 1.0), "dimple_nm": 1500.0, "hold_voltage_V": 50.0}
"""It touches before it would pull in, and is then pressed."""
SOLVED = {
    "at the buckling point": {"residual_stress_MPa": -EULER},
    "just below": {"residual_stress_MPa": -0.999 * EULER},
    "just beyond, up": {"residual_stress_MPa": -1.001 * EULER},
    "just beyond, down": {"residual_stress_MPa": -1.001 * EULER, "buckled": "down"},
    "far beyond, up": {"residual_stress_MPa": -60.0},
    "down, not onto the pad": {"residual_stress_MPa": -30.0, "buckled": "down"},
    "buckled with a bow against it": {"residual_stress_MPa": -40.0, "bow_nm": -300.0},
    "stress of 2 GPa": {"residual_stress_MPa": 2000.0, "gap_um": 1.0},
    "thickness a tenth of the gap": {"thickness_um": 0.35, "gap_um": 3.5},
    "thickness ten times the gap": {"thickness_um": 4.0, "gap_um": 0.4},
    "heated by 5 degrees": {"temperature_C": 25.0},
    "cooled to 77 K": {"temperature_C": -196.0, "gap_um": 1.0},
    "soft anchors": {"anchor_um_per_N": 1e6},
    "bow of more than the thickness": {"bow_nm": 5000.0},
    "bow towards the pad": {"bow_nm": -1500.0},
    "tilt of half the gap": {"tilt_nm": 1700.0},
    "cantilever on its tip": {**TIP, "contact": (0.9, 1.0), "stopper_nm": 30.0},
    "cantilever all along": TIP,
    "cantilever curled up": {**TIP, "bow_nm": 1000.0, "contact": (0.9, 1.0), "stopper_nm": 30.0},
    "electrode beside the contact": {**TIP, **BESIDE},
    "the same, pressed harder": {**TIP, **BESIDE, "hold_voltage_V": 60.0},
    "dimple in the middle": {"contact": (0.45, 0.55), "dimple_nm": 500.0},
    "electrode on one side": {**TIP, "ends": "clamped", **BESIDE, "contact": (0.45, 0.55), "hold_voltage_V": 400.0},
    "on stoppers as high as the dimple": {"contact": (0.45, 0.55), "dimple_nm": 300.0, "stopper_nm": 300.0},
    "held with three times its pull-in": {"hold_voltage_V": 150.0, "gap_um": 2.0},
}
REFUSED = {
    "onto the pad": ({"residual_stress_MPa": -200.0, "buckled": "down"}, "the beam stands on the dielectric at rest"),
    "hot onto the pad": ({"temperature_C": 400.0, "buckled": "down"}, "temperature_C = 400: the beam stands on"),
    "stopper above the gap": (
        {"contact": (0.4, 0.6), "stopper_nm": 4000.0},
        "lower bow_nm, tilt_nm, dimple_nm or stop",
    ),
    "stopper that keeps it off": (
        {"contact": (0.45, 0.55), "electrode": (0.2, 0.4), "stopper_nm": 1500.0},
        "does not land on the pad",
    ),
    "that touches gently, held with no more": ({**TIP, **BESIDE, "hold_voltage_V": None}, "raise hold_voltage_V"),
    "gap inside the pad": ({"gap_um": 0.03}, "rests within reach of its pad"),
    "held with too little": ({"hold_voltage_V": 20.0}, "never closes this switch"),
}


@pytest.mark.parametrize("name", SOLVED)
def test_hard_beams_are_solved(name):
    settings = DeviceSettings(**SOLVED[name])
    fine, coarse = (with_pad(lambda law, n=n: solve_beam(settings, law, n), made_up_law(2.0))[0] for n in (128, 64))
    for states in (fine, coarse):
        assert all(np.isfinite(value) for value in vars(states).values())
        assert 0.0 <= states.release_V < states.hold_V
        assert 0.0 < states.landed_share <= 1.0
        assert states.pull_in_V <= states.hold_V * 1.002
    assert coarse.pull_in_V == pytest.approx(fine.pull_in_V, rel=5e-3)
    # the mesh moves a release by some per cent of the hold voltage where the beam tears off in jerks
    assert coarse.release_V == pytest.approx(fine.release_V, abs=0.02 * fine.hold_V)


def softer(settings, law, times):
    """The same switch and pad with all moduli, stresses and pressures times a number."""
    stress = times * settings.residual_stress_MPa
    update = {"youngs_modulus_GPa": times * settings.youngs_modulus_GPa, "residual_stress_MPa": stress}
    flats = replace(law.flats, hamaker=times * law.flats.hamaker)
    pad = PadLaw(law.separation_nm, times * law.closing, law.depth_nm, times * law.opening, flats)
    return settings.model_copy(update=update), pad


@pytest.mark.parametrize(
    "name", ["cooled to 77 K", "on stoppers as high as the dimple", "electrode beside the contact"]
)
@pytest.mark.parametrize("times", [2.0**-14, 1e-4])
def test_the_solver_knows_no_pressure_but_those_of_beam_and_pad(name, times):
    """Voltages go with the root of all pressures; a power of four scales every number exactly."""
    settings, law = DeviceSettings(**{**SOLVED[name], "temperature_C": 20.0}), made_up_law(2.0)
    hold = {"hold_voltage_V": times**0.5 * settings.hold_voltage_V if settings.hold_voltage_V else None}
    stiff, _ = with_pad(lambda pad: solve_beam(settings, pad), law)
    soft_settings, soft_law = softer(settings, law, times)
    soft, _ = with_pad(lambda pad: solve_beam(soft_settings.model_copy(update=hold), pad), soft_law)
    for way in ("pull_in_V", "hold_V", "release_V"):
        assert getattr(soft, way) / times**0.5 == pytest.approx(getattr(stiff, way), rel=1e-6)
    assert soft.landed_share == pytest.approx(stiff.landed_share, rel=1e-6)
    # a balance is found to a thousandth of a nanometre, of some 50
    assert soft.capacitance_fF == pytest.approx(stiff.capacitance_fF, rel=1e-5)


@pytest.mark.parametrize("adhesion_kPa", [0.0, 2.0, 30.0])
def test_a_long_thin_cantilever_lands_on_an_ordinary_pad(adhesion_kPa):
    """Its spring pulls with 0.4 Pa, that of the default with 15 kPa."""
    settings = DeviceSettings(
        ends="cantilever", length_um=766.0, width_um=180.0, thickness_um=1.04, youngs_modulus_GPa=45.0
    )
    states, _ = with_pad(lambda law: solve_beam(settings, law), made_up_law(adhesion_kPa))
    assert 0.4 < states.pull_in_V < 0.5  # of a cantilever: sqrt(0.28 E t^3 g^3 / eps L^4) = 0.47
    assert 0.2 < states.landed_share < 0.5
    assert 0.0 <= states.release_V < states.pull_in_V


@pytest.mark.parametrize("name", REFUSED)
def test_beams_that_are_no_switch_are_refused_in_one_line(name):
    change, words = REFUSED[name]
    with pytest.raises(InputError, match=words) as caught:
        with_pad(lambda law: solve_beam(DeviceSettings(**change), law), made_up_law())
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"thickness_um": 0.5},
        {"residual_stress_MPa": 200.0},
        {"bow_nm": -1000.0},
        {"tilt_nm": 1000.0},
        {"ends": "cantilever", "length_um": 250.0},
    ],
)
def test_a_pad_higher_than_the_gap_names_a_gap_that_works(change):
    """As rough as optical maps are: it reaches 6 um above its mean plane."""
    law = made_up_law(2.0)
    law = PadLaw(law.separation_nm + 6e3, law.closing, law.depth_nm + 6e3, law.opening, law.flats)
    with pytest.raises(InputError, match="rests within reach of its pad; raise gap_um to") as caught:
        solve_beam(DeviceSettings(**change), law)
    gap_um = float(str(caught.value).partition("gap_um to ")[2].partition(",")[0])
    states, _ = with_pad(lambda law: solve_beam(DeviceSettings(**change, gap_um=gap_um), law, 64), law)
    assert states.landed_share > 0.0
    assert states.release_V > 0.0


def test_a_spread_that_leaves_no_device_and_a_beam_without_lumps_are_refused_in_one_line():
    wide = {"dielectric_nm": {"distribution": "normal", "values": [0, 0.5], "relative": True}}
    with pytest.raises(
        InputError, match=r"spread\.dielectric_nm: reaches dielectric_nm = -129.1: .*equal to 0; narrow"
    ):
        check_spread(DeviceSettings(spread=wide))
    check_spread(DeviceSettings())
    with pytest.raises(InputError, match="circuits are made of beams clamped at both ends"):
        lumped_beam(DeviceSettings(ends="cantilever"), 8)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"electrode": (0.5, 1.2)}, r"electrode = \[0\.5, 1\.2\]: accepted are two rising shares"),
        ({"contact": (0.6, 0.4)}, r"contact = \[0\.6, 0\.4\]: accepted are two rising shares"),
        ({"spread": {"gap_um": {"values": [0, 1], "varies": ["common", "each"]}}}, r"varies.*'common' or 'each'"),
        ({"spread": {"gap_um": {"distribution": "normal", "values": [0]}}}, "are none of distribution normal"),
        ({"ends": "free"}, "'clamped' or 'cantilever'"),
    ],
)
def test_a_device_that_is_none_is_refused_in_one_line(change, words):
    with pytest.raises(InputError, match=words) as caught:
        DeviceSettings(**change)
    assert "\n" not in str(caught.value)
