"""What hardness depends on besides the asperity: one knob at a time on the smallest closing run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from atomistic.hardness.plateau import Rows, find_hardness
from atomistic.hardness.runs import ClosingRun, planned_runs
from atomistic.settings import ClosingSettings, HardnessSettings

DEFAULT = "default"


@dataclass(frozen=True)
class Variation:
    """A changed key of `closing`."""

    name: str
    key: str
    factor: float

    def closing(self, settings: HardnessSettings) -> ClosingSettings:
        """The closing settings with the key changed."""
        if not self.key:
            return settings.closing
        value = getattr(settings.closing, self.key) * self.factor
        return settings.closing.model_copy(update={self.key: value})


VARIATIONS = {
    variation.name: variation
    for variation in (
        Variation(DEFAULT, "", 1),
        Variation("speed_double", "speed_m_s", 2),
        Variation("speed_fourfold", "speed_m_s", 4),
        Variation("timestep_half", "timestep_fs", 0.5),
        Variation("wall_stiffness_fourfold", "wall_stiffness_eV_A3", 4),
        Variation("temperature_tenth", "temperature_K", 0.1),
        Variation("base_larger", "base_over_contact", 1.5),
    )
}


def smallest_run(settings: HardnessSettings) -> ClosingRun:
    """The cheapest run of a scene at its highest energy scale."""
    return min(
        planned_runs(settings),
        key=lambda run: (run.asperity.tiles, run.asperity.amplitude_nm, -run.energy_scale),
    )


def compare(
    curves: Mapping[str, Rows],
    witnesses: Mapping[str, Rows],
    runs: Mapping[str, Mapping],
    settings: HardnessSettings,
) -> list[dict]:
    """Accuracy points of the variations: plateau stress of each variation against the default's.

    The scatter of a single run (`hardness_lo`, `hardness_hi`) limits what a difference means.
    """
    hardnesses = {
        name: find_hardness(
            curves[name],
            witnesses[name],
            runs[name]["wavelength_nm"] ** 2,
            VARIATIONS[name].closing(settings),
            settings.plasticity,
        )
        for name in curves
    }
    reference = hardnesses[DEFAULT].hardness_GPa
    rows = []
    for name, hardness in hardnesses.items():
        variation, run = VARIATIONS[name], runs[name]
        value = getattr(variation.closing(settings), variation.key) if variation.key else settings.closing.speed_m_s
        rows.append(
            {
                **_row(name, variation.key or "speed_m_s", value, hardness.hardness_GPa, reference),
                "wall_s": run["wall_s"],
                "cpu_s": run["lammps_cpu_s"] + run["python_cpu_s"],
                "peak_rss_MB": run.get("peak_rss_MB"),
                "hardness_lo": hardness.hardness_lo,
                "hardness_hi": hardness.hardness_hi,
                "status": hardness.status,
                "atom_steps": run["atoms"] * run["steps"],
            }
        )
    rows += _area_definitions(
        curves[DEFAULT], hardnesses[DEFAULT].onset_displacement_nm, settings, reference, runs[DEFAULT]
    )
    return rows


def _area_definitions(
    curve: Rows, onset_nm: float, settings: HardnessSettings, reference: float, run: Mapping
) -> Sequence[dict]:
    """The same run and the same averages with the area of other depths."""
    column = {name: np.array([float(row[name]) for row in curve]) for name in curve[0]}
    window = (
        (column["displacement_nm"] >= onset_nm)
        & (column["contact_length_nm"] >= settings.plasticity.min_length_nm)
        & (column["contact_area_nm2"] <= settings.plasticity.max_area_fraction * run["wavelength_nm"] ** 2)
    )
    rows = []
    for name in column:
        if name.startswith("contact_area_nm2_depth_") and np.any(window):
            depth = float(name.removeprefix("contact_area_nm2_depth_").removesuffix("A"))
            stress = float(np.mean(column["force_nN"][window] / column[name][window]))
            rows.append(
                {
                    **_row(f"area_depth_{depth:g}A", "area.depth_A", depth, stress, reference),
                    "peak_rss_MB": None,  # costs nothing of its own
                    "status": "yield",
                }
            )
    return rows


def _row(case: str, knob: str, value: float, hardness: float, reference: float) -> dict:
    return {
        "case": case,
        "knob": knob,
        "value": value,
        "error": hardness / reference - 1,
        "error_metric": "relative difference of the plateau stress",
        "reference": DEFAULT,
        "hardness_GPa": hardness,
    }
