"""Contact cycles on the measured scans themselves, and on random surfaces of the same statistics.

In: AFM files, topography/parameters.json, inputs.csv.
Out: curves/scans.h5 (groups <scan>/<surface>/closing|opening; nm, nN, nm^2), law/scans.csv (one row per scan,
surface and branch).
"""

from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from mesoscale.contact import run_cycle
from mesoscale.contact.cycle import BRANCH_COLUMNS
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import from_rows
from mesoscale.law.branches import fit_cycle
from mesoscale.law.fit import row_of
from mesoscale.settings import ContactSettings, LawSettings, TopographySettings
from mesoscale.topography import likelihood
from mesoscale.topography.analysis import trusted_scan
from mesoscale.topography.cleaning import clean
from mesoscale.topography.loading import read_scan
from mesoscale.topography.parameters import MAX_MISFIT
from mesoscale.topography.pressing import surfaces
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from workflow.job import job
from workflow.results import Dataset, read_csv, read_json, write_csv, write_h5

with job(snakemake) as run:
    settings = TopographySettings(**snakemake.params.settings)
    law = LawSettings(**snakemake.params.law)
    fitted = read_json(snakemake.input.parameters)["likelihood"]
    common = RoughSpectrum(fitted["plateau_nm4"], fitted["q0"], fitted["slope"], np.inf)
    table = from_rows(read_csv(snakemake.input.inputs))
    middle = {row.name: float(row.distribution.quantile(0.5)) for row in table.rows}
    inputs, contact = contact_of(middle, ContactSettings(**snakemake.params.contact))
    groups, attributes, rows = {}, {}, []
    files = list(snakemake.input.scans)
    for number, path in enumerate(files):
        raw = read_scan(path, f"{number + 1:02d}_{Path(path).stem}", settings.channel)
        scan = clean(raw, settings)
        alone = likelihood.fit([trusted_scan(raw, settings)]) if fitted["misfit"] > MAX_MISFIT else None
        spectrum = alone.spectrum(np.inf) if alone else common
        for surface, heights, chosen, force in surfaces(scan, spectrum, settings, contact):
            own = replace(inputs, rms=float(np.std(heights)))
            cycle = run_cycle(own, chosen, contact.nominal_seed, force, heights)
            name, area = f"{scan.name}/{surface}", chosen.length_nm**2
            for branch, curve in (("closing", cycle.closing), ("opening", cycle.opening)):
                groups[f"{name}/{branch}"] = {
                    key: Dataset(values, *BRANCH_COLUMNS[key], ("point",)) for key, values in asdict(curve).items()
                }
            facts = {
                "surface": surface,
                "cell_area_nm2": area,
                "pixels": chosen.pixels,
                "rms_nm": own.rms,
                "max_force_nN": force,
                "converged": cycle.converged,
                "first_contact_nm": cycle.first_contact_nm,
            }
            attributes[name] = {**facts, **cycle.flags}
            outcome = fit_cycle(cycle, own.hamaker, area, law)
            for branch, fit in (("closing", outcome.closing), ("opening", outcome.opening)):
                rows.append({"scan": scan.name, **facts, "branch": branch, **row_of(fit)})
            run.progress((number + 1) / len(files), name)
    write_h5(snakemake.output.curves, groups, {}, run.provenance, attributes)
    write_csv(snakemake.output.law, rows)
