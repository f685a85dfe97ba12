"""Error of a stage against run time, one numerical choice at a time, or the stage in stiff and extreme cases.

In: of the study pad or failure inputs.csv and pad/model.h5, of uncertainty inputs.csv and uq/direct/chunk_NNN.csv, of
contact inputs.csv; of topography nothing (synthetic scans with known truth); of hardness the summaries of varied runs,
or potential and glass; of elastic the material, bulk moduli and points.
Out: accuracy/STAGE.csv (s), stability/STAGE.csv.
"""

import shutil
from pathlib import Path

from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import from_rows, medians
from mesoscale.settings import TopographySettings, UncertaintySettings
from mesoscale.studies import contact_accuracy, failure_accuracy, law_accuracy, pad_accuracy, topography_accuracy
from mesoscale.studies.contact_stability import stability_checks
from mesoscale.uncertainty.validation import direct_runs_of_rows
from workflow.files.results import load_csv, load_json, load_numbers, write_csv
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


def atomistic_points(stage, progress):
    """The same of the atomistic stages, whose packages the others do without."""
    if stage == "hardness":
        from atomistic.hardness.studies import compare
        from atomistic.settings import HardnessSettings

        paths = {Path(path).parent.name: Path(path) for path in snakemake.input.summaries}
        return compare(
            {name: load_numbers(path.with_suffix(".csv")) for name, path in paths.items()},
            {name: load_numbers(path.with_suffix(".witness.csv")) for name, path in paths.items()},
            {name: load_json(path) for name, path in paths.items()},
            settings_from_job(HardnessSettings, snakemake.params.hardness).closing,
        )
    from atomistic.elastic.studies import accuracy_points
    from atomistic.materials import load_material
    from atomistic.settings import ElasticSettings

    fits, points = load_csv(snakemake.input.moduli), load_csv(snakemake.input.points)
    settings = settings_from_job(ElasticSettings, snakemake.params.elastic)
    return accuracy_points(load_material(snakemake.input.material), fits, points, settings, progress)


def checks_of(stage):
    """Hard cases of a stage."""
    if stage == "contact":
        return stability_checks(*central_contact())
    if stage == "hardness":
        from atomistic.hardness.studies import glass_checks
        from atomistic.lammps import load_data
        from atomistic.potentials import load_potential

        potential, asked = load_potential(snakemake.input.potential), snakemake.params.hardness
        glass = load_data(snakemake.input.glass, tuple(potential.materials[asked["material"]]))
        return glass_checks(potential, glass, asked["energy_scales"], Path(snakemake.params.work))
    from atomistic.elastic import studies
    from atomistic.materials import load_material
    from atomistic.settings import ElasticSettings

    dft = settings_from_job(ElasticSettings, snakemake.params.elastic).dft
    return studies.stability_checks(load_material(snakemake.input.material), dft)


with job(snakemake) as run:
    kind, stage = snakemake.wildcards.study.split("/")
    if kind == "stability":
        rows = stability_rows(stage, checks_of(stage), run.progress)
    else:
        points = atomistic_points if stage in ("hardness", "elastic") else points_of
        rows = accuracy_rows(stage, points(stage, run.progress))
    write_csv(snakemake.output[0], rows)
    shutil.rmtree(snakemake.params.work, ignore_errors=True)
