"""Hard cases for the calibration: known answer, said what is wrong, or refused.

In: nothing.  Out: stability/calibration.csv.
"""

from mesoscale.calibration.studies.stability import Bench, stability_checks
from workflow.checks import stability_rows
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    checks = stability_checks(Bench.computed())
    write_csv(snakemake.output[0], stability_rows("calibration", checks, run.progress))
