"""Melt and quench one glass cell.

In:  material, potential (YAML).
Out: glass (LAMMPS data file, Å), properties (density, coordination, gate).
"""

import time
from pathlib import Path

from atomistic.hardness.glass import glass_properties, make_glass
from atomistic.lammps import write_data
from atomistic.materials import load_material
from atomistic.potentials import load_potential
from atomistic.settings import GlassSettings
from workflow.files.results import atomic_path, write_json
from workflow.run.job import job, settings_from_job

with job(snakemake, shared=True) as run:
    material = load_material(snakemake.input.material)
    seed = int(snakemake.params.seed)
    settings = settings_from_job(GlassSettings, snakemake.params.glass)
    potential = load_potential(snakemake.input.potential)
    started = time.perf_counter()
    glass = make_glass(
        material, potential, settings, seed, Path(snakemake.params.work), run.progress
    )
    properties = glass_properties(material, potential, glass)
    with atomic_path(snakemake.output.atoms) as path:
        write_data(path, glass, potential.masses_u)
    write_json(
        snakemake.output.properties,
        {"seed": seed, **properties, "wall_s": time.perf_counter() - started},
        run.provenance,
    )
