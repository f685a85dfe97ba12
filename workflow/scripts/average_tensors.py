"""Isotropic moduli.  In: elastic/tensors/*.{json,xyz}.  Out: elastic/isotropic_moduli.csv (GPa)."""

from atomistic.elastic.constants import isotropic_table
from workflow.job import job
from workflow.results import load_json, write_csv
from workflow.structure_files import load_structure

with job(snakemake) as run:
    files = zip(snakemake.input.tensors, snakemake.input.at_rest, strict=True)
    write_csv(
        snakemake.output.table, isotropic_table((load_json(report), load_structure(cell)) for report, cell in files)
    )
