"""Error of the failure rate against run time, by the number of samples.

In: pad/inputs.csv, pad/model.h5.  Out: accuracy/failure.csv (s).
"""

from mesoscale.studies.failure_accuracy import accuracy_points
from workflow.checks import accuracy_rows
from workflow.failing import load_population
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    population, allowed = load_population(snakemake)
    write_csv(snakemake.output[0], accuracy_rows("failure", accuracy_points(population, allowed, run.progress)))
