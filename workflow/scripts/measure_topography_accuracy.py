"""Error of q0, slope and RMS against run time of the analysis.

In: nothing (synthetic scans with known truth).  Out: accuracy/topography.csv.
"""

from mesoscale.settings import TopographySettings
from mesoscale.topography.studies.accuracy import COLUMNS, accuracy_rows
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    settings = TopographySettings(**snakemake.params.settings)
    rows = accuracy_rows(settings.synthetic, settings, settings.study_repeats, run.progress)
    write_csv(snakemake.output[0], rows, COLUMNS)
