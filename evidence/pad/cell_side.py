"""How long must cells be, so that the waves of a film that are longer do not matter?

Pads of equal area on one film, of cells of different sides, drive the switch of a finished scene
with measured scans, at central inputs. All places have the same RMS height, so that pads of few
cells compare. Repeats have other surfaces.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from evidence.record import load_table
from mesoscale.answer.points import Point
from mesoscale.answer.switches import solve_point
from mesoscale.inputs.table import from_rows
from mesoscale.pad.cells import FIRST_SEED
from mesoscale.settings import ContactSettings
from mesoscale.topography.pooling import Pooled, pool
from mesoscale.topography.records import in_order
from workflow.files.results import load_h5
from workflow.scene import Scene, load_scene

APART = 10_000_000
"""Between the surfaces of two repeats."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Which scene, and which cells."""
    parser.add_argument("--scene", default="diamond")
    parser.add_argument(
        "--sides", type=float, nargs="+", default=[1000.0, 2000.0, 4000.0, 8000.0], help="nm"
    )
    parser.add_argument(
        "--spacings", type=float, nargs="+", default=[7.8125], help="of grid points, nm"
    )
    parser.add_argument("--area", type=float, default=512.0, help="of a pad, um^2")
    parser.add_argument("--repeats", type=int, default=3)


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """The release of each pad."""
    scene, results = load_scene(given.scene), Path("results") / given.scene
    medians = from_rows(load_table(results / "pad/inputs.csv")).medians()
    for side in given.sides:
        described = _described(results, scene, side)
        height = described.film["rms"]
        values = {**medians, "rms": 0.5 * (height["a"] + height["b"]), "rms_scatter": 0.0}
        for spacing in given.spacings:
            grid_points = {"pixels": round(side / spacing), "surface": described.surface}
            contact = ContactSettings(**dict(scene.contact) | grid_points).on_cell(side)
            point = Point(values, contact.gap_cutoff_nm, scene.device)
            count = round(given.area / (side / 1000.0) ** 2)
            for repeat in range(given.repeats):
                solved = solve_point(point, contact, count, FIRST_SEED + APART * repeat)
                opening = (
                    solved.pad.curves.opening[0].sum(axis=0) if solved.pad else np.array([np.nan])
                )
                yield {
                    "scene": given.scene,
                    "side_nm": side,
                    "spacing_nm": spacing,
                    "cells": count,
                    "repeat": repeat,
                    "rms_nm": values["rms"],
                    "release_V": solved.states.release_V if solved.states else np.nan,
                    "pull_off_kPa": -1e6 * float(np.nanmin(opening)),
                }


def _described(results: Path, scene: Scene, side_nm: float) -> Pooled:
    """The film as cells of a side have it, from the spectra of a finished scene."""
    arrays, attributes = {}, {}
    for path in sorted((results / "topography/spectra").glob("chunk_*.h5")):
        groups, _, described = load_h5(path)
        arrays.update(groups)
        attributes.update(described)
    return pool(in_order(arrays, attributes), attributes, scene.topography, side_nm, cut_off=True)


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Mean release by cells of each side and grid: `release_4_8` of 4 um and 8 nm."""
    of: dict[str, list[float]] = {}
    for row in table:
        name = f"release_{float(row['side_nm']) / 1000:g}_{float(row['spacing_nm']):.0f}"
        of.setdefault(name, []).append(float(row["release_V"]))
    return {name: f"{np.mean(volts):.1f} V" for name, volts in of.items()}
