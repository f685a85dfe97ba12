"""Press the measured scans beside surfaces made from the description of the surface.

In: topography/spectra/chunk_*.h5, the files of the scans, topography/parameters.json, inputs.csv.
Out: topography/judged.csv (nm, nm^2).
"""

from pathlib import Path

from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from mesoscale.scan_checks.judged import judge
from mesoscale.scan_checks.surface import has_square_pixels
from mesoscale.settings import TopographySettings
from mesoscale.topography.measurements.loading import load_measurements
from mesoscale.topography.records import copies, in_order, trusted_record
from workflow.files.results import load_csv, load_h5, load_json, write_csv
from workflow.run.contact_settings import contact_settings
from workflow.run.job import job, settings_from_job

with job(snakemake) as run:
    settings = settings_from_job(TopographySettings, snakemake.params.settings)
    groups = {}
    attributes = {}
    for path in snakemake.input.chunks:
        judgement, _, described = load_h5(path)
        groups |= judgement
        attributes |= described
    alike = copies(in_order(groups, attributes), attributes)
    spectra = [
        trusted_record(name, data, attributes[name])
        for name, data in groups.items()
        if name not in alike
    ]
    scans = []
    for number, path in enumerate(snakemake.input.scans):
        measured = load_measurements(path, f"{number + 1:02d}_{Path(path).stem}", settings)
        scans += [
            item.data
            for item in measured
            if has_square_pixels(item.data) and item.data.name not in alike
        ]
    name = load_json(snakemake.input.parameters)["description"]["name"]
    values = medians(load_csv(snakemake.input.inputs))
    inputs, contact = contact_of(values, contact_settings(snakemake.params.contact, snakemake))
    rows = []
    for row in judge(scans, spectra, name, inputs, settings, contact):
        rows.append(row)
        run.progress(len(rows) / (5 * len(scans)), row["scan"])
    write_csv(snakemake.output[0], rows)
