"""Contact cycles at the medians of the inputs (the means, where they are symmetric), for figures 4 and 11.

In: inputs.csv.  Out: curves/nominal.h5 (groups <model>/closing|opening and load_<F nN>/closing|opening; nm,
nN, nm^2), with inputs, seed, largest force and flags as attributes of the group of each curve.
"""

from dataclasses import asdict

from mesoscale.contact.cycle import BRANCH_COLUMNS
from mesoscale.contact.nominal import nominal_cycles
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from workflow.contact_settings import contact_settings
from workflow.job import job
from workflow.results import Dataset, load_csv, write_h5

with job(snakemake) as run:
    middle = medians(load_csv(snakemake.input.inputs))
    inputs, settings = contact_of(middle, contact_settings(snakemake.params.settings, snakemake))
    groups, attributes = {}, {}
    for name, chosen, force, cycle in nominal_cycles(inputs, settings, run.progress):
        attributes[name] = {
            **asdict(inputs),
            "model": chosen.model,
            "seed": settings.nominal_seed,
            "max_force_nN": force,
            "converged": cycle.converged,
            "first_contact_nm": cycle.first_contact_nm,
            "last_contact_nm": cycle.last_contact_nm,
            **cycle.flags,
        }
        for branch, curve in (("closing", cycle.closing), ("opening", cycle.opening)):
            groups[f"{name}/{branch}"] = {
                key: Dataset(values, *BRANCH_COLUMNS[key], ("separation_nm",)) for key, values in asdict(curve).items()
            }
    reading = {"cell_area_nm2": settings.length_nm**2, "contact": settings.model_dump(mode="json")}
    write_h5(snakemake.output.curves, groups, reading, run.provenance, attributes)
