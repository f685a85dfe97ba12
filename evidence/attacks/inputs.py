"""Are random maps, switches and contacts either solved soundly or refused in one line that names a
reason?

Seeds are stated before a run. A map pressed by `asp.press` carries the load that was asked for, or
says that it did not converge. A copy of a switch whose moduli, stresses and pressures are 2^-14 of
it, so that no number rounds otherwise, has all voltages 2^-7 of it, to six digits. Pull-in and
release follow the residual stress without jumps. A cycle of any mechanics is finite, or refused.
"""

import time
import warnings
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

import asperity as asp
from evidence.attacks.runs import Attack, figures, table
from mesoscale.contact.cycle import run_cycle
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.curves import PadCurves
from mesoscale.settings import ContactSettings
from mesoscale.studies.answer_stability import made_up_pad, published_beam, solved_beam
from mesoscale.switch.beam_switch import BeamStates

__all__ = ["contacts", "devices", "figures", "presses", "rows", "stresses"]
SOFTER = 2.0**-14
DIGITS = 1e-6
"""Of voltages."""
PLACE, BALANCE = 0.03, 0.01
"""Of landed share and capacitance, which have not six digits: balances are sought to a thousandth
of a nanometre of some ten. Of seed 741128 one of 150 beams lands in jerks, where rounding moves its
capacitance by 0.15 %."""
PIXELS = 32
MECHANICS = ("asperity", "coupled", "adhesive")
JUMP = 0.02
"""Of a voltage from one stress to the next, over the largest: a mesh moves a release by some per
cent where it tears off in jerks (`tests/mesoscale/switch/test_hard_beams.py`)."""


def arguments(parser: ArgumentParser) -> None:
    """Seed and numbers of each kind."""
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--presses", type=int, default=1000)
    parser.add_argument("--devices", type=int, default=600)
    parser.add_argument("--sweeps", type=int, default=4, help="of stress")
    parser.add_argument("--contacts", type=int, default=400, help="of each mechanics")
    parser.add_argument("--mechanics", nargs="+", choices=MECHANICS, default=MECHANICS)
    parser.add_argument("--pixels", type=int, default=PIXELS, help="of a contact, along a side")


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each kind."""
    yield from table(presses(given.seed, given.presses))
    yield from table(devices(given.seed, given.devices))
    yield from table(stresses(given.seed, given.sweeps))
    for mechanics in given.mechanics:
        yield from table(contacts(given.seed, given.contacts, mechanics, given.pixels))


def _tried(kind: str, attempt: Callable[[], str]) -> Attack:
    """What came of one attempt, which gives what is wrong with its result, or nothing."""
    started = time.process_time()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            words = attempt()
        outcome = "fault" if words else "used"
    except InputError as error:
        words = str(error)
        told = (
            words.isprintable() and "fault of the solver" not in words and "internal" not in words
        )
        outcome = "refused" if told else "fault"
    except Exception as error:  # of any kind: that is what is looked for
        outcome, words = "fault", f"{type(error).__name__}: {error}"
    return Attack(kind, outcome, time.process_time() - started, words)


def presses(seed: int, count: int) -> Iterator[Attack]:
    """Maps of all sizes, heights, loads and options, among them ones that cannot be."""
    for number in range(count):
        rng = np.random.default_rng([seed, 1, number])
        yield _tried("map pressed", lambda rng=rng: _pressed(rng))


def _pressed(rng: np.random.Generator) -> str:
    nx, ny = rng.integers(2, 28, 2)
    periodic = bool(rng.random() < 0.6)
    if periodic and rng.random() < 0.9:
        ny = nx
    heights = 10.0 ** rng.uniform(-3, 3) * rng.normal(size=(nx, ny))
    if rng.random() < 0.3:
        heights += 10.0 ** rng.uniform(-2, 3) * np.linspace(0, 1, nx)[:, None]
    if rng.random() < 0.05:
        heights[0, 0] = rng.choice([np.nan, np.inf])
    side: Any = 10.0 ** rng.uniform(0, 5)
    ways = [side, np.float64(side), np.array(side), (side, side * ny / nx)]
    side = ways[rng.integers(4)]
    modulus = 10.0 ** rng.uniform(-3, 3)
    load = 10.0 ** rng.uniform(-8, 0) * modulus * float(np.max(side)) ** 2
    good: list[Any] = [load, np.array([0.5 * load, load])]
    bad: list[Any] = [[load, 0.5 * load], -load, 0.0, None]
    loads = good[rng.integers(2)] if rng.random() < 0.8 else bad[rng.integers(4)]
    options: dict[str, Any] = {"periodic": periodic}
    if rng.random() < 0.4:
        options["h_macro"] = 10.0 ** rng.uniform(-3, 2) * modulus
    if rng.random() < 0.2:
        options["h_prime"] = rng.choice([0.0, 0.1, 10.0, -1.0]) * modulus
    if rng.random() < 0.2:
        options["counterface"] = heights[::-1] if rng.random() < 0.8 else heights[:2]
    if rng.random() < 0.2:
        laws = [lambda gap: 0.01 / (gap + 0.3) ** 3, lambda gap: -gap, lambda gap: 1.0, 5.0]
        options["attraction"] = laws[rng.integers(4)]
    pressed = asp.press(heights, side, loads, modulus, **options)
    numbers = (
        pressed.loads_nN,
        pressed.separation_nm,
        pressed.approach_nm,
        pressed.attraction_nN,
        pressed.gap_nm,
    )
    if not all(np.isfinite(of).all() for of in (*numbers, pressed.pressure_GPa)):
        return "not a number"
    if (pressed.pressure_GPa < 0.0).any():
        return "negative pressure"
    site = (
        pressed.lengths_nm[0]
        / pressed.pressure_GPa.shape[1]
        * pressed.lengths_nm[1]
        / pressed.pressure_GPa.shape[2]
    )
    carried, asked = (
        pressed.pressure_GPa.sum((1, 2)) * site,
        np.atleast_1d(np.asarray(loads, float)),
    )
    if pressed.converged and abs(carried / asked - 1.0).max() > 0.02:
        return f"carries {carried} for {asked}"
    return ""


def devices(seed: int, count: int) -> Iterator[Attack]:
    """Beams of all shapes on pads of all adhesions, each with a copy that is softer."""
    for number in range(count):
        rng = np.random.default_rng([seed, 2, number])
        yield _tried("switch and its copy", lambda rng=rng: _copied(rng))


def _copied(rng: np.random.Generator) -> str:
    start, end = np.sort(rng.uniform(0.0, 1.0, 2))
    settings = published_beam(
        ends="cantilever" if rng.random() < 0.3 else "clamped",
        length_um=10.0 ** rng.uniform(1.7, 3),
        width_um=10.0 ** rng.uniform(0.7, 2.5),
        thickness_um=10.0 ** rng.uniform(-0.5, 1),
        gap_um=10.0 ** rng.uniform(-0.5, 1),
        youngs_modulus_GPa=10.0 ** rng.uniform(0.5, 2.7),
        residual_stress_MPa=rng.choice([0.0, rng.uniform(-30, 200)]),
        bow_nm=rng.choice([0.0, rng.uniform(-500, 1000)]),
        tilt_nm=rng.choice([0.0, rng.uniform(-500, 500)]),
        dielectric_nm=rng.uniform(20, 1000),
        electrode=(0.0, 1.0) if rng.random() < 0.7 else (start, end),
        contact=(0.0, 1.0) if rng.random() < 0.7 else tuple(np.sort(rng.uniform(0.0, 1.0, 2))),
        stopper_nm=rng.choice([0.0, 50.0]),
    )
    law = made_up_pad(rng.choice([0.0, 10.0 ** rng.uniform(-1, 2)]))
    solved = solved_beam(settings, law, 64)
    softer = settings.model_copy(
        update={
            name: SOFTER * getattr(settings, name)
            for name in ("youngs_modulus_GPa", "residual_stress_MPa")
        }
    )
    flats = replace(law.flats, hamaker=SOFTER * law.flats.hamaker)
    soft_law = PadCurves(
        law.separation_nm, SOFTER * law.closing, law.depth_nm, SOFTER * law.opening, flats
    )
    copy = solved_beam(softer, soft_law, 64)
    return _differ(solved, copy)


def _differ(solved: BeamStates, copy: BeamStates) -> str:
    for name in ("pull_in_V", "hold_V", "release_V"):
        ours, theirs = getattr(solved, name), getattr(copy, name) / SOFTER**0.5
        if not abs(theirs - ours) <= DIGITS * abs(ours):
            return f"{name} = {ours:.8g}, of the copy {theirs:.8g}"
    if abs(copy.landed_share - solved.landed_share) > PLACE:
        return f"landed share {solved.landed_share:.4g}, of the copy {copy.landed_share:.4g}"
    if abs(copy.capacitance_fF / solved.capacitance_fF - 1.0) > BALANCE:
        return f"capacitance {solved.capacitance_fF:.8g}, of the copy {copy.capacitance_fF:.8g} fF"
    # without a snap it lets go as soon as the voltage falls
    in_range = 0.0 <= solved.release_V <= solved.hold_V
    return "" if in_range else f"released at {solved.release_V:.4g} of {solved.hold_V:.4g} V"


def stresses(seed: int, count: int) -> Iterator[Attack]:
    """Sweeps of residual stress, from compression to tension, on random pads."""
    for number in range(count):
        rng = np.random.default_rng([seed, 3, number])
        yield _tried("sweep of stress", lambda rng=rng: _swept(rng))


def _swept(rng: np.random.Generator) -> str:
    law = made_up_pad(10.0 ** rng.uniform(-1, 1.3))
    settings = published_beam(thickness_um=rng.uniform(3.0, 5.0))
    solved = []
    for stress in np.arange(-4.0, 40.0, 1.0):
        at_stress = settings.model_copy(update={"residual_stress_MPa": float(stress)})
        solved.append(solved_beam(at_stress, law))
    for name in ("pull_in_V", "release_V"):
        volts = np.array([getattr(states, name) for states in solved])
        jumps = abs(np.diff(volts, 2))
        if jumps.max() > JUMP * volts.max():
            return f"{name} jumps by {jumps.max():.3g} of {volts.max():.3g} V"
    return ""


def contacts(seed: int, count: int, mechanics: str, pixels: int = PIXELS) -> Iterator[Attack]:
    """Cycles of one mechanics, of inputs far beyond Table 1."""
    for number in range(count):
        rng = np.random.default_rng([seed, 4, number])
        yield _tried(f"contact, {mechanics}", lambda rng=rng: _cycled(rng, mechanics, pixels))


def _cycled(rng: np.random.Generator, mechanics: str, pixels: int) -> str:
    length = 10.0 ** rng.uniform(1, 3.3)
    modulus = 10.0 ** rng.uniform(-1, 3)
    plastic = bool(rng.random() < 0.5)
    inputs = ContactInputs(
        hamaker=rng.choice([0.0, 10.0 ** rng.uniform(-2, 0)]),
        e_star=modulus,
        h_macro=modulus * 10.0 ** rng.uniform(-2.5, 0),
        h_prime=rng.choice([0.0, modulus * 10.0 ** rng.uniform(-2, 0)]),
        q0=2.0 * np.pi / length * 10.0 ** rng.uniform(-0.1, 1),
        hurst=rng.uniform(0.1, 1.0),
        rms=length * 10.0 ** rng.uniform(-4, -0.7),
    )
    settings = ContactSettings(
        mechanics=mechanics,
        model="plastic" if plastic else "elastic",
        pixels=pixels,
        length_nm=length,
        gap_cutoff_nm=10.0 ** rng.uniform(-1, 0),
        max_force_nN=modulus * length**2 * 10.0 ** rng.uniform(-7, -2),
    )
    cycle = run_cycle(inputs, settings, seed=int(rng.integers(1000)))
    numbers = [
        value for branch in (cycle.closing, cycle.opening) for value in vars(branch).values()
    ]
    if not all(np.isfinite(value).all() for value in numbers):
        return "not a number"
    if (cycle.closing.repulsive_nN < 0.0).any() or (cycle.closing.attractive_nN > 0.0).any():
        return "a force of the wrong sign"
    return ""
