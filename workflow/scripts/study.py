"""Error of a stage against run time, one numerical choice at a time, or the contact in stiff and extreme cases.

In: of the study pad inputs.csv and pad/model.h5, of contact inputs.csv; of topography nothing (synthetic scans with
known truth).  Out: accuracy/STAGE.csv (s), stability/contact.csv.
"""

from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from mesoscale.settings import TopographySettings
from mesoscale.studies import pad_accuracy, topography_accuracy
from mesoscale.studies.contact_stability import stability_rows
from workflow.files.results import load_csv, write_csv
from workflow.run.contact_settings import contact_settings
from workflow.run.job import job, settings_from_job
from workflow.run.pads import load_model, points_of_job


def rows_of_study(study, progress):
    """What each value of each choice costs and errs, or how each extreme case went."""
    if study == "accuracy/topography":
        settings = settings_from_job(TopographySettings, snakemake.params.topography)
        return topography_accuracy.accuracy_points(settings, progress)
    if study == "accuracy/pad":
        points, pad = points_of_job(snakemake)
        model = load_model([snakemake.input.model], points)
        return pad_accuracy.accuracy_points(model, points.table, points.contact, pad.point_cells, progress)
    contact = contact_settings(snakemake.params.contact, snakemake)
    return stability_rows(*contact_of(medians(load_csv(snakemake.input.inputs)), contact), progress)


with job(snakemake) as run:
    study = snakemake.wildcards.study
    stage = study.split("/")[1]
    write_csv(snakemake.output[0], ({"stage": stage, **row} for row in rows_of_study(study, run.progress)))
