"""Contact area of bodies whose section is known: pressed glass, frozen and cut by planes, by a sphere and by a wave.

A flat slab of glass is pressed at the temperature in use; its frozen snapshots have the layer of atoms of a contact
under load.  Tiled and cut by a flank, they have a section that geometry gives exactly.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.hardness.contact_area import contact_area
from atomistic.hardness.pressing import plan_closing, prepare_body, press_bodies
from atomistic.hardness.readout import beyond_counterface
from atomistic.hardness.runs import ClosingRun
from atomistic.lammps import Atoms, Workspace, load_averages, load_dump
from atomistic.potentials import Potential
from atomistic.settings import AreaSettings, AsperitySettings, HardnessSettings

SLAB_TILES, SLAB_BASE_NM, SLAB_TRAVEL_A = 2, 2.0, (7.0, 12.0)  # against a wall, against a second slab
STRESS_GPA = (6.0, 14.0)  # of the snapshots in use, at full energies: about the hardness
LENGTHS_NM = (2.0, 3.0, 4.0, 6.0, 8.0)
SLOPE = 0.6  # of the planes: that of eq. 6 with A / lambda = 0.1 halfway up is 0.63
TRIALS = 24
BOUND = 0.05


@dataclass(frozen=True)
class Layer:
    """The atoms next to the counterface in one snapshot of a pressed slab; lengths in Å.

    Attributes
    ----------
    cell : side of the periodic cell.
    places : x and y, shape (atoms, 2).
    beyond : how far each lies beyond the counterface.
    depth : how far each lies below the plane of contact, at least 0.
    """

    cell: float
    places: np.ndarray
    beyond: np.ndarray
    depth: np.ndarray


def pressed_layers(
    slabs: Sequence[tuple[Potential, Atoms]], energy_scale: float, settings: HardnessSettings, work: Path
) -> list[Layer]:
    """Press a slab against a rigid flat (or, where there are two, against the second, which only repels it).

    Parameters
    ----------
    slabs : potential and glass of each, in cells of one width.
    """
    bodies = len(slabs)
    closing = settings.closing.model_copy(
        update={"counterface": "oxide" if bodies == 2 else "flat", "interface": "repulsive", "control": "speed"}
    )
    settings = settings.model_copy(update={"closing": closing})
    run = ClosingRun("slab", AsperitySettings(name="slab", tiles=SLAB_TILES, amplitude_nm=0), 1, energy_scale)
    plan = plan_closing(settings, run)
    start = plan.segments * plan.segment_steps  # from the clearance to first touch; the slab is pressed after it
    steps = start + round(SLAB_TRAVEL_A[bodies - 1] / (plan.speed * plan.timestep))
    plan = replace(plan, segments=-(-steps // plan.segment_steps))
    annealed = [
        prepare_body(
            run, glass, potential, settings, Workspace(work / f"anneal{k}", {}, "anneal.in"), (1, k), 0.0, SLAB_BASE_NM
        )
        for k, (potential, glass) in enumerate(slabs)
    ]
    workspace = Workspace(work / "pressed", {}, "closing.in")
    geometry, _ = press_bodies(
        run, annealed, slabs[0][0], settings, plan, (1, 9), workspace, counter_potential=slabs[-1][0]
    )
    low, high = (energy_scale * stress for stress in STRESS_GPA)
    layers = []
    for n in range(1, plan.segments + 1):
        force = {int(row[0]): row[2] for row in load_averages(workspace / f"averages.{n}")}
        for step, near in load_dump(workspace / f"near.{n}"):
            if low < force.get(step, 0.0) / geometry.wavelength_A**2 * EV_PER_A3_IN_GPA < high:
                places, beyond = beyond_counterface(near, geometry, settings.area.touch_A)
                height = near[near[:, 0] <= geometry.lower, 4]
                plane = np.mean(height[beyond > -settings.area.depth_A]) if bodies == 2 else np.max(height - beyond)
                layers.append(Layer(geometry.wavelength_A, places, beyond, np.maximum(0.0, plane - height)))
    return layers


Flank = Callable[[np.ndarray, float], np.ndarray]  # depth below the section (Å), its length (Å) -> half-width (Å)


def _planes(depth: np.ndarray, length: float) -> np.ndarray:
    return length / 2 + depth / SLOPE


def _sphere(depth: np.ndarray, length: float) -> np.ndarray:
    """Of twice the radius of the contact."""
    radius = length / np.sqrt(np.pi)
    return np.sqrt(4 * radius**2 - np.maximum(np.sqrt(3) * radius - depth, 0.0) ** 2)


def _wave(depth: np.ndarray, length: float) -> np.ndarray:
    """Eq. 6 with A / lambda = 0.1 where the contact takes up a quarter of the cell."""
    wavelength, amplitude = 2 * length, 0.2 * length
    height = amplitude * np.cos(np.pi * length / wavelength) - depth
    return wavelength / (2 * np.pi) * np.arccos(np.clip(height / amplitude, -1, 1))


FLANKS: dict[str, Flank] = {"planes": _planes, "sphere": _sphere, "wave": _wave}


def cut_layer(layer: Layer, shape: str, length_A: float, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Places and `beyond` of the atoms of a body cut from the tiled layer, its section of area length² about 0."""
    tiles = int(np.ceil(1.5 * length_A / layer.cell)) + 2
    steps = layer.cell * (np.arange(tiles) - tiles / 2)
    shifts = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    inside = np.mod(layer.places + rng.uniform(0, layer.cell, 2), layer.cell)
    places = (inside[:, None] + shifts).reshape(-1, 2)
    beyond, depth = (np.repeat(values, len(shifts)) for values in (layer.beyond, layer.depth))
    from_axis = np.hypot(*places.T) if shape == "sphere" else np.max(np.abs(places), axis=1)
    kept = from_axis < FLANKS[shape](depth, length_A)
    return places[kept], beyond[kept]


def area_rows(layers: list[Layer], area: AreaSettings, label: dict[str, str | float]) -> Iterator[dict]:
    """Accuracy points: found over known area, mean over random snapshots and places; bound 5 %."""
    for shape in FLANKS:
        for length in LENGTHS_NM:
            rng = np.random.default_rng(np.random.SeedSequence([31, round(10 * length)]))
            edge = 20 * length  # Å, twice the length: room for the rim
            ratios = []
            for _ in range(TRIALS):
                places, beyond = cut_layer(layers[rng.integers(len(layers))], shape, 10 * length, rng)
                touching = places[beyond > -area.depth_A]
                ratios.append(contact_area(touching, (edge, edge), area, (0.0, 0.0)) / (10 * length) ** 2)
            error = float(np.mean(ratios) - 1)
            yield {
                **label,
                "case": f"{shape}_{length:g}nm",
                "knob": "contact_length_nm",
                "value": length,
                "error": error,
                "error_metric": "found over known area, minus 1",
                "reference": "section by geometry",
                "bound": BOUND,
                "passed": abs(error) <= BOUND,
                "trials": TRIALS,
                "scatter": float(np.std(ratios, ddof=1)),
                "snapshots": len(layers),
            }
