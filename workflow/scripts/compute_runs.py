"""Compute a chunk of contact cycles of the collocation.

In: inputs.csv.  Out: law/runs/chunk_NNN.h5 (groups run_NNNN/closing and run_NNNN/opening; nm,
nN, nm^2).
"""

from dataclasses import asdict

from mesoscale.contact.cycle import BRANCH_COLUMNS
from mesoscale.inputs.table import from_rows
from mesoscale.uncertainty.designs import collocation_runs
from mesoscale.uncertainty.runs import compute_all
from workflow.files.results import Dataset, load_csv, write_h5
from workflow.run.contact_settings import contact_settings
from workflow.run.job import job

with job(snakemake, shared=True) as run:
    contact = contact_settings(snakemake.params.contact, snakemake)
    table = from_rows(load_csv(snakemake.input.inputs))
    runs = collocation_runs(table, *snakemake.params.bounds)
    groups = {}
    attributes = {}
    for item, cycle in compute_all(runs, contact, run.progress):
        name = f"run_{item.index:04d}"
        about_run = {"run": item.index, "node": item.node, "seed": item.seed, **item.values}
        if isinstance(cycle, str):
            attributes[name] = {**about_run, "status": cycle}
            continue
        attributes[name] = {
            **about_run,
            "status": "ok" if cycle.converged else "unconverged",
            "flags": cycle.flags,
            "first_contact_nm": cycle.first_contact_nm,
            "last_contact_nm": cycle.last_contact_nm,
        }
        for branch, curve in (("closing", cycle.closing), ("opening", cycle.opening)):
            groups[f"{name}/{branch}"] = {
                key: Dataset(values, *BRANCH_COLUMNS[key], ("separation_nm",))
                for key, values in asdict(curve).items()
            }
    reading = {"cell_area_nm2": contact.length_nm**2, "contact": contact.model_dump(mode="json")}
    write_h5(snakemake.output[0], groups, reading, run.provenance, attributes)
