"""Scan rough surfaces of known spectrum with a synthetic AFM.

In: nothing.  Out: topography/scans/*.gwy (Gwyddion files, metres), topography/truth.json (1/nm,
nm).
"""

from pathlib import Path

from mesoscale.settings import SyntheticScanSettings
from mesoscale.topography.measurements.loading import write_gwy
from mesoscale.topography.synthetic_scans import ScanSet, synthetic_scans
from workflow.files.results import atomic_path, write_json
from workflow.run.job import job, settings_from_job

with job(snakemake) as run:
    settings = ScanSet(
        **settings_from_job(SyntheticScanSettings, snakemake.params.settings).model_dump()
    )
    truths = {}
    for number, (path, item) in enumerate(
        zip(snakemake.output.scans, synthetic_scans(settings), strict=True)
    ):
        with atomic_path(path) as temporary:
            write_gwy(temporary, item.scan)
        truths[Path(path).stem] = {"rms_nm": item.truth.rms_nm, "plateau_nm4": item.truth.plateau}
        run.progress((number + 1) / len(snakemake.output.scans), Path(path).name)
    truth = {
        name: getattr(settings, name) for name in ("q0", "q1", "slope", "rms_nm", "rms_variation")
    }
    write_json(snakemake.output.truth, {"truth": truth, "scans": truths}, run.provenance)
