"""From the records of all measurements to the parameters, the description and the curves of the surface."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.curves import fit_curves, pooled_curve
from mesoscale.topography.description.cell import finer_waves_doubt, grown_cell, refuse_coarse_measurements, suited_cell
from mesoscale.topography.description.choice import (
    Choice,
    carried_on,
    choose,
    description_doubts,
    rows_of,
    share_on_cells,
    surface_of,
)
from mesoscale.topography.description.doubts import Doubt
from mesoscale.topography.description.end import cutoff_row, rms_before
from mesoscale.topography.description.heights import HeightTest, compare_heights, not_gaussian
from mesoscale.topography.description.one_spectrum import (
    OneSpectrum,
    Overlap,
    merge,
    overlaps,
    refuse_different_films,
)
from mesoscale.topography.description.parameters import Topography, analyse
from mesoscale.topography.description.places import rms_scatter_row
from mesoscale.topography.description.surfaces import several_surfaces
from mesoscale.topography.description.tip_error import spectrum_with_radius_error, with_radius_error
from mesoscale.topography.description.tip_on_grains import lift_doubt, with_lift_error, without_lift
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.records import is_profile, trusted_record
from mesoscale.topography.roughness_spectrum import RoughSpectrum, SpectrumTable
from mesoscale.topography.spectrum import Spectrum

ENDS = ("spacing", "nyquist")


@dataclass(frozen=True)
class Pooled:
    """All that the measurements say of their surface.

    Attributes
    ----------
    spectra : of each measurement, without what tips added to grainy maps.
    one : the spectrum over all scales; None where there is not enough for one.
    tests : of the heights of each scan.
    pairs : measurements that see common bands.
    surface, rows : entries of `contact.surface`, distributions of q0, hurst, rms and q1.
    film : distributions of q0, hurst and rms of the typical place, and of the scatter of ln RMS between places.
    cell_nm : side of the cells that the contact is computed on.
    doubts : those that touch what is used.
    """

    spectra: list[TrustedSpectrum]
    topography: Topography
    one: OneSpectrum | None
    tests: list[HeightTest]
    pairs: list[Overlap]
    choice: Choice
    surface: dict[str, Any]
    rows: dict[str, dict[str, Any]]
    film: dict[str, dict[str, Any]]
    doubts: list[Doubt]
    cell_nm: float


def pool(
    arrays: Mapping[str, Mapping[str, np.ndarray]],
    attributes: Mapping[str, Mapping[str, Any]],
    settings: TopographySettings,
    cell_nm: float | None,
    cut_off: bool = False,
    electrode_nm: float = math.inf,
    pixels: int = 0,
) -> Pooled:
    """Describe the surface behind all records.

    Parameters
    ----------
    arrays, attributes : records by name (`records.record`).
    cell_nm : side of the surfaces that the contact model will make; None: the one that suits (`suited_cell`).
    cut_off : they end at the measured cut-off; the RMS height is then that of the waves before it.
    electrode_nm : side of a square of the electrode's area.
    pixels : grid points a side of these surfaces. Where they end at the cut-off, a side that is chosen grows with them
        (`grown_cell`).

    Raises
    ------
    InputError : measured files that cannot be of one surface, or that see no wave of a cell.
    """
    images = [trusted_record(name, data, attributes[name], settings) for name, data in arrays.items()]
    tests = [
        compare_heights(
            name,
            data["heights"],
            (float(attributes[name]["length_x_nm"]), float(attributes[name]["length_y_nm"])),
        )
        for name, data in arrays.items()
        if not is_profile(attributes[name]) and np.ptp(data["heights"]) > 0
    ]
    pairs = overlaps(images)
    if settings.scans:
        refuse_different_films(pairs)
    quantiles = {name: data["quantiles"] for name, data in arrays.items() if "quantiles" in data}
    topography, spectra, lifted = parameters_of(images, quantiles if not_gaussian(tests) else {}, settings)
    grows = cell_nm is None and cut_off
    cell_nm = suited_cell(spectra, electrode_nm) if cell_nm is None else cell_nm
    refuse_coarse_measurements(spectra, cell_nm)
    one = merge(spectra, lifted)
    if settings.scans:  # synthetic scans know their tip
        one = spectrum_with_radius_error(one, spectra)
    choice = choose(topography, one, tests, settings)
    cutoff = cutoff_row(topography, spectra)
    if grows:

        def held(side_nm: float) -> float:
            return share_on_cells(topography, one, choice, side_nm)[0]

        shortest_nm = 2.0 * np.pi / max(cutoff["a"], cutoff.get("b", 0.0))
        cell_nm = grown_cell(cell_nm, held, shortest_nm, pixels, electrode_nm)
    typical = settings.model_copy(update={"ranges": "interval"})
    surface = surface_of(choice, topography, one, list(quantiles.values()), settings, cell_nm)
    rows, film = (rows_of(choice, topography, one, asked, cell_nm) for asked in (settings, typical))
    if rows:
        rows["q1"] = cutoff
        film["rms_scatter"] = rms_scatter_row(topography, one if surface else None)
        if cut_off:
            rows["rms"], film["rms"] = (
                rms_before(rows["q1"], part["rms"], topography, surface) for part in (rows, film)
            )
    doubts = []
    if settings.scans:
        apart = _disagreements(pairs, one)
        doubts = several_surfaces(
            images, pairs, {name: str(values.get("file", name)) for name, values in attributes.items()}
        )
        doubts += description_doubts(topography, choice, one, attributes, apart, cell_nm, tests)
        if one is not None:
            doubts += finer_waves_doubt(SpectrumTable(*carried_on(one, one.psd)).psd, spectra, cell_nm)
    doubts += lift_doubt(images, spectra, lifted)
    if choice.name == "power_law":
        doubts = [*topography.doubts, *doubts]
    else:
        doubts = [*(doubt for doubt in topography.doubts if doubt.fatal), *doubts]
    return Pooled(spectra, topography, one, tests, pairs, choice, surface, rows, film, doubts, cell_nm)


def parameters_of(
    images: Sequence[TrustedSpectrum], quantiles: Mapping[str, np.ndarray], settings: TopographySettings
) -> tuple[Topography, list[TrustedSpectrum], float]:
    """Parameters with intervals that hold the tips' errors, spectra without the tips' lift, and the error it leaves.

    Parameters
    ----------
    quantiles : of maps whose heights are not Gaussian, by name (`heights.height_quantiles`).
    """
    topography = analyse(images, settings)
    if not settings.scans:  # synthetic scans know their tip, and are Gaussian
        return topography, list(images), 0.0
    spectra, error = without_lift(images, topography, quantiles)
    if error > 0:
        topography = analyse(spectra, settings)
    topography = with_radius_error(topography, spectra, settings)
    return with_lift_error(topography, error), spectra, error


def _disagreements(pairs: Sequence[Overlap], one: OneSpectrum | None) -> list[str]:
    """In words the measurements of different size or instrument that differ by more than places do."""
    between = 1.645 * np.sqrt(2) * one.place_sd if one else 0.0
    worst = [pair for pair in pairs if abs(np.log(pair.ratio)) > np.hypot(np.log(pair.expected), between)]
    worst.sort(key=lambda pair: -abs(np.log(pair.ratio)))
    return [
        f"{pair.first} and {pair.second} differ by a factor of {max(pair.ratio, 1 / pair.ratio):.2g} in C from "
        f"{pair.low:.2g} to {pair.high:.2g} /nm, expected is {pair.expected:.2g}"
        for pair in worst[:3]
    ]


def result_curves(
    pooled: Pooled,
    arrays: Mapping[str, Mapping[str, np.ndarray]],
    attributes: Mapping[str, Mapping[str, Any]],
    settings: TopographySettings,
    typical: RoughSpectrum | None,
) -> dict[str, dict[str, np.ndarray]]:
    """Groups of curves over q for spectra.h5; units and meanings stand in `curves.CURVES`."""
    flat = [
        Spectrum(data["flat_q"], data["flat_psd"], data["flat_modes"], *(attributes[name][key] for key in ENDS))
        for name, data in arrays.items()
        if "flat_q" in data
    ]
    lowest = min(item.spectrum.q[0] for item in pooled.spectra)
    groups = {"pooled": pooled_curve([item.spectrum for item in pooled.spectra])}
    if flat:
        groups["pooled_flat"] = pooled_curve(flat)
    groups["fits"] = dict(fit_curves(pooled.topography, lowest, typical))
    if pooled.one is not None and settings.scans:
        low, high = pooled.one.band()
        curves = {"q": pooled.one.q, "psd": pooled.one.psd, "band_low": low, "band_high": high}
        curves["measurements"] = pooled.one.count
        measured = pooled.one.q >= pooled.one.first
        groups["one_spectrum"] = {key: values[measured] for key, values in curves.items()}
    return groups
