"""Hard cases for the scan analysis: recover, doubt or refuse.

In: nothing.  Out: stability/topography.csv.
"""

from mesoscale.settings import TopographySettings
from mesoscale.topography.studies.stability import stability_checks
from workflow.checks import stability_rows
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    write_csv(snakemake.output[0], stability_rows("topography", stability_checks(TopographySettings()), run.progress))
