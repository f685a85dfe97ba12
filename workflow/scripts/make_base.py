"""Anneal a cube of metal as wide as an asperity.

In:  material (YAML); glass (LAMMPS data file), whose edge times `tiles` is the wavelength.  Out: LAMMPS data file, Å.
"""

from pathlib import Path

from atomistic.hardness.metal import Metal, make_base
from atomistic.lammps import load_data, write_data
from atomistic.materials import load_material
from atomistic.potentials import masses_u
from workflow.job import job
from workflow.results import atomic_path

with job(snakemake) as run:
    metal, params = Metal(load_material(snakemake.input.material)), snakemake.params
    edge_A = params.tiles * float(load_data(snakemake.input.glass, ()).cell_A[0])
    cube = make_base(metal, edge_A, params.seed, Path(params.work), run.progress)
    with atomic_path(snakemake.output.atoms) as path:
        write_data(path, cube, masses_u(metal, cube.elements))
