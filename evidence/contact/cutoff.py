"""What do the short-wave cut-off and the grid do to the outputs, on the same surfaces?

A surface of a seed has the same waves on every grid that resolves its cut-off, so its outputs differ by the grid alone.
A grid passes where twice as many sites a side change no mean by more than 2 % (d_c: of RMS) or a fifth of the deviation
between surfaces. All cycles have the same nominal pressure and the
paper's attraction.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, replace
from itertools import groupby, product
from typing import Any, NamedTuple

import numpy as np

from evidence.contact.draws import MIDDLE
from mesoscale.contact.energy import opening_stiffness, pull_off
from mesoscale.law.branches import fit_cycle
from mesoscale.law.parameters import OUTPUTS
from mesoscale.settings import ContactSettings
from mesoscale.uncertainty.runs import compute

INPUTS = {
    "middle": MIDDLE,  # of Table 1
    "hurst 0.46": replace(MIDDLE, hurst=0.46),
    "scans": replace(MIDDLE, hurst=0.42, rms=5.5),  # the synthetic scans of scene `reduced`
}
NAMES = (*OUTPUTS, "pull_off_nN", "opening_stiffness_nN_nm")
LARGEST_ERROR = 0.02  # of an output (of d_c and its change: in RMS heights), by which a grid is judged
SHARE_OF_SCATTER = 0.2  # or, where that is more, this share of the deviation between surfaces


ENDS = {0.1: "smooth", 1.6: "rough"}
"""Cut-offs (1/nm) whose pull-off is quoted."""


class Case(NamedTuple):
    """Surfaces that share all but the seed."""

    inputs: str
    mechanics: str
    length_nm: float
    q1_per_nm: float
    pixels: int


def plan() -> Iterator[tuple[Case, int]]:
    """The cases, each with its number of surfaces."""
    for name in ("middle", "hurst 0.46"):
        for q1, (pixels, seeds) in product((0.1, 0.2, 0.4, 0.8, 1.6, 3.2), ((256, 8), (512, 8), (1024, 4))):
            if q1 < ContactSettings(pixels=pixels).nyquist_per_nm:
                yield Case(name, "coupled", 1000.0, q1, pixels), seeds
                yield Case(name, "asperity", 1000.0, q1, pixels), 8
        for pixels, seeds in ((256, 8), (512, 8), (1024, 4)):  # the sites of 1024 and 2048 on a cell of 1000 nm
            yield Case(name, "coupled", 500.0, 0.4, pixels), seeds
    for q1, (pixels, seeds) in product((0.2, 0.38), ((256, 8), (512, 8), (1024, 4))):
        yield Case("scans", "coupled", 1000.0, q1, pixels), seeds


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """The means of each case, and what the next finer grid changes."""
    jobs = [(case, seed) for case, seeds in plan() for seed in range(1, seeds + 1)]
    with ProcessPoolExecutor() as pool:
        yield from summary(list(pool.map(_cycle, *zip(*jobs, strict=True))))


def _cycle(case: Case, seed: int) -> dict[str, Any]:
    force = ContactSettings().max_force_nN * (case.length_nm / ContactSettings().length_nm) ** 2
    settings = ContactSettings(**{key: value for key, value in case._asdict().items() if key != "inputs"})
    cycle = compute(
        asdict(INPUTS[case.inputs]), seed, settings.model_copy(update={"max_force_nN": force, "attraction": "clamped"})
    )
    values = np.full(len(NAMES), np.nan)
    if not isinstance(cycle, str):
        values = np.append(fit_cycle(cycle).outputs, [pull_off(cycle.opening), opening_stiffness(cycle.opening)])
    return {**case._asdict(), "seed": seed, **dict(zip(NAMES, values.tolist(), strict=True))}


def summary(cycles: Sequence[Mapping[str, Any]]) -> Iterator[dict[str, Any]]:
    """Rows of cycles (a mapping each: the fields of `Case`, the seed and `NAMES`)."""
    ordered = sorted(cycles, key=_case)
    grids = {case: {int(row["seed"]): _values(row) for row in part} for case, part in groupby(ordered, _case)}
    for case, surfaces in grids.items():
        finer = grids.get(case._replace(pixels=2 * case.pixels))
        row: dict[str, Any] = {**case._asdict(), "surfaces": len(surfaces)}
        row |= dict(zip(NAMES, np.nanmean(list(surfaces.values()), axis=0).tolist(), strict=True))
        change = scatter = np.full(len(NAMES), np.nan)
        if finer is not None:
            change, scatter = grid_error(case.inputs, surfaces, finer)
        row |= {f"change_{name}": value for name, value in zip(NAMES, change.tolist(), strict=True)}
        yield {**row, "passes": "" if finer is None else passes(change, scatter)}


def grid_error(
    inputs: str, coarse: Mapping[int, np.ndarray], fine: Mapping[int, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Change of the means from one grid to the next over the surfaces of both, shapes (quantities,).

    Returns
    -------
    relative : over the mean on the finer grid; of d_c and its change over the RMS height.
    scatter : over the deviation between the surfaces of the coarser grid.
    """
    common = sorted(set(coarse) & set(fine))
    before, after = (np.array([values[seed] for seed in common]) for values in (coarse, fine))
    change = np.abs(np.nanmean(before - after, axis=0))
    scale = np.abs(np.nanmean(after, axis=0))
    scale[[NAMES.index("d_c_nm"), NAMES.index("delta_d_c_nm")]] = INPUTS[inputs].rms
    deviation = np.nanstd(list(coarse.values()), axis=0, ddof=1)
    return change / scale, change / deviation


def passes(relative: np.ndarray, scatter: np.ndarray) -> bool:
    """Is the coarser grid good enough, in every quantity?"""
    return bool(np.all((relative <= LARGEST_ERROR) | (scatter <= SHARE_OF_SCATTER)))


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Pull-off (nN) by both mechanics at both ends of the cut-offs, and the grids that pass."""
    pull = {
        (row["mechanics"], float(row["q1_per_nm"])): f"{float(row['pull_off_nN']):.0f}"
        for row in rows
        if row["inputs"] == "middle" and row["pixels"] == "512" and float(row["length_nm"]) == 1000.0
    }
    judged = [row for row in rows if row["mechanics"] == "coupled" and float(row["q1_per_nm"]) <= 0.4]
    return {
        **{f"pull_off_{mechanics}_{ENDS[q1]}": text for (mechanics, q1), text in pull.items() if q1 in ENDS},
        **{
            f"passes_{pixels}": f"{sum(row['passes'] == 'True' for row in part)} of {len(part)}"
            for pixels in ("256", "512")
            if (part := [row for row in judged if row["pixels"] == pixels and row["passes"]])
        },
    }


def _case(row: Mapping[str, Any]) -> Case:
    """What cycles of one case share."""
    return Case(row["inputs"], row["mechanics"], float(row["length_nm"]), float(row["q1_per_nm"]), int(row["pixels"]))


def _values(row: Mapping[str, Any]) -> np.ndarray:
    return np.array([float(row[name] or "nan") for name in NAMES])
