"""Collect the table of uncertain inputs, each row from literature or from the stage that computes it.

In: hardness/fit.json, elastic/e_star.json, topography/parameters.json (those that the scene wants); the files of
samples that it names, as samples_<input>.
Out: inputs.csv.
"""

import copy

from mesoscale.inputs.table import check_resolved, collect, to_rows
from mesoscale.settings import InputsSettings
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.results import load_json, write_csv

with job(snakemake) as run:
    given = copy.deepcopy(snakemake.params.settings)
    results = dict(snakemake.input.items())
    for name in [name for name in results if name.startswith("samples_")]:
        given[name.removeprefix("samples_")]["values"] = results.pop(name)  # found beside the scene, perhaps
    settings = settings_from_job(InputsSettings, given)
    stages = {stage: load_json(path) for stage, path in results.items()}
    files = {stage: "/".join(path.split("/")[-2:]) for stage, path in results.items()}
    table = collect(settings, stages, files, snakemake.params.contact["attraction"])
    check_resolved(table, contact_settings(snakemake.params.contact, snakemake).nyquist_per_nm)
    write_csv(snakemake.output[0], to_rows(table))
