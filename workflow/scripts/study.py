"""Error of a stage against run time, one numerical choice at a time, or the contact in stiff and extreme cases.

In: of the study pad or failure inputs.csv and pad/model.h5, of uncertainty inputs.csv and uq/direct/chunk_NNN.csv, of
contact inputs.csv; of topography nothing (synthetic scans with known truth).
Out: accuracy/STAGE.csv (s), stability/contact.csv.
"""

from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import from_rows, medians
from mesoscale.settings import TopographySettings, UncertaintySettings
from mesoscale.studies import contact_accuracy, failure_accuracy, law_accuracy, pad_accuracy, topography_accuracy
from mesoscale.studies.contact_stability import stability_rows
from mesoscale.uncertainty.validation import direct_runs_of_rows
from workflow.files.results import load_csv, write_csv
from workflow.run.contact_settings import contact_settings
from workflow.run.failing import load_population
from workflow.run.job import job, settings_from_job
from workflow.run.pads import load_model, points_of_job


def rows_of_study(study, progress):
    """What each value of each choice costs and errs, or how each extreme case went."""
    if study == "accuracy/topography":
        settings = settings_from_job(TopographySettings, snakemake.params.topography)
        return topography_accuracy.accuracy_points(settings, progress)
    if study == "accuracy/failure":
        return failure_accuracy.accuracy_points(*load_population(snakemake)[:2], progress)
    if study == "accuracy/pad":
        points, pad = points_of_job(snakemake)
        model = load_model([snakemake.input.model], points)
        return pad_accuracy.accuracy_points(model, points.table, points.contact, pad.point_cells, progress)
    table = load_csv(snakemake.input.inputs)
    contact = contact_settings(snakemake.params.contact, snakemake)
    if study == "accuracy/uncertainty":
        settings, inputs = settings_from_job(UncertaintySettings, snakemake.params.uncertainty), from_rows(table)
        rows = (row for path in snakemake.input.direct for row in load_csv(path))
        direct = direct_runs_of_rows(rows, inputs.names, settings.direct_runs)
        return law_accuracy.accuracy_points(direct, inputs, contact, settings)
    central = contact_of(medians(table), contact)
    if study == "stability/contact":
        return stability_rows(*central, progress)
    return contact_accuracy.accuracy_points(*central, progress)


with job(snakemake) as run:
    study = snakemake.wildcards.study
    stage = study.split("/")[1]
    write_csv(snakemake.output[0], ({"stage": stage, **row} for row in rows_of_study(study, run.progress)))
