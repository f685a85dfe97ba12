"""Oxide glass by melt and quench, and the gates it must pass.

A glass cell is periodic and cubic; bodies are cut from a tiling of it, so that a wavelength is a
whole number of cells and nothing is strained.
"""

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from asperity.guards.errors import InputError
from atomistic.constants import AVOGADRO
from atomistic.covalent import random_places
from atomistic.lammps import Atoms, LammpsFolder, Progress, load_data, run_lammps, write_data
from atomistic.materials import SEARCHED_A, SHORTEST_BOND_A, Material, OxideGlass
from atomistic.potentials import ForceField, Potential
from atomistic.settings import GlassSettings

NEAREST_START_A = 1.5  # random starts keep atoms this far apart
MELT_K = 4000.0  # every shipped potential melts in some ps
FINAL_K = 300.0  # the temperature of the closings
TIMESTEP_FS = 2.0  # energy is kept to 0.2 meV per atom and ps, also in the melt


def cations(material: Material, potential: Potential) -> tuple[str, ...]:
    """The cation species of a material."""
    return tuple(
        ion
        for ion in potential.materials[material.formula_text]
        if potential.species[ion].charge_e > 0
    )


def random_start(
    material: Material, potential: Potential, settings: GlassSettings, seed: int
) -> Atoms:
    """Ions at random places of a cube of the experimental density, no two nearer than 1.5 Å."""
    formula = _formula(material, potential)
    elements = tuple(formula)
    units = max(1, round(settings.atoms / sum(formula.values())))
    counts = [units * count for count in formula.values()]
    masses_u = [potential.species[ion].mass_u for ion in elements]
    mass_u = sum(count * mass for count, mass in zip(counts, masses_u, strict=True))
    volume_A3 = mass_u / AVOGADRO / material.part("oxide_glass").density_g_cm3 * 1e24
    edge_A = volume_A3 ** (1 / 3)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 1]))
    placed = random_places(sum(counts), np.full(3, edge_A), NEAREST_START_A, rng)
    types = rng.permutation(np.repeat(np.arange(1, len(elements) + 1), counts))
    return Atoms(elements, types, placed, np.full(3, edge_A))


def _formula(material: Material, potential: Potential) -> Mapping[str, int]:
    if material.formula_text not in potential.materials:
        raise InputError(
            f"potential {potential.name}: material {material.formula_text} is not among "
            f"{', '.join(potential.materials)}; choose another potential or material"
        )
    return potential.materials[material.formula_text]


def write_forcefield(
    workspace: LammpsFolder, potential: ForceField, elements: tuple[str, ...], energy_scale: float
) -> None:
    """Write a potential's tables and the commands that use them (file `pairs`).

    They are written at every start, since LAMMPS executes `pairs`: one that came with a received
    folder must not run.

    Parameters
    ----------
    elements : of each LAMMPS type.
    """
    for file, text in potential.files(elements, energy_scale).items():
        (workspace / file).write_text(text, encoding="utf-8")


SEGMENT_KEYS = ("ensemble", "from", "to", "steps")
"""What a segment of `glass.in` has."""


def make_glass(
    material: Material,
    potential: Potential,
    settings: GlassSettings,
    seed: int,
    work: Path,
    progress: Progress | None = None,
    segment_steps: int = 5000,
) -> Atoms:
    """Melt a random start and quench it; resumes in `work` after a kill.

    Parameters
    ----------
    material : an oxide, with the `oxide_glass` that its file in config/materials gives.
    segment_steps : a killed quench loses at most as many.

    Returns
    -------
    Atoms at 300 K, cell at the volume of the last step.

    Raises
    ------
    InputError : the potential does not know the material, or nothing is known of its glass.
    """
    elements = tuple(_formula(material, potential))
    identity = {
        "potential": potential.model_dump(),
        "settings": settings.model_dump(),
        "seed": seed,
        "of": [material.formula_text, material.part("oxide_glass").density_g_cm3],
        "constants": [MELT_K, FINAL_K, TIMESTEP_FS, segment_steps],
    }
    return run_segments(
        LammpsFolder(work, identity, "glass.in"),
        potential,
        elements,
        lambda: random_start(material, potential, settings, seed),
        schedule(settings, segment_steps),
        1 + int(np.random.SeedSequence([seed, 2]).generate_state(1)[0] % 900_000_000),
        TIMESTEP_FS,
        "melt and quench",
        progress,
    )


def run_segments(
    workspace: LammpsFolder,
    force: ForceField,
    elements: tuple[str, ...],
    start: Callable[[], Atoms],
    segments: Sequence[Mapping[str, Any]],
    seed: int,
    timestep_fs: float,
    doing: str,
    progress: Progress | None,
) -> Atoms:
    """Carry out segments of a periodic cell (glass.in), or go on; deletes the workspace at the end.

    Parameters
    ----------
    start : makes the cell, where nothing is done yet.
    segments : ensemble, temperatures `from` and `to` (K) and steps of each.
    doing : what this is, for the progress.
    """
    done = workspace.segments_done(len(segments))
    write_forcefield(workspace, force, elements, 1.0)
    if not done:
        write_data(workspace / "start.data", start(), force.masses_u)
    total = sum(segment["steps"] for segment in segments)

    def on_step(step: int) -> None:
        if progress is not None:
            progress(step / total, f"{step * timestep_fs / 1000:.0f} ps of {doing}")

    if left := segments[done:]:
        columns = {key: [segment[key] for segment in left] for key in SEGMENT_KEYS}
        variables = {
            "data": "start.data",
            "pairs": "pairs",
            "seed": seed,
            "timestep": timestep_fs / 1000,
            "segment": range(done + 1, len(segments) + 1),
            "previous": range(done, len(segments)),
            **columns,
        }
        run_lammps("glass.in", workspace, variables, on_step)
    end = load_data(workspace / "glass.data", elements)
    workspace.remove()
    return end


def schedule(settings: GlassSettings, segment_steps: int) -> list[dict]:
    """Segments of the melt (constant volume), and of the quench and the rest (zero pressure)."""

    def steps(duration_ps: float) -> int:
        return max(1, round(1000 * duration_ps / TIMESTEP_FS))

    def segment(ensemble: str, begin_K: float, end_K: float, duration_ps: float) -> dict:
        return {"ensemble": ensemble, "from": begin_K, "to": end_K, "steps": steps(duration_ps)}

    quench_ps = (MELT_K - FINAL_K) / settings.quench_rate_K_ps
    count = max(1, round(steps(quench_ps) / segment_steps))
    ramp_K = np.linspace(MELT_K, FINAL_K, count + 1).tolist()
    hotter = segment("nvt", 1.5 * MELT_K, MELT_K, 0.3 * settings.melt_ps)
    melt = segment("nvt", MELT_K, MELT_K, 0.7 * settings.melt_ps)
    quench = [
        segment("npt", high_K, low_K, quench_ps / count) for high_K, low_K in pairwise(ramp_K)
    ]
    rest = segment("npt", FINAL_K, FINAL_K, settings.rest_ps)
    return [hotter, melt, *quench, rest]


def density_g_cm3(atoms: Atoms, force: ForceField) -> float:
    """Density of a periodic cell."""
    masses_u = np.array([force.masses_u[element] for element in atoms.elements])
    mass_g = float(masses_u[atoms.types - 1].sum()) / AVOGADRO
    return mass_g / (float(np.prod(atoms.cell_A)) * 1e-24)


def unlike_neighbours(
    atoms: Atoms, kind: np.ndarray, reach_A: float
) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of unlike atoms within a distance, shape (pairs, 2), and their distances (Å).

    Parameters
    ----------
    kind : of each atom.
    """
    places = np.mod(atoms.positions_A, atoms.cell_A)
    pairs = KDTree(places, boxsize=atoms.cell_A).query_pairs(reach_A, output_type="ndarray")
    pairs = pairs[kind[pairs[:, 0]] != kind[pairs[:, 1]]]
    apart = places[pairs[:, 0]] - places[pairs[:, 1]]
    apart -= atoms.cell_A * np.round(apart / atoms.cell_A)
    return pairs, np.linalg.norm(apart, axis=1)


def commonest_A(distances_A: np.ndarray) -> float:
    """Commonest distance of unlike neighbours, where their radial distribution is largest."""
    edges = np.arange(SHORTEST_BOND_A, SEARCHED_A, 0.02)
    middle = 0.5 * (edges[1:] + edges[:-1])
    distribution = np.histogram(distances_A, edges)[0] / middle**2
    smooth = np.convolve(distribution, np.ones(3) / 3, mode="same")
    return float(middle[np.argmax(smooth)])


def glass_properties(material: Material, potential: Potential, atoms: Atoms) -> dict:
    """Density, coordination, bond length of a glass, and the gate of its material file."""
    reference: OxideGlass = material.part("oxide_glass")
    formula = material.formula_text
    sources = "; ".join(material.sources[name] for name in reference.sources)
    density = density_g_cm3(atoms, potential)
    ions = [atoms.elements.index(ion) + 1 for ion in cations(material, potential)]
    is_cation = np.isin(atoms.types, ions)
    _, distances_A = unlike_neighbours(atoms, is_cation, SEARCHED_A)
    bonded = np.sum(distances_A < reference.cutoff_A)
    coordination = float(bonded / np.sum(is_cation))
    checks = {
        "density_g_cm3": (density, reference.density_range_g_cm3),
        "bond_A": (commonest_A(distances_A), reference.bond_range_A),
        "cation_coordination": (coordination, reference.coordination_range),
    }
    reasons = []
    for name, (value, (low, high)) in checks.items():
        if not low <= value <= high:
            reasons.append(
                f"{formula} glass: {name} {value:.3g} outside {low:g}..{high:g} ({sources})"
            )
    return {
        "material": formula,
        "atoms": len(atoms),
        "cell_nm": float(atoms.cell_A[0]) / 10,
        **{name: value for name, (value, _) in checks.items()},
        "gate": {"passed": not reasons, "reasons": reasons},
    }
