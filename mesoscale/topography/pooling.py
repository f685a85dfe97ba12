"""From the records of all measurements to parameters, description and curves of the surface."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.description.cell import (
    finer_waves_doubt,
    grown_cell,
    refuse_coarse_measurements,
    share_on_cells,
    suited_cell,
    unlike_measured,
    unseen_doubt,
)
from mesoscale.topography.description.choice import Choice, choose, description_doubts
from mesoscale.topography.description.doubts import Doubt
from mesoscale.topography.description.heights import compare_heights, not_gaussian
from mesoscale.topography.description.inputs import (
    cutoff_row,
    middle,
    rms_before,
    rms_scatter_row,
    rows_of,
    surface_of,
)
from mesoscale.topography.description.one_spectrum import OneSpectrum, merge
from mesoscale.topography.description.overlaps import Overlap, overlaps, refuse_different_films
from mesoscale.topography.description.parameters import Topography, analyse
from mesoscale.topography.description.surfaces import several_surfaces
from mesoscale.topography.description.tip import (
    lift_doubt,
    spectrum_with_radius_error,
    with_lift_error,
    with_radius_error,
    without_lift,
)
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.records import copies, is_profile, longest_nm, trusted_record
from mesoscale.topography.roughness_spectrum import SpectrumTable


@dataclass(frozen=True)
class Pooled:
    """All that the measurements say of their surface.

    Attributes
    ----------
    spectra : of each measurement, without what tips added to grainy maps.
    merged : the spectrum over all scales; None where there is not enough for one.
    pairs : measurements that see common bands.
    surface, rows : entries of `contact.surface`, distributions of q0, hurst, rms and q1.
    film : distributions of q0, hurst and rms of the typical place, and of the scatter of ln RMS
        between places.
    cell_nm : side of the cells that the contact is computed on.
    doubts : those that touch what is used.
    """

    spectra: list[TrustedSpectrum]
    topography: Topography
    merged: OneSpectrum | None
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
    cell_nm : side of the surfaces that the contact model will make; None: the one that suits
        (`suited_cell`).
    cut_off : they end at the measured cut-off; the RMS height is then that of the waves before it.
    electrode_nm : side of a square of the electrode's area.
    pixels : grid points a side of these surfaces. Where they end at the cut-off, a side that is
        chosen grows with them (`grown_cell`).

    Raises
    ------
    InputError : measured files that cannot be of one surface, or that see no wave of a cell.
    """
    alike = copies(arrays, attributes)
    arrays = {name: data for name, data in arrays.items() if name not in alike}
    attributes = {name: values for name, values in attributes.items() if name not in alike}
    images = [trusted_record(name, data, attributes[name]) for name, data in arrays.items()]
    tests = []
    for name, data in arrays.items():
        record = attributes[name]
        if not is_profile(record) and np.ptp(data["heights"]) > 0:
            lengths_nm = (float(record["length_x_nm"]), float(record["length_y_nm"]))
            tests.append(compare_heights(name, data["heights"], lengths_nm))
    pairs = overlaps(images)
    if settings.scans:
        refuse_different_films(pairs)
    quantiles = {name: data["quantiles"] for name, data in arrays.items() if "quantiles" in data}
    topography, spectra, lifted = parameters_of(
        images, quantiles if not_gaussian(tests) else {}, settings
    )
    grows = cell_nm is None and cut_off
    if cell_nm is None:
        cell_nm = suited_cell(spectra, electrode_nm)
    refuse_coarse_measurements(spectra, cell_nm)
    merged = merge(spectra, lifted)
    if settings.scans:  # synthetic scans know their tip
        merged = spectrum_with_radius_error(merged, spectra)
    choice = choose(topography, merged, tests, settings)
    used = None if choice.name == "power_law" else merged
    cutoff = cutoff_row(topography, spectra)
    if grows:

        def held(side_nm: float) -> float:
            return share_on_cells(topography, used, side_nm)[0]

        shortest_nm = 2.0 * np.pi / max(cutoff["a"], cutoff.get("b", 0.0))
        cell_nm = grown_cell(
            cell_nm, held, shortest_nm, pixels, min(electrode_nm, longest_nm(attributes))
        )
    charts = []
    if choice.name == "measured_heights":
        charts = list(quantiles.values())
    surface = surface_of(topography, used, charts, settings, cell_nm)
    typical = settings.model_copy(update={"ranges": "interval"})
    rows = rows_of(topography, used, settings, cell_nm)
    film = rows_of(topography, used, typical, cell_nm)
    if rows:
        rows["q1"] = cutoff
        film["rms_scatter"] = rms_scatter_row(topography, used)
        if cut_off:
            rows["rms"] = rms_before(cutoff, rows["rms"], topography, surface)
            film["rms"] = rms_before(cutoff, film["rms"], topography, surface)
    doubts = [doubt for doubt in topography.doubts if used is None or doubt.fatal]
    if settings.scans:
        files = {name: str(values.get("file", name)) for name, values in attributes.items()}
        doubts += several_surfaces(images, pairs, files)
        doubts += description_doubts(topography, choice.name, merged, attributes, tests, cell_nm)
        if merged is not None:
            doubts += finer_waves_doubt(
                SpectrumTable(*merged.carried_on(merged.psd)).psd, spectra, cell_nm
            )
    if settings.scans and rows:
        heights = {name: _levelled(arrays[name], values) for name, values in attributes.items()}
        doubts += unlike_measured(middle(rows["rms"]), heights, cell_nm)
        if used is not None:
            doubts += unseen_doubt(rows["rms"], longest_nm(attributes), cell_nm)
    doubts += lift_doubt(images, spectra, lifted)
    if alike:
        text = (
            f"{', '.join(f'{name} is a copy of {other}' for name, other in alike.items())}: it"
            " counts once"
        )
        doubts.append(Doubt("copies", text, "measure other places of the surface", "rms"))
    return Pooled(spectra, topography, merged, pairs, choice, surface, rows, film, doubts, cell_nm)


def _levelled(
    arrays: Mapping[str, np.ndarray], attributes: Mapping[str, Any]
) -> tuple[np.ndarray, tuple[float, ...]]:
    """Levelled heights (nm), thinned, with their lengths (nm)."""
    if is_profile(attributes):
        return arrays["line"], (float(attributes["length_x_nm"]),)
    return arrays["heights"], (float(attributes["length_x_nm"]), float(attributes["length_y_nm"]))


def parameters_of(
    images: Sequence[TrustedSpectrum],
    quantiles: Mapping[str, np.ndarray],
    settings: TopographySettings,
) -> tuple[Topography, list[TrustedSpectrum], float]:
    """Parameters with the tips' errors, spectra without the tips' lift, and the error that leaves.

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
