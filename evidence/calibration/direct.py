"""Does the posterior by responses equal that of Markov chains that call the engine at every step?

Two inputs are unknown, the Hamaker constant and RMS; the data are one first contact and one pull-off force of one
surface. The chain walks over inputs and surfaces together: every step proposes inputs near the last ones and a surface
that was never seen, computes its cycle, and accepts by the likelihood of the data on that very surface. Its inputs then
follow the exact posterior, whatever the distribution over surfaces (pseudo-marginal Metropolis: Andrieu and Roberts,
Ann. Stat. 37, 697, 2009, doi 10.1214/07-AOS574). As a second way, cycles over the prior are weighed by the same
likelihood.

The distance is Wasserstein's first. Its Monte Carlo error is what it would be on average, were the distributions equal.
"""

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import wasserstein_distance

from mesoscale.calibration.measurements import Measurements
from mesoscale.calibration.posterior import calibrate, cycles_of_rows, observe_runs
from mesoscale.calibration.sampling import sample
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.table import input_table
from mesoscale.settings import ContactSettings, DeviceSettings, InputRow, MeasurementsSettings
from mesoscale.uncertainty.designs import Run, random_runs

Array = NDArray[np.float64]

CONTACT = ContactSettings(pixels=128, attraction="clamped")
FREE = ("hamaker", "rms")
MIDDLE = {"e_star": 91.0, "h_macro": 1.95, "h_prime": 8.4, "q0": 0.025, "hurst": 0.75}
TRUTH = {**MIDDLE, "hamaker": 0.21, "rms": 6.0}
CONTACT_BEGIN_ERROR_NM, PULL_OFF_ERROR = 2.0, 0.3  # of the data; the second as a share
CHAINS, STEPS, BURN_IN = 8, 5000, 200
STEP = 0.35  # of a proposal, as a share of an input's range
FIRST_SURFACE = 2_000_000_000
PARTS, PART_RUNS, FIRST_WEIGHED = 10, 1000, 1_200_000_000
STATISTICS = {
    "mean": np.mean,
    "sd": np.std,
    "q05": partial(np.quantile, q=0.05),
    "q50": np.median,
    "q95": partial(np.quantile, q=0.95),
}


def rows(given: Any) -> Iterator[dict[str, Any]]:
    """Each statistic of each unknown input without and with responses."""
    seen, rng = observed(TRUTH, FIRST_SURFACE - 1), np.random.default_rng(4)
    begin = seen[0] + CONTACT_BEGIN_ERROR_NM * rng.standard_normal()
    data = np.array([begin, seen[1] * np.exp(PULL_OFF_ERROR * rng.standard_normal())])
    with ProcessPoolExecutor() as pool:
        chains = list(pool.map(partial(direct_chain, data), range(CHAINS)))
        parts = list(pool.map(partial(weighed_part, data), range(PARTS)))
    ours = by_responses(prior(), data)
    yield from compare("chains", [chain[BURN_IN:] for chain in chains], ours)
    yield from compare("weighed cycles", parts, ours)


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Largest difference of a mean in posterior deviations, and the distances in Monte Carlo errors."""
    of = {(row["way"], row["input"], row["quantity"]): row for row in rows}
    off = max(
        abs(float(row["responses"]) - float(row["direct"])) / float(of[way, name, "sd"]["direct"])
        for (way, name, quantity), row in of.items()
        if quantity == "mean"
    )
    distances = [float(row["difference_in_errors"]) for row in rows if row["quantity"] == "distance"]
    return {"mean_off": f"{off:.2f}", "distance": f"{min(distances):.1f} to {max(distances):.1f}"}


def prior() -> InputTable:
    """Table 1 with all inputs known but two."""
    return input_table(None, **{name: InputRow(distribution="fixed", values=(at,)) for name, at in MIDDLE.items()})


def observed(values: dict[str, float], seed: int) -> Array:
    """First contact (nm) and pull-off force (nN) of one surface; NaN where a cycle fails."""
    (row,) = observe_runs([Run(0, -1, seed, values)], CONTACT)
    return np.array([row["contact_begin_nm"], row["pull_off_nN"]])


def log_likelihood(seen: Array, data: Array) -> float:
    """Of the data given the surface on which they were measured; -inf where there is no cycle."""
    off = np.array([(data[0] - seen[0]) / CONTACT_BEGIN_ERROR_NM, np.log(data[1] / seen[1]) / PULL_OFF_ERROR])
    return -0.5 * float(off @ off) if np.isfinite(off).all() else -np.inf


def direct_chain(data: Array, number: int, steps: int = STEPS) -> Array:
    """Free inputs along one chain, shape (steps, 2)."""
    table = prior()
    ranges = table.ranges()[[table.names.index(name) for name in FREE]]
    here, value, chain = ranges.mean(axis=1), -np.inf, []
    for step in range(steps):
        rng = np.random.default_rng(np.random.SeedSequence([0xD1, number, step]))
        there = here + STEP * np.ptp(ranges, axis=1) * rng.standard_normal(len(FREE))
        chance = np.log(rng.random())
        if ((there > ranges[:, 0]) & (there < ranges[:, 1])).all():
            values = {**MIDDLE, **dict(zip(FREE, there.tolist(), strict=True))}
            proposed = log_likelihood(observed(values, FIRST_SURFACE + 10_000 * number + step), data)
            if not np.isfinite(value) or chance < proposed - value:
                here, value = there, proposed
        chain.append(here)
    return np.array(chain)


def weighed_part(data: Array, number: int, count: int = PART_RUNS) -> Array:
    """Free inputs of cycles over the prior, resampled by the likelihood of the data, shape (count, 2)."""
    runs = random_runs(prior(), number * count, (number + 1) * count, seed=91, first_surface=FIRST_WEIGHED)
    logs = np.array([log_likelihood(observed(run.values, run.seed), data) for run in runs])
    weights = np.exp(logs - logs.max())
    shares = (np.arange(count) + 0.5) / count  # systematic resampling adds next to no noise
    x = np.array([[run.values[name] for name in FREE] for run in runs])
    return x[np.searchsorted(np.cumsum(weights) / weights.sum(), shares)]


def by_responses(table: InputTable, data: Array) -> Array:
    """Free inputs by the product's own calibration with the same data, by chains long enough to add no error."""
    tables = [
        Measurements(kind, {kind: np.array([value]), f"{kind}_error": np.array([error])}, ("s",), False, 0.0, kind)
        for kind, value, error in (
            ("contact_begin", data[0], CONTACT_BEGIN_ERROR_NM),
            ("pull_off", data[1], PULL_OFF_ERROR * data[1]),
        )
    ]
    runs = random_runs(table, 0, 800, seed=3, first_surface=FIRST_SURFACE - 10_000)
    cycles = cycles_of_rows(observe_runs(runs, CONTACT), table.names)
    posterior = calibrate(table, tables, cycles, CONTACT, DeviceSettings(), MeasurementsSettings()).posterior
    chain = sample(lambda z: posterior.log_likelihood(posterior.inputs(z)), len(posterior.free), 400, 8000, 50000)
    if not chain.converged:
        raise RuntimeError(chain.reason)
    return posterior.inputs(chain.z)[:, [table.names.index(name) for name in FREE]]


def compare(way: str, parts: Sequence[Array], ours: Array) -> Iterator[dict[str, Any]]:
    """One row for each statistic of each input; the error is that of the mean over independent parts (s, 2) each."""
    for k, name in enumerate(FREE):
        column, every, inferred = [part[:, k] for part in parts], np.concatenate(parts)[:, k], ours[:, k]
        found = {
            quantity: (of(every), np.std([of(part) for part in column], ddof=1) / np.sqrt(len(column)), of(inferred))
            for quantity, of in STATISTICS.items()
        }
        found["distance"] = (0.0, _own_distance(column), wasserstein_distance(every, inferred))
        for quantity, (direct, error, inferred_value) in found.items():
            yield {
                "way": way,
                "input": name,
                "quantity": quantity,
                "direct": direct,
                "monte_carlo_error": error,
                "responses": inferred_value,
                "difference_in_errors": (inferred_value - direct) / error,
            }


def _own_distance(parts: Sequence[Array]) -> float:
    """Half the mean distance between halves of the parts, each of which has twice the variance of the whole."""
    apart = []
    for chosen in combinations(range(len(parts)), len(parts) // 2):
        sides = [np.concatenate([part for k, part in enumerate(parts) if (k in chosen) == side]) for side in (1, 0)]
        apart.append(wasserstein_distance(*sides))
    return float(np.mean(apart) / 2)
