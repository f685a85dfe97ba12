"""Molecular dynamics of a scene in hard cases.

In:  potential (YAML), glass (LAMMPS data file).
Out: stability/hardness.csv.
"""

import shutil
from pathlib import Path

from atomistic.hardness.studies import glass_checks
from atomistic.lammps import load_data
from atomistic.potentials import load_potential
from workflow.files.results import write_csv
from workflow.run.job import job
from workflow.run.studies import stability_rows

with job(snakemake) as run:
    params, work = snakemake.params, Path(snakemake.params.work)
    potential = load_potential(snakemake.input.potential)
    glass = load_data(snakemake.input.glass, tuple(potential.materials[params.material]))
    checks = glass_checks(potential, glass, params.energy_scales, work)
    write_csv(snakemake.output.table, stability_rows("hardness", checks, run.progress))
    shutil.rmtree(work)
