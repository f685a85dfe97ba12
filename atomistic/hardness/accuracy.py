"""What hardness depends on besides the asperity: one choice at a time on the smallest closing run of a scene."""

from collections.abc import Iterator, Mapping

from atomistic.hardness.plateau import Rows, find_hardness
from atomistic.hardness.runs import PROTOCOL, ClosingRun, Protocol
from atomistic.settings import ClosingSettings

DEFAULT = "default"
VARIATIONS = {  # choice and factor on it
    DEFAULT: ("speed_m_s", 1.0),
    "speed_double": ("speed_m_s", 2.0),
    "speed_fourfold": ("speed_m_s", 4.0),
    "timestep_half": ("timestep_fs", 0.5),
    "wall_stiffness_fourfold": ("wall_stiffness_eV_A3", 4.0),
    "temperature_tenth": ("temperature_K", 0.1),
    "base_larger": ("base_over_contact", 1.5),
    "bonds_weaker": ("bond_factor", 0.5),
    "bonds_stronger": ("bond_factor", 1.5),
}


def variations(run: ClosingRun) -> list[str]:
    """Those that mean something for a run: bonds of film and metal are of films only."""
    return [name for name, (key, _) in VARIATIONS.items() if key != "bond_factor" or run.asperity.film_nm]


def varied(name: str, closing: ClosingSettings) -> tuple[ClosingSettings, Protocol]:
    """Settings and protocol of a closing with one choice changed."""
    key, factor = VARIATIONS[name]
    of = closing if key == "speed_m_s" else PROTOCOL
    changed = of.model_copy(update={key: factor * getattr(of, key)})
    return (changed, PROTOCOL) if isinstance(changed, ClosingSettings) else (closing, changed)


def compare(
    curves: Mapping[str, Rows], witnesses: Mapping[str, Rows], runs: Mapping[str, Mapping], closing: ClosingSettings
) -> Iterator[dict]:
    """Accuracy points of the variations: plateau stress of each against the default's.

    The scatter of a single run (`hardness_lo`, `hardness_hi`) limits what a difference means.
    """
    hardnesses = {
        name: find_hardness(
            curves[name], witnesses[name], run["wavelength_nm"] ** 2, on_base=run.get("film_nm") is not None
        )
        for name, run in runs.items()
    }
    for name, hardness in hardnesses.items():
        key, run = VARIATIONS[name][0], runs[name]
        settings, protocol = varied(name, closing)
        yield {
            "case": name,
            "knob": key,
            "value": getattr(settings if key == "speed_m_s" else protocol, key),
            "error": hardness.hardness_GPa / hardnesses[DEFAULT].hardness_GPa - 1,
            "error_metric": "relative difference of the plateau stress",
            "reference": DEFAULT,
            "hardness_GPa": hardness.hardness_GPa,
            "wall_s": run["wall_s"],
            "cpu_s": run["lammps_cpu_s"] + run["python_cpu_s"],
            "peak_rss_MB": run.get("peak_rss_MB"),
            "hardness_lo": hardness.hardness_lo,
            "hardness_hi": hardness.hardness_hi,
            "status": hardness.status,
            "atom_steps": run["atoms"] * run["steps"],
        }
