"""What does a closing-opening cycle cost beside a plain model and other codes, in one run?

One thread each. The floor is what any random surface costs at least: a normal number per site, and a transform there
and back. The plain model is `evidence.contact.plain_contact`. The peers solve one elastic load at the largest force;
they have no plastic flow of asperities, so their time says what a load costs, not who is right.
"""

import argparse
import importlib.util
import statistics
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy import fft

from evidence.contact import plain_contact
from evidence.contact.draws import MIDDLE
from evidence.contact.half_space import by_tamaas
from mesoscale.contact import Cycle, run_cycle
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings

SEED = 1
PLAIN_PIXELS = 512  # the plain model takes minutes on more


def arguments(parser: argparse.ArgumentParser) -> None:
    """How much is timed."""
    parser.add_argument("--large", action="store_true", help="also 4096 x 4096")
    parser.add_argument("--repeats", type=int, default=3, help="timings, of which the median is given")


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each grid and code; printed as it comes."""
    for mechanics in ("asperity", "coupled"):  # compile, or load the compiled
        run_cycle(MIDDLE, ContactSettings(mechanics=mechanics, pixels=64, max_force_nN=100), SEED)
    for pixels in (512, 1024, 2048, *([4096] if given.large else [])):
        settings = ContactSettings(pixels=pixels)
        timed = _Timed(pixels, given.repeats)
        yield timed("floor", lambda n=pixels: _floor(n))[0]
        row, heights = timed("surface", lambda s=settings: random_surface(MIDDLE, s, SEED))
        yield row
        row, cycle = timed("surface and cycle", lambda s=settings: run_cycle(MIDDLE, s, SEED))
        yield row
        if pixels > 1024:
            continue
        coupled = settings.model_copy(update={"mechanics": "coupled"})
        yield timed(
            "coupled cycle", lambda s=coupled, h=heights: run_cycle(MIDDLE, s, SEED, heights=h, contact_at="lowest")
        )[0]
        elastic = coupled.model_copy(update={"model": "elastic"})
        row, closed = timed(
            "coupled elastic cycle",
            lambda s=elastic, h=heights: run_cycle(MIDDLE, s, SEED, heights=h, contact_at="lowest"),
        )
        yield {**row, "note": f"{int((closed.closing.repulsive_nN > 0).sum())} loads"}
        if pixels == PLAIN_PIXELS:
            row, forces = timed("plain model", lambda s=settings, h=heights, c=cycle: _plain(h, c, s), 1)
            repulsion = np.concatenate((cycle.closing.repulsive_nN, cycle.opening.repulsive_nN))
            apart = np.abs(forces[:, 0] - repulsion).max() / repulsion.max()
            yield {**row, "note": f"same points; forces differ by {apart:.0e}"}
        for name, solve in PEERS.items():
            if importlib.util.find_spec(name) is None:
                print(f"{name}: not installed; uv sync --locked --all-groups --extra peers")
                continue
            row, area = timed(name, lambda f=solve, s=settings, h=heights: f(h, s))
            yield {**row, "note": f"one elastic load, contact {area:.0f} nm^2"}


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Times of a cycle over those of the others, on the same grid."""
    seconds = {(row["pixels"], row["what"]): float(row["wall_s"]) for row in rows}
    found = {
        f"{what.replace(' ', '_')}_{pixels}": f"{value / seconds[pixels, 'surface and cycle']:.0f}"
        for (pixels, what), value in seconds.items()
        if what in ("plain model", *PEERS)
    }
    over = {
        pixels: seconds[pixels, "surface and cycle"] / value
        for (pixels, what), value in seconds.items()
        if what == "floor"
    }
    return found | {f"over_floor_{pixels}": f"{ratio:.1f}" for pixels, ratio in over.items()}


class _Timed:
    """Median wall times of one grid."""

    def __init__(self, pixels: int, repeats: int) -> None:
        self.pixels, self.repeats = pixels, repeats

    def __call__(self, what: str, work: Callable[[], Any], repeats: int | None = None) -> tuple[dict[str, Any], Any]:
        times, result = [], None
        for _ in range(repeats or self.repeats):
            start = time.perf_counter()
            result = work()
            times.append(time.perf_counter() - start)
        print(f"{self.pixels:6} {what:24} {statistics.median(times):9.4f} s", flush=True)
        return {"pixels": self.pixels, "what": what, "wall_s": statistics.median(times), "note": ""}, result


def _floor(pixels: int) -> np.ndarray:
    noise = np.random.default_rng(SEED).standard_normal((pixels, pixels))
    return np.asarray(fft.irfft2(np.asarray(fft.rfft2(noise)), s=noise.shape))


def _plain(heights: np.ndarray, cycle: Cycle, settings: ContactSettings) -> np.ndarray:
    """Forces of the plain model at the separations of a cycle; columns repulsion, attraction."""
    elastic = settings.model_copy(update={"model": "elastic"})
    there, flowed = plain_contact.walk(heights, cycle.closing.separation_nm, MIDDLE, settings)
    back, _ = plain_contact.walk(flowed, cycle.opening.separation_nm, MIDDLE, elastic)
    return np.concatenate((there, back))


def _tamaas(heights: np.ndarray, settings: ContactSettings) -> float:
    """Contact area (nm^2) of an elastic half-space at the largest force."""
    bare = replace(MIDDLE, hamaker=0.0)
    pressed = by_tamaas(heights, settings.length_nm, settings.max_force_nN, bare.e_star, tolerance=1e-6)
    return float((pressed.pressure > 0).mean()) * settings.length_nm**2


def _contact_mechanics(heights: np.ndarray, settings: ContactSettings) -> float:
    """The same by ContactMechanics."""
    from ContactMechanics import PeriodicFFTElasticHalfSpace  # pyright: ignore[reportMissingImports]  (optional extra)
    from ContactMechanics.Factory import make_system  # pyright: ignore[reportMissingImports]
    from SurfaceTopography import Topography

    size = (settings.length_nm,) * 2
    system = make_system(
        interaction="hardwall",
        substrate=PeriodicFFTElasticHalfSpace(heights.shape, MIDDLE.e_star, size),
        surface=Topography(-heights, size, periodic=True),
    )
    result = system.minimize_proxy(external_force=settings.max_force_nN)
    return float((result.jac > 0).mean()) * settings.length_nm**2


PEERS = {"tamaas": _tamaas, "ContactMechanics": _contact_mechanics}
