"""How often a switch fails: the share of switches that stick, or let go too late, down to one in a million.

Sticking is a yes or no, from which no rare event can be learned. So the reserve of a switch is the logarithm of the
factor on its attraction with which it just fails. It fails by itself where the reserve is below zero, and with k times
the attraction where it is below ln k. One response of the reserve serves all laws of attraction and hold voltages. It
is learned from switches on pads that are pressed for them: those of the answer, and further ones where a failure is
likely. Such switches also correct it.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Any, Protocol
from zlib import crc32

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from mesoscale.device.beam_switch import closed_beam
from mesoscale.device.numerics import SWITCH
from mesoscale.device.plate import plate_from_settings, solve_on_pad
from mesoscale.device.points import Point, kinds, point_of, values_at
from mesoscale.device.pressing import held_V, pull_in_V
from mesoscale.device.release import WORKS
from mesoscale.errors import InputError, NotComputed
from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.memory import PadLaw, attracting, deepened
from mesoscale.settings import DeviceSettings
from mesoscale.uncertainty.rare_events import (
    LEAST,
    REPEATS,
    SAMPLES,
    Corrected,
    Process,
    Sampled,
    correct,
    quantiles_of,
    rates_given,
    sample_event,
)

Array = NDArray[np.float64]
FAR = 8.0
"""Deviations beyond which a probability is 1 in double precision, so that a number would be endless."""
Known = tuple[int, float]
"""A number of the population that is known, and its value."""


class Pressed(Protocol):
    """A pad that was pressed: its mean curves, and those of two halves of its cells."""

    @property
    def law(self) -> PadLaw: ...
    @property
    def halves(self) -> tuple[PadLaw, PadLaw]: ...


Press = Callable[[Point, int, int], Pressed]
"""Presses the pad of a point: with so many times the cells of the scene, and surfaces by a number."""


@dataclass(frozen=True)
class FailureNumerics:
    """How rare failures are looked for; no scene sets these choices.

    Attributes
    ----------
    first, fewest : switches of the first response beside those of the answer, and the fewest that may be solved.
    rounds, batch : switches are added so often, so many at once, where a failure is likely.
    runs : switches that correct a probability.
    wide : half of the first switches have this many times the deviations of the inputs: rare events are far out.
    surer_cells : times as many cells has a pad whose halves disagree on whether the switch fails.
    surfaces : numbers of surfaces.
    least_times, most_times, step : factors on the attraction that are tried, and the difference of their logarithms to
        which the reserve is known.
    span, voltages : largest hold voltage of the curve, over that of the scene, and the number of voltages.
    rough : probabilities of the RMS heights among which the least is sought, from the roughest.
    springs : springs among which the least is sought, over that of the scene.
    spring_runs : switches that are solved with each spring. They know a probability to some 25 %, and a spring to 1 or
        2 %.
    confidence : that no more fail than allowed, by what is common to all devices and not known.
    near : difference of logarithms to which attractions and springs are sought.
    """

    first: int = 48
    fewest: int = 32
    rounds: int = 5
    batch: int = 16
    runs: int = 64
    wide: float = 2.0
    surer_cells: int = 4
    surfaces: int = 4000
    least_times: float = 0.1
    most_times: float = 30.0
    step: float = 0.1
    span: float = 1.5
    voltages: int = 5
    rough: tuple[float, ...] = (0.98, 0.84, 0.5, 0.16, 0.02)
    springs: tuple[float, float] = (0.5, 2.0)
    spring_runs: int = 32
    confidence: float = 0.9
    near: float = 0.02


FAILURE = FailureNumerics()
"""What every scene uses."""


class Attracted:
    """A switch whose attraction can be changed.

    Parameters
    ----------
    release_V : a switch that is still closed at this voltage has failed.
    elements : of its beam.
    """

    def __init__(self, settings: DeviceSettings, law: PadLaw, release_V: float, elements: int):
        self.settings, self.release_V, self.elements = settings, release_V, elements
        self.laws = [law]
        self.closed: Callable[[float, float], bool] | None = None

    def fails(self, times: float) -> bool:
        """Whether the switch fails with `times` its attraction.

        Raises
        ------
        InputError : the pad is pressed beyond what is known of it, or the electrode cannot be solved.
        """
        while True:
            try:
                if not self.settings.bends:
                    law = attracting(self.laws[-1], times)
                    plate = solve_on_pad(plate_from_settings(self.settings), law, self.settings.hold_voltage_V)
                    return plate.stuck or plate.release_V < self.release_V
                self.closed = self.closed or closed_beam(self.settings, self.laws[-1], self.elements)
                return self.closed(self.release_V, times)
            except NotComputed:
                if len(self.laws) > SWITCH.deepened_by:
                    raise
                self.laws.append(deepened(self.laws[-1]))
                self.closed = None

    def reserve(self, step: float = FAILURE.step) -> float:
        """Logarithm of the factor on the attraction with which the switch just fails, known to half a step."""
        low, high = np.log(FAILURE.least_times), np.log(FAILURE.most_times)
        while high - low > step:
            middle = 0.5 * (low + high)
            try:
                failed = self.fails(float(np.exp(middle)))
            except InputError:
                failed = True
            low, high = (low, middle) if failed else (middle, high)
        return float(0.5 * (low + high))


@dataclass(frozen=True)
class Population:
    """All switches that the scene allows, as standard normal numbers z: inputs, D0 and properties of the device.

    Attributes
    ----------
    table, settings, cutoffs_nm : as `mesoscale.device.points` takes them.
    release_V : a switch that is still closed at this voltage has failed.
    press : of the pads.
    solved : probabilities (m, dimension) of switches whose pads were pressed at the hold voltage, and these pads.
    """

    table: InputTable
    settings: DeviceSettings
    cutoffs_nm: tuple[float, float]
    release_V: float
    press: Press
    solved: tuple[Array, Sequence[Pressed]]

    @property
    def dimension(self) -> int:
        """Number of standard normal numbers."""
        return len(self.names)

    @property
    def names(self) -> list[str]:
        """What the numbers stand for."""
        return [*self.table.names, "gap_cutoff_nm", *self.settings.varied]

    @property
    def common(self) -> NDArray[np.bool_]:
        """Which of the numbers are one unknown value for all devices."""
        return np.array([kind == "common" for kind in kinds(self.table, self.settings)], bool)

    @property
    def spring(self) -> str:
        """The setting of the device that is its spring."""
        return "thickness_um" if self.settings.bends else "spring_N_per_m"

    @property
    def hold_V(self) -> float:
        """Hold voltage of the scene; where it has none, that of the pull-in without contact."""
        return held_V(self.settings)

    @cached_property
    def positive(self) -> NDArray[np.bool_]:
        """Which of the numbers stand for what is above zero."""
        ends = np.outer([-FAR, FAR], np.ones(self.dimension))
        return values_at(ndtr(ends), self.table, self.settings, self.cutoffs_nm).min(axis=0) > 0.0

    def columns(self, z: Array, hold_V: Array) -> Array:
        """What the response depends on: logarithms of what is positive, as the reserve is a logarithm."""
        values = values_at(ndtr(np.clip(z, -FAR, FAR)), self.table, self.settings, self.cutoffs_nm)
        logs = np.log(np.maximum(values, np.finfo(float).tiny))
        return np.column_stack([np.where(self.positive, logs, values), hold_V])

    def points(self, z: Array, hold_V: float) -> list[Point]:
        """The switches of numbers (m, dimension)."""
        held = self.settings.model_copy(update={"hold_voltage_V": hold_V})
        rows = values_at(ndtr(z), self.table, self.settings, self.cutoffs_nm)
        return [point_of(row, self.table.names, held) for row in rows]

    def reserves(self, z: Array, hold_V: float, pads: Sequence[Pressed] | None = None) -> Array:
        """Reserves of switches, shape (m,), on pads that are pressed where none are given; NaN where one cannot be."""
        reserves = np.full(len(z), np.nan)
        for k, point in enumerate(self.points(z, hold_V)):
            with suppress(InputError):
                pad = self.press(point, 1, _surface(z[k])) if pads is None else pads[k]
                reserves[k] = Attracted(point.device, pad.law, self.release_V, SWITCH.coarse_elements).reserve()
        return reserves

    def failed(self, z: Array, hold_V: float, times: float) -> NDArray[np.bool_]:
        """Which switches fail, shape (m,); one that cannot be solved has failed."""
        points = self.points(z, hold_V)
        return np.array([self._fails(point, _surface(row), times) for row, point in zip(z, points, strict=True)])

    def _fails(self, point: Point, surface: int, times: float) -> bool:
        def fails(law: PadLaw, elements: int) -> bool:
            return Attracted(point.device, law, self.release_V, elements).fails(times)

        try:
            pad = self.press(point, 1, surface)
            failed = fails(pad.law, SWITCH.elements)
            if any(fails(half, SWITCH.coarse_elements) != failed for half in pad.halves):
                failed = fails(self.press(point, FAILURE.surer_cells, surface).law, SWITCH.elements)
        except InputError:
            return True
        return failed


def _surface(z: Array) -> int:
    """Number of the surfaces of a switch."""
    return crc32(z.tobytes()) % FAILURE.surfaces


def _with(z: Array, known: Known | None) -> Array:
    """The numbers (m, dimension) with the known one in place."""
    return z if known is None else np.where(np.arange(z.shape[1]) == known[0], known[1], z)


@dataclass(frozen=True)
class ReserveResponse:
    """What was learned of the reserve of a population, from a number of switches."""

    population: Population
    process: Process
    switches: int

    def moments(self, z: Array, hold_V: float) -> tuple[Array, Array]:
        """Mean and deviation of the reserve."""
        return self.process(self.population.columns(z, np.full(len(z), hold_V)))

    def sample(
        self,
        times: float,
        hold_V: float,
        seed: int,
        known: Known | None = None,
        samples: int = SAMPLES,
        repeats: int = 1,
    ) -> Sampled:
        """The failures with `times` the attraction; one run where probabilities are only compared."""
        return sample_event(
            lambda z: self.moments(_with(z, known), hold_V),
            self.population.dimension,
            float(np.log(times)),
            seed,
            samples,
            repeats,
        )

    def rates(self, times: float, hold_V: float, known: Known | None = None, seed: int = 0) -> Array:
        """Shares of the devices that fail with `times` the attraction, by draws of what is common to all of them."""
        return rates_given(
            lambda z: self.moments(_with(z, known), hold_V), self.population.common, float(np.log(times)), seed
        )


def voltages(population: Population) -> Array:
    """Hold voltages of the curve: from pull-in, or that of the scene, to `FAILURE.span` times that of the scene."""
    hold_V = population.hold_V
    return np.linspace(min(hold_V, pull_in_V(population.settings)), FAILURE.span * hold_V, FAILURE.voltages)


def learn(population: Population, tell: Callable[[float, str], None], seed: int = 0) -> ReserveResponse:
    """The response of the reserve, from switches of the whole population and then from such as nearly fail."""
    *_, last = learned(population, tell, seed)
    return last


def learned(population: Population, tell: Callable[[float, str], None], seed: int) -> Iterator[ReserveResponse]:
    """The response after each of the `FAILURE.rounds`, the first of the whole population."""
    from scipy.stats import qmc  # slow to import

    rng = np.random.default_rng(np.random.SeedSequence([seed, 0xFA11]))
    low, high = voltages(population)[[0, -1]]
    first = qmc.LatinHypercube(population.dimension, rng=rng).random(FAILURE.first)
    z = ndtri(first) * np.where(np.arange(FAILURE.first) % 2, 1.0, FAILURE.wide)[:, None]
    units, pads = population.solved
    known_z, hold_V = ndtri(units), population.hold_V
    columns = population.columns(known_z, np.full(len(known_z), hold_V))
    reserves = population.reserves(known_z, hold_V, pads)
    batches = [(z[k :: FAILURE.voltages], float(volts)) for k, volts in enumerate(voltages(population))]
    number = 0
    while True:
        for part, hold_V in batches:
            tell(0.6 * number / FAILURE.rounds, f"{len(reserves)} switches")
            columns = np.concatenate([columns, population.columns(part, np.full(len(part), hold_V))])
            reserves = np.concatenate([reserves, population.reserves(part, hold_V)])
        # a switch that fails with the least attraction says nothing of where others begin to
        within, known = np.isfinite(reserves), reserves > np.log(FAILURE.least_times) + FAILURE.step
        if within.sum() < FAILURE.fewest:
            raise InputError(
                f"failure: {within.sum()} of {len(reserves)} switches can be solved; accepted are at least "
                f"{FAILURE.fewest}; lower device.hold_voltage_V, or narrow the inputs"
            )
        if known.sum() < FAILURE.fewest:
            raise InputError(
                f"failure.release_V = {population.release_V:.4g}: {known.sum()} of {within.sum()} switches release "
                f"above it; accepted are at least {FAILURE.fewest}; lower it, or device.hold_voltage_V"
            )
        response = ReserveResponse(population, Process(columns[known], reserves[known]), len(reserves))
        yield response
        if number == FAILURE.rounds:
            return
        hold_V, times = float(rng.uniform(low, high)), WORKS[number % len(WORKS)]
        likely = response.sample(times, hold_V, seed + number).points
        number += 1
        batches = [(likely[rng.permutation(len(likely))[: FAILURE.batch]], hold_V)]


def corrected(
    response: ReserveResponse, times: float, hold_V: float, seed: int = 0, runs: int = FAILURE.runs
) -> Corrected:
    """Probability of a failure with `times` the attraction, the response corrected by so many runs."""
    sampled = response.sample(times, hold_V, seed, repeats=REPEATS)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 0xC0]))
    chosen = rng.permutation(len(sampled.points))[:runs]
    failed = response.population.failed(sampled.points[chosen], hold_V, times)
    return correct(sampled, failed, sampled.chance[chosen])


def furthest_allowed(values: Array, probability: Array, allowed: float) -> float | None:
    """The last of values, from the safest on, with an allowed probability of failure; None where the first has more.

    Between values, which rise or fall, the logarithm of the probability is interpolated; both of shape (n,).
    """
    logarithm = np.log(np.maximum(np.maximum.accumulate(probability), LEAST))
    wanted = float(np.log(allowed))
    if logarithm[0] > wanted:
        return None
    if logarithm[-1] <= wanted:
        return float(values[-1])
    beyond = int(np.argmax(logarithm > wanted))
    share = (wanted - logarithm[beyond - 1]) / (logarithm[beyond] - logarithm[beyond - 1])
    return float(values[beyond - 1] + share * (values[beyond] - values[beyond - 1]))


def least_rms_nm(response: ReserveResponse, times: float, hold_V: float, allowed: float) -> float | None:
    """Least RMS height (nm), all else varying, with which no more switches fail than allowed, by `FAILURE.confidence`.

    None where even the largest of `FAILURE.rough` is too little, or where roughness is no input.
    """
    population = response.population
    if "rms" not in population.names:
        return None
    place = population.names.index("rms")
    rough = ndtri(np.array(FAILURE.rough))
    middle = np.zeros((rough.size, population.dimension))
    middle[:, place] = rough
    rms_nm = values_at(ndtr(middle), population.table, population.settings, population.cutoffs_nm)[:, place]
    failing = [np.quantile(response.rates(times, hold_V, (place, z)), FAILURE.confidence) for z in rough.tolist()]
    return furthest_allowed(rms_nm, np.array(failing), allowed)


def just_allowed(response: ReserveResponse, hold_V: float, allowed: float) -> float:
    """Factor on the attraction with which just as many as allowed fail by the response."""
    low, high = float(np.log(FAILURE.least_times)), float(np.log(FAILURE.most_times))
    while high - low > FAILURE.near:
        middle = 0.5 * (low + high)
        more = response.sample(float(np.exp(middle)), hold_V, 0).probability > allowed
        low, high = (low, middle) if more else (middle, high)
    return float(np.exp(high))


def least_spring(
    response: ReserveResponse, likely: Sampled, times: float, hold_V: float, allowed: float
) -> float | None:
    """Least spring, in the unit of its setting, all else varying, with which no more switches fail than allowed.

    A weaker spring makes those fail that nearly fail with more attraction. So some of `likely` are solved with other
    springs, and correct its probability as in `corrected`. None where even the largest of `FAILURE.springs` is too
    weak, or where none is likely.

    Parameters
    ----------
    likely : the failures with about the allowed probability; see `just_allowed`.
    """
    if not len(likely.points):
        return None
    population = response.population
    now = getattr(population.settings, population.spring)
    rng = np.random.default_rng(np.random.SeedSequence([0, 0x5B1]))
    chosen = rng.permutation(len(likely.points))[: FAILURE.spring_runs]

    def too_many(logarithm: float) -> bool:
        changed = population.settings.model_copy(update={population.spring: now * float(np.exp(logarithm))})
        failed = replace(population, settings=changed).failed(likely.points[chosen], hold_V, times)
        return likely.probability * float(np.mean(failed / likely.chance[chosen])) > allowed

    low, high = np.log(FAILURE.springs).tolist()
    if too_many(high):
        return None
    while high - low > FAILURE.near:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if too_many(middle) else (low, middle)
    return now * float(np.exp(high))


def failure_rate(
    population: Population, allowed: float, tell: Callable[[float, str], None]
) -> tuple[dict[str, Any], list[dict[str, float]]]:
    """Content of device/failure.json and rows of device/failure.csv.

    Parameters
    ----------
    allowed : share of the switches that may fail.

    Raises
    ------
    InputError : no switch of the population can be solved, or none lets go above the asked voltage.
    """
    hold, response = population.hold_V, learn(population, tell)
    given = {(volts, times): response.rates(times, volts) for volts in voltages(population).tolist() for times in WORKS}
    rows = [
        {
            "hold_V": volts,
            "attraction": times,
            "failing": response.sample(times, volts, 0).probability,
            "failing_q95": float(np.quantile(rates, 0.95)),
            "failing_sure": float(np.quantile(rates, FAILURE.confidence)),
        }
        for (volts, times), rates in given.items()
    ]
    laws = []
    likely = response.sample(just_allowed(response, hold, allowed), hold, 0)
    for number, times in enumerate(WORKS):
        tell(0.6 + 0.4 * number / len(WORKS), f"{times:.2g} times the attraction")
        curve = [row for row in rows if row["attraction"] == times]
        volts, share = (np.array([row[key] for row in curve]) for key in ("hold_V", "failing_sure"))
        rates = response.rates(times, hold)
        allowed_V = furthest_allowed(volts, share, allowed)
        laws.append(
            {
                "attraction": times,
                "failing": asdict(corrected(response, times, hold)),
                "given_common": quantiles_of(rates),
                "sure": float(np.mean(rates <= allowed)),
                "largest_hold_V": allowed_V,
                "least_rms_nm": least_rms_nm(response, times, hold, allowed),
                "least_spring": least_spring(response, likely, times, hold, allowed),
                "there": None if allowed_V is None else asdict(corrected(response, times, allowed_V)),
            }
        )
    # with the scene's own attraction, or where that never fails with the largest
    judged = next((times for times in (1.0, WORKS[-1]) if response.sample(times, hold, 0).probability > 0.0), None)
    return {
        "release_V": population.release_V,
        "allowed": allowed,
        "confidence": FAILURE.confidence,
        "hold_V": hold,
        "spring": population.spring,
        "laws": laws,
        "control_attraction": judged,
        "control": sorted(
            (
                {"name": name, "failing_if_known": response.sample(judged, hold, 0, (k, 0.0)).probability}
                for k, name in enumerate(population.names)
                if judged is not None
            ),
            key=lambda row: row["failing_if_known"],
        ),
        "switches": response.switches,
    }, rows
