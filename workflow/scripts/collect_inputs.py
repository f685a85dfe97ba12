"""Collect the table of uncertain inputs, each row from literature or from the stage that computes
it.

In: hardness/fit.json, elastic/e_star.json, topography/parameters.json (those that the scene wants);
the files of samples that it names, as samples_<input>. Out: inputs.csv.
"""

import copy

from mesoscale.contact.steepness import at_slope
from mesoscale.inputs.table import check_resolved, collect, to_rows
from mesoscale.settings import InputsSettings
from workflow.files.results import load_json, write_csv
from workflow.run.contact_settings import contact_settings
from workflow.run.job import job, settings_from_job

with job(snakemake) as run:
    stated = copy.deepcopy(snakemake.params.settings)
    results = dict(snakemake.input.items())
    for name in [name for name in results if name.startswith("samples_")]:
        # found beside the scene, perhaps
        stated[name.removeprefix("samples_")]["values"] = results.pop(name)
    settings = settings_from_job(InputsSettings, stated)
    stages = {stage: load_json(path) for stage, path in results.items()}
    files = {stage: "/".join(path.split("/")[-2:]) for stage, path in results.items()}
    contact = contact_settings(snakemake.params.contact, snakemake)
    table = collect(settings, stages, files, contact.attraction)
    check_resolved(table, contact.nyquist_per_nm)
    table = at_slope(table, stages.get("hardness", {}).get("inputs", {}), contact)
    write_csv(snakemake.output[0], to_rows(table))
