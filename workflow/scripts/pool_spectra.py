"""Fit q0, q1, slope and RMS to the spectra of all scans.

In: topography/spectra/chunk_*.h5, truth.json for synthetic scans.
Out: topography/spectra.h5 (figures 9 and 10), topography/parameters.json (1/nm, 1, nm).
"""

from mesoscale.settings import TopographySettings
from mesoscale.topography.analysis import CURVES, fit_curves, parameters, pooled_curve, scan_rows, trusted
from mesoscale.topography.description.parameters import analyse
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.spectrum import Spectrum
from workflow.job import job
from workflow.results import Dataset, load_h5, load_json, write_h5, write_json


def curve_datasets(curves):
    """Curves over q with unit and meaning."""
    return {name: Dataset(values, *CURVES[name], ("q",)) for name, values in curves.items()}


with job(snakemake) as run:
    settings = TopographySettings(**snakemake.params.settings)
    scans, attributes = {}, {}
    for path in snakemake.input.chunks:
        groups, _, group_attributes = load_h5(path)
        scans.update(groups)
        attributes.update(group_attributes)

    truth, typical = None, None
    if snakemake.input.truth:
        truth = load_json(snakemake.input.truth)
        known = truth["truth"]
        typical = RoughSpectrum.from_rms(known["rms_nm"], known["q0"], known["slope"], known["q1"])
    spectra, flat = [], []
    scans = dict(sorted(scans.items(), key=lambda item: (attributes[item[0]]["length_x_nm"], item[0])))
    for name, data in scans.items():
        spacing, nyquist = attributes[name]["spacing"], attributes[name]["nyquist"]
        spectrum = Spectrum(data["q"], data["psd"], data["modes"], spacing, nyquist)
        spectra.append(trusted(name, spectrum, attributes[name]["rms_nm"], settings))
        flat.append(Spectrum(data["flat_q"], data["flat_psd"], data["flat_modes"], spacing, nyquist))
    topography = analyse(spectra, settings)
    rows = scan_rows(spectra, topography, attributes, truth)
    for row in rows:
        attributes[row["name"]] = {**attributes[row["name"]], **row}
    curves = fit_curves(topography, min(item.spectrum.q[0] for item in spectra), typical)
    result_groups = {
        "pooled": curve_datasets(pooled_curve([item.spectrum for item in spectra])),
        "pooled_flat": curve_datasets(pooled_curve(flat)),
        "fits": curve_datasets(curves),
    }
    for name, data in scans.items():
        result_groups[f"scans/{name}"] = {
            "q": Dataset(data["q"], "1/nm", "wave vector", ("q",)),
            "psd": Dataset(data["psd"], "nm^4", "isotropic spectrum, Hann window", ("q",)),
            "flat_q": Dataset(data["flat_q"], "1/nm", "wave vector", ("flat_q",)),
            "flat_psd": Dataset(data["flat_psd"], "nm^4", "isotropic spectrum, nearly flat window", ("flat_q",)),
            "profile_q": Dataset(data["profile_q"], "1/nm", "wave vector along scan lines", ("profile_q",)),
            "profile_psd": Dataset(data["profile_psd"], "nm^3", "spectrum along scan lines", ("profile_q",)),
            "lag": Dataset(data["lag"], "nm", "distance along scan lines", ("lag",)),
            "autocorrelation": Dataset(data["autocorrelation"], "nm^2", "height autocorrelation", ("lag",)),
            "heights": Dataset(data["heights"], "nm", "cleaned heights, thinned", ("x", "y")),
        }
    write_h5(
        snakemake.output.spectra,
        result_groups,
        {"synthetic": truth is not None},
        run.provenance,
        {f"scans/{name}": values for name, values in attributes.items()},
    )
    write_json(snakemake.output.parameters, parameters(topography, rows, settings, truth), run.provenance)
