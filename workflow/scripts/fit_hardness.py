"""Fit H(A) to the MD points, or the law of films to their curves, and the cut-off of the attraction to the tops.

In:  points.csv (GPa, nm), witnesses and curves of the runs, glass/*.json, potential (YAML), counter_potentials: one
     where the counterface is of another oxide or potential, base_material (YAML): below films.
Out: fit.json (H_macro in GPa, H' in GPa nm^0.5, law of films, cut-off D0 of the attraction in nm, gate).
"""

from pathlib import Path

from atomistic.hardness.contact_area import calibrated
from atomistic.hardness.film_law import fit_films
from atomistic.hardness.size_effect import fit_size_effect
from atomistic.hardness.top_attraction import gap_cutoff
from atomistic.materials import load_material
from atomistic.potentials import load_potential
from atomistic.settings import FitSettings
from workflow.job import job, settings_from_job
from workflow.results import load_csv, load_json, load_numbers, write_json

with job(snakemake) as run:
    settings = settings_from_job(FitSettings, snakemake.params.fit)
    glasses = [load_json(path) for path in snakemake.input.glasses]
    counter = [load_potential(path) for path in snakemake.input.counter_potentials]
    _, area_error = calibrated(load_potential(snakemake.input.potential), *counter)
    points = load_csv(snakemake.input.points)
    if snakemake.input.curves:
        below = load_material(snakemake.input.base_material).part("film_base")
        area_error = max(area_error, below.area_of_film.error, below.area_of_base.error)
        curves = {Path(path).stem: load_numbers(path) for path in snakemake.input.curves}
        fit = fit_films(points, curves, glasses, area_error)
    else:
        fit = fit_size_effect(points, glasses, settings, snakemake.params.energy_scales, area_error)
    witnesses = {Path(path).stem: load_numbers(path) for path in snakemake.input.witnesses}
    used = {p["run"]: int(p["seed"]) for p in points if p["status"] == "yield" and not p["film_nm"]}
    if cutoff := gap_cutoff({name: witnesses[name] for name in used}, used):
        fit["tops"] = cutoff.pop("runs")
        fit["inputs"]["gap_cutoff"] = cutoff
    write_json(snakemake.output.fit, fit, run.provenance)
