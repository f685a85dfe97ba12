"""How often a switch fails: the share of switches that stick, or let go too late, down to one in a
million.

Sticking is a yes or no, from which no rare event can be learned. So a response is learned of the
reserve of switches (`mesoscale.failure.population`). One fails by itself where its reserve is below
zero, and with k times the attraction where it is below ln k: one response serves all laws of
attraction and hold voltages. It is learned from switches on pads that are pressed for them: those
of the answer, and further ones where a failure is likely. Such switches also correct it.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from mesoscale.answer.points import values_at
from mesoscale.answer.release import WORKS
from mesoscale.errors import InputError
from mesoscale.failure.population import FAILURE, Population
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


def learn(
    population: Population, tell: Callable[[float, str], None], seed: int = 0
) -> ReserveResponse:
    """The response of the reserve, from switches of the whole population and then from such as
    nearly fail.

    Raises
    ------
    InputError : no switch of the population can be solved, or none lets go above the asked voltage.
    """
    from scipy.stats import qmc  # slow to import

    rng = np.random.default_rng(np.random.SeedSequence([seed, 0xFA11]))
    volts = voltages(population).tolist()
    # switches that the answer has solved, and others over all voltages: every second one farther
    # out than devices are
    units, pads = population.solved
    solved_z = ndtri(units)
    hold_V = population.hold_V
    columns = population.columns(solved_z, np.full(len(solved_z), hold_V))
    reserves = population.reserves(solved_z, hold_V, pads)
    first = qmc.LatinHypercube(population.dimension, rng=rng).random(FAILURE.first)
    farther = np.where(np.arange(FAILURE.first) % 2, 1.0, FAILURE.wide)
    z = ndtri(first) * farther[:, None]
    batches = [(z[k :: FAILURE.voltages], hold_V) for k, hold_V in enumerate(volts)]
    rounds = 0
    while True:
        for batch_z, hold_V in batches:
            tell(0.2 * rounds / FAILURE.rounds, f"{len(reserves)} switches")
            of_batch = population.columns(batch_z, np.full(len(batch_z), hold_V))
            columns = np.concatenate([columns, of_batch])
            reserves = np.concatenate([reserves, population.reserves(batch_z, hold_V)])
        response = _learned(population, columns, reserves)
        if rounds == FAILURE.rounds:
            return response
        # then such as nearly fail by the response so far
        hold_V = float(rng.uniform(volts[0], volts[-1]))
        times = WORKS[rounds % len(WORKS)]
        likely = response.sample(times, hold_V, seed + rounds).points
        chosen = rng.permutation(len(likely))[: FAILURE.batch]
        batches = [(likely[chosen], hold_V)]
        rounds += 1


def _learned(population: Population, columns: Array, reserves: Array) -> ReserveResponse:
    """The response of the reserve from those of some switches.

    Raises
    ------
    InputError : too few of them can be solved, or let go above the asked voltage.
    """
    solved = np.isfinite(reserves)
    # a switch that fails with the least attraction says nothing of where others begin to
    known = reserves > np.log(FAILURE.least_times) + FAILURE.step
    if solved.sum() < FAILURE.fewest:
        raise InputError(
            f"failure: {solved.sum()} of {len(reserves)} switches can be solved; accepted are"
            f" at least {FAILURE.fewest}; lower device.hold_voltage_V, or narrow the inputs"
        )
    if known.sum() < FAILURE.fewest:
        raise InputError(
            f"failure.release_V = {population.release_V:.4g}: {known.sum()} of {solved.sum()}"
            f" switches release above it; accepted are at least {FAILURE.fewest}; lower it, or"
            " device.hold_voltage_V"
        )
    process = Process(columns[known], reserves[known])
    return ReserveResponse(population, process, len(reserves), columns[known], reserves[known])


def corrected(
    response: ReserveResponse, times: float, hold_V: float, seed: int = 0, runs: int = FAILURE.runs
) -> Corrected:
    """Probability of a failure with `times` the attraction, the response corrected by so many
    runs.
    """
    sampled = response.sample(times, hold_V, seed, repeats=REPEATS)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 0xC0]))
    chosen = rng.permutation(len(sampled.points))[:runs]
    failed = response.population.failed(sampled.points[chosen], hold_V, times)
    return correct(sampled, failed, sampled.chance[chosen])


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


def least_spring(
    response: ReserveResponse, likely: Sampled, times: float, hold_V: float, allowed: float
) -> float | None:
    """Least spring, in the unit of its setting, all else varying, with which no more switches fail
    than allowed.

    A weaker spring makes those fail that nearly fail with more attraction. So some of `likely` are
    solved with other springs, and correct its probability as in `corrected`. None where even the
    largest of `FAILURE.springs` is too weak, or where none is likely.

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
        changed = population.settings.model_copy(
            update={population.spring: now * float(np.exp(logarithm))}
        )
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
    """Content of failure/failure.json and rows of failure/failure.csv.

    Parameters
    ----------
    allowed : share of the switches that may fail.

    Raises
    ------
    InputError : no switch of the population can be solved, or none lets go above the asked voltage.
    """
    hold = population.hold_V
    response = learn(population, tell)
    given = {
        (volts, times): response.rates(times, volts)
        for volts in voltages(population).tolist()
        for times in WORKS
    }
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
        law = f"{times:.2g} times the attraction"
        step = 0.8 / len(WORKS)
        tell(0.2 + number * step, law)
        share = np.array([row["failing_sure"] for row in rows if row["attraction"] == times])
        allowed_V = furthest_allowed(voltages(population), share, allowed)
        rates = response.rates(times, hold)
        failing = asdict(corrected(response, times, hold))
        tell(0.2 + (number + 0.2) * step, f"{law}, least spring")
        spring = least_spring(response, likely, times, hold, allowed)
        tell(0.2 + (number + 0.8) * step, f"{law}, largest hold voltage")
        laws.append(
            {
                "attraction": times,
                "failing": failing,
                "given_common": quantiles_of(rates),
                "sure": float(np.mean(rates <= allowed)),
                "largest_hold_V": allowed_V,
                "least_rms_nm": least_rms_nm(response, times, hold, allowed),
                "least_spring": spring,
                "there": (
                    None if allowed_V is None else asdict(corrected(response, times, allowed_V))
                ),
            }
        )
    # with the scene's own attraction, or where that never fails with the largest
    judged = next(
        (times for times in (1.0, WORKS[-1]) if response.sample(times, hold, 0).probability > 0.0),
        None,
    )
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
                {
                    "name": name,
                    "failing_if_known": response.sample(judged, hold, 0, (k, 0.0)).probability,
                }
                for k, name in enumerate(population.names)
                if judged is not None
            ),
            key=lambda row: row["failing_if_known"],
        ),
        "switches": response.switches,
    }, rows
