"""Time a surface and a closing-opening cycle on several grids, side by side with others in one run.

python -m benchmarks [--large] [--repeats 3] [--plain] [--cycles 200]

One thread each; docs/contact_reference.md, Run time.
"""

import argparse
import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before any library starts its threads

import importlib
import resource
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import fft

from benchmarks.many import many
from mesoscale.contact import Cycle, run_cycle
from mesoscale.contact.studies.stability import MIDDLE
from mesoscale.settings import ContactSettings
from mesoscale.topography.synthesis import synthesize

SEED = 1


def timed(work: Callable[[], Any], repeats: int) -> tuple[float, Any]:
    """Median wall time (s) of a few calls, and the last result."""
    times = []
    result = None
    for _ in range(repeats):
        start = time.perf_counter()
        result = work()
        times.append(time.perf_counter() - start)
    return statistics.median(times), result


def peak_MB() -> float:
    """Largest memory this process has held so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def surface(settings: ContactSettings) -> np.ndarray:
    """The surface of the nominal inputs."""
    i = MIDDLE
    return synthesize(settings.pixels, settings.length_nm, i.q0, i.hurst, i.rms, SEED, settings.convention)


def floor(pixels: int) -> np.ndarray:
    """What any random surface costs at least: a normal number per site and a transform there and back."""
    noise = np.random.default_rng(SEED).standard_normal((pixels, pixels))
    return np.asarray(fft.irfft2(np.asarray(fft.rfft2(noise)), s=noise.shape))


def plain(heights: np.ndarray, cycle: Cycle, settings: ContactSettings) -> np.ndarray:
    """Forces of the plain NumPy/SciPy model at the separations of a cycle; columns repulsion, attraction."""
    from benchmarks import plain_contact

    elastic = settings.model_copy(update={"model": "elastic"})
    there, flowed = plain_contact.walk(heights, cycle.closing.separation_nm, MIDDLE, settings)
    back, _ = plain_contact.walk(flowed, cycle.opening.separation_nm, MIDDLE, elastic)
    return np.concatenate((there, back))


def tamaas(heights: np.ndarray, settings: ContactSettings) -> float:
    """Contact area (nm^2) of an elastic half-space at the largest force, by tamaas."""
    import tamaas as tm  # pyright: ignore[reportMissingImports]  (optional extra)

    tm.set_log_level(tm.LogLevel.error)
    model = tm.Model(tm.model_type.basic_2d, [settings.length_nm] * 2, list(heights.shape))
    model.E, model.nu = MIDDLE.e_star, 0.0
    solver = tm.PolonskyKeerRey(model, -heights, 1e-6)
    solver.solve(settings.max_force_nN / settings.length_nm**2)
    return float((model.traction > 0).mean()) * settings.length_nm**2


def contact_mechanics(heights: np.ndarray, settings: ContactSettings) -> float:
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


PEERS = {"tamaas": tamaas, "ContactMechanics": contact_mechanics}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--large", action="store_true", help="also 4096 x 4096")
    parser.add_argument("--plain", action="store_true", help="the plain model at 1024 x 1024, too (minutes)")
    parser.add_argument("--cycles", type=int, default=0, help="also this many cycles on two processes")
    parser.add_argument("--repeats", type=int, default=3, help="timings, of which the median is given")
    options = parser.parse_args()
    row = "{:>6} {:<34} {:>9} {:>9} {:>9}  {}".format

    run_cycle(MIDDLE, ContactSettings(pixels=64, max_force_nN=100), SEED)  # compile, or load the compiled
    synthesize(64, 1000.0, 0.025, 0.75, 8.5, SEED)
    print(f"one thread, medians of {options.repeats}; Python and its libraries take {peak_MB():.0f} MB")
    print(row("pixels", "what", "s", "/ floor", "/ cycle", "notes"))
    measured = {}
    for pixels in (512, 1024, 2048, *([4096] if options.large else [])):
        settings = ContactSettings(pixels=pixels)
        lowest, _ = timed(lambda n=pixels: floor(n), options.repeats)
        making, heights = timed(lambda s=settings: surface(s), options.repeats)
        whole, cycle = timed(lambda s=settings: run_cycle(MIDDLE, s, SEED), options.repeats)
        steps = len(cycle.closing.separation_nm) + len(cycle.opening.separation_nm)
        note = f"{steps} points, {cycle.closing.sweeps.sum()} sweeps, converged {cycle.converged}"
        print(row(pixels, "floor: normals + FFT there and back", f"{lowest:.4f}", "1.0", "", ""))
        print(row("", "surface", f"{making:.4f}", f"{making / lowest:.1f}", f"{making / whole:.3f}", ""))
        print(row("", "surface + closing + opening", f"{whole:.4f}", f"{whole / lowest:.1f}", "1.000", note))
        print(row("", "peak memory so far, MB", f"{peak_MB():.0f}", "", "", ""), flush=True)
        measured[pixels] = settings, lowest, whole, heights, cycle

    def beside(pixels: int, what: str, seconds: float, note: str) -> None:
        _, lowest, whole, _, _ = measured[pixels]
        ratios = f"{seconds / lowest:.0f}", f"{seconds / whole:.1f}"
        print(row(pixels, what, f"{seconds:.2f}", *ratios, note), flush=True)

    for pixels in (512, 1024) if options.plain else (512,):
        settings, _, _, heights, cycle = measured[pixels]
        seconds, forces = timed(lambda h=heights, c=cycle, s=settings: plain(h, c, s), 1)
        repulsion = np.concatenate((cycle.closing.repulsive_nN, cycle.opening.repulsive_nN))
        apart = np.abs(forces[:, 0] - repulsion).max() / repulsion.max()
        beside(pixels, "plain NumPy/SciPy, same points, once", seconds, f"forces differ by {apart:.0e}")
    if options.cycles:
        wall, cpu_each = many(options.cycles, 2)
        note = f"{cpu_each:.3f} s of processor time each; 10,000 would take {wall / options.cycles / 6 * 1e3:.1f} min"
        beside(1024, f"{options.cycles} draws of Table 1, 2 processes", wall, note)
    print("other codes: one elastic solve at the largest force. They solve the elastic coupling between")
    print("asperities that this model neglects, and have no plastic flow of asperities; no like for like.")
    for name, solve in PEERS.items():
        try:
            importlib.import_module(name)
        except ImportError:
            print(f"       {name}: not installed; uv sync --locked --all-groups --extra peers")
            continue
        for pixels in (512, 1024):
            settings, _, _, heights, _ = measured[pixels]
            seconds, area = timed(lambda f=solve, h=heights, s=settings: f(h, s), options.repeats)
            beside(pixels, f"{name}, one elastic load", seconds, f"contact {area:.0f} nm^2")


if __name__ == "__main__":
    main()
