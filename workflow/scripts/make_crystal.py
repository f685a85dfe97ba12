"""Set up a crystal.  In: config/materials/*.yaml.  Out: elastic/structures/CRYSTAL.xyz (Å)."""

from atomistic.elastic.networks import crystal
from atomistic.materials import load_material
from workflow.job import job
from workflow.results import write_text
from workflow.structure_files import structure_text

with job(snakemake) as run:
    material = load_material(snakemake.input.material)
    atoms = crystal(material, snakemake.wildcards.crystal)
    write_text(snakemake.output.structure, structure_text(atoms))
