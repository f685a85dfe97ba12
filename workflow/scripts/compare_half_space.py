"""Single asperities beside an elastic half-space at the medians of the inputs.

In: inputs.csv.  Out: coupling/comparison.csv (nN, nm, nm^2).
"""

from mesoscale.contact.studies.half_space import compare
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from mesoscale.settings import CouplingSettings
from workflow.contact_settings import contact_settings
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    settings = CouplingSettings(**snakemake.params.settings)
    contact = contact_settings(snakemake.params.contact, snakemake)
    inputs, contact = contact_of(medians(load_csv(snakemake.input.inputs)), contact)
    write_csv(snakemake.output[0], compare(inputs, contact, settings, run.progress))
