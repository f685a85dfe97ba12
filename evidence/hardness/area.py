"""How large is the error of the contact area?

Bodies whose section is known: a flat slab of glass is pressed at 300 K by a flat.  Its frozen
snapshots have the layer of atoms of a contact under load.  Tiled and cut by planes, by a sphere and
by a wave of the slopes in use, they have a section that geometry gives exactly.  The potential's
file then gets the largest error as `contact_area`. With `--base` the slabs are that metal, and a
film of the glass on it; the metal's file gets both errors (`film_base`). Rows with two `bodies` are
of slabs pressed by a second one, which the stage did until commit 884b5d7.
"""

import tempfile
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.hardness.asperity import cut_asperity, formula_of
from atomistic.hardness.closing import CutBody, cut_body
from atomistic.hardness.contact_area import Area, contact_area
from atomistic.hardness.film_base import Base
from atomistic.hardness.glass import make_glass
from atomistic.hardness.pressing import lammps_seed, plan_closing, prepare_body, press_body
from atomistic.hardness.readout import PressedCell
from atomistic.hardness.runs import PROTOCOL, ClosingRun, Protocol, slowed
from atomistic.hardness.stack import base_of
from atomistic.lammps import Atoms, LammpsFolder, load_averages, load_dump
from atomistic.materials import load_material, load_materials, oxide_glasses
from atomistic.potentials import Potential, load_potential
from atomistic.settings import AsperitySettings, ClosingSettings, GlassSettings
from evidence.record import ROOT

SLAB_TILES, SLAB_BASE_NM, SLAB_TRAVEL_A = 2, 2.0, 7.0
STRESS_GPA = (6.0, 14.0)  # of the snapshots in use, at full energies: about the hardness
SLAB_FILM_NM = 1.2
LENGTHS_NM = (2.0, 3.0, 4.0, 6.0, 8.0)
SLOPE = 0.6  # of the planes: that of eq. 6 with A / lambda = 0.1 halfway up is 0.63
TRIALS = 24


def arguments(parser: ArgumentParser) -> None:
    """Potential, oxide and base."""
    parser.add_argument("--potential", default="pmmcs", help="of config/potentials")
    parser.add_argument("--material", default="SiO2")
    parser.add_argument(
        "--base", help="metal of config/materials, for slabs of it and of a film on it"
    )
    parser.add_argument("--energy-scales", type=float, nargs="+", default=[1.0, 0.5])


def rows(given: Namespace) -> Iterator[dict]:
    """Cut bodies of a slab of glass at each energy scale, or of slabs of the base and of a film on
    it.
    """
    oxides = oxide_glasses(load_materials(ROOT / "config" / "materials").values())
    first = load_potential(ROOT / "config" / "potentials" / f"{given.potential}.yaml")
    area = Area()
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        glass = make_glass(oxides[given.material], first, GlassSettings(), 1, work / "glass")
        if given.base:
            below = base_of(load_material(ROOT / "config" / "materials" / f"{given.base}.yaml"))
            protocol = slowed(PROTOCOL, below.below_films.timestep_factor)
            for name, slab in on_base(glass, first, below, work).items():
                for row in cut_bodies(pressed_layers(slab, 1.0, area, work / name, protocol), area):
                    yield {
                        "potential": name,
                        "energy_scale": 1.0,
                        "bodies": 1,
                        "touch_A": 2.4,
                        **row,
                    }
            return
        for scale in given.energy_scales:
            slab = cut_asperity(glass, SLAB_TILES, 0.0, 10 * SLAB_BASE_NM, lammps_seed(1, 0, 3))
            body = CutBody(slab, formula_of(glass), first)
            for row in cut_bodies(pressed_layers(body, scale, area, work / f"{scale:g}"), area):
                yield {
                    "potential": first.name,
                    "energy_scale": scale,
                    "bodies": 1,
                    "touch_A": 2.4,
                    **row,
                }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Largest error of each body."""
    groups: dict[str, list[float]] = {}
    for row in rows:
        if row["bodies"] == "1" and row["touch_A"] == "2.4":
            name = row["potential"].replace(" ", "_") + "_halved" * (
                float(row["energy_scale"]) == 0.5
            )
            groups.setdefault(name, []).append(abs(float(row["error"])))
    return {name: f"{100 * max(errors):.1f} %" for name, errors in groups.items()}


@dataclass(frozen=True)
class Layer:
    """The atoms next to the flat in one snapshot of a pressed slab; lengths in Å.

    Attributes
    ----------
    cell : side of the periodic cell.
    places : x and y, shape (atoms, 2).
    beyond : how far each lies beyond the flat.
    depth : how far each lies below the plane of contact, at least 0.
    """

    cell: float
    places: np.ndarray
    beyond: np.ndarray
    depth: np.ndarray


def on_base(glass: Atoms, potential: Potential, below: Base, work: Path) -> dict[str, CutBody]:
    """Flat slabs of the base, and of a film on it, by the name of their rows."""
    cell, base = (
        below.make(float(glass.cell_A[0]), SLAB_TILES, 1, work / "base"),
        below.material.name,
    )
    found = {}
    for name, film_nm in ((base, 0.0), (f"{potential.name} film on {base}", SLAB_FILM_NM)):
        run = _flat_run(1.0, film_nm)
        found[name] = cut_body(run, glass, potential, SLAB_BASE_NM, (1, 0), (below, cell))
    return found


def _flat_run(energy_scale: float, film_nm: float | None = None) -> ClosingRun:
    """Of a slab: no asperity."""
    flat = AsperitySettings.model_construct(
        name="slab", tiles=SLAB_TILES, amplitude_nm=0.0, film_nm=film_nm
    )
    return ClosingRun.model_construct(name="slab", asperity=flat, seed=1, energy_scale=energy_scale)


def pressed_layers(
    slab: CutBody, energy_scale: float, area: Area, work: Path, protocol: Protocol = PROTOCOL
) -> list[Layer]:
    """Press a slab by the rigid flat.

    Parameters
    ----------
    slab : flat.
    """
    closing, run = ClosingSettings(), _flat_run(energy_scale)
    plan = plan_closing(closing, run, protocol)
    # from the clearance to first touch; the slab is pressed after it
    start = plan.segments * plan.segment_steps
    steps = start + round(SLAB_TRAVEL_A / (plan.speed * plan.timestep))
    plan = replace(plan, segments=-(-steps // plan.segment_steps))
    aside, place = LammpsFolder(work / "anneal", {}, "anneal.in"), (1, 0)
    annealed = prepare_body(
        run, slab.atoms, slab.formula, slab.force, closing, protocol, aside, place
    )
    workspace = LammpsFolder(work / "pressed", {}, "closing.in")
    low, high = (run.energy_scale * stress for stress in STRESS_GPA)

    def pressed_enough(cell: PressedCell, segments: int) -> bool:
        """Stiff slabs would be crushed on the whole travel."""
        force = load_averages(workspace / f"averages.{segments}")[-1, 2]
        return force / cell.wavelength_A**2 * EV_PER_A3_IN_GPA > high

    cell, reached = press_body(
        run, annealed, slab.force, closing, protocol, plan, (1, 9), workspace, pressed_enough
    )
    layers = []
    for n in range(1, reached.segments + 1):
        force = {int(row[0]): row[2] for row in load_averages(workspace / f"averages.{n}")}
        for step, near in load_dump(workspace / f"near.{n}"):
            if low < force.get(step, 0.0) / cell.wavelength_A**2 * EV_PER_A3_IN_GPA < high:
                places, height, beyond = near[:, 2:4], near[:, 4], near[:, 5]
                plane = np.max(height - beyond)
                layers.append(
                    Layer(cell.wavelength_A, places, beyond, np.maximum(0.0, plane - height))
                )
    return layers


# depth below the section (Å), its length (Å) -> half-width (Å)
Flank = Callable[[np.ndarray, float], np.ndarray]


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


def cut_layer(
    layer: Layer, shape: str, length_A: float, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Places and `beyond` of the atoms of a body cut from the tiled layer, its section of area
    length² about 0.
    """
    tiles = int(np.ceil(1.5 * length_A / layer.cell)) + 2
    steps = layer.cell * (np.arange(tiles) - tiles / 2)
    shifts = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    inside = np.mod(layer.places + rng.uniform(0, layer.cell, 2), layer.cell)
    places = (inside[:, None] + shifts).reshape(-1, 2)
    beyond, depth = (np.repeat(values, len(shifts)) for values in (layer.beyond, layer.depth))
    from_axis = np.hypot(*places.T) if shape == "sphere" else np.max(np.abs(places), axis=1)
    kept = from_axis < FLANKS[shape](depth, length_A)
    return places[kept], beyond[kept]


def cut_bodies(layers: list[Layer], area: Area) -> Iterator[dict]:
    """Found over known area, minus 1: mean over random snapshots and places."""
    for shape in FLANKS:
        for length in LENGTHS_NM:
            rng = np.random.default_rng(np.random.SeedSequence([31, round(10 * length)]))
            edge = 20 * length  # Å, twice the length: room for the rim
            ratios = []
            for _ in range(TRIALS):
                places, beyond = cut_layer(
                    layers[rng.integers(len(layers))], shape, 10 * length, rng
                )
                touching = places[beyond > -area.depth_A]
                ratios.append(
                    contact_area(touching, (edge, edge), area, (0.0, 0.0)) / (10 * length) ** 2
                )
            yield {
                "shape": shape,
                "length_nm": length,
                "error": float(np.mean(ratios) - 1),
                "scatter": float(np.std(ratios, ddof=1)),
                "snapshots": len(layers),
            }
