"""The posterior by the responses against Markov chains that call the engine at every step, for two unknown inputs.

The direct chain walks over inputs and surfaces together: every step proposes inputs near the last ones and a surface
that was never seen, computes its cycle, and accepts by the likelihood of the data on that very surface. Its inputs then
follow the exact posterior, whatever the distribution over surfaces (pseudo-marginal Metropolis: Andrieu and Roberts,
Ann. Stat. 37, 697 (2009), doi 10.1214/07-AOS574). As a second way without responses, cycles over the prior are weighed
by the same likelihood.

`python -m mesoscale.calibration.studies.direct FOLDER` writes direct.csv there, and every chain as it goes on.
"""

import sys
from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import wasserstein_distance

from mesoscale.calibration.measurements import Measurements
from mesoscale.calibration.posterior import Cycles, calibrate, cycles_of_rows, observe_runs
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.table import input_table
from mesoscale.settings import (
    ContactSettings,
    DeviceSettings,
    InputRow,
    LawSettings,
    MeasurementsSettings,
    UncertaintySettings,
)
from mesoscale.tables import load_table, write_table
from mesoscale.uncertainty.designs import Run, random_runs

Array = NDArray[np.float64]

CONTACT = ContactSettings(pixels=128)
FREE = ("hamaker", "rms")
MIDDLE = {"e_star": 91.0, "h_macro": 1.95, "h_prime": 8.4, "q0": 0.025, "hurst": 0.75}
"""The inputs that are known."""
TRUTH = {**MIDDLE, "hamaker": 0.21, "rms": 6.0}
CONTACT_BEGIN_ERROR_NM, PULL_OFF_ERROR = 2.0, 0.3
"""Standard deviations of the data; the second as a share."""
CHAINS, STEPS, BURN_IN = 8, 5000, 200
STEP = 0.35
"""Of a proposal, as a share of an input's range."""
FIRST_SURFACE = 2_000_000_000
PARTS, PART_RUNS, FIRST_WEIGHED = 10, 1000, 1_200_000_000
"""Cycles that are weighed, each on a surface of its own, and how they are parted to know their Monte Carlo error."""
SETTINGS = MeasurementsSettings(max_steps=8000, walkers=400, samples=50000, response_error=0.1)
"""Many walkers and cycles: the errors of chain and responses stay small beside the Monte Carlo error of the others."""


def prior() -> InputTable:
    """Table 1 with all inputs known but two."""
    known = {name: InputRow(origin="literature", distribution="normal", a=a, b=0.0) for name, a in MIDDLE.items()}
    return input_table(None, **known)


def observed(values: dict[str, float], seed: int) -> Array:
    """First contact (nm) and pull-off force (nN) of one surface; NaN where a cycle fails."""
    (row,) = observe_runs([Run(0, -1, seed, values)], CONTACT, LawSettings())
    return np.array([row["contact_begin_nm"], row["pull_off_nN"]])


def log_likelihood(seen: Array, data: Array) -> float:
    """Of the data given the surface on which they were measured; -inf where there is no cycle."""
    off = np.array([(data[0] - seen[0]) / CONTACT_BEGIN_ERROR_NM, np.log(data[1] / seen[1]) / PULL_OFF_ERROR])
    return -0.5 * float(off @ off) if np.isfinite(off).all() else -np.inf


def direct_chain(table: InputTable, data: Array, number: int, path: Path) -> Array:
    """Free inputs along one chain, shape (STEPS, 2); steps that lie in the file are not computed again."""
    places = [table.names.index(name) for name in FREE]
    ranges = table.ranges(0.999)[places]
    known = [line.split() for line in path.read_text().splitlines(keepends=True)] if path.exists() else []
    known = [row for row in known if len(row) == len(FREE) + 2 and row[-1] == "."]  # a cut last line is computed again
    chain = [[float(value) for value in row[:-1]] for row in known]
    *here, value = chain[-1] if chain else [*ranges.mean(axis=1).tolist(), -np.inf]
    with path.open("w", encoding="utf-8") as stream:
        stream.writelines(" ".join(row) + "\n" for row in known)
        for step in range(len(chain), STEPS):
            rng = np.random.default_rng(np.random.SeedSequence([0xD1, number, step]))
            there = np.array(here) + STEP * np.ptp(ranges, axis=1) * rng.standard_normal(len(FREE))
            chance = np.log(rng.random())
            if ((there > ranges[:, 0]) & (there < ranges[:, 1])).all():
                surface = FIRST_SURFACE + 10_000 * number + step
                seen = observed({**MIDDLE, **dict(zip(FREE, there.tolist(), strict=True))}, surface)
                proposed = log_likelihood(seen, data)
                if not np.isfinite(value) or chance < proposed - value:
                    here, value = there.tolist(), proposed
            chain.append([*here, value])
            stream.write(" ".join(repr(number) for number in chain[-1]) + " .\n")
            stream.flush()
    return np.array(chain)[:, : len(FREE)]


def responses_posterior(table: InputTable, data: Array) -> Array:
    """Free inputs by the product's own calibration with the same data, shape (s, 2)."""
    specimen = ("s",)
    tables = [
        Measurements(kind, {kind: np.array([value]), f"{kind}_error": np.array([error])}, specimen, False, 0.0, kind)
        for kind, value, error in (
            ("contact_begin", data[0], CONTACT_BEGIN_ERROR_NM),
            ("pull_off", data[1], PULL_OFF_ERROR * data[1]),
        )
    ]
    runs = random_runs(table, UncertaintySettings(sample_seed=3), 0, 800, first_surface=FIRST_SURFACE - 10_000)
    cycles: Cycles = cycles_of_rows(observe_runs(runs, CONTACT, LawSettings()), table.names)
    result = calibrate(table, tables, cycles, CONTACT, LawSettings(), DeviceSettings(), SETTINGS)
    if result.reasons:
        raise RuntimeError(result.reasons[0])
    return result.x[:, [table.names.index(name) for name in FREE]]


def weighed_part(table: InputTable, data: Array, number: int, path: Path) -> Array:
    """Free inputs of cycles over the prior, resampled by the likelihood of the data, shape (PART_RUNS, 2)."""
    if not path.exists():
        first, last = number * PART_RUNS, (number + 1) * PART_RUNS
        runs = random_runs(table, UncertaintySettings(sample_seed=91), first, last, first_surface=FIRST_WEIGHED)
        write_table(
            path, observe_runs(runs, CONTACT, LawSettings()), columns=[*FREE, "contact_begin_nm", "pull_off_nN"]
        )
    rows = np.array([[float(value) for value in row.values()] for row in load_table(path)])
    logs = np.array([log_likelihood(seen, data) for seen in rows[:, len(FREE) :]])
    weights = np.exp(logs - logs.max())
    shares = (np.arange(len(rows)) + 0.5) / len(rows)  # systematic resampling adds next to no noise
    return rows[np.searchsorted(np.cumsum(weights) / weights.sum(), shares), : len(FREE)]


def compare(way: str, parts: Sequence[Array], ours: Array) -> list[dict[str, Any]]:
    """Mean, deviation and quantiles without and with responses, and the distance of the distributions, one row each.

    The Monte Carlo error is that of all parts, from their scatter. The distance is Wasserstein's first, in the input's
    unit; its Monte Carlo error is half of that between one half of the parts and the other, averaged over all ways to
    halve them: each half has twice the variance of the whole. It is what the distance would be on average, were the
    two distributions the same.

    Parameters
    ----------
    parts : draws without responses, independent of each other, shape (s, 2) each.
    ours : by the responses, shape (m, 2).
    """
    kinds = {
        "mean": np.mean,
        "sd": np.std,
        "q05": lambda v: np.quantile(v, 0.05),
        "q50": np.median,
        "q95": lambda v: np.quantile(v, 0.95),
    }
    rows = []
    for k, name in enumerate(FREE):
        column, every, inferred = [part[:, k] for part in parts], np.concatenate(parts)[:, k], ours[:, k]
        for quantity, of in kinds.items():
            error = float(np.std([of(part) for part in column], ddof=1) / np.sqrt(len(column)))
            off = float(of(inferred) - of(every))
            rows.append(_row(way, name, quantity, float(of(every)), error, float(of(inferred)), off))
        distance = float(wasserstein_distance(every, inferred))
        rows.append(_row(way, name, "distance", 0.0, _own_distance(column), distance, distance))
    return rows


def _own_distance(parts: Sequence[Array]) -> float:
    """Half the mean Wasserstein distance between one half of the parts and the other."""
    apart = []
    for chosen in combinations(range(len(parts)), len(parts) // 2):
        sides = [[part for k, part in enumerate(parts) if (k in chosen) == side] for side in (True, False)]
        apart.append(wasserstein_distance(*(np.concatenate(side) for side in sides)))
    return float(np.mean(apart) / 2)


def _row(
    way: str, name: str, quantity: str, direct: float, error: float, inferred: float, off: float
) -> dict[str, Any]:
    return {
        "way": way,
        "input": name,
        "quantity": quantity,
        "direct": direct,
        "monte_carlo_error": error,
        "responses": inferred,
        "difference_in_errors": off / error,
    }


def main(folder: Path) -> None:
    """All ways on the same made-up data."""
    folder.mkdir(parents=True, exist_ok=True)
    table = prior()
    seen = observed(TRUTH, FIRST_SURFACE - 1)
    rng = np.random.default_rng(4)
    data = np.array(
        [
            seen[0] + CONTACT_BEGIN_ERROR_NM * rng.standard_normal(),
            seen[1] * np.exp(PULL_OFF_ERROR * rng.standard_normal()),
        ]
    )
    chains = [direct_chain(table, data, number, folder / f"chain_{number}.txt") for number in range(CHAINS)]
    parts = [weighed_part(table, data, number, folder / f"cycles_{number}.csv") for number in range(PARTS)]
    ours = responses_posterior(table, data)
    rows = compare("chains", [chain[BURN_IN:] for chain in chains], ours)
    write_table(folder / "direct.csv", rows + compare("weighed cycles", parts, ours))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
