"""Describe the surface behind all measurements: q0, q1, slope and RMS, one spectrum, and what
random surfaces follow.

In: topography/spectra/chunk_*.h5, truth.json for synthetic scans.
Out: topography/spectra.h5 (figures 9 and 10), topography/parameters.json (1/nm, 1, nm).
"""

import math

from mesoscale.settings import TopographySettings
from mesoscale.topography.curves import CURVES, result_curves
from mesoscale.topography.pooling import pool
from mesoscale.topography.records import DATASETS, KEPT, in_order
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.summary import parameters
from workflow.files.results import Dataset, load_h5, load_json, write_h5, write_json
from workflow.run.job import job, settings_from_job

with job(snakemake) as run:
    settings = settings_from_job(TopographySettings, snakemake.params.settings)
    arrays = {}
    attributes = {}
    for path in snakemake.input.chunks:
        groups, _, group_attributes = load_h5(path)
        arrays.update(groups)
        attributes.update(group_attributes)
    arrays = in_order(arrays, attributes)
    truth, typical = None, None
    if snakemake.input.truth:
        truth = load_json(snakemake.input.truth)
        known = truth["truth"]
        typical = RoughSpectrum.from_rms(known["rms_nm"], known["q0"], known["slope"], known["q1"])

    params = snakemake.params
    room_nm = params.electrode_nm or math.inf
    pooled = pool(
        arrays, attributes, settings, params.cell_nm, params.cut_off, room_nm, params.pixels
    )
    curves = result_curves(pooled, typical)
    groups = {
        group: {name: Dataset(values, *CURVES[name], ("q",)) for name, values in content.items()}
        for group, content in curves.items()
    }
    for name, data in arrays.items():
        groups[f"scans/{name}"] = {
            key: Dataset(data[key], *DATASETS[key]) for key in KEPT if key in data
        }
    write_h5(
        snakemake.output.spectra,
        groups,
        {"synthetic": truth is not None},
        run.provenance,
        {f"scans/{name}": values for name, values in attributes.items()},
    )
    write_json(
        snakemake.output.parameters, parameters(pooled, attributes, settings, truth), run.provenance
    )
