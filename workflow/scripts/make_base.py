"""Make a cell of what lies below a film: a metal is annealed, a glass is quenched.

In:  material (YAML); glass (LAMMPS data file), of which so many `tiles` are as wide as the
asperity.  Out: LAMMPS data
     file, Å.
"""

from pathlib import Path

from atomistic.hardness.stack import base_of
from atomistic.lammps import load_data, write_data
from atomistic.materials import load_material
from workflow.files.results import atomic_path
from workflow.run.job import job

with job(snakemake, shared=True) as run:
    base = base_of(load_material(snakemake.input.material))
    params = snakemake.params
    edge_A = float(load_data(snakemake.input.glass, ()).cell_A[0])
    cell = base.make(edge_A, params.tiles, params.seed, Path(params.work), run.progress)
    with atomic_path(snakemake.output.atoms) as path:
        write_data(path, cell, base.masses_u)
