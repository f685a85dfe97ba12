"""What closing runs will cost, before they are run: atoms, steps, core-hours."""

import numpy as np

from atomistic.hardness.asperity import MEAN_HEIGHT
from atomistic.hardness.metal import base_steps
from atomistic.hardness.plateau import RULES
from atomistic.hardness.pressing import base_thickness_nm, plan_closing
from atomistic.hardness.runs import PROTOCOL, planned_runs
from atomistic.hardness.stack import check_film
from atomistic.materials import Eam, Material
from atomistic.settings import HardnessSettings

ATOM_STEPS_PER_CORE_SECOND = 1.3e6  # tabulated pair potential: 12 runs of scene reduced took 31 core-minutes
METAL_ATOM_STEPS_PER_CORE_SECOND = 0.6e6  # embedded atoms, and pairs beside them


def plan_rows(
    settings: HardnessSettings, material: Material, counter_material: Material, base: Material | None = None
) -> list[dict[str, float | str]]:
    """One row per closing run, and their sum in the last.

    `restart_steps` is what a killed run loses at most.

    Parameters
    ----------
    material, counter_material : oxides of the asperity and of a counterface of atoms.
    base : metal below films.

    Raises
    ------
    InputError : a film that its asperity does not allow.
    """
    density, counter_density = (
        oxide.part("oxide_glass").quenched.atoms_per_nm3 for oxide in (material, counter_material)
    )
    rows: list[dict[str, float | str]] = []
    edge_nm = (settings.glass.atoms / density) ** (1 / 3)
    for run in planned_runs(settings):
        plan, closing = plan_closing(settings.closing, run), settings.closing
        wavelength, amplitude = run.asperity.tiles * edge_nm, run.asperity.amplitude_nm
        film, below = run.asperity.film_nm, base_thickness_nm(closing, wavelength) + MEAN_HEIGHT * amplitude
        speed, metal = ATOM_STEPS_PER_CORE_SECOND, 0.0
        if film is not None and base is not None:
            speed, metal = METAL_ATOM_STEPS_PER_CORE_SECOND, atoms_per_nm3(base.part("eam"))
            if film:
                check_film(film, RULES.max_area_fraction**0.5 * wavelength)
        atoms = wavelength**2 * (density * below if film is None else density * film + metal * below)
        if closing.counterface != "flat":
            relief = amplitude if closing.counterface == "asperity" else 0
            thickness = PROTOCOL.counter_base_nm + MEAN_HEIGHT * relief
            atoms += counter_density * wavelength**2 * thickness
        seconds = atoms * plan.total_steps / speed
        rows.append(
            {
                "run": run.name,
                "wavelength_nm": wavelength,
                "atoms": round(atoms),
                "steps": plan.total_steps,
                "restart_steps": plan.segment_steps,
                "atom_steps": atoms * plan.total_steps,
                "core_hours": seconds / 3600,
                "hours": seconds / 3600 / closing.processes,
                "processes": closing.processes,
            }
        )
    total = {key: sum(float(row[key]) for row in rows) for key in ("atom_steps", "core_hours")}
    return [*rows, {"run": "all", **total}]


def atoms_per_nm3(eam: Eam) -> float:
    """Of the hexagonal crystal."""
    a, c = eam.lattice_A
    return 4e3 / (a**2 * np.sqrt(3) * c)


def base_seconds(settings: HardnessSettings, material: Material, base: Material, tiles: int) -> float:
    """Of one core, for a cube of metal as wide as so many glass cells."""
    edge_nm = tiles * (settings.glass.atoms / material.part("oxide_glass").quenched.atoms_per_nm3) ** (1 / 3)
    return edge_nm**3 * atoms_per_nm3(base.part("eam")) * base_steps() / METAL_ATOM_STEPS_PER_CORE_SECOND
