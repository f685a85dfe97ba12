"""Weigh the waves that no instrument saw: random surfaces of the contact with them and without.

In: topography/parameters.json, inputs.csv.
Out: topography/unseen.csv (nm, nm^2, GPa, nN).
"""

from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import from_rows
from mesoscale.scan_checks.unseen import unseen_shares
from mesoscale.settings import LawSettings
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.results import load_csv, load_json, write_csv

with job(snakemake) as run:
    table = from_rows(load_csv(snakemake.input.inputs))
    values = table.medians()
    for row in table.rows:
        if row.name == "q1":  # all of the extrapolation reaches the upper end of its interval
            values["q1"] = float(row.distribution.quantile(0.99))
    inputs, contact = contact_of(values, contact_settings(snakemake.params.contact, snakemake))
    seen = float(load_json(snakemake.input.topography)["trusted_end"]["interval"][0])
    rows = list(unseen_shares(inputs, contact, settings_from_job(LawSettings, snakemake.params.law), seen))
    write_csv(snakemake.output[0], rows)
