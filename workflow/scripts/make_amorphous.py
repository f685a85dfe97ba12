"""Melt and quench one amorphous cell.  In: material file, cells before it.  Out:
elastic/quenched/NAME.{xyz,csv}.
"""

from pathlib import Path

import numpy as np

from atomistic.elastic.networks import make_glass
from atomistic.materials import load_material
from atomistic.settings import NitrideGlassSettings
from workflow.files.results import write_csv, write_text
from workflow.files.structures import load_structure, structure_text
from workflow.run.job import job, settings_from_job

with job(snakemake, shared=True) as run:
    material = load_material(snakemake.input.material)
    settings = settings_from_job(NitrideGlassSettings, snakemake.params.glass)
    number = int(snakemake.wildcards.amorphous[1:])
    seed = int(np.random.SeedSequence([snakemake.params.seed, number]).generate_state(1)[0])
    structures = {Path(path).stem: load_structure(path) for path in snakemake.input.others}
    atoms, attempts = make_glass(
        material, settings, seed, Path(snakemake.params.work), run.progress, structures
    )
    write_csv(
        snakemake.output.attempts,
        [{"structure": snakemake.wildcards.amorphous, **row} for row in attempts],
    )
    write_text(snakemake.output.structure, structure_text(atoms))
