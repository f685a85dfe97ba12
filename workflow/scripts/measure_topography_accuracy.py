"""Error of q0, slope and RMS against run time of the analysis.

In: nothing (synthetic scans with known truth).  Out: accuracy/topography.csv.
"""

from mesoscale.settings import TopographySettings
from mesoscale.studies.topography_accuracy import accuracy_points
from workflow.checks import accuracy_rows
from workflow.job import job, settings_from_job
from workflow.results import write_csv

with job(snakemake) as run:
    settings = settings_from_job(TopographySettings, snakemake.params.settings)
    write_csv(snakemake.output[0], accuracy_rows("topography", accuracy_points(settings, run.progress)))
