"""Molecular dynamics of a scene in hard cases.

In:  potential (YAML), glass (LAMMPS data file); counter_glass, counter_potential where the counterface is of another
     oxide or potential.
Out: stability/hardness.csv.
"""

import shutil
from pathlib import Path

from atomistic.hardness.stability import stability_checks
from atomistic.lammps import load_data
from atomistic.potentials import load_potential
from workflow.checks import stability_rows
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    given, params, work = snakemake.input, snakemake.params, Path(snakemake.params.work)
    files = [(given.potential, given.glass, params.material)]
    if given.get("counter_glass"):
        files.append((given.counter_potential, given.counter_glass, params.counter_material))
    bodies = []
    for potential_file, glass_file, formula in files:
        potential = load_potential(potential_file)
        bodies.append((potential, load_data(glass_file, tuple(potential.materials[formula]))))
    checks = stability_checks(bodies, params.energy_scales, work)
    write_csv(snakemake.output.table, stability_rows("hardness", checks, run.progress))
    shutil.rmtree(work)
