"""How well does the likelihood fit of eq. 9 return the truth of synthetic scans?

Sets of 8 scans of 1 um and 3 of 10 um, 1024 x 1024 pixels, with random roll-off, slope, RMS height, tip, noise, line
offsets, tilt, drift and digital steps. The analysis is told a tip radius that is wrong by up to 20 %. An estimate is
near where q0 is within 20 %, the slope within 0.15 and the RMS height within 5 % of the truth.

The rows kept were made before the discrepancy of 4 % was confined to waves beyond the knee: the likelihood's interval
of q0 was then a fifth wider.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import Any

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.description.parameters import analyse
from mesoscale.topography.description.trusted_range import trusted_scan
from mesoscale.topography.synthetic_scans import ScanSet, synthetic_scans

NEAR = {"q0": 0.20, "slope": 0.15, "rms": 0.05}  # relative for q0 and rms, absolute for the slope
TIP_ERROR = 0.2


def arguments(parser: argparse.ArgumentParser) -> None:
    """Sets of scans."""
    parser.add_argument("--sets", type=int, default=50, help="half a minute each on one core")


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """One row for each set: truth, estimate, interval."""
    with ProcessPoolExecutor() as pool:
        yield from pool.map(set_row, range(given.sets))


def random_truth(number: int, base: ScanSet) -> tuple[ScanSet, float]:
    """Truth and artefacts of set `number`, and the tip radius (nm) that the analysis is told."""
    rng = np.random.default_rng(np.random.SeedSequence(base.seed, spawn_key=(99, number)))
    tip = float(rng.uniform(2, 10))
    truth = base.model_copy(
        update={
            "seed": int(rng.integers(2**31)),
            "q0": float(rng.uniform(0.015, 0.035)),
            "slope": float(rng.uniform(2.2, 3.8)),
            "rms_nm": float(np.exp(rng.uniform(np.log(2), np.log(12)))),
            "tip_radius_nm": tip,
            "noise_nm": float(rng.uniform(0.02, 0.1)),
            "line_noise_nm": float(rng.uniform(0, 0.5)),
            "tilt_deg": float(rng.uniform(0, 2)),
            "drift_nm": float(rng.uniform(0, 10)),
            "step_nm": float(rng.uniform(0.002, 0.05)),
        }
    )
    return truth, tip * float(rng.uniform(1 - TIP_ERROR, 1 + TIP_ERROR))


def set_row(number: int) -> dict[str, Any]:
    """The row of one set."""
    truth, told = random_truth(number, ScanSet(rms_variation=0.0))
    settings = TopographySettings(tip_radius_nm=told)
    result = analyse([trusted_scan(item.scan, settings) for item in synthetic_scans(truth)], settings)
    row: dict[str, Any] = {"set": number, "tip_radius_nm": truth.tip_radius_nm, "told_tip_radius_nm": told}
    row["gate"] = "; ".join(reason for reason in result.reasons if not reason.startswith("H ="))
    for name, value in (("q0", truth.q0), ("slope", truth.slope), ("rms", truth.rms_nm)):
        estimate = result.estimates.get(name)
        low, high = estimate.interval if estimate else ("", "")
        row |= {f"{name}_true": value, name: estimate.value if estimate else "", f"{name}_low": low}
        row[f"{name}_high"] = high
    return row


def errors_of(rows: Sequence[Mapping[str, str]], name: str) -> tuple[np.ndarray, np.ndarray]:
    """Error of each estimate, relative but for the slope, and whether its interval holds the truth."""
    columns = (f"{name}_true", name, f"{name}_low", f"{name}_high")
    true, value, low, high = np.array([[float(row[key]) for key in columns] for row in rows if row[name]]).T
    return value - true if name == "slope" else value / true - 1, (low <= true) & (true <= high)


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """The shares of estimates near the truth, and those whose 90 % interval holds it."""
    found = {"sets": str(len(rows))}
    for name, near in NEAR.items():
        error, held = errors_of(rows, name)
        found[f"{name}_near"] = f"{np.mean(np.abs(error) <= near):.0%}"
        found[f"{name}_held"] = f"{np.mean(held):.0%}"
    return found
