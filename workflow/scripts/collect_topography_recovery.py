"""All sets of the recovery study in one table, and their summary in the log.

In: topography/recovery/sets_*.csv.  Out: topography/recovery.csv (one row per set and method).
"""

from mesoscale.topography.studies.recovery import COLUMNS, summary
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    rows = [row for path in snakemake.input for row in load_csv(path)]
    write_csv(snakemake.output[0], rows, COLUMNS)
    for method in ("likelihood", "lines"):
        shares = summary(rows, method)
        print(method, *(f"{name} {value:g}" for name, value in shares.items()), sep="  ", file=run.log)
