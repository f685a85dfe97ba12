"""The studies of the stages of atoms, each from what its job reads, for the driver of all studies."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from atomistic import studied
from atomistic.elastic import accuracy as elastic_accuracy
from atomistic.elastic import stability as elastic_stability
from atomistic.elastic.structures import trusted_moduli
from atomistic.materials import load_material
from atomistic.settings import DftSettings
from mesoscale.studies.driver import (
    Choice,
    Cost,
    Errors,
    HardCase,
    Knob,
    Progress,
    Quantity,
    StudyRow,
    rows_of,
    stability_rows,
    timed,
)
from workflow.files.results import load_csv, load_json
from workflow.files.structures import load_structure
from workflow.run.job import settings_from_job

SAMPLES = 2
"""Glasses that tell an error: enough to see whether it is one, at twice the cost."""


def accuracy_of_elastic(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Of the bulk modulus of the scene's glasses."""
    dft = settings_from_job(DftSettings, snakemake.params.elastic["dft"])
    moduli = trusted_moduli(load_csv(snakemake.input.moduli), [load_json(path) for path in snakemake.input.reports])
    trusted = [modulus for modulus in moduli if modulus.xc == "GGA" and modulus.trusted]
    structures = {Path(path).stem: path for path in snakemake.input.structures}
    scans = {Path(path).stem: load_csv(path) for path in snakemake.input.scans}
    glasses = []
    seconds = []
    for modulus in trusted:
        scan = [row for row in scans[modulus.structure] if row["xc"] == "GGA" and row["converged"] == "True"]
        seconds.append(sum(float(row["wall_s"]) for row in scan))
        energies_eV = {float(row["strain"]): float(row["energy_eV"]) for row in scan}
        if len(glasses) < SAMPLES:
            glass = load_structure(structures[modulus.structure])
            glasses.append(elastic_accuracy.ScannedGlass(glass, dft, energies_eV))
    scan_s = float(np.mean(seconds)) if seconds else 0.0
    found = elastic_accuracy.variations(glasses, [modulus.B_GPa for modulus in trusted], scan_s)
    return rows_of(knobs_of(found), progress)


def stability_of_elastic(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Cells and scans that have no modulus."""
    material = load_material(snakemake.input.material)
    return hard_rows(elastic_stability.hard_cases(material), progress)


def hard_rows(cases: Sequence[studied.HardCase], progress: Progress | None = None) -> Iterator[StudyRow]:
    """Rows of a stability table without the stage."""
    return stability_rows([HardCase(*case) for case in cases], progress)


def knobs_of(variations: Sequence[studied.Variation]) -> list[Knob]:
    """The choices of a stage of atoms as the driver takes them."""
    knobs = []
    for variation in variations:
        quantities = [Quantity(*quantity) for quantity in variation.quantities]
        choices = [Choice(value, _for_driver(compute)) for value, compute in variation.values]
        knobs.append(Knob(variation.name, quantities, choices, *variation[3:]))
    return knobs


def _for_driver(compute: Callable[[], Any]) -> Callable[[], Any]:
    """What a choice computes, or its errors with their cost."""

    def computed() -> Any:
        found, cost = timed(compute)
        if not isinstance(found, studied.Errors):
            return found
        # a value shares computations with others, so that it says itself what it takes, on one core
        return Errors(found.error, found.own_error, Cost(found.cpu_s, found.cpu_s, cost.peak_rss_MB))

    return computed


STUDIES_OF_ATOMS = {
    ("accuracy", "elastic"): accuracy_of_elastic,
    ("stability", "elastic"): stability_of_elastic,
}
