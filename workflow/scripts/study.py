"""Error of a stage against run time, one numerical choice at a time, or the stage in stiff and extreme cases.

In: of the study pad or failure inputs.csv and pad/model.h5, of uncertainty inputs.csv and uq/direct/chunk_NNN.csv, of
contact inputs.csv; of topography nothing (synthetic scans with known truth).
Out: accuracy/STAGE.csv (s), stability/STAGE.csv.
"""

from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import from_rows, medians
from mesoscale.settings import TopographySettings, UncertaintySettings
from mesoscale.studies import contact_accuracy, failure_accuracy, law_accuracy, pad_accuracy, topography_accuracy
from mesoscale.studies.contact_stability import stability_checks
from mesoscale.uncertainty.validation import direct_runs_of_rows
from workflow.files.results import load_csv, write_csv
from workflow.run.contact_settings import contact_settings
from workflow.run.failing import load_population
from workflow.run.job import job, settings_from_job
from workflow.run.pads import load_model, points_of_job
from workflow.run.studies import accuracy_rows, stability_rows


def central_contact():
    """Inputs of a contact at their medians, and its settings."""
    central = medians(load_csv(snakemake.input.inputs))
    return contact_of(central, contact_settings(snakemake.params.contact, snakemake))


def points_of(stage, progress):
    """What each value of each choice costs and errs."""
    if stage == "topography":
        settings = settings_from_job(TopographySettings, snakemake.params.topography)
        return topography_accuracy.accuracy_points(settings, progress)
    if stage == "contact":
        return contact_accuracy.accuracy_points(*central_contact(), progress)
    if stage == "uncertainty":
        settings = settings_from_job(UncertaintySettings, snakemake.params.uncertainty)
        table = from_rows(load_csv(snakemake.input.inputs))
        rows = (row for path in snakemake.input.direct for row in load_csv(path))
        direct = direct_runs_of_rows(rows, table.names, settings.direct_runs)
        contact = contact_settings(snakemake.params.contact, snakemake)
        return law_accuracy.accuracy_points(direct, table, contact, settings)
    if stage == "failure":
        return failure_accuracy.accuracy_points(*load_population(snakemake)[:2], progress)
    points, pad = points_of_job(snakemake)
    model = load_model([snakemake.input.model], points)
    return pad_accuracy.accuracy_points(model, points.table, points.contact, pad.point_cells, progress)


with job(snakemake) as run:
    kind, stage = snakemake.wildcards.study.split("/")
    if kind == "stability":
        rows = stability_rows(stage, stability_checks(*central_contact()), run.progress)
    else:
        rows = accuracy_rows(stage, points_of(stage, run.progress))
    write_csv(snakemake.output[0], rows)
