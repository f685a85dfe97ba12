"""What does a closing-opening cycle cost beside a plain model and other codes, in one run?

Seconds of the processor, one thread each. The floor is a normal number per site, and a transform
there and back. The plain model is `evidence.contact.plain_contact`. The peers solve one elastic
load at the largest force, without plastic flow. Adhesive cycles have branches of 20 steps of force,
beside what they need at touch, before it and after it. Memory is the largest of the process so far:
run one by `--only`.
"""

import argparse
import importlib.util
import resource
import statistics
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from scipy import fft

from evidence.contact import plain_contact
from evidence.contact.draws import MIDDLE
from evidence.contact.half_space import by_tamaas
from mesoscale.contact import run_cycle
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings

SEED = 1
PLAIN_PIXELS = 512  # the plain model takes minutes on more
COUPLED_PIXELS = 1024  # and the others on more than this
ADHESIVE = {"mechanics": "adhesive", "gap_cutoff_nm": 0.3, "q1_per_nm": 0.4}
FILM = [
    [{"young_GPa": 72, "poisson": 0.17, "thickness_nm": 2.5}, {"young_GPa": 250, "poisson": 0.25}]
]
CYCLES = {
    "coupled cycle": {"mechanics": "coupled"},
    "coupled elastic cycle": {"mechanics": "coupled", "model": "elastic"},
    **{
        f"coupled cycle at {percent}{name}": {
            "mechanics": "coupled",
            "air": {"humidity": percent / 100, "opening": opening},
        }
        for percent in (30, 60, 80, 95)
        for opening, name in (("balance", ""), ("volume", " constant volume"))
    },
    "adhesive cycle": ADHESIVE,
    "adhesive cycle on a film": {**ADHESIVE, "bodies": FILM},
}


def arguments(parser: argparse.ArgumentParser) -> None:
    """What is timed."""
    parser.add_argument("--pixels", type=int, nargs="+", default=[512, 1024, 2048])
    parser.add_argument("--only", default="", help="what has these words in its name")
    parser.add_argument(
        "--repeats", type=int, default=3, help="timings, of which the median is given"
    )


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each grid and code; printed as it comes."""
    for pixels in (128, *given.pixels):  # on the first grid all is compiled, or loaded
        for what, work in _works(ContactSettings(pixels=pixels)).items():
            if given.only in what:
                times, note = [], ""
                for _ in range(given.repeats if what != "plain model" and pixels > 128 else 1):
                    start = time.process_time()
                    note = work()
                    times.append(time.process_time() - start)
                memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
                row = {
                    "pixels": pixels,
                    "what": what,
                    "cpu_s": statistics.median(times),
                    "MB": memory,
                    "note": note,
                }
                if pixels > 128:
                    print(*row.values(), flush=True)
                    yield row


def _works(settings: ContactSettings) -> dict[str, Callable[[], str]]:
    """What is timed on a grid; each gives a note."""
    heights = random_surface(MIDDLE, settings, SEED)

    def cycle(changes: Mapping[str, Any]) -> str:
        changed = ContactSettings(**{**dict(settings), **changes})
        steps = Numerics(force_steps=20) if changed.mechanics == "adhesive" else NUMERICS
        surface = random_surface(MIDDLE, changed, SEED) if changed.q1_per_nm else heights
        found = run_cycle(
            MIDDLE, changed, SEED, heights=surface, contact_at="lowest", numerics=steps
        )
        return f"{len(found.closing.net_nN)} and {len(found.opening.net_nN)} rows"

    works: dict[str, Callable[[], str]] = {
        "floor": lambda: _floor(settings.pixels),
        "surface": lambda: str(random_surface(MIDDLE, settings, SEED).size),
        "surface and cycle": lambda: str(run_cycle(MIDDLE, settings, SEED).converged),
    }
    if settings.pixels <= COUPLED_PIXELS:
        works |= {what: partial(cycle, changes) for what, changes in CYCLES.items()}
        works |= {
            name: partial(f, heights, settings)
            for name, f in PEERS.items()
            if importlib.util.find_spec(name)
        }
    if settings.pixels == PLAIN_PIXELS:
        works["plain model"] = lambda: _plain(heights, settings)
    return works


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Times of a cycle over those of the others, on the same grid."""
    last = {(row["pixels"], row["what"]): row for row in rows}
    found = {}
    for (pixels, what), row in last.items():
        humid = what.startswith("coupled cycle at")
        value = float(row["cpu_s"])
        base = (
            "coupled cycle"
            if humid
            else "adhesive cycle"
            if "film" in what
            else "surface and cycle"
        )
        over = value / float(last[pixels, base]["cpu_s"]) if (pixels, base) in last else np.nan
        if what == "adhesive cycle":
            found[f"adhesive_{pixels}"] = f"{value:.0f} s and {row['MB']} MB"
        elif humid:
            found[f"{what.replace(' ', '_')}_{pixels}"] = f"{over:.3g}"
        elif what in ("plain model", "adhesive cycle on a film", *PEERS):
            found[f"{what.replace(' ', '_')}_{pixels}"] = f"{over:.2g}"
        elif what == "floor":
            found[f"over_floor_{pixels}"] = f"{1 / over:.1f}"
    return found


def _floor(pixels: int) -> str:
    noise = np.random.default_rng(SEED).standard_normal((pixels, pixels))
    return (
        f"{pixels**2} numbers,"
        f" {np.asarray(fft.irfft2(np.asarray(fft.rfft2(noise)), s=noise.shape)).size} back"
    )


def _plain(heights: np.ndarray, settings: ContactSettings) -> str:
    """The plain model at the separations of a cycle, and how far its repulsion is from the
    cycle's.
    """
    cycle = run_cycle(MIDDLE, settings, SEED, heights=heights, contact_at="lowest")
    there, flowed = plain_contact.walk(heights, cycle.closing.separation_nm, MIDDLE, settings)
    elastic = settings.model_copy(update={"model": "elastic"})
    back, _ = plain_contact.walk(flowed, cycle.opening.separation_nm, MIDDLE, elastic)
    repulsion = np.concatenate((cycle.closing.repulsive_nN, cycle.opening.repulsive_nN))
    apart = np.abs(np.concatenate((there, back))[:, 0] - repulsion).max() / repulsion.max()
    return f"same points; forces differ by {apart:.0e}"


def _tamaas(heights: np.ndarray, settings: ContactSettings) -> str:
    """Contact area (nm^2) of an elastic half-space at the largest force."""
    bare = replace(MIDDLE, hamaker=0.0)
    pressed = by_tamaas(
        heights, settings.length_nm, settings.max_force_nN, bare.e_star, tolerance=1e-6
    )
    return (
        f"one elastic load, contact {(pressed.pressure > 0).mean() * settings.length_nm**2:.0f}"
        " nm^2"
    )


def _contact_mechanics(heights: np.ndarray, settings: ContactSettings) -> str:
    """The same by ContactMechanics."""
    from ContactMechanics import (
        PeriodicFFTElasticHalfSpace,
    )  # pyright: ignore[reportMissingImports]  (optional extra)
    from ContactMechanics.Factory import make_system  # pyright: ignore[reportMissingImports]
    from SurfaceTopography import Topography

    size = (settings.length_nm,) * 2
    system = make_system(
        interaction="hardwall",
        substrate=PeriodicFFTElasticHalfSpace(heights.shape, MIDDLE.e_star, size),
        surface=Topography(-heights, size, periodic=True),
    )
    result = system.minimize_proxy(external_force=settings.max_force_nN)
    return f"one elastic load, contact {(result.jac > 0).mean() * settings.length_nm**2:.0f} nm^2"


PEERS = {"tamaas": _tamaas, "ContactMechanics": _contact_mechanics}
