"""Fit H(A) to the MD points.

In:  points.csv (GPa, nm), glass/*.json, potential (YAML), counter_potentials: one where the counterface is of another
     oxide or potential.
Out: fit.json (H_macro in GPa, H' in GPa nm^0.5, gate).
"""

from atomistic.hardness.contact_area import require_calibration
from atomistic.hardness.size_effect import fit_size_effect
from atomistic.potentials import load_potential
from atomistic.settings import HardnessSettings
from workflow.job import job
from workflow.results import load_csv, load_json, write_json

with job(snakemake) as run:
    settings = HardnessSettings(**snakemake.params.settings)
    glasses = [load_json(path) for path in snakemake.input.glasses]
    counter = [load_potential(path) for path in snakemake.input.counter_potentials]
    calibration = require_calibration(load_potential(snakemake.input.potential), settings.area, *counter)
    fit = fit_size_effect(load_csv(snakemake.input.points), glasses, settings, calibration.error)
    write_json(snakemake.output.fit, fit, run.provenance)
