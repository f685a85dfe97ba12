"""Are the forces of an adhesive contact those of the libraries Adhesion and tamaas, and how much
faster are they?

All press the same periodic, elastic surfaces to the same separations, and pull them off again, one
core each; times are of the processor. Adhesion (A. Sanner and L. Pastewka,
github.com/ContactEngineering/Adhesion) minimises the energy over the gaps by L-BFGS-B, each step
from the last; the law of attraction is added to it as a potential of its own. tamaas (L. Frerot et
al., J. Open Source Softw. 5 (2020) 2121) minimises it by Polonsky and Keer's conjugate gradients.
It has exponential attraction only, so it sums those whose integral the law is. Both are run at
every few separations, and their times are scaled to all. Needs `pip install Adhesion tamaas`.
"""

import argparse
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from evidence.contact.draws import MIDDLE
from mesoscale.contact.coupled.adhesive import AdhesiveContact
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings

SITE_NM = 1.0
STEPS = 10  # of each branch
# of the branches, from the first contact of the undeformed surface, in units of D0
DEPTHS = (-6.0, 1.0)
WORK_J_M2 = 0.05
RANGES_NM = (0.012, 1000.0)  # of the exponentials
RANGE_STEP = 0.5  # of their logarithms: the law to 1e-5
MOST_ITERATIONS = 500  # of tamaas, whose measure of its error knows no surfaces apart


def arguments(parser: argparse.ArgumentParser) -> None:
    """Grids and surfaces."""
    parser.add_argument("--pixels", type=int, nargs="+", default=[64, 128])
    parser.add_argument("--surfaces", type=int, default=2)
    parser.add_argument("--e-star", type=float, nargs="+", default=[5.0, 91.0])
    parser.add_argument(
        "--every", type=int, default=5, help="of how many separations the others solve one"
    )


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each grid, modulus and surface."""
    for pixels in given.pixels:
        for e_star in given.e_star:
            for seed in range(given.surfaces):
                yield {
                    "pixels": pixels,
                    "e_star_GPa": e_star,
                    "surface": seed,
                    **_compared(pixels, e_star, seed, given.every),
                }


def _compared(pixels: int, e_star: float, seed: int, every: int) -> dict[str, Any]:
    cutoff = 0.3
    settings = ContactSettings(
        mechanics="adhesive",
        model="elastic",
        pixels=pixels,
        length_nm=SITE_NM * pixels,
        gap_cutoff_nm=cutoff,
    )
    hamaker = 12 * np.pi * cutoff**2 * WORK_J_M2
    inputs = replace(MIDDLE, e_star=e_star, hamaker=hamaker, q0=0.06, rms=1.5)
    heights = random_surface(inputs, settings, seed)
    low, high = (-heights.min() + depth * cutoff for depth in DEPTHS)
    closing = np.linspace(high, low, STEPS)
    separations = np.concatenate((closing, closing[::-1]))

    def here(at: np.ndarray) -> np.ndarray:
        contact = AdhesiveContact(heights.copy(), inputs, settings)
        rows = [contact.away(separation) for separation in at.tolist()]
        return np.array([row.force + row.attraction for row in rows])

    given = (heights, settings.length_nm, e_star, hamaker, cutoff)
    (reached, adhesion), seconds_adhesion = _timed(
        lambda: _by_adhesion(*given, separations[::every])
    )
    tamaas, seconds_tamaas = _timed(lambda: _by_tamaas(*given, reached))
    _, seconds = _timed(lambda: here(separations))
    forces = here(reached)
    largest = np.abs(forces).max()
    return {
        "every": every,
        "largest_nN": forces.max(),
        "least_nN": forces.min(),
        "force_difference": np.abs(forces - adhesion).max() / largest,
        "force_difference_tamaas": np.abs(forces - tamaas).max() / largest,
        "seconds": seconds,
        "seconds_adhesion": seconds_adhesion * separations.size / reached.size,
        "seconds_tamaas": seconds_tamaas * separations.size / reached.size,
    }


def _timed(work: Callable[[], Any]) -> tuple[Any, float]:
    """What some work gives, and its seconds of processor time."""
    start = time.process_time()
    return work(), time.process_time() - start


def _by_tamaas(
    heights: np.ndarray,
    length: float,
    e_star: float,
    hamaker: float,
    cutoff: float,
    separations: np.ndarray,
) -> np.ndarray:
    """Net forces (nN), one after the other; 1/s^2 is the integral of t exp(-s t) over t."""
    import tamaas  # pyright: ignore[reportMissingImports]  (optional extra)

    tamaas.set_log_level(tamaas.LogLevel.error)
    model = tamaas.Model(tamaas.model_type.basic_2d, [length] * 2, list(heights.shape))
    model.E, model.nu = e_star, 0.0  # E/(1 - nu^2) = E*
    gap = tamaas.PolonskyKeerRey.gap
    solver = tamaas.PolonskyKeerRey(model, -heights, 1e-9, gap, gap)
    solver.max_iter = MOST_ITERATIONS
    terms = []
    for reach in np.exp(np.arange(*np.log(RANGES_NM), RANGE_STEP)):
        share = RANGE_STEP / reach**2 * np.exp(-cutoff / reach)
        terms.append(tamaas.ExponentialAdhesionFunctional(-heights))
        terms[-1].parameters = {"rho": reach, "surface_energy": hamaker / (12 * np.pi) * share}
        solver.addFunctionalTerm(terms[-1])
    forces = []
    for separation in separations.tolist():
        solver.solve(separation + float(heights.mean()))
        forces.append(float(np.mean(model.traction)) * length**2)
    return np.array(forces)


def _by_adhesion(
    heights: np.ndarray,
    length: float,
    e_star: float,
    hamaker: float,
    cutoff: float,
    separations: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Separations of the mean planes and net forces (nN), one after the other.

    The half-space of Adhesion yields as a whole, too: by the mean of its displacement it is farther
    away.
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
    system = make_system(
        Topography(-heights, sides), Walls(), half_space, system_class=BoundedSmoothContactSystem
    )
    reached, forces, last = [], [], None
    for separation in separations.tolist():
        options = {"ftol": 0.0, "gtol": 1e-7, "maxcor": 30, "maxiter": 5000, "maxfun": 20000}
        found = system.minimize_proxy(
            offset=-separation, initial_displacements=last, options=options
        )
        last = found.x.reshape(heights.shape)
        reached.append(separation + float(last.mean()))
        forces.append(float(system.compute_normal_force()))
    return np.array(reached), np.array(forces)


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Largest differences over the largest force, and times as much time, median and range."""

    def worst(column: str) -> str:
        return f"{max(float(row[column]) for row in rows):.0e}"

    def times(peer: str) -> str:
        ratios = [float(row[f"seconds_{peer}"]) / float(row["seconds"]) for row in rows]
        return f"{np.median(ratios):.0f} [{min(ratios):.0f}, {max(ratios):.0f}]"

    return {
        "difference": worst("force_difference"),
        "difference_tamaas": worst("force_difference_tamaas"),
        "times": times("adhesion"),
        "times_tamaas": times("tamaas"),
    }
