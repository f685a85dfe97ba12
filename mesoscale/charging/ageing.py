"""What time does to a held switch beside charge: its beam creeps, its tops creep, bonds grow.

Each effect has one strength that is a closed function of time. Pull-in and release are solved at a
few ages, with beam and bonds together. What ageing moves the squares of these voltages by adds to
what charge does. So does what creep of the tops moves them by, as it takes pads that are pressed
again.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from mesoscale.answer.other_devices import harder
from mesoscale.answer.switches import Solved, press_pad, surfaces_of
from mesoscale.charging.rates import GUESSES, ZERO_C_K
from mesoscale.contact.cycle import run_cycle
from mesoscale.history.creep import hardness_factor
from mesoscale.pad.curves import PadCurves, bonded
from mesoscale.settings import ContactSettings, DeviceSettings, HistorySettings, LifetimeSettings
from mesoscale.settings.ageing import AgeingSettings
from mesoscale.settings.contact import NOMINAL_SEED
from mesoscale.switch import switch_of
from mesoscale.switch.charge import shift_V
from mesoscale.switch.crept import crept_voltages, held_shape
from mesoscale.switch.shifted import as_felt
from mesoscale.theory import ageing as laws

if TYPE_CHECKING:  # a life asks for its ageing
    from mesoscale.charging.lifetime import SwitchLife

Array = NDArray[np.float64]
Effect = Literal["beam", "tops", "bonds"]

AGES = (0.1, 0.3, 0.5, 0.75, 1.0)
"""Of the ageing at the end of a life, at which switches are solved. Between them a release is off
by 0.05 V at most (tests/mesoscale/charging/test_ageing.py)."""
TOPS_AGES = (0.5, 1.0)
"""The same of the tops, for which pads are pressed again."""
FIRST_AGE_S = 1e-6
ROWS = 25
"""Times of lifetime/ageing.csv beside 0."""
AGE_TIMES = 4000
"""Times up to the end of a life among which ages are found."""
MOST_RELAXED = 1.0 - 1e-9


@dataclass(frozen=True)
class Moved:
    """Voltages as felt of one switch at ages, rising from 0."""

    ages: Array
    pull_in_V: Array
    release_V: Array

    def squares_V2(self, ages: Array) -> tuple[Array, Array]:
        """By how much the squares of pull-in and release have moved (V^2) at ages.

        The pull-in of a plate is the power 3/2 of its gap, and the square of its release is linear
        in it: so they are interpolated. What sticks goes on below 0 as it came there.
        """
        gaps = np.cbrt(np.square(self.pull_in_V))
        releases = _below_zero(self.ages, np.square(self.release_V))
        pull_in = np.interp(ages, self.ages, gaps) ** 3 - gaps[0] ** 3
        return pull_in, np.interp(ages, self.ages, releases) - releases[0]


def _below_zero(ages: Array, squares: Array) -> Array:
    """Squares of a release, where it is 0 continued in the line that led there."""
    continued = squares.copy()
    for place in range(2, squares.size):
        if squares[place] == 0.0:
            before, last = continued[place - 2 : place]
            step = ages[place] - ages[place - 1]
            slope = (last - before) / (ages[place - 1] - ages[place - 2])
            continued[place] = min(last + slope * step, 0.0)
    return continued


@dataclass(frozen=True)
class Surroundings:
    """What all devices share of their ageing: solved for the central one.

    Attributes
    ----------
    tops_GPa : mean pressure of what touches.
    tops : what creep of the tops moves, by the share of the hardness that is lost; None where they
        do not creep.
    """

    tops_GPa: float
    tops: Moved | None


@dataclass(frozen=True)
class Ageing:
    """The ageing of one device.

    Attributes
    ----------
    kelvin, humidity : of its surroundings.
    modulus_GPa : of its beam.
    strain : largest strain by the hold.
    end_s : time up to which it is known.
    moved : what beam and bonds move, by which of them act together and by guess.
    tops : what creep of the tops moves.
    """

    settings: LifetimeSettings
    kelvin: float
    humidity: float
    modulus_GPa: float
    strain: float
    end_s: float
    moved: dict[tuple[Effect, ...], dict[str, Moved]] = field(default_factory=dict)
    tops: Moved | None = None

    @cached_property
    def acting(self) -> tuple[Effect, ...]:
        """Beam and bonds, as far as they act at all."""
        aged = stated(self.settings)
        switched_on: tuple[tuple[Effect, object], ...] = (
            ("beam", aged.beam),
            ("bonds", aged.bonds_mJ_m2),
        )
        end = np.array([self.end_s])
        acting: list[Effect] = [
            effect
            for effect, value in switched_on
            if value and self.strength(effect, end, "most")[0]
        ]
        return tuple(acting)

    @property
    def effects(self) -> tuple[Effect, ...]:
        """All that act."""
        if self.tops is None:
            return self.acting
        return (*self.acting, "tops")

    def strength(self, effect: Effect, times: Array, guess: str) -> Array:
        """How strongly an effect acts after times (s): relaxed share of the stress, share of the
        hardness that is lost, or work of bonds (mJ/m^2 of what touches).
        """
        aged = stated(self.settings)
        # creep does not know the sign of the drive
        held = times * self.settings.duty
        if effect == "tops":
            assert aged.tops is not None
            law = HistorySettings(creep_strength=_guessed(aged.tops, guess))
            return 1.0 - hardness_factor(held, law)
        if effect == "bonds":
            assert aged.bonds_mJ_m2 is not None
            per_decade = _guessed(aged.bonds_mJ_m2, guess)
            if self.settings.period_s is not None:  # bonds break when it opens
                held = np.minimum(held, self.settings.duty * self.settings.period_s)
            return laws.bond_energy(held, self.humidity, per_decade)
        if aged.beam == "nickel":
            finest_nm, coarsest_nm = aged.grain_nm
            grain_nm = _guessed((coarsest_nm, finest_nm), guess)
            relaxation = laws.coble_relaxation_s(self.kelvin, grain_nm, self.modulus_GPa)
            return np.minimum(laws.relaxed_share(held, relaxation), MOST_RELAXED)
        # strain that comes and goes fast relaxes as its mean
        largest = self.settings.duty * _guessed(aged.relaxing, guess)
        if aged.beam == "aluminium":
            largest *= float(laws.aluminium_share(self.strain))
        return laws.relaxed_share(times, laws.gold_relaxation_s(self.kelvin), largest)

    def age(self, effects: Sequence[Effect], times: Array, guess: str) -> Array:
        """Mean of the strengths of effects over those at the end; of one effect over the strength
        of the guess that ages most.
        """
        reference = guess if len(effects) > 1 else "most"
        end = np.array([self.end_s])
        relative = [
            self.strength(effect, times, guess) / self.strength(effect, end, reference)[0]
            for effect in effects
        ]
        return np.mean(relative, axis=0)

    def times_of(self, effects: Sequence[Effect], guess: str) -> Array:
        """Times (s) of `AGES`."""
        log_times = np.linspace(np.log(FIRST_AGE_S), np.log(self.end_s), AGE_TIMES)
        ages = self.age(effects, np.exp(log_times), guess)
        return np.exp(np.interp(np.array(AGES), ages, log_times))

    def squares_V2(
        self, times: Array, guess: str, effects: Sequence[Effect] | None = None
    ) -> tuple[Array, Array]:
        """By how much the squares of pull-in and release have moved after times (s), in V^2.

        Parameters
        ----------
        effects : which count, of `effects`; None: all.
        """
        chosen = self.effects if effects is None else effects
        pull_in = np.zeros_like(times)
        release = np.zeros_like(times)
        contributions = []
        together: tuple[Effect, ...] = tuple([effect for effect in self.acting if effect in chosen])
        if together:
            contributions.append((self.moved[together][guess], self.age(together, times, guess)))
        if "tops" in chosen and self.tops is not None:
            contributions.append((self.tops, self.strength("tops", times, guess)))
        for moved, ages in contributions:
            closes, lets_go = moved.squares_V2(ages)
            pull_in = pull_in + closes
            release = release + lets_go
        return pull_in, release


def stated(settings: LifetimeSettings) -> AgeingSettings:
    """The ageing that a scene states, which is there."""
    assert settings.ageing is not None
    return settings.ageing


def _guessed(bounds: tuple[float, float], guess: str) -> float:
    """The value of a guess between the one that ages least and the one that ages most."""
    low, high = bounds
    share = GUESSES.index(guess) / (len(GUESSES) - 1)
    return float(low ** (1.0 - share) * high**share)


def held_device(device: DeviceSettings, hold_V: float) -> DeviceSettings:
    """The device as it feels its voltages, held with what it feels of one."""
    shift = shift_V(device)
    felt = as_felt(device, shift)
    return felt.model_copy(update={"hold_voltage_V": hold_V - shift})


def ageing_of(
    device: DeviceSettings,
    hold_V: float,
    curves: PadCurves,
    settings: LifetimeSettings,
    end_s: float,
    humidity: float,
    shared: Surroundings,
    apart: bool = False,
) -> Ageing:
    """The ageing of a device on its pad.

    Parameters
    ----------
    end_s : time up to which it is asked for.
    apart : whether each effect alone is asked for, too.

    Raises
    ------
    InputError : it has no answer.
    """
    felt = held_device(device, hold_V)
    held = held_shape(felt, curves)
    ageing = Ageing(
        settings,
        felt.temperature_C + ZERO_C_K,
        humidity,
        felt.youngs_modulus_GPa,
        held.strain,
        end_s,
        tops=shared.tops,
    )
    combinations: set[tuple[Effect, ...]] = {ageing.acting} if ageing.acting else set()
    if apart:
        for effect in ageing.acting:
            combinations.add((effect,))
    states = switch_of(felt).states(curves)

    @cache  # guesses may agree
    def voltages_at(relaxed: float, bonds_mJ_m2: float) -> tuple[float, float]:
        pad = curves
        if bonds_mJ_m2 > 0.0:
            pad = bonded(curves, 1e-3 * bonds_mJ_m2, shared.tops_GPa)
        return crept_voltages(felt, held, relaxed, pad)

    def solved(effects: tuple[Effect, ...], guess: str) -> Moved:
        voltages = [(states.pull_in_V, states.release_V)]
        for time in ageing.times_of(effects, guess)[:, None]:
            strengths = {
                effect: float(ageing.strength(effect, time, guess)[0]) for effect in effects
            }
            voltages.append(voltages_at(strengths.get("beam", 0.0), strengths.get("bonds", 0.0)))
        return _moved(voltages, np.array([0.0, *AGES]))

    for effects in combinations:
        if len(effects) == 1:
            ageing.moved[effects] = dict.fromkeys(GUESSES, solved(effects, "most"))
        else:
            ageing.moved[effects] = {guess: solved(effects, guess) for guess in GUESSES}
    return ageing


def _moved(voltages: Sequence[tuple[float, float]], ages: Array) -> Moved:
    pull_ins, releases = np.array(voltages).T
    return Moved(ages, pull_ins, releases)


def surroundings_of(
    central: Solved, contact: ContactSettings, settings: LifetimeSettings, end_s: float
) -> Surroundings:
    """What the ageing of all devices shares.

    Pads are pressed again at lower hardness. That a contact which is held while its hardness falls
    comes to the state of one that was closed at the lower hardness is a test of `history`.

    Raises
    ------
    InputError : the central switch has no answer.
    """
    point = central.point
    hold_V = central.held_V
    aged = stated(settings)
    tops_GPa = np.nan
    if aged.bonds_mJ_m2:
        tops_GPa = _tops_GPa(central, contact)
    if aged.tops is None:
        return Surroundings(tops_GPa, None)
    most_c = HistorySettings(creep_strength=aged.tops[1])
    most_lost = 1.0 - float(hardness_factor(end_s * settings.duty, most_c))
    felt = held_device(point.device, hold_V)
    fresh = switch_of(felt).states(central.pressed.curves)
    voltages = [(fresh.pull_in_V, fresh.release_V)]
    for share in TOPS_AGES:
        softer = harder(point, 1.0 - share * most_lost)
        pad = press_pad(softer, contact, central.pressed.count, surfaces_of(0))
        states = switch_of(felt).states(pad.curves)
        voltages.append((states.pull_in_V, states.release_V))
    return Surroundings(tops_GPa, _moved(voltages, most_lost * np.array([0.0, *TOPS_AGES])))


def _tops_GPa(central: Solved, contact: ContactSettings) -> float:
    """Mean pressure of what touches: of one cell, pressed as hard as the pad was computed."""
    inputs, settings = central.point.contact_of(contact)
    force_nN = float(central.pressed.curves.closing[0, 0]) * settings.length_nm**2
    closing = run_cycle(inputs, settings, NOMINAL_SEED, max_force_nN=force_nN).closing
    return float(closing.repulsive_nN[-1] / closing.contact_area_nm2[-1])


def ageing_rows(life: "SwitchLife") -> Iterator[dict[str, Any]]:
    """Rows of lifetime/ageing.csv: each effect alone, and all, of a switch without charge."""
    ageing = life.ageing
    assert ageing is not None
    felt_V = life.pull_in_V[0], life.release_V[0]
    times = np.concatenate([[0.0], np.geomspace(1.0, ageing.end_s, ROWS)])
    effects: list[tuple[str, tuple[Effect, ...]]] = [
        (effect, (effect,)) for effect in ageing.effects
    ]
    effects.append(("all", ageing.effects))
    for name, acting in effects:
        for guess in GUESSES:
            moved = ageing.squares_V2(times, guess, acting)
            pull_in, release = (
                np.sqrt(np.maximum(volts**2 + squares, 0.0))
                for volts, squares in zip(felt_V, moved, strict=True)
            )
            strengths: list[float | None] = [None] * times.size
            if name != "all":
                strengths = ageing.strength(acting[0], times, guess).tolist()
            for place, time in enumerate(times.tolist()):
                yield {
                    "effect": name,
                    "guess": guess,
                    "time_s": time,
                    "strength": strengths[place],
                    "pull_in_V": float(pull_in[place]),
                    "release_V": float(release[place]),
                }


def ageing_summary(ageing: Ageing) -> dict[str, Any]:
    """What lifetime/lifetime.json says of ageing."""
    end = np.array([ageing.end_s])
    menisci_s = float(laws.meniscus_time_s(ageing.kelvin))
    return {
        "metal": stated(ageing.settings).beam,
        "largest_strain": ageing.strain,
        "humidity": ageing.humidity,
        "menisci_s": menisci_s,
        "menisci_99_s": menisci_s * float(np.log(100.0)),
        "strengths": {
            effect: {guess: float(ageing.strength(effect, end, guess)[0]) for guess in GUESSES}
            for effect in ageing.effects
        },
    }
