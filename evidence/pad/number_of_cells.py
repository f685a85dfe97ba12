"""How does the net adhesive pressure of a pad fall with its number of cells?

Pads of up to an eighth of the computed cells are groups of them. Larger ones are extrapolated: the deepest point of a
noisy mean is too deep by an amount that falls as 1/n (half samples of the cells against all of them), and a pad of N
cells differs from the mean by the scatter of groups, which falls as 1/sqrt(N). `low_kPa` and `high_kPa` hold 90 % of
the pads; `standard_error_kPa` is that of the mean over pads. The attraction is `offset` with D0 0.3 nm. Cells of 128²
are cheap, so that thousands tell what 64 leave open.

For hard tops the excess of n cells falls more slowly than 1/n: 16,384 cells gave 0.6 kPa where groups of 16, 64, 256,
1024 and 4096 of them gave 7.3, 3.2, 1.7, 1.0 and 0.8. So the mean of 64 with half samples (1.7 kPa) is too large, too.
Tried and left out: a Gaussian tail of repulsion and near attraction beyond what the cells sample. From 64 cells it
scatters over two decades.

Tried and left out: cells of one height cannot stand for those of all heights. A cell that touches far out does so with
one tall asperity, so a mean made of shifted curves has 2 to 5 times the repulsion of computed cells.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.cells import FIRST_SEED, PadGrid, close_cells, plan_grid
from mesoscale.pad.curves import PadCells, assemble, deepest_net_GPa
from mesoscale.settings import ContactSettings, PadGridSettings

Array = NDArray[np.float64]

INPUTS = ContactInputs(hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5)
LOADS_MPa = (2.0, 6.6)
PIXELS = 128
HARD_GPa = 9.5
"""Of tops made of atoms (docs/hardness.md), at all sizes; the others have eq. 4."""
SIZES = (1, 2, 4, 8, 16, 32, 64, 128, 256, 1000, 10_000, 100_000)
FEWEST_GROUPS = 8
SPLITS = 40
BLOCKS = 16
WITHIN_90 = 1.645
"""Half-width of a normal 90 % interval in deviations."""


def arguments(parser: ArgumentParser) -> None:
    """Options on the command line."""
    parser.add_argument("--cells", type=int, default=4096)
    parser.add_argument("--mechanics", nargs="+", default=["asperity", "coupled", "hard"], help="hard: coupled")


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each mechanics, load and number of cells."""
    for name in given.mechanics:
        mechanics = "coupled" if name == "hard" else name
        contact = ContactSettings.model_validate({"mechanics": mechanics, "pixels": PIXELS, "gap_cutoff_nm": 0.3})
        inputs = replace(INPUTS, h_macro=HARD_GPa, h_prime=0.0) if name == "hard" else INPUTS
        grid = opened_grid(inputs, contact)
        cells = close_cells(inputs, contact, grid, range(FIRST_SEED, FIRST_SEED + given.cells))
        yield from adhesion_rows(name, assemble(grid, list(cells), contact.length_nm**2))


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Net adhesive pressure of one cell and of a large pad, closed to the larger load."""
    found = {}
    for row in table:
        if row["load_MPa"] == "6.6" and row["cells"] in ("1", "64", "100000"):
            key = f"{row['mechanics']}_{row['cells']}"
            found[key] = f"{float(row['net_adhesion_kPa']):.2g} kPa"
            found[f"{key}_range"] = f"{float(row['low_kPa']):.2g} to {float(row['high_kPa']):.2g} kPa"
    return found


def opened_grid(inputs: ContactInputs, contact: ContactSettings, pilot_cells: int = 32) -> PadGrid:
    """Separations of the pad, opened from those at which pilot cells carry the loads."""
    settings = PadGridSettings(pilot_cells=pilot_cells, depths=2)
    largest_GPa = max(LOADS_MPa) * 1e-3
    grid = plan_grid(inputs, contact, settings, lambda separation: np.full_like(separation, largest_GPa))
    shut = PadGrid(grid.separation_nm, np.empty(0, int))
    seeds = range(FIRST_SEED, FIRST_SEED + pilot_cells)
    pilots = assemble(shut, list(close_cells(inputs, contact, shut, seeds)), contact.length_nm**2)
    repelled = pilots.closing[:, 0].mean(axis=0) * 1e3
    depths = np.array([int(np.argmax(repelled >= load)) for load in LOADS_MPa])
    return PadGrid(shut.separation_nm[: depths.max() + 1], depths)


def deepest_kPa(net: Array) -> float:
    """Largest net adhesive pressure of the mean of some cells, shape (cells, n); 0 where they only push."""
    return max(float(deepest_net_GPa(net.mean(axis=0))), 0.0) * 1e6


def whole_and_halves(net: Array) -> tuple[float, float]:
    """Deepest point of the mean of all cells, and the mean of those of random halves (kPa)."""
    rng = np.random.default_rng(np.random.SeedSequence([0x4A1F]))
    half, halves = len(net) // 2, []
    for _ in range(SPLITS):
        order = rng.permutation(len(net))
        halves += [deepest_kPa(net[order[:half]]), deepest_kPa(net[order[half : 2 * half]])]
    return deepest_kPa(net), float(np.mean(halves))


def extrapolated(depths_kPa: tuple[float, float], count: int, cells: float) -> float:
    """Mean over pads of so many cells from `whole_and_halves` of `count` cells (kPa)."""
    whole, halves = depths_kPa
    return max(whole - (halves - whole) * (1.0 - count / cells), 0.0)


def adhesion_rows(mechanics: str, cells: PadCells) -> Iterator[dict[str, Any]]:
    """Deepest net pressure on opening against the number of cells of a pad, for each load."""
    for k, load in enumerate(LOADS_MPa):
        net = cells.opening[:, k].sum(axis=1)
        net = net[:, np.isfinite(net).all(axis=0)]
        depths = whole_and_halves(net)
        parts = np.array_split(np.arange(cells.count), BLOCKS)
        without = [(cells.count - len(part), whole_and_halves(np.delete(net, part, axis=0))) for part in parts]
        closed = float(cells.closing[:, 0, cells.grid.depths[k]].mean() * 1e3)
        largest, spread = 1, 0.0
        for size in SIZES:
            groups = cells.count // size
            if groups >= FEWEST_GROUPS:
                pads = np.array([deepest_kPa(part) for part in np.array_split(net[: groups * size], groups)])
                mean, (low, high) = float(pads.mean()), np.quantile(pads, [0.05, 0.95])
                largest, spread = size, float(pads.std(ddof=1))
                error, method = spread / groups**0.5, "groups"
            else:
                mean = extrapolated(depths, cells.count, size)
                others = np.array([extrapolated(left, count, size) for count, left in without])
                error = float(np.sqrt((BLOCKS - 1) * np.mean((others - others.mean()) ** 2)))
                width = WITHIN_90 * float(np.hypot(error, spread * (largest / size) ** 0.5))
                low, high, method = max(mean - width, 0.0), mean + width, "extrapolated"
            yield {
                "mechanics": mechanics,
                "load_MPa": load,
                "closed_to_MPa": closed,
                "cells": size,
                "method": method,
                "net_adhesion_kPa": mean,
                "low_kPa": float(low),
                "high_kPa": float(high),
                "standard_error_kPa": error,
                "computed_cells": cells.count,
            }
