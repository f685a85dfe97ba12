"""Set up a crystal.  In: config/materials/*.yaml.  Out: elastic/structures/CRYSTAL.xyz (Å)."""

from pathlib import Path

import yaml

from atomistic.elastic.networks import crystal
from workflow.job import job
from workflow.results import write_text
from workflow.structure_files import structure_text

with job(snakemake) as run:
    material = yaml.safe_load(Path(snakemake.input.material).read_text(encoding="utf-8"))
    atoms = crystal(material, snakemake.wildcards.crystal)
    write_text(snakemake.output.structure, structure_text(atoms))
