"""Error of a stage against run time, one numerical choice at a time, or the stage in stiff and
extreme cases.

In: of studies of pad, answer, circuit, failure and contact inputs.csv and pad/model.h5; of
uncertainty inputs.csv and the direct runs; of topography nothing (synthetic scans with known
truth); of hardness and elastic their materials, and what the stage made. Out: accuracy/STAGE.csv
(s), stability/STAGE.csv.
"""

import shutil

from workflow.files.results import write_csv
from workflow.run.job import job
from workflow.run.studies import STUDIES

with job(snakemake) as run:
    kind, stage = snakemake.wildcards.kind, snakemake.wildcards.stage
    rows = STUDIES[kind, stage](snakemake, run.progress)
    write_csv(snakemake.output[0], ({"stage": stage, **row} for row in rows))
    shutil.rmtree(snakemake.params.work, ignore_errors=True)
