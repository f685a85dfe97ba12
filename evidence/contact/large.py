"""How long does a large surface take to 1 % contact, and how much memory?

Smooth elastic surfaces with sites of 1 nm, 63 to the shortest wave: ten loads and back, or one load
alone. Seconds are those of the processor. Memory is the largest of the process, with the map: give
one grid a run.
"""

import argparse
import resource
import time
from collections.abc import Iterator
from typing import Any
from unittest import mock

import asperity as asp
from evidence.contact.where_pads_press import SEED, SMOOTH, SMOOTH_CELL
from mesoscale.contact import cycle, run_cycle
from mesoscale.contact.numerics import Numerics
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings

PRESSURE_GPA = 20.5e-3


def arguments(parser: argparse.ArgumentParser) -> None:
    """Which grid, and what of it."""
    parser.add_argument("--pixels", type=int, default=4096)
    parser.add_argument("--one-load", action="store_true", help="one load, not ten and back")


def rows(options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """One row."""
    pixels = options.pixels
    cell = {**SMOOTH_CELL, "pixels": pixels, "length_nm": float(pixels)}
    settings = ContactSettings(mechanics="coupled", model="elastic", **cell)
    heights = random_surface(SMOOTH, settings, SEED)
    load_nN = PRESSURE_GPA * pixels**2
    start = time.process_time()
    if options.one_load:
        pressed = asp.press(
            heights, float(pixels), load_nN, float(SMOOTH.e_star), contact_at="lowest"
        )
        share = float(pressed.area_share[0])
        converged = pressed.converged
    else:
        with mock.patch.object(cycle, "check_memory"):  # which is what is measured
            cycled = run_cycle(
                SMOOTH,
                settings,
                SEED,
                load_nN,
                heights,
                contact_at="lowest",
                numerics=Numerics(force_steps=10),
            )
        share = cycled.closing.contact_area_nm2.max() / cycled.cell_area_nm2
        converged = cycled.converged
    yield {
        "pixels": pixels,
        "loads": 1 if options.one_load else 10,
        "share": share,
        "cpu_s": time.process_time() - start,
        "GB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024e-9,
        "converged": converged,
    }


def figures(rows: list[dict[str, str]]) -> dict[str, str]:
    """Seconds and memory of each grid."""
    numbers = {}
    for row in rows:
        name = row["pixels"] if row["loads"] == "10" else f"{row['pixels']}_load"
        numbers[f"{name}_s"] = f"{float(row['cpu_s']):.0f}"
        numbers[f"{name}_GB"] = f"{float(row['GB']):.1f}"
    return numbers
