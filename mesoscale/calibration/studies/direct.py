"""The posterior by the responses against Markov chains that call the engine at every step, for two unknown inputs.

The direct chain walks over inputs and surfaces together: every step proposes inputs near the last ones and a surface
that was never seen, computes its cycle, and accepts by the likelihood of the data on that very surface. Its inputs then
follow the exact posterior, whatever the distribution over surfaces (pseudo-marginal Metropolis: Andrieu and Roberts,
Ann. Stat. 37, 697 (2009), doi 10.1214/07-AOS574).

`python -m mesoscale.calibration.studies.direct FOLDER` writes direct.csv there, and every chain as it goes on.
"""

import csv
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
from mesoscale.uncertainty.designs import Run, random_runs

Array = NDArray[np.float64]

CONTACT = ContactSettings(pixels=128)
FREE = ("hamaker", "rms")
MIDDLE = {"e_star": 91.0, "h_macro": 1.95, "h_prime": 8.4, "q0": 0.025, "hurst": 0.75}
"""The inputs that are known."""
TRUTH = {**MIDDLE, "hamaker": 0.21, "rms": 6.0}
CONTACT_BEGIN_ERROR_NM, PULL_OFF_ERROR = 2.0, 0.3
"""Standard deviations of the data; the second as a share."""
CHAINS, STEPS, BURN_IN = 4, 2500, 100
STEP = 0.35
"""Of a proposal, as a share of an input's range."""
FIRST_SURFACE = 2_000_000_000


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
    """Free inputs along one chain, shape (STEPS, 2); what lies in the file is not computed again."""
    if not path.exists():
        rng = np.random.default_rng(np.random.SeedSequence([0xD1, number]))
        places = [table.names.index(name) for name in FREE]
        ranges = table.ranges(0.999)[places]
        here, value = ranges.mean(axis=1), -np.inf
        chain = np.empty((STEPS, len(FREE)))
        for step in range(STEPS):
            there = here + STEP * np.ptp(ranges, axis=1) * rng.standard_normal(len(FREE))
            chance = np.log(rng.random())
            if ((there > ranges[:, 0]) & (there < ranges[:, 1])).all():
                seen = observed(
                    {**MIDDLE, **dict(zip(FREE, there.tolist(), strict=True))},
                    FIRST_SURFACE + 10_000 * number + step,
                )
                proposed = log_likelihood(seen, data)
                if not np.isfinite(value) or chance < proposed - value:
                    here, value = there, proposed
            chain[step] = here
        np.savetxt(path, chain)
    return np.loadtxt(path)


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
    result = calibrate(
        table, tables, cycles, CONTACT, LawSettings(), DeviceSettings(), MeasurementsSettings(max_steps=8000)
    )
    if result.reasons:
        raise RuntimeError(result.reasons[0])
    return result.x[:, [table.names.index(name) for name in FREE]]


def compare(chains: Sequence[Array], ours: Array) -> list[dict[str, Any]]:
    """Mean, deviation and quantiles by both ways, with the Monte Carlo error of the direct chains, one row each."""
    halves = [half for chain in chains for half in np.array_split(chain[BURN_IN:], 2)]
    kinds = {
        "mean": np.mean,
        "sd": np.std,
        "q05": lambda v: np.quantile(v, 0.05),
        "q50": np.median,
        "q95": lambda v: np.quantile(v, 0.95),
    }
    rows = []
    for k, name in enumerate(FREE):
        for quantity, of in kinds.items():
            parts = np.array([of(half[:, k]) for half in halves])
            direct = float(of(np.concatenate(halves)[:, k]))
            error = float(parts.std(ddof=1) / np.sqrt(len(parts)))
            value = float(of(ours[:, k]))
            rows.append(
                {
                    "input": name,
                    "quantity": quantity,
                    "direct": direct,
                    "monte_carlo_error": error,
                    "responses": value,
                    "difference_in_errors": (value - direct) / error,
                }
            )
    return rows


def main(folder: Path) -> None:
    """Both ways on the same made-up data."""
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
    rows = compare(chains, responses_posterior(table, data))
    with (folder / "direct.csv").open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
