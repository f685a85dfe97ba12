"""How long does a large surface take to 1 % contact and back, and how much memory?

Smooth elastic surfaces with sites of 1 nm, 63 to the shortest wave, in ten steps of force. Seconds
are those of the processor. Memory is the largest of the process: give one grid a run.
"""

import argparse
import resource
import time
from collections.abc import Iterator
from typing import Any
from unittest import mock

from evidence.contact.where_pads_press import SEED, SMOOTH, SMOOTH_CELL
from mesoscale.contact import cycle, run_cycle
from mesoscale.contact.numerics import Numerics
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings


def arguments(parser: argparse.ArgumentParser) -> None:
    """Which grid."""
    parser.add_argument("--pixels", type=int, default=4096)


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """One row."""
    cell = {**SMOOTH_CELL, "pixels": given.pixels, "length_nm": float(given.pixels)}
    settings = ContactSettings(mechanics="coupled", model="elastic", **cell)
    # 20.5 MPa
    heights, force_nN = (random_surface(SMOOTH, settings, SEED), 20.5e-3 * given.pixels**2)
    start, numerics = time.process_time(), Numerics(force_steps=10)
    with mock.patch.object(cycle, "check_memory"):  # which is what is measured
        found = run_cycle(
            SMOOTH, settings, SEED, force_nN, heights, contact_at="lowest", numerics=numerics
        )
    yield {
        "pixels": given.pixels,
        "share": found.closing.contact_area_nm2.max() / found.cell_area_nm2,
        "cycle_s": time.process_time() - start,
        "GB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024e-9,
        "converged": found.converged,
    }


def figures(rows: list[dict[str, str]]) -> dict[str, str]:
    """Seconds and memory of each grid."""
    seconds = {f"{row['pixels']}_s": f"{float(row['cycle_s']):.0f}" for row in rows}
    return seconds | {f"{row['pixels']}_GB": f"{float(row['GB']):.1f}" for row in rows}
