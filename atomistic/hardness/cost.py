"""What closing runs will cost, before they are run: atoms, steps, core-hours."""

from atomistic.hardness.asperity import MEAN_HEIGHT
from atomistic.hardness.pressing import base_thickness_nm, plan_closing
from atomistic.hardness.runs import PROTOCOL, planned_runs
from atomistic.materials import Material
from atomistic.settings import HardnessSettings

ATOM_STEPS_PER_CORE_SECOND = 1.3e6  # tabulated pair potential: 12 runs of scene reduced took 31 core-minutes


def plan_rows(
    settings: HardnessSettings, material: Material, counter_material: Material
) -> list[dict[str, float | str]]:
    """One row per closing run, and their sum in the last.

    `restart_steps` is what a killed run loses at most.

    Parameters
    ----------
    material, counter_material : oxides of the asperity and of a counterface of atoms.
    """
    density, counter_density = (_atoms_per_nm3(oxide) for oxide in (material, counter_material))
    rows: list[dict[str, float | str]] = []
    edge_nm = (settings.glass.atoms / density) ** (1 / 3)
    for run in planned_runs(settings):
        plan, closing = plan_closing(settings.closing, run), settings.closing
        wavelength, amplitude = run.asperity.tiles * edge_nm, run.asperity.amplitude_nm
        atoms = density * wavelength**2 * (base_thickness_nm(closing, wavelength) + MEAN_HEIGHT * amplitude)
        if closing.counterface != "flat":
            relief = amplitude if closing.counterface == "asperity" else 0
            thickness = PROTOCOL.counter_base_nm + MEAN_HEIGHT * relief
            atoms += counter_density * wavelength**2 * thickness
        seconds = atoms * plan.total_steps / ATOM_STEPS_PER_CORE_SECOND
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


def _atoms_per_nm3(oxide: Material) -> float:
    return oxide.part("oxide_glass").quenched.atoms_per_nm3
