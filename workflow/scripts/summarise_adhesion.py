"""Mean, standard error and range over the pads of each case and load.

In: adhesion/pads/*.csv.  Out: adhesion/summary.csv (uJ/m^2, kPa, nm; uN and mJ/m^2 of a sphere).
"""

from mesoscale.pad.adhesion import summary_rows
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake):
    write_csv(snakemake.output[0], summary_rows([row for path in snakemake.input for row in load_csv(path)]))
