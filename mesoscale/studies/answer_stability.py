"""Stiff and extreme switches: each is solved with numbers that can be, or refused in one line that
says why.

Beams are those around the published default, on a made-up pad: a change of stress or shape is hard
only for the beam that it is made for. The device of the scene stands at its own extremes on its own
pad.
"""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from mesoscale.errors import InputError
from mesoscale.pad.curves import Flats, PadCurves, attracting, on_deep_enough
from mesoscale.settings import DeviceSettings
from mesoscale.studies.driver import HardCase
from mesoscale.switch import switch_of
from mesoscale.switch.beam import COARSE_ELEMENTS, ELEMENTS, beam_of, euler_MPa
from mesoscale.switch.beam_switch import BeamStates, BeamSwitch

Changes = dict[str, Any]


def published_beam(**changes: Any) -> DeviceSettings:
    """The default beam with the modulus that its publication states, or a change of it.

    Voltages of tests, hard cases and studies are of it.
    """
    return DeviceSettings(**{"youngs_modulus_GPa": 89.3, **changes})


FLAT = published_beam()
EULER_MPa = euler_MPa(FLAT) / (1.0 - FLAT.poisson_ratio)
"""Residual stress at which the default beam buckles."""
TIP: Changes = {"ends": "cantilever", "length_um": 250.0, "thickness_um": 3.0}
BESIDE: Changes = {
    "electrode": (0.3, 0.8),
    "contact": (0.93, 1.0),
    "dimple_nm": 1500.0,
    "hold_voltage_V": 50.0,
}
"""It touches before it would pull in, and is then pressed."""
SOLVED: dict[str, Changes] = {
    "at the buckling point": {"residual_stress_MPa": -EULER_MPa},
    "just below": {"residual_stress_MPa": -0.999 * EULER_MPa},
    "just beyond, up": {"residual_stress_MPa": -1.001 * EULER_MPa},
    "just beyond, down": {"residual_stress_MPa": -1.001 * EULER_MPa, "buckled": "down"},
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
    "electrode on one side": {
        **TIP,
        "ends": "clamped",
        **BESIDE,
        "contact": (0.45, 0.55),
        "hold_voltage_V": 400.0,
    },
    "on stoppers as high as the dimple": {
        "contact": (0.45, 0.55),
        "dimple_nm": 300.0,
        "stopper_nm": 300.0,
    },
    "held with three times its pull-in": {"hold_voltage_V": 150.0, "gap_um": 2.0},
}
REFUSED: dict[str, tuple[Changes, str]] = {
    "onto the pad": (
        {"residual_stress_MPa": -200.0, "buckled": "down"},
        "the beam stands on the dielectric at rest",
    ),
    "hot onto the pad": (
        {"temperature_C": 400.0, "buckled": "down"},
        "temperature_C = 400: the beam stands on",
    ),
    "stopper above the gap": (
        {"contact": (0.4, 0.6), "stopper_nm": 4000.0},
        "lower bow_nm, tilt_nm, dimple_nm or stop",
    ),
    "stopper that keeps it off": (
        {"contact": (0.45, 0.55), "electrode": (0.2, 0.4), "stopper_nm": 1500.0},
        "does not land on the pad",
    ),
    "that touches gently, held with no more": (
        {**TIP, **BESIDE, "hold_voltage_V": None},
        "raise hold_voltage_V",
    ),
    "gap inside the pad": ({"gap_um": 0.03}, "rests within reach of its pad"),
    "held with too little": ({"hold_voltage_V": 20.0}, "never closes this switch"),
}
"""With a part of the line that says why."""
HIGHER: dict[str, Changes] = {
    "flat": {},
    "thin": {"thickness_um": 0.5},
    "tense": {"residual_stress_MPa": 200.0},
    "bowed towards it": {"bow_nm": -1000.0},
    "tilted": {"tilt_nm": 1000.0},
    "cantilever": {"ends": "cantilever", "length_um": 250.0},
}
"""Beams over a pad that is higher than their gap."""
CHECK_SOLVED = (
    "finite, released below the hold voltage, landed, pull-in and release by half as many elements"
    " alike"
)
CHECK_REFUSED = "refused in one line that says why"
CHECK_HIGHER = "refused with a gap, and with that gap it lands and lets go"
CHECK_OWN = "finite, released below the hold voltage; or refused in one line"
DEPTHS_NM = (16.0, 18.0, 20.0, 22.0, 24.0, 26.0, 28.0, 30.0, 32.0)


def made_up_pad(adhesion_kPa=0.0):
    """Closing 7 MPa at 24 nm, e-fold 2 nm; opening loses contact 4 nm above the depth, with a well
    1 nm wide there.
    """
    s = np.arange(15.0, 80.0, 0.05)
    closing = np.stack([7e-3 * np.exp((24.0 - s) / 2.0) * (s < 40.0), np.full(s.size, -1e-12)])
    opening = np.full((len(DEPTHS_NM), 2, s.size), np.nan)
    for k, depth in enumerate(DEPTHS_NM):
        above = s >= depth - 1e-9
        risen = s[above] - depth
        opening[k, 0, above] = (
            7e-3 * np.exp((24.0 - depth) / 2.0) * np.maximum(1.0 - risen / 4.0, 0.0)
        )
        opening[k, 1, above] = -1e-12 - adhesion_kPa * 1e-6 * np.exp(-((risen - 5.0) ** 2) / 0.5)
    return PadCurves(s, closing, np.array(DEPTHS_NM), opening, Flats(1e-6, 0.0))


def lifted(pad: PadCurves, by_nm: float) -> PadCurves:
    """The pad with so much more height above its mean plane."""
    return PadCurves(
        pad.separation_nm + by_nm, pad.closing, pad.depth_nm + by_nm, pad.opening, pad.flats
    )


def hard_cases(device: DeviceSettings, pad: PadCurves) -> list[HardCase]:
    """Hard beams, and the scene's device on its own pad at its extremes."""
    return [*hard_beams(), *_own(device, pad)]


def hard_beams() -> Iterator[HardCase]:
    """Beams around the default, on made-up pads."""
    for name, changes in SOLVED.items():
        yield HardCase(
            name, _told(changes), CHECK_SOLVED, partial(_solved, published_beam(**changes))
        )
    for name, (changes, words) in REFUSED.items():
        yield HardCase(
            name, _told(changes), CHECK_REFUSED, partial(_refused, published_beam(**changes), words)
        )
    for name, changes in HIGHER.items():
        description = f"a pad 6 um high, as rough as optical maps are; {_told(changes)}"
        yield HardCase(
            f"pad above the gap, {name}", description, CHECK_HIGHER, partial(_higher, changes)
        )


def _told(changes: Changes) -> str:
    """What is changed of the default device."""
    words = [
        f"{key} = {value:.6g}" if isinstance(value, float) else f"{key} = {value}"
        for key, value in changes.items()
    ]
    return ", ".join(words) or "the default beam"


def solved_beam(settings: DeviceSettings, pad: PadCurves, elements: int = ELEMENTS) -> BeamStates:
    """What a beam of so many elements does on a pad that is continued as far as it presses."""
    beam = BeamSwitch(settings, beam_of(settings, elements))
    states, _ = on_deep_enough(pad, beam.states_on)
    return states


def _solved(settings: DeviceSettings) -> tuple[bool, str]:
    fine = solved_beam(settings, made_up_pad(2.0))
    coarse = solved_beam(settings, made_up_pad(2.0), COARSE_ELEMENTS)
    broken = []
    for states in (fine, coarse):
        if not all(np.isfinite(value) for value in vars(states).values()):
            broken.append("not finite")
        if not 0.0 <= states.release_V < states.hold_V:
            broken.append(f"release at {states.release_V:.4g} V, held at {states.hold_V:.4g} V")
        if not 0.0 < states.landed_share <= 1.0:
            broken.append(f"{states.landed_share:.3g} of the contact part landed")
        if not states.pull_in_V <= states.hold_V * 1.002:
            broken.append(f"held below its pull-in of {states.pull_in_V:.4g} V")
    if not abs(coarse.pull_in_V - fine.pull_in_V) <= 5e-3 * fine.pull_in_V:
        broken.append(f"pull-in at {coarse.pull_in_V:.4g} V with {COARSE_ELEMENTS} elements")
    # the mesh moves a release by some per cent of the hold voltage where the beam tears off in
    # jerks
    if not abs(coarse.release_V - fine.release_V) <= 0.02 * fine.hold_V:
        broken.append(f"release at {coarse.release_V:.4g} V with {COARSE_ELEMENTS} elements")
    detail = (
        f"pull-in {fine.pull_in_V:.4g} V, release {fine.release_V:.4g} V, {fine.landed_share:.0%}"
        " landed"
    )
    return not broken, "; ".join([*broken, detail])


def _refused(settings: DeviceSettings, words: str) -> tuple[bool, str]:
    try:
        states = solved_beam(settings, made_up_pad())
    except InputError as error:
        line = str(error)
        return words in line and "\n" not in line, line
    return False, f"solved: release at {states.release_V:.4g} V"


def _higher(changes: Changes) -> tuple[bool, str]:
    pad = lifted(made_up_pad(2.0), 6e3)
    try:
        BeamSwitch(published_beam(**changes)).states_on(pad)
    except InputError as error:
        line = str(error)
    else:
        return False, "not refused"
    if "rests within reach of its pad; raise gap_um to" not in line:
        return False, line
    gap_um = float(line.partition("gap_um to ")[2].partition(",")[0])
    wider = published_beam(**changes, gap_um=gap_um)
    states = solved_beam(wider, pad, COARSE_ELEMENTS)
    detail = (
        f"gap {gap_um:.4g} um, release {states.release_V:.4g} V, {states.landed_share:.0%} landed"
    )
    return states.landed_share > 0.0 and states.release_V > 0.0, detail


def _own(device: DeviceSettings, pad: PadCurves) -> Iterator[HardCase]:
    """The scene's device on its own pad, one property at an extreme at a time."""
    changes: dict[str, Changes] = {
        "half the gap": {"gap_um": 0.5 * device.gap_um},
        "twice the gap": {"gap_um": 2.0 * device.gap_um},
        "thin dielectric": {"dielectric_nm": 1.0},
        "permittivity of 1000": {"permittivity": 1000.0},
        "half as thick": {"thickness_um": 0.5 * device.thickness_um},
        "twice as thick": {"thickness_um": 2.0 * device.thickness_um},
        "100 MPa of tension": {"residual_stress_MPa": 100.0},
        "100 MPa of compression": {"residual_stress_MPa": -100.0},
        "77 K": {"temperature_C": -196.0},
    }
    for name, changed in changes.items():
        if not all(map(device.has, changed)):
            continue
        settings = device.model_copy(update=changed)
        yield HardCase(
            f"own device, {name}", _told(changed), CHECK_OWN, partial(_finite, settings, pad)
        )
    for times in (0.0, 30.0):
        pulling = attracting(pad, times)
        words = f"{times:g} times the attraction of its pad"
        yield HardCase(f"own device, {words}", words, CHECK_OWN, partial(_finite, device, pulling))


def _finite(settings: DeviceSettings, pad: PadCurves) -> tuple[bool, str]:
    try:
        states = switch_of(settings).states(pad)
    except InputError as error:
        line = str(error)
        return "\n" not in line, f"refused: {line}"
    hold_V = settings.hold_voltage_V or states.pull_in_V
    finite = all(np.isfinite(value) for value in states.numbers.values())
    detail = f"pull-in {states.pull_in_V:.4g} V, release {states.release_V:.4g} V"
    return finite and 0.0 <= states.release_V < hold_V, detail
