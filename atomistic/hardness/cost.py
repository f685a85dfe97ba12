"""What closing runs will cost, before they are run: seconds of one core."""

import numpy as np

from atomistic.hardness.film_base import Base
from atomistic.hardness.plateau import RULES
from atomistic.hardness.pressing import base_thickness_nm, plan_closing
from atomistic.hardness.runs import PROTOCOL, planned_runs, slowed
from atomistic.hardness.stack import check_film
from atomistic.materials import Material
from atomistic.settings import HardnessSettings

# tabulated pair potential: 12 runs of scene reduced took 31 core-minutes
ATOM_STEPS_PER_CORE_SECOND = 1.3e6


def closing_seconds(
    settings: HardnessSettings, material: Material, base: Base | None = None
) -> dict[str, float]:
    """Of one core, by closing run.

    Parameters
    ----------
    material : oxide of the asperity.
    base : what lies below films.

    Raises
    ------
    InputError : a film that its asperity does not allow.
    """
    density = material.part("oxide_glass").quenched.atoms_per_nm3
    seconds = {}
    for run in planned_runs(settings):
        film = run.asperity.film_nm
        protocol = PROTOCOL
        wavelength = run.asperity.tiles * glass_edge_A(settings, material) / 10
        mean_height = -4 / np.pi**2 * run.asperity.amplitude_nm  # of the smaller of two sines
        below = base_thickness_nm(settings.closing, wavelength) + mean_height
        speed = ATOM_STEPS_PER_CORE_SECOND
        of_base = 0.0
        if film is not None and base is not None:
            protocol = slowed(PROTOCOL, base.below_films.timestep_factor)
            # embedded atoms or a Tersoff potential, and pairs beside them
            speed, of_base = 0.6e6, base.atoms_per_nm3
            if film:
                check_film(film, RULES.max_area_fraction**0.5 * wavelength)
        atoms_per_nm2 = density * below
        if film is not None:
            atoms_per_nm2 = density * film + of_base * below
        atoms = wavelength**2 * atoms_per_nm2
        steps = plan_closing(settings.closing, run, protocol).total_steps
        seconds[run.name] = atoms * steps / speed
    return seconds


def glass_edge_A(settings: HardnessSettings, material: Material) -> float:
    """Edge of a quenched cell."""
    return 10 * (settings.glass.atoms / material.part("oxide_glass").quenched.atoms_per_nm3) ** (
        1 / 3
    )
