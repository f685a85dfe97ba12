"""The coupled engine beside tamaas: cost of a curve, forces and areas at equal separation.

python -m benchmarks.coupled cost|large
python -m benchmarks.coupled elastic|saturated|unloading [PIXELS [SURFACES]]
(one thread, processor times; docs/contact.md, Coupled mechanics)

cost: cycles at 512 x 512 and 1024 x 1024, and some of their loads by tamaas. large: closing to half of full contact at
1024 x 1024. The others: forces and areas of random surfaces at the separations of tamaas.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before any library starts its threads

import resource
import sys
import time
from dataclasses import replace

import numpy as np

from mesoscale.contact import ContactInputs, run_cycle
from mesoscale.contact.coupled.engine import CoupledContact
from mesoscale.contact.coupled.grid import Grid
from mesoscale.contact.path import trace
from mesoscale.contact.studies.stability import MIDDLE
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings

LOADS = 4
HARDNESS = 4.0  # GPa, of the comparison with saturated pressure
CELL_NM = 62.5  # side of 64 sites


def peak_MB() -> float:
    """Largest memory this process has held so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def by_tamaas(heights: np.ndarray, length: float, load_nN: float, hardness: float | None = None):
    """Pressures (N, N), separation of the mean planes (nm) and processor time (s) of one load."""
    import tamaas as tm  # pyright: ignore[reportMissingImports]  (optional extra)

    tm.set_log_level(tm.LogLevel.error)
    start = time.process_time()
    model = tm.Model(tm.model_type.basic_2d, [length] * 2, list(heights.shape))
    model.E, model.nu = MIDDLE.e_star, 0.0
    if hardness is None:
        solver = tm.PolonskyKeerRey(model, -heights, 1e-8)
    else:
        solver = tm.KatoSaturated(model, -heights, 1e-8, hardness)
    solver.max_iter = 5000
    solver.solve(load_nN / length**2)
    spent = time.process_time() - start
    p = np.array(model.traction).reshape(heights.shape)
    # the displacement in the model holds the plastic part, too
    u = Grid(len(heights), length, MIDDLE.e_star).displacement(p.ravel()).reshape(heights.shape)
    free = p > 0 if hardness is None else (p > 0) & (p < hardness * (1 - 1e-9))
    return p, -(heights + u)[free].mean(), spent


def timed_cycle(settings: ContactSettings, heights: np.ndarray, repeats: int = 3):
    """Median processor time (s) of a cycle on a given surface, and the cycle."""
    times, cycle = [], None
    for _ in range(repeats):
        start = time.process_time()
        cycle = run_cycle(MIDDLE, settings, 1, heights=heights)
        times.append(time.process_time() - start)
    return float(np.median(times)), cycle


def cost() -> None:
    """Print the processor time of cycles, and of single loads by tamaas."""
    run_cycle(MIDDLE, ContactSettings(mechanics="coupled", pixels=64, max_force_nN=100), 1)  # compile
    for pixels in (512, 1024):
        for model in ("elastic", "nonlinear", "plastic"):
            settings = ContactSettings(mechanics="coupled", pixels=pixels, model=model)
            heights = random_surface(MIDDLE, settings, 1)
            spent, cycle = timed_cycle(settings, heights)
            rows = int((cycle.closing.repulsive_nN > 0).sum())
            area = cycle.closing.contact_area_nm2[-1] / (settings.length_nm / pixels) ** 2
            print(f"{pixels} {model:10} {spent:7.3f} s, {rows} loads, {area:.0f} sites touch, {peak_MB():.0f} MB")
            if model == "elastic":
                forces = cycle.closing.repulsive_nN[-rows:][:: max(rows // LOADS, 1)]
                tamaas_s = float(np.mean([by_tamaas(heights, settings.length_nm, force)[2] for force in forces]))
                ratio = tamaas_s * rows / spent
                print(
                    f"{'':15} {tamaas_s:7.3f} s a load by tamaas ({len(forces)} loads): {ratio:.0f} times as long",
                    flush=True,
                )


def elastic(pixels: int = 64, surfaces: int = 10) -> None:
    """Compare elastic forces and areas with tamaas, up to near full contact."""
    compare("elastic", None, (1e2, 1e3, 1e4, 8e4, 3e5), pixels, surfaces)


def saturated(pixels: int = 64, surfaces: int = 10) -> None:
    """The same with a pressure that saturates at HARDNESS, up to 0.9 of all that it carries."""
    compare("nonlinear", HARDNESS, (1e2, 1e3, 5e3, 0.9 * HARDNESS * CELL_NM**2), pixels, surfaces)


def rough_cell(pixels: int) -> tuple[ContactInputs, ContactSettings, float]:
    """Inputs, settings of a square of sites of 1 nm, and its area over that of 64 x 64 sites."""
    settings = ContactSettings(mechanics="coupled", pixels=pixels, length_nm=CELL_NM * pixels / 64)
    return replace(MIDDLE, q0=0.15, rms=2.0, h_macro=HARDNESS, h_prime=0.0), settings, (pixels / 64) ** 2


def compare(model: str, hardness: float | None, loads: tuple[float, ...], pixels: int, surfaces: int) -> None:
    """Print the largest differences of force and area at the separations of tamaas; loads are those on 64 x 64."""
    rough, settings, share = rough_cell(pixels)
    force = area = least = most = 0.0
    for seed in range(1, surfaces + 1):
        heights = random_surface(rough, settings, seed)
        for load in (share * load for load in loads):
            p, separation, spent = by_tamaas(heights, settings.length_nm, load, hardness)
            start = time.process_time()
            contact = CoupledContact(heights.copy(), rough, settings.model_copy(update={"model": model}))
            moved = contact.move_to(separation, False)
            touching = int((p > 0).sum())
            part = touching / p.size
            print(
                f"  surface {seed}, {load:.3g} nN, {part:.2%} touch: force {moved.force / load - 1:.1e}, "
                f"{touching} and {moved.sites} sites, {spent:.2f} and {time.process_time() - start:.2f} s",
                flush=True,
            )
            force, area = max(force, abs(moved.force / load - 1)), max(area, abs(moved.sites / touching - 1))
            least, most = min(least or part, part), max(most, part)
    print(f"{model}, {pixels}: {surfaces} surfaces x {len(loads)} loads, touching {least:.2%} to {most:.1%}: ", end="")
    print(f"force differs by at most {force:.1e}, area by {area:.1e}", flush=True)


def unloading(pixels: int = 64, surfaces: int = 10) -> None:
    """Print the largest difference of force on surfaces that plastic closing has flattened."""
    rough, settings, share = rough_cell(pixels)
    elastic_settings = settings.model_copy(update={"model": "elastic"})
    worst = 0.0
    for seed in range(1, surfaces + 1):
        chosen = settings.model_copy(update={"max_force_nN": 2e3 * share})
        cycle = run_cycle(rough, chosen, seed, heights=random_surface(rough, settings, seed), keep_surface=True)
        assert cycle.heights is not None
        for load in (share * load for load in (1.9e3, 1e3, 200.0, 20.0)):
            _, separation, _ = by_tamaas(cycle.heights, settings.length_nm, load)
            contact = CoupledContact(cycle.heights.copy(), rough, elastic_settings)
            worst = max(worst, abs(contact.move_to(separation, False).force / load - 1))
        print(f"  surface {seed}: {worst:.1e} so far", flush=True)
    print(f"unloading of {surfaces} flattened surfaces of {pixels} at 4 loads: force differs by at most {worst:.1e}")


def large() -> None:
    """Print the cost of closing to half of full contact at 1024 x 1024, a tenth of the force of full contact."""
    settings = ContactSettings(mechanics="coupled", model="elastic", force_steps=10)
    bare = replace(MIDDLE, hamaker=0.0)
    contact = CoupledContact(random_surface(bare, settings, 1), bare, settings)
    start = time.process_time()
    path = trace(contact, settings.force_steps, False, stop_force=0.11 * contact.capacity)
    spent = time.process_time() - start
    share = path.rows[-1].sites / contact.heights.size
    print(f"1024 elastic to {path.rows[-1].force:.3g} nN, {share:.1%} of the sites: {len(path.rows)} loads, ", end="")
    print(f"{spent:.1f} s, unsettled {path.unconverged}, {peak_MB():.0f} MB")


if __name__ == "__main__":
    parts = {"cost": cost, "large": large, "elastic": elastic, "saturated": saturated, "unloading": unloading}
    parts[sys.argv[1]](*map(int, sys.argv[2:]))
