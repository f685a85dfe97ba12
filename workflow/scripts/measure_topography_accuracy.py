"""Error of q0, slope and RMS against run time of the analysis.

In: nothing (synthetic scans with known truth).  Out: accuracy/topography.csv.
"""

from mesoscale.settings import TopographySettings
from mesoscale.topography.studies.accuracy import accuracy_points
from workflow.checks import accuracy_rows
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    settings = TopographySettings(**snakemake.params.settings)
    points = accuracy_points(settings.synthetic, settings, settings.study_repeats, run.progress)
    write_csv(snakemake.output[0], accuracy_rows("topography", points))
