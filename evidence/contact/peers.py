"""Are the forces of an adhesive contact those of the library Adhesion, and how much faster are they?

Both press the same periodic, elastic surfaces to the same separations, and pull them off again, one core each.
Adhesion (A. Sanner and L. Pastewka, github.com/ContactEngineering/Adhesion) minimises the energy over the gaps by
L-BFGS-B, each step from the last; the law of attraction is added to it as a potential of its own.
Needs `pip install Adhesion`.
"""

import argparse
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from evidence.contact.draws import MIDDLE
from mesoscale.contact.coupled.adhesive import AdhesiveContact
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings

SITE_NM = 1.0
STEPS = 10  # of each branch
DEPTHS = (-6.0, 1.0)  # of the branches, from the first contact of the undeformed surface, in units of D0
WORK_J_M2 = 0.05


def arguments(parser: argparse.ArgumentParser) -> None:
    """Grids and surfaces."""
    parser.add_argument("--pixels", type=int, nargs="+", default=[64, 128])
    parser.add_argument("--surfaces", type=int, default=2)
    parser.add_argument("--e-star", type=float, nargs="+", default=[5.0, 91.0])


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each grid, modulus and surface."""
    for pixels in given.pixels:
        for e_star in given.e_star:
            for seed in range(given.surfaces):
                yield {"pixels": pixels, "e_star_GPa": e_star, "surface": seed, **_compared(pixels, e_star, seed)}


def _compared(pixels: int, e_star: float, seed: int) -> dict[str, Any]:
    cutoff = 0.3
    settings = ContactSettings(
        mechanics="adhesive", model="elastic", pixels=pixels, length_nm=SITE_NM * pixels, gap_cutoff_nm=cutoff
    )
    hamaker = 12 * np.pi * cutoff**2 * WORK_J_M2
    inputs = replace(MIDDLE, e_star=e_star, hamaker=hamaker, q0=0.06, rms=1.5)
    heights = random_surface(inputs, settings, seed)
    low, high = (-heights.min() + depth * cutoff for depth in DEPTHS)
    closing = np.linspace(high, low, STEPS)
    separations = np.concatenate((closing, closing[::-1]))

    start = time.perf_counter()
    reached, theirs = _by_adhesion(heights, settings.length_nm, e_star, hamaker, cutoff, separations)
    there = time.perf_counter() - start
    start = time.perf_counter()
    contact = AdhesiveContact(heights, inputs, settings)
    forces = []
    for separation in reached.tolist():
        row = contact.away(separation)
        forces.append(row.force + row.attraction)
    here = time.perf_counter() - start
    ours = np.array(forces)
    return {
        "largest_nN": ours.max(),
        "pull_off_nN": -ours.min(),
        "pull_off_adhesion_nN": -theirs.min(),
        "force_difference": np.abs(ours - theirs).max() / np.abs(ours).max(),
        "seconds": here,
        "seconds_adhesion": there,
    }


def _by_adhesion(
    heights: np.ndarray, length: float, e_star: float, hamaker: float, cutoff: float, separations: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Separations of the mean planes and net forces (nN), one after the other.

    The half-space of Adhesion yields as a whole, too: by the mean of its displacement it is farther away.
    """
    from Adhesion.Interactions import Potential  # pyright: ignore[reportMissingImports]  (not a dependency)
    from Adhesion.System import BoundedSmoothContactSystem, make_system  # pyright: ignore[reportMissingImports]
    from ContactMechanics import PeriodicFFTElasticHalfSpace  # pyright: ignore[reportMissingImports]
    from SurfaceTopography import Topography

    class Walls(Potential):
        """Energy of flats that are D0 apart at touch."""

        r_min = r_infl = None
        max_tensile = -hamaker / (6 * np.pi * cutoff**3)

        def __init__(self) -> None:
            super().__init__()

        def __repr__(self) -> str:
            return "walls"

        def evaluate(self, gap, potential=True, gradient=False, curvature=False, mask=None):
            walls = np.asarray(gap) + cutoff
            strength = hamaker / (6 * np.pi)
            return -0.5 * strength / walls**2, strength / walls**3, -3 * strength / walls**4

    sides = (length, length)
    half_space = PeriodicFFTElasticHalfSpace(heights.shape, e_star, sides)
    system = make_system(Topography(-heights, sides), Walls(), half_space, system_class=BoundedSmoothContactSystem)
    reached, forces, last = [], [], None
    for separation in separations.tolist():
        options = {"ftol": 0.0, "gtol": 1e-7, "maxcor": 30, "maxiter": 5000, "maxfun": 20000}
        found = system.minimize_proxy(offset=-separation, initial_displacements=last, options=options)
        last = found.x.reshape(heights.shape)
        reached.append(separation + float(last.mean()))
        forces.append(float(system.compute_normal_force()))
    return np.array(reached), np.array(forces)


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Largest difference over the largest force, and times as much time."""
    ratios = [float(row["seconds_adhesion"]) / float(row["seconds"]) for row in rows]
    return {
        "difference": f"{max(float(row['force_difference']) for row in rows):.1%}",
        "times": f"{np.median(ratios):.0f}",
    }
