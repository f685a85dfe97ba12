"""Isotropic moduli.  In: elastic/tensors/*.json, structures/*.json.  Out: elastic/isotropic_moduli.csv (GPa)."""

from atomistic.elastic.joint_moduli import isotropic_rows
from workflow.job import job
from workflow.results import load_json, write_csv

with job(snakemake) as run:
    write_csv(
        snakemake.output.table, [row for path in snakemake.input.tensors for row in isotropic_rows(load_json(path))]
    )
