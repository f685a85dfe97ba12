"""Read AFM scans, clean them and compute their spectra.

In: AFM files of any supported format.
Out: topography/spectra/chunk_*.h5 (nm, 1/nm, nm^4; one group per scan).
"""

from pathlib import Path

from mesoscale.settings import TopographySettings
from mesoscale.topography.analysis import analyse_scan, thumbnail
from mesoscale.topography.measurements.loading import load_scan
from workflow.checksums import file_checksum
from workflow.job import job
from workflow.results import Dataset, write_h5

with job(snakemake) as run:
    settings = TopographySettings(**snakemake.params.settings)
    groups, attributes = {}, {}
    files = list(snakemake.input.scans)
    for number, path in enumerate(files):
        stem = Path(path).stem
        name = stem if not settings.scans else f"{snakemake.params.first + number + 1:02d}_{stem}"
        result = analyse_scan(load_scan(path, name, settings.channel), settings)
        spectrum, flat, cleaned = result.spectrum, result.flat_spectrum, result.cleaned
        groups[name] = {
            "q": Dataset(spectrum.q, "1/nm", "wave vector", ("q",)),
            "psd": Dataset(spectrum.psd, "nm^4", "isotropic spectrum, Hann window", ("q",)),
            "modes": Dataset(spectrum.modes, "1", "independent amplitudes behind each value", ("q",)),
            "flat_q": Dataset(flat.q, "1/nm", "wave vector", ("flat_q",)),
            "flat_psd": Dataset(flat.psd, "nm^4", "isotropic spectrum, nearly flat window", ("flat_q",)),
            "flat_modes": Dataset(flat.modes, "1", "independent amplitudes behind each value", ("flat_q",)),
            "profile_q": Dataset(result.profile_q, "1/nm", "wave vector along scan lines", ("profile_q",)),
            "profile_psd": Dataset(result.profile_psd, "nm^3", "spectrum along scan lines", ("profile_q",)),
            "lag": Dataset(result.lag_nm, "nm", "distance along scan lines", ("lag",)),
            "autocorrelation": Dataset(result.autocorrelation_nm2, "nm^2", "height autocorrelation", ("lag",)),
            "heights": Dataset(thumbnail(cleaned.heights_nm), "nm", "cleaned heights, thinned", ("x", "y")),
        }
        attributes[name] = {
            "file": path,
            "sha256": file_checksum(path),
            "length_x_nm": cleaned.lengths_nm[0],
            "length_y_nm": cleaned.lengths_nm[1],
            "pixels_x": cleaned.heights_nm.shape[0],
            "pixels_y": cleaned.heights_nm.shape[1],
            "raw_rms_nm": result.raw_rms_nm,
            "rms_nm": cleaned.rms_nm,
            "spacing": spectrum.spacing,
            "nyquist": spectrum.nyquist,
            "flat_spacing": flat.spacing,
            "steps": "; ".join(cleaned.steps),
        }
        run.progress((number + 1) / len(files), name)
    write_h5(snakemake.output[0], groups, {"synthetic": not settings.scans}, run.provenance, attributes)
