"""Contact cycles on the measured scans themselves, and on random surfaces of the same statistics.

In: AFM files, topography/parameters.json, inputs.csv.
Out: curves/scans.h5 (groups <scan>/<surface>/closing|opening; nm, nN, nm^2), law/scans.csv (one row per scan,
surface and branch).
"""

import math
from dataclasses import asdict
from itertools import chain
from pathlib import Path

from mesoscale.contact.cycle import BRANCH_COLUMNS
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from mesoscale.scan_checks.pressing import has_square_pixels, press_scan
from mesoscale.settings import LawSettings, TopographySettings
from mesoscale.topography.measurements.loading import load_measurements
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.results import Dataset, load_csv, load_json, write_csv, write_h5

with job(snakemake) as run:
    settings = settings_from_job(TopographySettings, snakemake.params.settings)
    law = settings_from_job(LawSettings, snakemake.params.law)
    fitted = load_json(snakemake.input.parameters)["likelihood"]
    spectrum = RoughSpectrum(fitted["plateau_nm4"], fitted["q0"], fitted["slope"], math.inf)
    central = medians(load_csv(snakemake.input.inputs))
    inputs, contact = contact_of(central, contact_settings(snakemake.params.contact, snakemake))
    groups, attributes, rows = {}, {}, []
    files = list(snakemake.input.scans)
    for number, path in enumerate(files):
        measured = load_measurements(path, f"{number + 1:02d}_{Path(path).stem}", settings)
        maps = [item.data for item in measured if has_square_pixels(item.data)]
        pressing = (press_scan(raw, spectrum, fitted["misfit"], inputs, settings, contact, law) for raw in maps)
        for pressed in chain.from_iterable(pressing):
            name = f"{pressed.scan}/{pressed.surface}"
            for branch, curve in (("closing", pressed.cycle.closing), ("opening", pressed.cycle.opening)):
                groups[f"{name}/{branch}"] = {
                    key: Dataset(values, *BRANCH_COLUMNS[key], ("separation_nm",))
                    for key, values in asdict(curve).items()
                }
            attributes[name] = {**pressed.description, **pressed.cycle.flags}
            rows += pressed.rows()
            run.progress((number + 1) / len(files), name)
    write_h5(snakemake.output.curves, groups, {}, run.provenance, attributes)
    write_csv(snakemake.output.law, rows)
