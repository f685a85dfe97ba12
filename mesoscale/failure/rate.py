"""How often a switch fails: the share of switches that stick, or let go too late, down to one in a
million.

Sticking is a yes or no, from which no rare event can be learned. So a response is learned of the
reserve. The reserve of a switch is the logarithm of the factor on its attraction with which it just
fails (`mesoscale.failure.population`). With k times the attraction a switch fails where its reserve
is below ln k. So one response serves all laws of attraction and hold voltages. It is learned from
switches on pads that are pressed for them: those of the answer, and further ones where a failure is
likely. Such switches also correct it.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from mesoscale.answer.points import values_at
from mesoscale.answer.release import WORKS
from mesoscale.errors import InputError
from mesoscale.failure.population import FAILURE, Population
from mesoscale.failure.springs import Sprung, least_spring
from mesoscale.switch import switch_of
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
Known = tuple[int, float]
"""A number of the population that is known, and its value."""
Tell = Callable[[float, str], None]
"""Is told which share of the work is done, and what comes next."""


def _with(z: Array, known: Known | None) -> Array:
    """The numbers (m, dimension) with the known one in place."""
    return z if known is None else np.where(np.arange(z.shape[1]) == known[0], known[1], z)


@dataclass(frozen=True)
class ReserveResponse:
    """What was learned of the reserve of a population.

    Attributes
    ----------
    switches : number of them that were pressed.
    columns, reserves : of those that it was learned from, shapes (m, k) and (m,).
    """

    population: Population
    process: Process
    switches: int
    columns: Array
    reserves: Array

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
        """The failures with `times` the attraction; one run where probabilities are only
        compared.
        """
        return sample_event(
            lambda z: self.moments(_with(z, known), hold_V),
            self.population.dimension,
            float(np.log(times)),
            seed,
            samples,
            repeats,
        )

    def rates(
        self, times: float, hold_V: float, known: Known | None = None, seed: int = 0
    ) -> Array:
        """Shares of the devices that fail with `times` the attraction, by draws of what is common
        to all of them.
        """
        return rates_given(
            lambda z: self.moments(_with(z, known), hold_V),
            self.population.common,
            float(np.log(times)),
            seed,
        )


def voltages(population: Population) -> Array:
    """Hold voltages of the curve: from pull-in, or that of the scene, to `FAILURE.span` times that
    of the scene.
    """
    hold_V = population.hold_V
    return np.linspace(
        min(hold_V, switch_of(population.settings).pull_in_V),
        FAILURE.span * hold_V,
        FAILURE.voltages,
    )


def learn(population: Population, tell: Tell, seed: int = 0) -> ReserveResponse:
    """The response of the reserve, from switches of the whole population and then from such as
    nearly fail.

    Raises
    ------
    InputError : no switch of the population can be solved, or none lets go above the asked voltage.
    """
    from scipy.stats import qmc  # slow to import

    rng = np.random.default_rng(np.random.SeedSequence([seed, 0xFA11]))
    curve_V = voltages(population).tolist()
    # switches that the answer has solved, and others over all voltages: every second one farther
    # out than devices are
    units, pads = population.solved
    solved_z = ndtri(units)
    scene_V = population.hold_V
    columns = population.columns(solved_z, np.full(len(solved_z), scene_V))
    reserves = population.reserves(solved_z, scene_V, pads)
    first = qmc.LatinHypercube(population.dimension, rng=rng).random(FAILURE.first)
    farther = np.where(np.arange(FAILURE.first) % 2, 1.0, FAILURE.wide)
    z = ndtri(first) * farther[:, None]
    batches = [(z[k :: FAILURE.voltages], batch_V) for k, batch_V in enumerate(curve_V)]
    response = None
    rounds = 0
    while True:
        for batch_z, batch_V in batches:
            tell(0.2 * rounds / FAILURE.rounds, f"{len(reserves)} switches")
            batch_columns = population.columns(batch_z, np.full(len(batch_z), batch_V))
            about = None
            if response is not None:
                about, _ = response.process(batch_columns)
            batch_reserves = population.reserves(batch_z, batch_V, about=about)
            columns = np.concatenate([columns, batch_columns])
            reserves = np.concatenate([reserves, batch_reserves])
        response = _learned(population, columns, reserves)
        if rounds == FAILURE.rounds:
            return response
        # then such as nearly fail by the response so far
        times, drawn_V = 1.0, scene_V
        if rounds < FAILURE.rounds - FAILURE.own_rounds:
            times = WORKS[rounds % len(WORKS)]
            drawn_V = float(rng.uniform(curve_V[0], curve_V[-1]))
        likely = response.sample(times, drawn_V, seed + rounds).points
        chosen = rng.permutation(len(likely))[: FAILURE.batch]
        batches = [(likely[chosen], drawn_V)]
        rounds += 1


def _learned(population: Population, columns: Array, reserves: Array) -> ReserveResponse:
    """The response of the reserve from those of some switches.

    Raises
    ------
    InputError : too few of them can be solved, or let go above the asked voltage.
    """
    solved = np.isfinite(reserves)
    # a switch that fails with the least attraction says nothing of where others begin to
    tells = reserves > np.log(FAILURE.least_times) + FAILURE.step
    if solved.sum() < FAILURE.fewest:
        raise InputError(
            f"failure: {solved.sum()} of {len(reserves)} switches can be solved; accepted are"
            f" at least {FAILURE.fewest}; lower device.hold_voltage_V, or narrow the inputs"
        )
    if tells.sum() < FAILURE.fewest:
        raise InputError(
            f"failure.release_V = {population.release_V:.4g}: {tells.sum()} of {solved.sum()}"
            f" switches release above it; accepted are at least {FAILURE.fewest}; lower it, or"
            " device.hold_voltage_V"
        )
    process = Process(columns[tells], reserves[tells])
    return ReserveResponse(population, process, len(reserves), columns[tells], reserves[tells])


def corrected(
    response: ReserveResponse, times: float, hold_V: float, seed: int = 0, runs: int = FAILURE.runs
) -> Corrected:
    """Probability of a failure with `times` the attraction, the response corrected by so many
    runs, or fewer where these know enough (`FAILURE.known`).
    """
    sampled = response.sample(times, hold_V, seed, repeats=REPEATS)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 0xC0]))
    chosen = rng.permutation(len(sampled.points))[:runs]
    failed = np.zeros(0, bool)
    probability = correct(sampled, failed, sampled.chance[:0])
    while failed.size < chosen.size and (
        not probability.events or probability.scatter > FAILURE.known
    ):
        batch = chosen[failed.size : failed.size + FAILURE.batch]
        more = response.population.failed(sampled.points[batch], hold_V, times)
        failed = np.concatenate([failed, more])
        probability = correct(sampled, failed, sampled.chance[chosen[: failed.size]])
    return probability


def furthest_allowed(values: Array, probability: Array, allowed: float) -> float | None:
    """The last of values, from the safest on, with an allowed probability of failure; None where
    the first has more.

    Between values, which rise or fall, the logarithm of the probability is interpolated; both of
    shape (n,).
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


def least_rms_nm(
    response: ReserveResponse, times: float, hold_V: float, allowed: float
) -> float | None:
    """Least RMS height (nm), all else varying, with which no more switches fail than allowed, by
    `FAILURE.confidence`.

    None where even the largest of `FAILURE.rough` is too little, or where roughness is no input.
    """
    population = response.population
    if "rms" not in population.names:
        return None
    place = population.names.index("rms")
    rough = ndtri(np.array(FAILURE.rough))
    middle = np.zeros((rough.size, population.dimension))
    middle[:, place] = rough
    rms_nm = values_at(ndtr(middle), population.table, population.settings, population.cutoffs_nm)[
        :, place
    ]
    failing = [
        np.quantile(response.rates(times, hold_V, (place, z)), FAILURE.confidence)
        for z in rough.tolist()
    ]
    return furthest_allowed(rms_nm, np.array(failing), allowed)


def just_allowed(response: ReserveResponse, hold_V: float, allowed: float) -> float:
    """Factor on the attraction with which just as many as allowed fail by the response."""
    low = float(np.log(FAILURE.least_times))
    high = float(np.log(FAILURE.most_times))
    while high - low > FAILURE.near:
        middle = 0.5 * (low + high)
        more = response.sample(float(np.exp(middle)), hold_V, 0).probability > allowed
        low, high = (low, middle) if more else (middle, high)
    return float(np.exp(high))


def failure_rate(
    population: Population, allowed: float, tell: Tell
) -> tuple[dict[str, Any], list[dict[str, float]]]:
    """Content of failure/failure.json and rows of failure/failure.csv.

    Parameters
    ----------
    allowed : share of the switches that may fail.

    Raises
    ------
    InputError : no switch of the population can be solved, or none lets go above the asked voltage.
    """
    response = learn(population, tell)
    rows = _curve(response)
    likely = response.sample(
        just_allowed(response, population.hold_V, allowed), population.hold_V, 0
    )
    sprung = Sprung(population, likely, population.hold_V)
    step = 0.8 / len(WORKS)
    laws = []
    for number, times in enumerate(WORKS):
        curve = [row for row in rows if row["attraction"] == times]
        tell_of_law = _within(tell, 0.2 + number * step, step)
        laws.append(_of_law(response, times, allowed, sprung, curve, tell_of_law))
    return {
        "release_V": population.release_V,
        "allowed": allowed,
        "confidence": FAILURE.confidence,
        "hold_V": population.hold_V,
        "spring": population.spring,
        "laws": laws,
        **_control(response),
        "switches": response.switches,
    }, rows


def _within(tell: Tell, begun: float, step: float) -> Tell:
    """Told the share of a step, tells that of the whole."""

    def tell_of_step(share: float, words: str) -> None:
        tell(begun + share * step, words)

    return tell_of_step


def _curve(response: ReserveResponse) -> list[dict[str, float]]:
    """Shares that fail by hold voltage and attraction: of all devices, and as far as what is common
    to them is known, with 95 % and `FAILURE.confidence`.
    """
    rows = []
    for hold_V in voltages(response.population).tolist():
        for times in WORKS:
            rates = response.rates(times, hold_V)
            rows.append(
                {
                    "hold_V": hold_V,
                    "attraction": times,
                    "failing": response.sample(times, hold_V, 0).probability,
                    "failing_q95": float(np.quantile(rates, 0.95)),
                    "failing_sure": float(np.quantile(rates, FAILURE.confidence)),
                }
            )
    return rows


def _of_law(
    response: ReserveResponse,
    times: float,
    allowed: float,
    sprung: Sprung,
    curve: Sequence[dict[str, float]],
    tell: Tell,
) -> dict[str, Any]:
    """What `times` the attraction does at the scene's hold voltage, and what would be allowed.

    Parameters
    ----------
    sprung : switches that fail with about the allowed probability; see `just_allowed`.
    curve : rows of this attraction.
    tell : of this law alone.
    """
    hold_V = response.population.hold_V
    law = f"{times:.2g} times the attraction"
    tell(0.0, law)
    sure = np.array([row["failing_sure"] for row in curve])
    largest_V = furthest_allowed(voltages(response.population), sure, allowed)
    rates = response.rates(times, hold_V)
    failing = asdict(corrected(response, times, hold_V))
    tell(0.2, f"{law}, least spring")
    spring = least_spring(sprung, times, allowed)
    tell(0.8, f"{law}, largest hold voltage")
    there = None
    if largest_V is not None:
        there = asdict(corrected(response, times, largest_V))
    return {
        "attraction": times,
        "failing": failing,
        "given_common": quantiles_of(rates),
        "sure": float(np.mean(rates <= allowed)),
        "largest_hold_V": largest_V,
        "least_rms_nm": least_rms_nm(response, times, hold_V, allowed),
        "least_spring": spring,
        "there": there,
    }


def _control(response: ReserveResponse) -> dict[str, Any]:
    """Shares that would fail if one number were known, from the least: what to control first.

    They are of the scene's own attraction, or where that never fails of the largest.
    """
    hold_V = response.population.hold_V
    failing_times = [
        times for times in (1.0, WORKS[-1]) if response.sample(times, hold_V, 0).probability > 0.0
    ]
    if not failing_times:
        return {"control_attraction": None, "control": []}
    times = failing_times[0]
    control = []
    for k, name in enumerate(response.population.names):
        if_known = response.sample(times, hold_V, 0, (k, 0.0)).probability
        control.append({"name": name, "failing_if_known": if_known})
    control.sort(key=lambda row: row["failing_if_known"])
    return {"control_attraction": times, "control": control}
