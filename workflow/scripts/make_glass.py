"""Melt and quench one glass cell.

In:  potential (YAML).  Out: glass/N.data (LAMMPS data file, Å), glass/N.json (density, coordination, gate).
"""

import time
from pathlib import Path

from atomistic.glass import glass_properties, make_glass
from atomistic.lammps import write_data
from atomistic.potentials import load_potential
from atomistic.settings import HardnessSettings
from workflow.job import job
from workflow.results import atomic_path, write_json

with job(snakemake) as run:
    settings = HardnessSettings(**snakemake.params.settings)
    potential = load_potential(snakemake.input.potential)
    seed = int(snakemake.wildcards.glass)
    started = time.perf_counter()
    glass = make_glass(settings.material, potential, settings.glass, seed, Path(snakemake.params.work), run.progress)
    properties = glass_properties(settings.material, potential, glass)
    with atomic_path(snakemake.output.atoms) as path:
        write_data(path, glass, {ion: potential.species[ion].mass_u for ion in glass.elements})
    write_json(
        snakemake.output.properties,
        {"seed": seed, **properties, "wall_s": time.perf_counter() - started},
        run.provenance,
    )
