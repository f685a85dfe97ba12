"""Fit H(A) to the MD points.

In:  points.csv (GPa, nm), glass/*.json, potential (YAML), counter_potentials: one where the counterface is of another
     oxide or potential.
Out: fit.json (H_macro in GPa, H' in GPa nm^0.5, gate).
"""

from atomistic.hardness.contact_area import calibrated
from atomistic.hardness.size_effect import fit_size_effect
from atomistic.potentials import load_potential
from atomistic.settings import FitSettings
from workflow.job import job, settings_from_job
from workflow.results import load_csv, load_json, write_json

with job(snakemake) as run:
    settings = settings_from_job(FitSettings, snakemake.params.fit)
    glasses = [load_json(path) for path in snakemake.input.glasses]
    counter = [load_potential(path) for path in snakemake.input.counter_potentials]
    _, area_error = calibrated(load_potential(snakemake.input.potential), *counter)
    points = load_csv(snakemake.input.points)
    fit = fit_size_effect(points, glasses, settings, snakemake.params.energy_scales, area_error)
    write_json(snakemake.output.fit, fit, run.provenance)
