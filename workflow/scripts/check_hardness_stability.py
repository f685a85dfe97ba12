"""Molecular dynamics of a scene in hard cases.

In:  potential (YAML), glass (LAMMPS data file); base (LAMMPS data file), base_material (YAML) where a film lies on
     another body.
Out: stability/hardness.csv.
"""

import shutil
from pathlib import Path

from atomistic.hardness.closing import weld
from atomistic.hardness.runs import ClosingRun
from atomistic.hardness.stack import base_of
from atomistic.hardness.studies import film_checks, glass_checks
from atomistic.lammps import load_data
from atomistic.materials import load_material
from atomistic.potentials import load_potential
from atomistic.settings import ClosingSettings
from workflow.checks import stability_rows
from workflow.job import job, settings_from_job
from workflow.results import write_csv

with job(snakemake) as run:
    given, params, work = snakemake.input, snakemake.params, Path(snakemake.params.work)
    potential = load_potential(given.potential)
    glass = load_data(given.glass, tuple(potential.materials[params.material]))
    checks = glass_checks(potential, glass, params.energy_scales, work)
    if given.get("base"):
        below = base_of(load_material(given.base_material))
        base = below, load_data(given.base, below.elements)
        film = settings_from_job(ClosingRun, params.closing_run)
        closing = settings_from_job(ClosingSettings, params.closing)
        checks += film_checks(*weld(film, glass, potential, closing, base, work), params.energy_scales, work)
    write_csv(snakemake.output.table, stability_rows("hardness", checks, run.progress))
    shutil.rmtree(work)
