"""Stiff and extreme cases around the inputs of the scene, judged by invariants.

In: inputs.csv.  Out: stability/contact.csv.
"""

from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from mesoscale.studies.contact_stability import stability_checks
from workflow.checks import stability_rows
from workflow.contact_settings import contact_settings
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    central = medians(load_csv(snakemake.input.inputs))
    checks = stability_checks(*contact_of(central, contact_settings(snakemake.params.settings, snakemake)))
    write_csv(snakemake.output[0], stability_rows("contact", checks, run.progress))
