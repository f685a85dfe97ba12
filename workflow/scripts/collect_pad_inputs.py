"""Collect the uncertain inputs of the pad: the film's typical place, and how much places differ.

In: inputs.csv, topography/parameters.json where an input comes from there.  Out: pad/inputs.csv.
"""

from mesoscale.inputs.table import film_table, from_rows, to_rows
from workflow.job import job
from workflow.results import load_csv, load_json, write_csv

with job(snakemake) as run:
    path = snakemake.input.get("topography")
    film = load_json(path)["film"] if path else {}
    table = from_rows(load_csv(snakemake.input.inputs))
    write_csv(snakemake.output[0], to_rows(film_table(table, film, snakemake.params.rms_scatter)))
