"""Find how often the switch fails, down to one in a million, and what is allowed of hold voltage, film and spring.

In: pad/inputs.csv, pad/grid.csv, pad/cells/*.h5 (nN), pad/draws/*.csv.
Out: device/failure.json, device/failure.csv (V).
"""

from mesoscale.device.failure import failure_rate
from workflow.job import job
from workflow.pad_files import load_population
from workflow.results import write_csv, write_json

with job(snakemake) as run:
    rate, rows = failure_rate(*load_population(snakemake), run.progress)
    write_json(snakemake.output.rate, rate, run.provenance)
    write_csv(snakemake.output.table, rows)
