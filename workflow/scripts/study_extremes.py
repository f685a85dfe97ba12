"""First contact and d_c as the area of the sample grows, at the middle of the inputs.

In: inputs.csv.  Out: uq/extremes.csv (nm).
"""

from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import from_rows
from mesoscale.settings import LawSettings
from mesoscale.uncertainty.studies.extremes import COLUMNS, extreme_rows
from workflow.contact_settings import contact_settings
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    table = from_rows(load_csv(snakemake.input.inputs))
    middle = table.ranges(snakemake.params.central_share).mean(axis=1).tolist()
    inputs, contact = contact_of(
        dict(zip(table.names, middle, strict=True)), contact_settings(snakemake.params.contact, snakemake)
    )
    rows = extreme_rows(inputs, contact, LawSettings(**snakemake.params.law), run.progress)
    write_csv(snakemake.output[0], rows, COLUMNS)
