"""Press the measured scans beside surfaces made from the description of the surface; weigh the waves that none saw.

In: topography/spectra/chunk_*.h5, the files of the scans, topography/parameters.json, inputs.csv.
Out: topography/judged.csv (nm, nm^2); topography/unseen.csv, of random surfaces with these waves and without (nm, nm^2,
GPa, nN).
"""

from pathlib import Path

from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import from_rows
from mesoscale.scan_checks.judged import judge
from mesoscale.scan_checks.surface import has_square_pixels
from mesoscale.scan_checks.unseen import unseen_shares
from mesoscale.settings import ContactSettings, LawSettings, TopographySettings
from mesoscale.topography.measurements.loading import load_measurements
from mesoscale.topography.records import trusted_record
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.results import load_csv, load_h5, load_json, write_csv

with job(snakemake) as run:
    settings = settings_from_job(TopographySettings, snakemake.params.settings)
    described = load_json(snakemake.input.topography)
    table = from_rows(load_csv(snakemake.input.inputs))
    values = table.medians()

    spectra = []
    for path in snakemake.input.chunks:
        groups, _, attributes = load_h5(path)
        spectra += [trusted_record(name, data, attributes[name], settings) for name, data in groups.items()]
    scans = []
    for number, path in enumerate(snakemake.input.scans):
        measured = load_measurements(path, f"{number + 1:02d}_{Path(path).stem}", settings)
        scans += [item.data for item in measured if has_square_pixels(item.data)]
    inputs, contact = contact_of(values, settings_from_job(ContactSettings, snakemake.params.contact))
    rows = []
    for row in judge(scans, spectra, described["description"]["name"], inputs, settings, contact):
        rows.append(row)
        run.progress(len(rows) / (5 * len(scans)), row["scan"])
    write_csv(snakemake.output.judged, rows)

    for row in table.rows:
        if row.name == "q1":  # all of the extrapolation reaches the upper end of its interval
            values["q1"] = float(row.distribution.quantile(0.99))
    inputs, contact = contact_of(values, contact_settings(snakemake.params.contact, snakemake))
    seen = float(described["trusted_end"]["interval"][0])
    law = settings_from_job(LawSettings, snakemake.params.law)
    write_csv(snakemake.output.unseen, unseen_shares(inputs, contact, law, seen))
