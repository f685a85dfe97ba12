"""Read measurements of a surface, clean them and compute their spectra.

In: AFM files, line profiles and containers of any supported format.
Out: topography/spectra/chunk_*.h5 (nm, 1/nm, nm^4; one group per measurement).
"""

from pathlib import Path

from mesoscale.settings import TopographySettings
from mesoscale.topography.measurements.loading import load_measurements
from mesoscale.topography.records import DATASETS, record
from workflow.files.checksums import file_checksum
from workflow.files.results import Dataset, write_h5
from workflow.run.job import job, settings_from_job

with job(snakemake) as run:
    settings = settings_from_job(TopographySettings, snakemake.params.settings)
    groups = {}
    attributes = {}
    files = list(snakemake.input.scans)
    scene_folder = Path(snakemake.output[0]).parents[2]
    for number, path in enumerate(files):
        stem = Path(path).stem
        label = stem if not settings.scans else f"{snakemake.params.first + number + 1:02d}_{stem}"
        # the same words in all scenes that write the same scans, so that they share their pads
        shown = path if settings.scans else str(Path(path).relative_to(scene_folder))
        origin = {"file": shown, "sha256": file_checksum(path)}
        for measured in load_measurements(path, label, settings):
            name = measured.data.name
            arrays, described = record(measured, settings)
            groups[name] = {key: Dataset(values, *DATASETS[key]) for key, values in arrays.items()}
            attributes[name] = {**origin, **described}
        run.progress((number + 1) / len(files), label)
    write_h5(
        snakemake.output[0], groups, {"synthetic": not settings.scans}, run.provenance, attributes
    )
