"""Extreme lives of a held switch: each has finite voltages that its charge explains, or is refused
in one line.

The surfaces are made up: waves of some nanometres on cells of 500 nm, on a made-up pad.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from mesoscale.charging.ageing import Surroundings, ageing_of
from mesoscale.charging.gaps import GAPS_NM, HeldGaps
from mesoscale.charging.lifetime import SwitchLife, life_with, times_s
from mesoscale.charging.rates import guesses, shifts_V
from mesoscale.errors import InputError
from mesoscale.settings import DeviceSettings, LifetimeSettings
from mesoscale.studies.answer_stability import made_up_pad, published_beam
from mesoscale.studies.driver import HardCase

Changes = dict[str, Any]
PIXELS = 32
SIDE_NM = 500.0
HELD_NM = 20.0
RMS_NM = 7.0
CHECK_SOLVED = (
    "finite; shift between nothing and the hold; it grows with time; before any hold as without"
    " charge"
)
CHECK_AGED = "finite; falls with time; before any hold as without ageing"
CHECK_REFUSED = "refused in one line that says why"
LIFE: dict[str, Changes] = {
    "the default": {},
    "a thousand years": {"years": 1000.0},
    "a second": {"years": 3.2e-8},
    "a billion seconds": {"years": 31.7},
    "nothing injected": {"injection_A_m2": (1e-300, 1e-300)},
    "charge that stays at once": {"injection_A_m2": (1e6, 1e6), "traps_e_cm2": (1e16, 1e16)},
    "no barrier to speak of": {"barrier_eV": (0.05, 0.05)},
    "a barrier of 20 eV": {"barrier_eV": (20.0, 20.0)},
    "a surface that holds next to nothing": {"traps_e_cm2": (1.0, 1.0)},
    "a surface that holds all": {"traps_e_cm2": (1e18, 1e18)},
    "nothing unknown": {
        "injection_A_m2": (1e-9, 1e-9),
        "barrier_eV": (4.5, 4.5),
        "traps_e_cm2": (1e12, 1e12),
    },
    "a positive electrode": {"electrode": "positive"},
    "the other polarity alone": {"other_polarity": 1.0},
    "alternating, nearly to nothing": {"other_polarity": 0.4999},
    "held for a millionth of the time": {"duty": 1e-6},
    "cycles that leak": {"period_s": 1.0, "duty": 0.5},
    "cycles of a microsecond for a thousand years": {
        "period_s": 1e-6,
        "duty": 0.5,
        "years": 1000.0,
    },
    "a cycle longer than the life": {"period_s": 1e9, "duty": 0.5},
    "a leak that leaves nothing": {"period_s": 1.0, "duty": 1e-3, "recovery_exponent": (5.0, 5.0)},
    "cycles that alternate, nearly to nothing": {"period_s": 1e-3, "other_polarity": 0.4999},
    "contactless charge that closes it": {"contactless_V": 100.0},
    "traps as of a vacuum": {"optical_permittivity": 1.0},
    "traps as of a metal": {"optical_permittivity": 100.0},
}
DEVICE: dict[str, Changes] = {
    "dielectric of 1 nm": {"dielectric_nm": 1.0},
    "dielectric of 10 um": {"dielectric_nm": 1e4},
    "permittivity of 1": {"permittivity": 1.0},
    "permittivity of 1000": {"permittivity": 1000.0},
    "a contact potential": {"shift_V": 0.8},
    "charged to the other sign": {"charge_e_cm2": -5e11},
    "at 77 K": {"temperature_C": -196.0, "gap_um": 1.0},
    "held harder": {"hold_voltage_V": 100.0},
    "a plate": {"spring_N_per_m": 1000.0},
}
SURFACE: dict[str, tuple[float, float]] = {
    "one class of gap": (20.0, 0.0),
    "all gaps closed": (0.0, 0.0),
    "all gaps wide": (500.0, 0.0),
    "as rough as it is far": (20.0, 20.0),
}
"""Mean separation, and RMS height (nm)."""
TOPS_GPA = 5.0
"""Mean pressure of what touches on the made-up pad."""
HUMIDITY = 0.2
NICKEL: Changes = {"beam": "nickel"}
BONDS: Changes = {"bonds_mJ_m2": (3.0, 100.0)}
PLATE: Changes = {"spring_N_per_m": 1000.0}
AGEING: dict[str, tuple[Changes, Changes, float]] = {
    "all effects": ({**NICKEL, **BONDS}, {}, HUMIDITY),
    "creep that collapses": ({**NICKEL, "grain_nm": (0.1, 0.1)}, {}, HUMIDITY),
    "a cantilever": (
        NICKEL,
        {"ends": "cantilever", "length_um": 250.0, "thickness_um": 3.0, "hold_voltage_V": 40.0},
        HUMIDITY,
    ),
    "aluminium": ({"beam": "aluminium"}, {}, HUMIDITY),
    "gold that relaxes wholly": ({"beam": "gold", "relaxing": (1.0, 1.0)}, {}, HUMIDITY),
    "bonds that hold it": ({"bonds_mJ_m2": (1e5, 1e5)}, {}, HUMIDITY),
    "a plate that creeps": (NICKEL, PLATE, HUMIDITY),
    "grains of a millimetre": ({**NICKEL, "grain_nm": (1e6, 1e6)}, PLATE, HUMIDITY),
    "nickel at 4 K": (NICKEL, {**PLATE, "temperature_C": -269.0}, HUMIDITY),
    "nickel at 1000 C": (NICKEL, {**PLATE, "temperature_C": 1000.0}, HUMIDITY),
    "gold that hardly relaxes": ({"beam": "gold", "relaxing": (1e-12, 1e-12)}, PLATE, HUMIDITY),
    "gold at 4 K": ({"beam": "gold"}, {**PLATE, "temperature_C": -269.0}, HUMIDITY),
    "bonds in dry air": (BONDS, PLATE, 0.0),
    "bonds at 1 % of humidity": (BONDS, PLATE, 0.01),
    "bonds at 100 % of humidity": (BONDS, PLATE, 1.0),
    "bonds next to nothing": ({"bonds_mJ_m2": (1e-12, 1e-12)}, PLATE, HUMIDITY),
    "charged, and creeping": (NICKEL, {**PLATE, "charge_e_cm2": -5e11}, HUMIDITY),
}
"""What ages, of which device, at which humidity."""
REFUSED: dict[str, tuple[Changes, Changes, str]] = {
    "polarities that sum to nothing": ({"other_polarity": 0.5}, {}, "sum to nothing"),
    "cycles without length": ({"period_s": 0.0}, {}, "period_s"),
    "a leak that grows": ({"recovery_exponent": (-0.2, 0.1)}, {}, "recovery_exponent"),
    "a barrier of zero": ({"barrier_eV": (0.0, 4.0)}, {}, "barrier_eV"),
    "a range that falls": ({"injection_A_m2": (1e-3, 1e-9)}, {}, "least value first"),
    "no life": ({"years": None}, {}, "give the life that is asked for"),
    "a life below zero": ({"years": -1.0}, {}, "years"),
    "hold below pull-in": ({}, {"hold_voltage_V": 30.0}, "never closes this switch"),
    "charge in no dielectric": ({}, {"dielectric_nm": 0.0, "charge_e_cm2": 1e11}, "thickness"),
}


def hard_cases() -> Iterator[HardCase]:
    """All extreme lives."""
    for name, changes in LIFE.items():
        yield _solved_case(name, changes, {}, (HELD_NM, RMS_NM))
    for name, changes in DEVICE.items():
        yield _solved_case(name, {}, changes, (HELD_NM, RMS_NM))
    for name, surface in SURFACE.items():
        yield _solved_case(name, {}, {}, surface)
    for name, (ageing, of_device, humidity) in AGEING.items():
        yield HardCase(
            name,
            _listed({**ageing, **of_device, "humidity": humidity}),
            CHECK_AGED,
            partial(_aged, {"ageing": ageing}, of_device, humidity),
        )
    for name, (of_life, of_device, words) in REFUSED.items():
        yield HardCase(
            name,
            _listed({**of_life, **of_device}),
            CHECK_REFUSED,
            partial(_refused, of_life, of_device, words),
        )


def _solved_case(
    name: str, of_life: Changes, of_device: Changes, surface: tuple[float, float]
) -> HardCase:
    described = {**of_life, **of_device, "separation and RMS (nm)": surface}
    return HardCase(
        name, _listed(described), CHECK_SOLVED, partial(_solved, of_life, of_device, surface)
    )


def _listed(changes: Changes) -> str:
    return ", ".join(f"{key} = {value}" for key, value in changes.items())


def made_up_gaps(
    device: DeviceSettings, separation_nm: float = HELD_NM, rms_nm: float = RMS_NM
) -> HeldGaps:
    """A device over two made-up cells."""
    rng = np.random.default_rng(0)
    places = SIDE_NM * np.arange(PIXELS) / PIXELS
    cells = []
    for _ in range(2):
        heights = np.zeros((PIXELS, PIXELS))
        for rows, columns in rng.integers(1, 6, size=(40, 2)):
            phase = 2.0 * np.pi * rng.random()
            wave = rows * places[:, None] + columns * places
            heights += np.cos(2.0 * np.pi * wave / SIDE_NM + phase)
        cells.append(rms_nm * heights / heights.std())
    return HeldGaps(
        device, np.array([separation_nm]), np.ones(1), np.stack(cells), np.full(2, 0.5), SIDE_NM
    )


def made_up_life(
    of_life: Changes, of_device: Changes, surface: tuple[float, float] = (HELD_NM, RMS_NM)
) -> tuple[SwitchLife, LifetimeSettings]:
    """A life on the made-up pad.

    Raises
    ------
    InputError : settings that are none, or a switch without an answer.
    """
    settings = LifetimeSettings(**{"years": 10.0, **of_life})
    device = published_beam(**of_device)
    gaps = made_up_gaps(device.uncharged, *surface)
    return life_with(gaps, device, made_up_pad(2.0), settings), settings


def made_up_ageing(
    of_life: Changes, of_device: Changes, humidity: float = HUMIDITY
) -> tuple[SwitchLife, LifetimeSettings]:
    """The same with what ages; its tops do not, as its pad has none.

    Raises
    ------
    InputError : see `made_up_life`.
    """
    life, settings = made_up_life(of_life, of_device)
    ageing = ageing_of(
        published_beam(**of_device),
        life.hold_V,
        made_up_pad(2.0),
        settings,
        float(times_s(settings)[-1]),
        humidity,
        Surroundings(TOPS_GPA, None),
        apart=True,
    )
    return replace(life, ageing=ageing), settings


def _aged(of_life: Changes, of_device: Changes, humidity: float) -> tuple[bool, str]:
    life, settings = made_up_ageing(of_life, of_device, humidity)
    times = np.concatenate([[0.0], times_s(settings), [1e9]])
    broken = []
    release = np.zeros(1)
    nothing = np.zeros(times.size)
    for guess in guesses(settings):
        aged = life.aged(times, guess)
        pull_in, release = life.voltages(nothing, nothing, aged)
        if not (np.isfinite(pull_in).all() and np.isfinite(release).all()):
            broken.append(f"{guess}: not finite")
        if (np.diff(pull_in) > 1e-9).any() or (np.diff(release) > 1e-9).any():
            broken.append(f"{guess}: a voltage rises")
        fresh = life.voltages(nothing[:1], nothing[:1])
        if pull_in[0] != fresh[0][0] or release[0] != fresh[1][0]:
            broken.append(f"{guess}: not as without ageing before any hold")
    detail = f"most ageing: release from {release[0]:.4g} V to {release[-1]:.4g} V"
    return not broken, "; ".join([*broken, detail])


def _solved(of_life: Changes, of_device: Changes, surface: tuple[float, float]) -> tuple[bool, str]:
    life, settings = made_up_life(of_life, of_device, surface)
    times = np.concatenate([[0.0], times_s(settings)])
    broken = []
    shift = pull_in = release = np.zeros(1)
    for guess, rates in guesses(settings).items():
        shift, squares = life.charged(life.hold_V, times, settings, rates)
        pull_in, release = life.voltages(shift, squares)
        if not all(np.isfinite(values).all() for values in (shift, squares, pull_in, release)):
            broken.append(f"{guess}: not finite")
        places = shifts_V(
            life.hold_V - life.shift_V, GAPS_NM, times, life.gaps.device, settings, rates
        )
        if not (places.min() >= 0.0 and places.max() <= life.hold_V - life.shift_V):
            broken.append(f"{guess}: shifts from {places.min():.4g} to {places.max():.4g} V")
        if (np.diff(places, axis=1) < -1e-9).any():
            broken.append(f"{guess}: a place loses charge")
        fresh = life.voltages(np.zeros(1), np.zeros(1))
        if pull_in[0] != fresh[0][0] or release[0] != fresh[1][0]:
            broken.append(f"{guess}: not as without charge before any hold")
    detail = (
        f"most charge: shift {shift[-1]:.4g} V, pull-in {pull_in[-1]:.4g} V, release"
        f" {release[-1]:.4g} V"
    )
    return not broken, "; ".join([*broken, detail])


def _refused(of_life: Changes, of_device: Changes, words: str) -> tuple[bool, str]:
    try:
        life, _ = made_up_life(of_life, of_device)
    except InputError as error:
        line = str(error)
        return words in line and "\n" not in line, line
    return False, f"solved: release at {life.release_V[0]:.4g} V"
