"""Mean pressure of a pad against separation, from its cells, and what the number of cells does to it.

Two uncertainties are kept apart. The *estimate's* error falls with the number of cells that are computed. The *pad's*
own scatter falls with the number of cells that a pad has; another pad of the same film differs by it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.displacement import Displacement
from mesoscale.errors import InputError
from mesoscale.pad.cells import PadGrid

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PadCells:
    """Pressures of all computed cells at the separations they share; far to near.

    Attributes
    ----------
    grid : separations and depths.
    first_contact_nm : first contact of each cell, shape (cells,).
    closing : repulsive and attractive pressure (GPa, attraction negative), shape (cells, 2, n).
    opening : the same while opening from each depth, shape (cells, k, 2, n); NaN below the depth.
    settled : whether flow came to rest in each cell, shape (cells,).
    """

    grid: PadGrid
    first_contact_nm: Array
    closing: Array
    opening: Array
    settled: NDArray[np.bool_]

    @property
    def count(self) -> int:
        """Number of cells."""
        return len(self.first_contact_nm)


def assemble(grid: PadGrid, cells: Sequence[Displacement], cell_area_nm2: float) -> PadCells:
    """The cells of a pad from what closing each of them gave."""
    return PadCells(
        grid,
        np.array([cell.first_contact_nm for cell in cells]),
        np.array([cell.closing for cell in cells]) / cell_area_nm2,
        np.array([cell.opening for cell in cells]) / cell_area_nm2,
        np.array([cell.settled for cell in cells]),
    )


def deepest_net_GPa(net: Array) -> Array:
    """Largest net adhesive pressure (positive) of opening curves, shape (..., n) to (...)."""
    return -np.nanmin(net, axis=-1)


def adhesion_by_cells(cells: PadCells, sizes: Sequence[int], seed: int = 0) -> list[dict[str, Any]]:
    """Rows of pad/adhesion.csv: deepest net pressure of a pad against its number of cells, for each depth.

    Pads of up to half the computed cells are disjoint groups of them. The last row of a depth is the mean of all
    computed cells; its bias (the deepest point of a noisy curve is too deep) is taken off by half samples,
    2 m(n) - m(n/2), and its error is a bootstrap over cells.

    Raises
    ------
    InputError : fewer than eight cells.
    """
    if cells.count < 8:
        raise InputError(f"pad.cells = {cells.count}: accepted are at least 8 cells")
    rng = np.random.default_rng(np.random.SeedSequence([seed, 0x9AD]))
    order = rng.permutation(cells.count)
    rows = []
    for k, depth in enumerate(cells.grid.depth_nm):
        net = cells.opening[:, k].sum(axis=1)[order]
        closed_MPa = float(cells.closing[:, :, cells.grid.depths[k]].sum(axis=1).mean() * 1e3)
        for size in (size for size in sizes if size <= cells.count // 2):
            groups = net[: cells.count // size * size].reshape(-1, size, net.shape[-1]).mean(axis=1)
            pull_offs = deepest_net_GPa(groups) * 1e6
            scatter = float(pull_offs.std(ddof=1))
            rows.append(
                _adhesion_row(
                    depth, closed_MPa, size, "groups", float(pull_offs.mean()), scatter, scatter / len(pull_offs) ** 0.5
                )
            )
        whole = float(deepest_net_GPa(net.mean(axis=0))) * 1e6
        halves = deepest_net_GPa(net[: cells.count // 2 * 2].reshape(2, -1, net.shape[-1]).mean(axis=1)) * 1e6
        picks = rng.integers(cells.count, size=(200, cells.count))
        resampled = np.array([deepest_net_GPa(net[pick].mean(axis=0)) for pick in picks]) * 1e6
        corrected = max(2.0 * whole - float(halves.mean()), 0.0)
        rows.append(
            _adhesion_row(depth, closed_MPa, cells.count, "all, bias taken off", corrected, 0.0, float(resampled.std()))
        )
    return rows


def _adhesion_row(
    depth: float, closed_MPa: float, size: int, method: str, mean: float, scatter: float, error: float
) -> dict[str, Any]:
    return {
        "depth_nm": float(depth),
        "closed_to_MPa": closed_MPa,
        "cells": size,
        "method": method,
        "net_adhesion_kPa": mean,
        "pad_scatter_kPa": scatter,
        "standard_error_kPa": error,
    }


def curve_rows(cells: PadCells) -> list[dict[str, Any]]:
    """Rows of pad/curves.csv: mean pressures of the cells against separation, closing and opening from each depth."""
    rows = _branch_rows(cells, "closing", None, cells.closing)
    for k, depth in enumerate(cells.grid.depth_nm):
        rows += _branch_rows(cells, "opening", float(depth), cells.opening[:, k])
    return rows


def _branch_rows(cells: PadCells, branch: str, depth: float | None, pressures: Array) -> list[dict[str, Any]]:
    mean = pressures.mean(axis=0)
    error = pressures.sum(axis=1).std(axis=0, ddof=1) / cells.count**0.5
    return [
        {
            "branch": branch,
            "depth_nm": depth,
            "separation_nm": float(separation),
            "repulsive_MPa": float(mean[0, place] * 1e3),
            "attractive_MPa": float(mean[1, place] * 1e3),
            "net_kPa": float(mean[:, place].sum() * 1e6),
            "standard_error_kPa": float(error[place] * 1e6),
        }
        for place, separation in enumerate(cells.grid.separation_nm)
        if np.isfinite(mean[0, place])
    ]
