"""The life of a switch that is held: what charge makes of its voltages, from a second to years.

Every point of the joint distribution is a device. Its gaps say where charge enters at the hold
voltage; what that does to release and pull-in is solved for a few strengths of its uneven part,
between which squares of voltages are straight. The rates are not known: three guesses bound them.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from mesoscale.answer.switches import PadModel, Solved, surfaces_of
from mesoscale.charging.cycles import driven_V
from mesoscale.charging.gaps import GAPS_NM, RISES_NM, HeldGaps, held_gaps
from mesoscale.charging.rates import GUESSES, Rates, contactless_V, guesses
from mesoscale.errors import InputError
from mesoscale.pad.curves import PadCurves
from mesoscale.settings import ContactSettings, DeviceSettings, LifetimeSettings
from mesoscale.settings.device import UnevenCharge
from mesoscale.switch import switch_of
from mesoscale.switch.charge import shift_V
from mesoscale.switch.shifted import as_driven, as_felt

if TYPE_CHECKING:  # it compiles, and is imported where a scene asks for ageing
    from mesoscale.charging.ageing import Ageing, Surroundings

Array = NDArray[np.float64]
Squares = tuple[Array | float, Array | float]

NOT_AGED: Squares = (0.0, 0.0)
YEAR_S = 3.15576e7
FIRST_S = 1.0
PER_DECADE = 2
"""Times of the life."""
STRENGTHS = (0.0, 0.05, 0.3, 1.0)
"""Of the largest uneven charge of a device, at which its switch is solved."""
TELLING = 4
"""Position in `RISES_NM` of the rise whose U^2 tells the strength: 4 nm, where the last places let
go."""
FARTHEST_NM = 1e5
FEWEST = 8
"""Devices of which a life can be."""
HOLDS = np.linspace(0.4, 1.2, 17)
"""Hold voltages of the curve, over that of the scene."""
MOST_FAILING = 1e-6
SHIFTED_V = 1.0
"""Shift up to which the time is told, for volts a decade."""
QUANTILES = {"q05": 0.05, "q50": 0.5, "q95": 0.95}


def times_s(settings: LifetimeSettings) -> Array:
    """Times of the life, from a second on, in equal steps of their logarithm; the last is its end.

    Raises
    ------
    InputError : the scene asks for no life.
    """
    if settings.years is None:
        raise InputError("lifetime.years = null: give the life that is asked for, such as 10")
    end = settings.years * YEAR_S
    count = max(int(np.ceil(PER_DECADE * np.log10(end / FIRST_S))), 1) + 1
    return np.geomspace(FIRST_S, end, count)


@dataclass(frozen=True)
class SwitchLife:
    """One device that is held.

    Attributes
    ----------
    shift_V : of the device before it is held.
    hold_V : drive that holds it.
    squares_V2 : U^2 at the telling rise, of the strengths that were solved, rising.
    pull_in_V, release_V : as felt, with these; release 0: it sticks.
    ageing : what time does beside charge; None where a scene does not ask.
    """

    gaps: HeldGaps
    shift_V: float
    hold_V: float
    squares_V2: Array
    pull_in_V: Array
    release_V: Array
    ageing: "Ageing | None" = None

    def aged(self, times: Array, guess: str) -> Squares:
        """By how much the squares of pull-in and release have moved (V^2) by ageing."""
        if self.ageing is None:
            return NOT_AGED
        return self.ageing.squares_V2(times, guess)

    def charged(
        self, hold_V: float, times: Array, settings: LifetimeSettings, rates: Rates
    ) -> tuple[Array, Array]:
        """Even shift (V), and U^2 at the telling rise (V^2), after times (s) at a drive."""
        felt_V = hold_V - self.shift_V
        shifts = driven_V(felt_V, GAPS_NM, times, self.gaps.device, settings, rates)
        classes = self.gaps.class_V(shifts)
        squares = np.einsum("ct,cd,dt->t", classes, self.gaps.uneven[TELLING], classes)
        return self.gaps.mean_V(shifts) - contactless_V(times, settings), squares

    def felt(self, squares: Array, aged: Squares = NOT_AGED) -> tuple[Array, Array]:
        """Pull-in and release as felt (V) with so much uneven charge and ageing; 0: it sticks."""
        pull_in, release = (
            np.sqrt(np.maximum(np.interp(squares, self.squares_V2, felt**2) + moved, 0.0))
            for felt, moved in zip((self.pull_in_V, self.release_V), aged, strict=True)
        )
        return pull_in, release

    def voltages(
        self, shift: Array, squares: Array, aged: Squares = NOT_AGED
    ) -> tuple[Array, Array]:
        """Drives at which it closes and lets go with so much charge and ageing; 0: it sticks."""
        pull_in, release = self.felt(squares, aged)
        both = [
            as_driven(float(close), float(let_go), self.shift_V + float(moved))
            for close, let_go, moved in zip(pull_in, release, shift, strict=True)
        ]
        return np.array([close for close, _ in both]), np.array([let_go for _, let_go in both])


def life_of(
    solved: Solved,
    contact: ContactSettings,
    number: int,
    settings: LifetimeSettings,
    by_guess: Mapping[str, Rates] | None = None,
    shared: "Surroundings | None" = None,
) -> SwitchLife:
    """A device of the model, by its number (0: the central one).

    Parameters
    ----------
    by_guess : rates that are not those of the settings.
    shared : what it shares of its ageing with the others; None: it does not age.

    Raises
    ------
    InputError : it has no answer, or its dielectric no thickness.
    """
    device = solved.point.device
    if device.dielectric_nm == 0.0:
        raise InputError("lifetime: a dielectric without thickness holds no charge; give it one")
    gaps = held_gaps(solved, contact, surfaces_of(number))
    life = life_with(gaps, device, solved.pressed.curves, settings, by_guess)
    if shared is None:
        return life
    from mesoscale.charging.ageing import ageing_of

    humidity = solved.point.humidity(contact)
    end_s = float(times_s(settings)[-1])
    curves = solved.pressed.curves
    ageing = ageing_of(
        device, life.hold_V, curves, settings, end_s, humidity, shared, apart=number == 0
    )
    return replace(life, ageing=ageing)


def life_with(
    gaps: HeldGaps,
    device: DeviceSettings,
    curves: PadCurves,
    settings: LifetimeSettings,
    by_guess: Mapping[str, Rates] | None = None,
) -> SwitchLife:
    """A device whose gaps are known, on its pad.

    Raises
    ------
    InputError : it has no answer.
    """
    shift = shift_V(device)
    fresh = switch_of(as_felt(device, shift))
    states = fresh.states(curves)
    hold_V = device.hold_voltage_V or states.pull_in_V + shift
    life = SwitchLife(
        gaps,
        shift,
        hold_V,
        np.zeros(1),
        np.array([states.pull_in_V]),
        np.array([states.release_V]),
    )
    times = times_s(settings)
    largest_squares = np.zeros(RISES_NM.size)
    for rates in (by_guess or guesses(settings)).values():
        shifts = driven_V(hold_V - shift, GAPS_NM, times, gaps.device, settings, rates)
        classes = gaps.class_V(shifts)
        squares = np.einsum("ct,rcd,dt->rt", classes, gaps.uneven, classes)
        largest = squares[:, np.argmax(squares[TELLING])]
        if largest[TELLING] > largest_squares[TELLING]:
            largest_squares = largest
    if largest_squares[TELLING] <= 0.0:
        return life
    both = [(states.pull_in_V, states.release_V)]
    both += [
        _charged_states(gaps, curves, strength * largest_squares) for strength in STRENGTHS[1:]
    ]
    closes, lets_go = np.array(both).T
    return replace(
        life,
        squares_V2=np.array(STRENGTHS) * float(largest_squares[TELLING]),
        pull_in_V=closes,
        release_V=lets_go,
    )


def _charged_states(gaps: HeldGaps, curves: PadCurves, squares_V2: Array) -> tuple[float, float]:
    """Pull-in and release as felt with uneven charge; 0 where it closes the switch alone."""
    above = [
        (gaps.middle_nm + rise, float(square))
        for rise, square in zip(RISES_NM, squares_V2, strict=True)
    ]
    uneven = UnevenCharge(felt=(*above, (FARTHEST_NM, 0.0)))
    try:
        charged = gaps.device.model_copy(update={"uneven": uneven})
        states = switch_of(charged).states(curves)
    except InputError:
        return 0.0, 0.0
    return states.pull_in_V, states.release_V


@dataclass(frozen=True)
class Lives:
    """All devices of a model that have an answer.

    Attributes
    ----------
    refused : reasons of those that have none.
    by_guess : rates by the names of the guesses.
    """

    central: SwitchLife
    devices: tuple[SwitchLife, ...]
    refused: tuple[str, ...]
    settings: LifetimeSettings
    by_guess: Mapping[str, Rates]


def lives_of(
    model: PadModel,
    contact: ContactSettings,
    settings: LifetimeSettings,
    progress: Callable[[float, str], None] | None = None,
    by_guess: Mapping[str, Rates] | None = None,
) -> Lives:
    """The lives of a scene's switches.

    Parameters
    ----------
    by_guess : rates that a measured drift leaves; None: those of the settings.

    Raises
    ------
    InputError : the central one, or too many others, have none.
    """
    shared = None
    if settings.ageing is not None:
        from mesoscale.charging.ageing import surroundings_of

        end_s = float(times_s(settings)[-1])
        shared = surroundings_of(model.central, contact, settings, end_s)
    central = life_of(model.central, contact, 0, settings, by_guess, shared)
    devices = []
    refused = []
    for number, solved in enumerate(model.points, 1):
        try:
            devices.append(life_of(solved, contact, number, settings, by_guess, shared))
        except InputError as error:
            refused.append(str(error))
        if progress:
            progress(number / len(model.points), f"{number} of {len(model.points)} devices")
    if len(devices) < FEWEST:
        raise InputError(
            f"lifetime: {len(devices)} devices have a life; accepted are at least {FEWEST}; raise"
            " pad.points"
        )
    return Lives(central, tuple(devices), tuple(refused), settings, by_guess or guesses(settings))


def _failing(life: SwitchLife, hold_V: float, shift: Array, squares: Array, aged: Squares) -> Array:
    """Margins (V) of a device, shape (2, times): to let go above 0, and to stay held."""
    _, release = life.voltages(shift, squares, aged)
    # one that sticks misses by what is felt without a drive
    _, felt = life.felt(squares, aged)
    open_margin = np.where(release > 0.0, release, np.minimum(felt + shift + life.shift_V, 0.0))
    return np.stack([open_margin, hold_V - np.maximum(release, 0.0)])


def life_rows(lives: Lives) -> Iterator[dict[str, Any]]:
    """Rows of lifetime/lifetime.csv: a guess and a time each; the first time is before any hold."""
    times = np.concatenate([[0.0], times_s(lives.settings)])
    holds_V = np.array([life.hold_V for life in lives.devices])
    for guess in GUESSES:
        rates = lives.by_guess[guess]
        shifts = []
        closes = []
        lets_go = []
        for life in lives.devices:
            shift, squares = life.charged(life.hold_V, times, lives.settings, rates)
            pull_in, release = life.voltages(shift, squares, life.aged(times, guess))
            shifts.append(shift)
            closes.append(pull_in)
            lets_go.append(release)
        central_shift, central_squares = lives.central.charged(
            lives.central.hold_V, times, lives.settings, rates
        )
        pull_in, release = lives.central.voltages(
            central_shift, central_squares, lives.central.aged(times, guess)
        )
        stuck = np.array(lets_go) <= 0.0
        lost = np.array(lets_go) >= holds_V[:, None]
        for place, time in enumerate(times.tolist()):
            row: dict[str, Any] = {"guess": guess, "time_s": time}
            row |= {
                "shift_V": float(central_shift[place]),
                "uneven_V": float(np.sqrt(central_squares[place])),
                "pull_in_V": float(pull_in[place]),
                "release_V": float(release[place]),
            }
            for name, values in (("shift", shifts), ("pull_in", closes), ("release", lets_go)):
                of_devices = np.array(values)[:, place]
                row |= {
                    f"{name}_{end}_V": float(np.quantile(of_devices, share))
                    for end, share in QUANTILES.items()
                }
            row["stuck"] = float(stuck[:, place].mean())
            row["lost"] = float((lost & ~stuck)[:, place].mean())
            yield row


def hold_rows(lives: Lives) -> Iterator[dict[str, Any]]:
    """Rows of lifetime/holds.csv: what the life's end is at other hold voltages, a guess each.

    The electrode was closed by the drive of the scene and is then held by another. Shares that fail
    are tails of normal distributions through the margins of all devices.
    """
    end = times_s(lives.settings)[-1:]
    for guess in GUESSES:
        rates = lives.by_guess[guess]
        for hold in HOLDS.tolist():
            margins = np.array(
                [
                    _failing(
                        life,
                        hold * life.hold_V,
                        *life.charged(hold * life.hold_V, end, lives.settings, rates),
                        life.aged(end, guess),
                    )[:, 0]
                    for life in lives.devices
                ]
            )
            deviations = np.maximum(margins.std(axis=0, ddof=1), 1e-9)
            tails = ndtr(-margins.mean(axis=0) / deviations)
            hold_V = hold * lives.central.hold_V
            shift, _ = lives.central.charged(hold_V, end, lives.settings, rates)
            yield {
                "guess": guess,
                "hold_V": hold_V,
                "shift_V": float(shift[0]),
                "sticking": float(tails[0]),
                "lost": float(tails[1]),
                "time_to_1V_s": _time_to(lives.central, hold_V, lives.settings, rates),
            }


def _time_to(
    life: SwitchLife, hold_V: float, settings: LifetimeSettings, rates: Rates
) -> float | None:
    """Time in which the even shift grows to `SHIFTED_V`; None beyond 10^12 s."""
    times = np.geomspace(1e-12, 1e12, 241)
    shift, _ = life.charged(hold_V, times, settings, rates)
    size = np.abs(shift)
    if size[-1] < SHIFTED_V:
        return None
    logs = np.log(np.maximum(size, 1e-30))
    return float(np.exp(np.interp(np.log(SHIFTED_V), logs, np.log(times))))


def volts_a_decade(rows: Sequence[dict[str, Any]], hold_V: float) -> float | None:
    """By how many volts of the hold the time to a shift of 1 V falls ten times, at a voltage."""
    known = [(row["hold_V"], row["time_to_1V_s"]) for row in rows if row["time_to_1V_s"]]
    if len(known) < 2:
        return None
    volts, times = np.array(known).T
    nearest = np.argsort(abs(volts - hold_V))[:2]
    slope = np.diff(np.log10(times[nearest]))[0] / np.diff(volts[nearest])[0]
    return -1.0 / float(slope) if slope < 0.0 else None


def summary(lives: Lives, holds: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Content of lifetime/lifetime.json."""
    central = lives.central
    felt_V = central.hold_V - central.shift_V
    fields = felt_V / (GAPS_NM[1:] + central.gaps.device.dielectric_gap_nm)
    shares = central.gaps.shares
    order = np.cumsum(shares[:-1])
    by_guess = {}
    for guess in GUESSES:
        rows = [row for row in holds if row["guess"] == guess]
        allowed = [row["hold_V"] for row in rows if row["sticking"] + row["lost"] <= MOST_FAILING]
        by_guess[guess] = {
            "highest_hold_V": max(allowed, default=None),
            "tried_V": max(row["hold_V"] for row in rows),
            "volts_a_decade": volts_a_decade(rows, central.hold_V),
        }
    cycles = {}
    if lives.settings.period_s is not None:
        names = ("period_s", "duty", "other_polarity")
        cycles["cycles"] = {name: getattr(lives.settings, name) for name in names}
    ageing = {}
    if central.ageing is not None:
        from mesoscale.charging.ageing import ageing_summary

        ageing["ageing"] = ageing_summary(central.ageing)
    return {
        "years": lives.settings.years,
        "hold_V": central.hold_V,
        "touching": central.gaps.touching,
        "contact_factor": central.gaps.contact_factor,
        "separation_nm": central.gaps.middle_nm,
        "gap_q50_nm": float(GAPS_NM[min(int(np.searchsorted(order, 0.5)), GAPS_NM.size - 1)]),
        "largest_field_V_nm": float(fields[0]),
        "uneven_share": float(np.sqrt(np.trace(central.gaps.uneven[TELLING]))),
        "devices": len(lives.devices),
        "refused": list(lives.refused),
        "guesses": by_guess,
        **cycles,
        **ageing,
    }
