"""What closing runs will cost, before they are run: atoms, steps, core-hours."""

from atomistic.hardness.asperity import MEAN_HEIGHT
from atomistic.hardness.film_base import Base
from atomistic.hardness.plateau import RULES
from atomistic.hardness.pressing import base_thickness_nm, plan_closing
from atomistic.hardness.runs import PROTOCOL, planned_runs, slowed
from atomistic.hardness.stack import check_film
from atomistic.materials import Material
from atomistic.settings import HardnessSettings

ATOM_STEPS_PER_CORE_SECOND = 1.3e6  # tabulated pair potential: 12 runs of scene reduced took 31 core-minutes
BASE_ATOM_STEPS_PER_CORE_SECOND = 0.6e6  # embedded atoms or a Tersoff potential, and pairs beside them


def plan_rows(
    settings: HardnessSettings, material: Material, counter_material: Material, base: Base | None = None
) -> list[dict[str, float | str]]:
    """One row per closing run, and their sum in the last.

    `restart_steps` is what a killed run loses at most.

    Parameters
    ----------
    material, counter_material : oxides of the asperity and of a counterface of atoms.
    base : what lies below films.

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
        film, closing, protocol = run.asperity.film_nm, settings.closing, PROTOCOL
        wavelength, amplitude = run.asperity.tiles * edge_nm, run.asperity.amplitude_nm
        below = base_thickness_nm(closing, wavelength) + MEAN_HEIGHT * amplitude
        speed, of_base = ATOM_STEPS_PER_CORE_SECOND, 0.0
        if film is not None and base is not None:
            protocol = slowed(PROTOCOL, base.below_films.timestep_factor)
            speed, of_base = BASE_ATOM_STEPS_PER_CORE_SECOND, base.atoms_per_nm3
            if film:
                check_film(film, RULES.max_area_fraction**0.5 * wavelength)
        plan = plan_closing(closing, run, protocol)
        atoms = wavelength**2 * (density * below if film is None else density * film + of_base * below)
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


def base_seconds(settings: HardnessSettings, material: Material, base: Base, tiles: int) -> float:
    """Of one core, for a cell of the base as wide as so many glass cells."""
    edge_A = 10 * (settings.glass.atoms / material.part("oxide_glass").quenched.atoms_per_nm3) ** (1 / 3)
    return base.make_atom_steps(edge_A, tiles) / BASE_ATOM_STEPS_PER_CORE_SECOND
