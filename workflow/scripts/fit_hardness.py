"""Hardness of each closing run, or the reason why there is none; the fit to all of them.

In:  curves, witnesses (GPa, nm) and summaries of the runs, glass/*.json, potential (YAML), material
and, below films,
     base_material (YAML); samples of H_macro (GPa) where the scene has a file of them.
Out: points.csv (GPa, nm), fit.json (H_macro in GPa, H' in GPa nm^0.5, law of films, cut-off D0 of
the attraction in nm,
     gate).
"""

from atomistic.hardness.contact_area import calibrated
from atomistic.hardness.film_law import fit_films
from atomistic.hardness.plateau import point
from atomistic.hardness.size_effect import fit_size_effect
from atomistic.hardness.top_attraction import gap_cutoff
from atomistic.materials import load_material
from atomistic.potentials import load_potential
from mesoscale.inputs.table import stated_distribution
from mesoscale.settings import InputRow
from workflow.files.results import load_csv, load_json, load_numbers, write_csv, write_json
from workflow.run.job import job, settings_from_job

with job(snakemake) as run:
    inputs, params = snakemake.input, snakemake.params
    summaries = {summary["run"]: summary for summary in map(load_json, inputs.summaries)}
    curves, witnesses = (
        dict(zip(summaries, map(load_numbers, files), strict=True))
        for files in (inputs.curves, inputs.witnesses)
    )
    rows = [
        point(curves[name], witnesses[name], summaries[name], params.potential)
        for name in summaries
    ]
    write_csv(snakemake.output.points, rows)
    points = load_csv(snakemake.output.points)
    glasses = [load_json(path) for path in inputs.glasses]
    area_error = calibrated(load_potential(inputs.potential))
    measured = load_material(inputs.material).part("oxide_glass").indentation_GPa
    if inputs.base_material:
        area_error = max(
            area_error, load_material(inputs.base_material).part("film_base").area_error
        )
        fit = fit_films(points, curves, glasses, area_error, params.energies, measured)
    else:
        row = settings_from_job(InputRow, params.h_macro)
        if inputs.h_macro:
            row = row.model_copy(update={"values": str(inputs.h_macro)})
        h_macro = stated_distribution("h_macro", row).quantile
        fit = fit_size_effect(points, glasses, area_error, h_macro, params.energies, measured)
    used = {
        point["run"]: int(point["seed"])
        for point in points
        if point["status"] == "yield"
        and not point["film_nm"]
        and float(point["energy_scale"]) == 1.0
    }
    if cutoff := gap_cutoff({name: witnesses[name] for name in used}, used):
        fit["tops"] = cutoff.pop("runs")
        fit["inputs"]["gap_cutoff"] = cutoff
    write_json(snakemake.output.fit, fit, run.provenance)
