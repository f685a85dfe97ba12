"""What it changes that asperities feel each other: the same surfaces and inputs by both mechanics of the contact."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact import Cycle
from mesoscale.contact.energy import opening_stiffness, pull_off
from mesoscale.law.branches import fit_cycle
from mesoscale.law.parameters import LAW_OUTPUTS
from mesoscale.settings import ContactSettings, LawSettings
from mesoscale.uncertainty.designs import SAMPLE_SEED, Run
from mesoscale.uncertainty.runs import compute

Array = NDArray[np.float64]

MECHANICS = ("asperity", "coupled")
RESAMPLES = 2000
FEWEST = 10
"""Pairs below which a row has no interval."""


@dataclass(frozen=True)
class Quantity:
    """What is compared."""

    name: str
    unit: str
    meaning: str
    any_sign: bool


QUANTITIES = (
    *(Quantity(row.name, row.unit, row.meaning, row.any_sign) for row in LAW_OUTPUTS),
    Quantity("pull_off_nN", "nN", "largest net attraction on opening", False),
    Quantity("opening_stiffness_nN_nm", "nN/nm", "fall of the repulsion to its half, over the way to there", False),
)
"""The outputs of Table 2, and what a switch depends on besides."""


def quantities(cycle: Cycle, law: LawSettings) -> Array:
    """The numbers of `QUANTITIES` of one cycle, shape (len(QUANTITIES),); NaN where there is none."""
    return np.append(fit_cycle(cycle, law).outputs, [pull_off(cycle.opening), opening_stiffness(cycle.opening)])


def pair_rows(
    runs: Sequence[Run],
    contact: ContactSettings,
    law: LawSettings,
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[dict[str, Any]]:
    """One row per run: inputs, seed, and by both mechanics the quantities, whether it converged, and its cost."""
    for mechanics in MECHANICS:  # loads the engine, so that its time is no cycle's
        compute(runs[0].values, runs[0].seed, contact.model_copy(update={"mechanics": mechanics}))
    for done, run in enumerate(runs):
        row: dict[str, Any] = {"run": run.index, "seed": run.seed, **run.values}
        for mechanics in MECHANICS:
            start = time.process_time()
            cycle = compute(run.values, run.seed, contact.model_copy(update={"mechanics": mechanics}))
            spent = time.process_time() - start
            failed = isinstance(cycle, str)
            values = np.full(len(QUANTITIES), np.nan) if failed else quantities(cycle, law)
            for quantity, value in zip(QUANTITIES, values.tolist(), strict=True):
                row[f"{mechanics}_{quantity.name}"] = value if np.isfinite(value) else ""
            row[f"{mechanics}_status"] = cycle if failed else "ok" if cycle.converged else "unconverged"
            row[f"{mechanics}_cpu_s"] = spent
        yield row
        if progress:
            progress((done + 1) / len(runs), f"{done + 1} of {len(runs)} pairs")


def shift_rows(rows: Sequence[Mapping[str, str]]) -> Iterator[dict[str, Any]]:
    """Rows of uq/model_form.csv from those of `pair_rows`, read from files.

    Pairs in which one of the two has no value are left out and counted.
    """
    cheap, dear = (float(_column(rows, f"{mechanics}_cpu_s").mean()) for mechanics in MECHANICS)
    for quantity in QUANTITIES:
        values = np.stack([_column(rows, f"{mechanics}_{quantity.name}") for mechanics in MECHANICS], axis=1)
        known = np.isfinite(values)
        pairs = values[known.all(axis=1)]
        count = len(pairs)
        row: dict[str, Any] = {"quantity": quantity.name, "unit": quantity.unit, "pairs": count}
        row |= {f"{name}_missing": int((~known[:, k]).sum()) for k, name in enumerate(MECHANICS)}
        rng = np.random.default_rng(np.random.SeedSequence([SAMPLE_SEED, 0x3F]))
        picks = rng.integers(count, size=(RESAMPLES, count)) if count >= FEWEST else np.empty((0, count), int)
        middle = pairs.mean(axis=0) if count else np.full(2, np.nan)
        spread = pairs.std(axis=0, ddof=1) if count > 1 else np.full(2, np.nan)
        for k, name in enumerate(MECHANICS):
            row |= {f"{name}_mean": middle[k], f"{name}_dev": spread[k]}
        shifts = pairs[:, 1] - pairs[:, 0]
        row |= _with_interval("shift", shifts.mean() if count else np.nan, shifts[picks].mean(axis=1))
        row["shift_over_dev"] = row["shift"] / spread[0] if spread[0] > 0 else np.nan
        ratio, ratios = np.nan, np.empty(0)
        if not quantity.any_sign and count and (pairs[:, 0] > 0).all():
            ratio = float(np.median(pairs[:, 1] / pairs[:, 0]))
            ratios = np.median((pairs[:, 1] / pairs[:, 0])[picks], axis=1)
        row |= _with_interval("ratio", ratio, ratios)
        alike = np.asarray(np.corrcoef(pairs.T)) if count > 1 and (spread > 0).all() else np.full((2, 2), np.nan)
        row["correlation"] = float(alike[0, 1])
        row["cost_ratio"] = dear / cheap
        yield {key: "" if isinstance(value, float) and not np.isfinite(value) else value for key, value in row.items()}


def _column(rows: Sequence[Mapping[str, str]], name: str) -> Array:
    return np.array([float(row[name]) if row[name] != "" else np.nan for row in rows])


def _with_interval(name: str, value: float, resampled: Array) -> dict[str, float]:
    """A number with its 90 % interval from resamples; no ends without them."""
    low, high = np.quantile(resampled, [0.05, 0.95]) if resampled.size else (np.nan, np.nan)
    return {name: float(value), f"{name}_low": float(low), f"{name}_high": float(high)}
