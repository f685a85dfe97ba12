"""Find how often the switch fails, down to one in a million, and what is allowed of hold voltage,
film and spring.

In: inputs.csv, pad/model.h5.  Out: failure/failure.json, failure/failure.csv (V).
"""

from mesoscale.failure.rate import failure_rate
from workflow.files.results import write_csv, write_json
from workflow.run.job import job
from workflow.run.pads import population_of_job

with job(snakemake) as run:
    rate, rows = failure_rate(*population_of_job(snakemake), run.progress)
    write_json(snakemake.output.rate, rate, run.provenance)
    write_csv(snakemake.output.table, rows)
