"""Isotropic moduli.  In: elastic/tensors/*.{json,xyz}.  Out: elastic/isotropic_moduli.csv (GPa)."""

from atomistic.elastic.joint_moduli import isotropic_rows
from atomistic.elastic.networks import same_network
from workflow.job import job
from workflow.results import load_json, write_csv
from workflow.structure_files import load_structure

with job(snakemake) as run:
    rows, before = [], {}
    for path, at_rest in zip(snakemake.input.tensors, snakemake.input.at_rest, strict=True):
        report, atoms = load_json(path), load_structure(at_rest)
        rows += isotropic_rows(report, same_network(atoms, before))
        if not report["failure"]:
            before[report["structure"]] = atoms
    write_csv(snakemake.output.table, rows)
