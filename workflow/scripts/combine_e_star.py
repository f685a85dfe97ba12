"""Combine E*.  In: elastic/bulk_moduli.csv (GPa), counter body.  Out: e_star.json, e_star.h5, structures.csv."""

from atomistic.elastic.moduli import SAMPLE_COLUMNS, effective_modulus, with_computed_poisson
from atomistic.elastic.structures import structure_rows, trusted_moduli
from atomistic.materials import load_material
from atomistic.settings import ElasticSettings
from workflow.job import job, settings_from_job
from workflow.results import Dataset, load_csv, load_json, write_csv, write_h5, write_json

with job(snakemake) as run:
    settings = settings_from_job(ElasticSettings, snakemake.params.settings)
    counter_body = load_material(snakemake.input.counter_body)
    reports = [load_json(path) for path in snakemake.input.structures]
    quenches = [len(load_csv(path)) for path in snakemake.input.attempts]
    moduli = trusted_moduli(load_csv(snakemake.input.moduli), reports)
    summary, samples = effective_modulus(moduli, counter_body, settings)
    if snakemake.input.get("isotropic"):
        isotropic = load_csv(snakemake.input.isotropic)
        summary, samples = with_computed_poisson(summary, isotropic, counter_body, settings)
    write_csv(snakemake.output.structures, structure_rows(reports, quenches))
    group = {key: Dataset(values, *SAMPLE_COLUMNS[key], ("sample",)) for key, values in samples.items()}
    write_h5(snakemake.output.samples, {"samples": group}, {"ions": summary["ions"]}, run.provenance)
    write_json(snakemake.output.e_star, summary, run.provenance)
