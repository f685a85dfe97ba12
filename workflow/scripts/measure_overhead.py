"""Share of the time that the workflow takes beside the engine.

In: uq/direct/timing_NNN.csv.  Out: uq/overhead.csv (one row).
"""

from mesoscale.uncertainty.studies.overhead import workload
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    timings = [row for path in snakemake.input.timing for row in load_csv(path)]
    write_csv(snakemake.output[0], [workload(timings, snakemake.params.cores)])
