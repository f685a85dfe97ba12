"""Error of the calibration against its run time: responses, chain, cycles added.

In: nothing.  Out: accuracy/calibration.csv.
"""

from mesoscale.calibration.studies.accuracy import accuracy_points
from workflow.checks import accuracy_rows
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    write_csv(snakemake.output[0], accuracy_rows("calibration", accuracy_points(run.progress)))
