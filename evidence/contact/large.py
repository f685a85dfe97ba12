"""How long does a large surface take to 1 % contact and back, and how much memory?

Smooth elastic or plastic surfaces with sites of 1 nm, 63 to the shortest wave, in ten steps of force. Seconds are those
of the processor, beside a pair of FFTs of the grid. Memory is the largest of the process: give one grid a run.
"""

import argparse
import resource
import time
from collections.abc import Iterator
from typing import Any
from unittest import mock

import numpy as np
from scipy import fft

from evidence.contact.where_pads_press import SEED, SMOOTH, SMOOTH_CELL
from mesoscale.contact import cycle, run_cycle
from mesoscale.contact.numerics import Numerics
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings

STRESS_MPa = 20.5
NUMERICS = Numerics(force_steps=10)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Which grid."""
    parser.add_argument("--pixels", type=int, default=4096)
    parser.add_argument("--model", default="elastic")


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """One row, after a small grid on which all is compiled, or loaded."""
    for pixels in (512, given.pixels):
        settings = ContactSettings(
            pixels=pixels, mechanics="coupled", model=given.model, **{**SMOOTH_CELL, "length_nm": float(pixels)}
        )
        start = time.process_time()
        heights = random_surface(SMOOTH, settings, SEED)
        made = time.process_time()
        with mock.patch.object(cycle, "check_memory"):  # which is what is measured
            force = 1e-3 * STRESS_MPa * settings.length_nm**2
            found = run_cycle(SMOOTH, settings, SEED, force, heights, contact_at="lowest", numerics=NUMERICS)
        row = {
            "pixels": pixels,
            "model": given.model,
            "share": found.closing.contact_area_nm2.max() / found.cell_area_nm2,
            "rows": len(found.closing.net_nN) + len(found.opening.net_nN),
            "surface_s": made - start,
            "cycle_s": time.process_time() - made,
            "GB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024e-9,
            "converged": found.converged,
        }
    start = time.process_time()
    fft.irfft2(np.asarray(fft.rfft2(heights)), s=heights.shape, overwrite_x=True)
    yield row | {"pair_s": time.process_time() - start}


def figures(rows: list[dict[str, str]]) -> dict[str, str]:
    """Seconds and memory of each grid."""
    found = {}
    for row in rows:
        name = f"{row['model']}_{row['pixels']}"
        found |= {f"{name}_s": f"{float(row['cycle_s']):.0f}", f"{name}_GB": f"{float(row['GB']):.1f}"}
    return found
