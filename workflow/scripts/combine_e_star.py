"""Fit equations of state and combine E*.

In:  elastic/scans/*.csv (Å3, eV), structures, quenches, material, counter body.
Out: elastic/points.csv (Å3, eV), bulk_moduli.csv (GPa), structures.csv, e_star.json, e_star.h5.
"""

from itertools import groupby

from atomistic.elastic.energy_scans import fit_scan
from atomistic.elastic.moduli import SAMPLE_COLUMNS, effective_modulus
from atomistic.elastic.structures import structure_rows, trusted_moduli
from atomistic.materials import load_material
from atomistic.settings import ElasticSettings
from workflow.files.results import Dataset, load_csv, load_json, write_csv, write_h5, write_json
from workflow.run.job import job, settings_from_job

with job(snakemake) as run:
    settings = settings_from_job(ElasticSettings, snakemake.params.settings)
    points = [row for path in snakemake.input.scans for row in load_csv(path)]
    fits = [
        fit_scan(list(scan))
        for _, scan in groupby(points, lambda row: (row["structure"], row["xc"]))
    ]
    reports = [load_json(path) for path in snakemake.input.structures]
    quenches = [len(load_csv(path)) for path in snakemake.input.attempts]
    material = load_material(snakemake.input.material)
    counter_body = load_material(snakemake.input.counter_body)
    summary, samples = effective_modulus(
        trusted_moduli(fits, reports), material, counter_body, settings
    )
    write_csv(snakemake.output.points, points)
    write_csv(snakemake.output.moduli, fits)
    write_csv(snakemake.output.structures, structure_rows(reports, quenches))
    group = {
        key: Dataset(values, *SAMPLE_COLUMNS[key], ("sample",)) for key, values in samples.items()
    }
    write_h5(
        snakemake.output.samples, {"samples": group}, {"ions": summary["ions"]}, run.provenance
    )
    write_json(snakemake.output.e_star, summary, run.provenance)
