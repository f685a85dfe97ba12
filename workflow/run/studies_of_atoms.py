"""The studies of the stages of atoms, each from what its job reads, for the driver of all
studies.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from atomistic import for_studies
from atomistic.elastic import accuracy as elastic_accuracy
from atomistic.elastic import stability as elastic_stability
from atomistic.elastic.moduli import share_of_glass
from atomistic.elastic.structures import trusted_moduli
from atomistic.hardness import accuracy as hardness_accuracy
from atomistic.hardness import stability as hardness_stability
from atomistic.lammps import Atoms, load_data
from atomistic.materials import Material, load_material
from atomistic.potentials import Potential, load_potential
from atomistic.settings import DftSettings, HardnessSettings
from mesoscale.contact.numerics import NUMERICS
from mesoscale.studies.driver import (
    Choice,
    Cost,
    Errors,
    HardCase,
    Knob,
    Progress,
    Quantity,
    StudyRow,
    root_mean_square,
    rows_of,
    stability_rows,
    timed,
)
from mesoscale.studies.in_volts import volts_per_percent
from workflow.files.results import load_csv, load_json
from workflow.files.structures import load_structure
from workflow.run.central_pads import central_pads
from workflow.run.job import settings_from_job

SAMPLES = 2
"""Glasses that tell an error: enough to see whether it is one, at twice the cost."""


def accuracy_of_elastic(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Of the bulk modulus of the scene's glasses."""
    dft = settings_from_job(DftSettings, snakemake.params.elastic["dft"])
    moduli = trusted_moduli(
        load_csv(snakemake.input.moduli), [load_json(path) for path in snakemake.input.reports]
    )
    trusted = [modulus for modulus in moduli if modulus.xc == "GGA" and modulus.trusted]
    structures = {Path(path).stem: path for path in snakemake.input.structures}
    scans = {Path(path).stem: load_csv(path) for path in snakemake.input.scans}
    glasses = []
    seconds = []
    for modulus in trusted:
        scan = [
            row
            for row in scans[modulus.structure]
            if row["xc"] == "GGA" and row["converged"] == "True"
        ]
        seconds.append(sum(float(row["wall_s"]) for row in scan))
        energies_eV = {float(row["strain"]): float(row["energy_eV"]) for row in scan}
        if len(glasses) < SAMPLES:
            glass = load_structure(structures[modulus.structure])
            glasses.append(elastic_accuracy.ScannedGlass(glass, dft, energies_eV))
    scan_s = float(np.mean(seconds)) if seconds else 0.0
    choices = elastic_accuracy.variations(glasses, [modulus.B_GPa for modulus in trusted], scan_s)
    volts = {}
    if of_e_star := input_volts(snakemake, ("e_star",)):
        volts["B"] = share_of_glass(load_json(snakemake.input.e_star)) * of_e_star["e_star"]
    return rows_of(knobs_of(choices, volts), progress)


def stability_of_elastic(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Cells and scans that have no modulus."""
    material = load_material(snakemake.input.material)
    return hard_rows(elastic_stability.hard_cases(material), progress)


def accuracy_of_hardness(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Of the smallest asperity of the scene, pressed in small form; a film is left out."""
    settings = settings_from_job(HardnessSettings, snakemake.params.hardness)
    smallest = min(
        settings.asperities, key=lambda asperity: (asperity.tiles, asperity.amplitude_nm)
    )
    _, potential, glass, work = atoms_of_job(snakemake)
    closings = hardness_accuracy.SmallClosings(smallest, glass, potential, settings.closing, work)
    # of a film, h_macro is that of its base
    volts = input_volts(snakemake, ("h_film",)) or input_volts(snakemake, ("h_macro", "h_prime"))
    moved = {"pressure at depth": sum(volts.values())} if volts else {}
    return rows_of(knobs_of(hardness_accuracy.variations(closings), moved), progress)


def stability_of_hardness(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Closings without a hardness, and atoms that are hot, fast or too near."""
    return hard_rows(hardness_stability.hard_cases(*atoms_of_job(snakemake)), progress)


def atoms_of_job(snakemake: Any) -> tuple[Material, Potential, Atoms, Path]:
    """Oxide, its potential and a glass, and the folder of the job."""
    material = load_material(snakemake.input.material)
    potential = load_potential(snakemake.input.potential)
    glass = load_data(snakemake.input.glass, tuple(potential.materials[material.formula_text]))
    work = Path(snakemake.params.work)
    work.mkdir(parents=True, exist_ok=True)
    return material, potential, glass, work


def hard_rows(
    cases: Sequence[for_studies.HardCase], progress: Progress | None = None
) -> Iterator[StudyRow]:
    """Rows of a stability table without the stage."""
    return stability_rows([HardCase(*case) for case in cases], progress)


def input_volts(snakemake: Any, names: Sequence[str]) -> dict[str, float]:
    """What 1 % more of some inputs moves in the release, V; empty where the scene has no switch or
    none of them.
    """
    pads = central_pads(snakemake)
    if pads is None:
        return {}
    point, on_grid, releases = pads
    return volts_per_percent(point, lambda moved: releases(moved, on_grid, NUMERICS), names)


def knobs_of(variations: Sequence[for_studies.Variation], volts: Mapping[str, float]) -> list[Knob]:
    """The choices of a stage of atoms as the driver takes them.

    Parameters
    ----------
    volts : what an error of one unit moves in the release, V, by quantity where it is known.
    """
    knobs = []
    for variation in variations:
        quantities = [
            Quantity(name, unit, volts=volts.get(name)) for name, unit in variation.quantities
        ]
        choices = [Choice(value, partial(_errors, compute)) for value, compute in variation.values]
        known = {
            "shipped": variation.shipped,
            "reference": variation.reference,
            "samples": variation.samples,
        }
        knobs.append(Knob(variation.name, quantities, choices, **known))
    return knobs


def _errors(compute: Callable[[], for_studies.Deviations]) -> Errors:
    """The errors of a value, known as far as its samples scatter and as it says itself."""
    deviations, cost = timed(compute)
    error, by_scatter = root_mean_square(deviations.values)
    own_error = np.hypot(np.nan_to_num(by_scatter), deviations.noise)
    # a value shares computations with others, so that it says itself what it takes, on one core
    return Errors(error, own_error, Cost(deviations.cpu_s, deviations.cpu_s, cost.peak_rss_MB))


STUDIES_OF_ATOMS = {
    ("accuracy", "hardness"): accuracy_of_hardness,
    ("stability", "hardness"): stability_of_hardness,
    ("accuracy", "elastic"): accuracy_of_elastic,
    ("stability", "elastic"): stability_of_elastic,
}
