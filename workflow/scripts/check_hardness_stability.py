"""Molecular dynamics of a scene in hard cases.

In:  potential (YAML), glass (LAMMPS data file); counter_glass, counter_potential where the counterface is of another
     oxide or potential; base (LAMMPS data file), base_material (YAML) where a film lies on another body.
Out: stability/hardness.csv.
"""

import shutil
from pathlib import Path

from atomistic.hardness.closing import weld
from atomistic.hardness.runs import ClosingRun
from atomistic.hardness.stability import film_checks, stability_checks
from atomistic.hardness.stack import base_of
from atomistic.lammps import load_data
from atomistic.materials import load_material
from atomistic.potentials import load_potential
from atomistic.settings import ClosingSettings
from workflow.checks import stability_rows
from workflow.job import job, settings_from_job
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
    if given.get("base"):
        below = base_of(load_material(given.base_material))
        base = below, load_data(given.base, below.elements)
        film = settings_from_job(ClosingRun, params.closing_run)
        closing, (potential, glass) = settings_from_job(ClosingSettings, params.closing), bodies[0]
        checks += film_checks(*weld(film, glass, potential, closing, base, work), params.energy_scales, work)
    write_csv(snakemake.output.table, stability_rows("hardness", checks, run.progress))
    shutil.rmtree(work)
