"""What the short-wave cut-off and the grid do to the outputs, on the same surfaces.

`scene_rows` are those of a scene, about its own cut-off and grid. A wider study at fixed inputs:

python -m mesoscale.uncertainty.studies.cutoff FILE.csv         cycles that FILE lacks are computed and added to it
python -m mesoscale.uncertainty.studies.cutoff FILE.csv show    tables of the means and of the errors of the grids

A surface of a seed has the same waves on every grid that resolves its cut-off, so its outputs differ by the grid alone.
"""

import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from mesoscale.contact.studies.stability import MIDDLE
from mesoscale.settings import ContactSettings, LawSettings
from mesoscale.tables import grow_table, load_table
from mesoscale.uncertainty.model_form import QUANTITIES, quantities
from mesoscale.uncertainty.runs import compute

INPUTS = {
    "middle": MIDDLE,  # of Table 1
    "hurst 0.46": replace(MIDDLE, hurst=0.46),
    "scans": replace(MIDDLE, hurst=0.42, rms=5.5),  # the synthetic scans of scene `reduced`
}
NAMES = tuple(quantity.name for quantity in QUANTITIES)
COLUMNS = ("inputs", "mechanics", "length_nm", "q1_per_nm", "pixels", "seed", *NAMES, "status", "cpu_s")
LARGEST_ERROR = 0.02  # of an output (of d_c and its change: in RMS heights), by which a grid is judged
SHARE_OF_SCATTER = 0.2  # or, where that is more, this share of the deviation between surfaces


class Cycles(NamedTuple):
    """Cycles on the surfaces 1 to `seeds`, all under the same nominal pressure."""

    inputs: str
    mechanics: str
    q1: float
    pixels: int
    seeds: int
    length: float = 1000.0


def plan() -> Iterator[Cycles]:
    """The cycles, those that decide first."""
    for q1 in (0.2, 0.38):
        for pixels, seeds in ((256, 8), (512, 8), (1024, 4)):
            yield Cycles("scans", "coupled", q1, pixels, seeds)
    for name in ("middle", "hurst 0.46"):
        for pixels, seeds in ((256, 8), (512, 8), (1024, 4)):
            yield Cycles(name, "coupled", 0.4, pixels, seeds)
    for q1 in (0.1, 0.2, 0.8, 1.6, 3.2):
        for name in ("middle", "hurst 0.46"):
            for pixels, seeds in ((256, 8), (512, 8), (1024, 3)):
                if q1 < ContactSettings(pixels=pixels).nyquist_per_nm:
                    yield Cycles(name, "coupled", q1, pixels, seeds)
    for name in ("middle", "hurst 0.46"):
        for q1 in (0.1, 0.2, 0.4, 0.8, 1.6, 3.2):
            for pixels, seeds in ((512, 8), (1024, 8), (2048, 4)):
                if q1 < ContactSettings(pixels=pixels).nyquist_per_nm:
                    yield Cycles(name, "asperity", q1, pixels, seeds)
    for name in ("middle", "hurst 0.46"):  # the sites of 1024 and 2048 on a cell of 1000 nm
        for pixels, seeds in ((256, 8), (512, 8), (1024, 4)):
            yield Cycles(name, "coupled", 0.4, pixels, seeds, 500.0)


def cycle_rows(known: Sequence[Mapping[str, str]]) -> Iterator[dict[str, Any]]:
    """Rows of the planned cycles that are not among those known."""
    done = {(*_case(row), int(row["pixels"]), int(row["seed"])) for row in known}
    law = LawSettings()
    compute(asdict(MIDDLE), 1, ContactSettings(mechanics="coupled", pixels=64, max_force_nN=30.0))  # loads the engine
    for name, mechanics, q1, pixels, seeds, length in plan():
        given = {"mechanics": mechanics, "q1_per_nm": q1, "pixels": pixels, "length_nm": length}
        force = ContactSettings().max_force_nN * (length / ContactSettings().length_nm) ** 2
        settings = ContactSettings.model_validate({**given, "max_force_nN": force})
        for seed in range(1, seeds + 1):
            if (name, mechanics, length, q1, pixels, seed) in done:
                continue
            start = time.process_time()
            cycle = compute(asdict(INPUTS[name]), seed, settings)
            spent = time.process_time() - start
            row: dict[str, Any] = {"inputs": name, **given, "seed": seed}
            if isinstance(cycle, str):
                row["status"] = cycle
            else:
                row |= {name: f"{value:.7g}" for name, value in zip(NAMES, quantities(cycle, law), strict=True)}
                row["status"] = "ok" if cycle.converged else "unconverged"
            yield row | {"cpu_s": round(spent, 3)}


def show(rows: Sequence[Mapping[str, str]]) -> Iterator[str]:
    """Lines: for each cut-off and grid the means, and what the next finer grid changes on the surfaces of both."""
    groups: dict[tuple[str, str, float, float], dict[int, dict[int, np.ndarray]]] = {}
    cost: dict[tuple[str, str, float, float, int], list[float]] = {}
    for row in rows:
        values = np.array([float(row[name] or "nan") for name in NAMES])
        groups.setdefault(_case(row), {}).setdefault(int(row["pixels"]), {})[int(row["seed"])] = values
        cost.setdefault((*_case(row), int(row["pixels"])), []).append(float(row["cpu_s"]))
    yield "mean over surfaces: " + ", ".join(NAMES)
    for case, grids in sorted(groups.items()):
        words = _words(case)
        for pixels, surfaces in sorted(grids.items()):
            means = " ".join(f"{value:10.3e}" for value in np.nanmean(list(surfaces.values()), axis=0))
            spent = float(np.median(cost[*case, pixels]))
            yield f"{words} {pixels:5} ({len(surfaces)}, {spent:6.2f} s) {means}"
    yield "change from a grid to the next: share of the output (d_c: of RMS) / of the deviation between surfaces"
    for case, grids in sorted(groups.items()):
        for coarse, fine in pairwise(sorted(grids)):
            common = sorted(set(grids[coarse]) & set(grids[fine]))
            change, scatter = grid_error(case[0], grids[coarse], grids[fine])
            verdict = "passes" if passes(change, scatter) else "fails"
            parts = " ".join(f"{100 * a:6.1f}/{100 * b:4.0f}" for a, b in zip(change, scatter, strict=True))
            yield f"{_words(case)} {coarse:4} to {fine:4} ({len(common)}) {parts} % {verdict}"


def _case(row: Mapping[str, str]) -> tuple[str, str, float, float]:
    """What rows of one surface share on all grids: inputs, mechanics, side and cut-off."""
    return row["inputs"], row["mechanics"], float(row["length_nm"]), float(row["q1_per_nm"])


def _words(case: tuple[str, str, float, float]) -> str:
    inputs, mechanics, length, q1 = case
    return f"{inputs:10} {mechanics:8} {length:4g} nm q1 {q1:4}"


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


def main() -> None:
    """Compute what the file lacks, or show what it has."""
    file = Path(sys.argv[1])
    known = load_table(file)
    if sys.argv[2:] == ["show"]:
        for line in show(known):
            print(line)
        return
    grow_table(file, cycle_rows(known), columns=COLUMNS)


if __name__ == "__main__":
    main()
