"""Measured scans pressed, beside random surfaces of the same statistics."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, TypeGuard

import numpy as np
import scipy.fft

from mesoscale.contact import Cycle, run_cycle
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.law.branches import Outcome, fit_cycle
from mesoscale.law.fit import row_of
from mesoscale.settings import ContactSettings, LawSettings, TopographySettings
from mesoscale.settings.contact import NOMINAL_SEED
from mesoscale.topography.analysis import trusted_scan
from mesoscale.topography.description import likelihood
from mesoscale.topography.description.parameters import MAX_MISFIT
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.measurements.profiles import Profile
from mesoscale.topography.roughness_spectrum import RoughSpectrum, SpectrumTable
from mesoscale.topography.spectrum import SECTION_SIDE, SECTIONS, radial_spectrum
from mesoscale.topography.synthesis import synthesize_spectrum

OBLONG = 0.01  # pixels that differ more in their sides do not fit the square grid of the contact
SURFACES = {
    "measured": "the scan itself",
    "own spectrum": "a Gaussian surface with the scan's own spectrum: what its other statistics do",
    "eq. 9": "a Gaussian surface with the fitted power law up to the pixels: what the microscope does not see",
}


def has_square_pixels(data: Scan | Profile) -> TypeGuard[Scan]:
    """Can this be pressed: a scan whose pixels are square?"""
    return isinstance(data, Scan) and abs(data.pixel_nm[0] / data.pixel_nm[1] - 1) <= OBLONG


def contacting_heights(scan: Scan) -> tuple[np.ndarray, float]:
    """The largest centred square of a cleaned scan as the contact model wants it: heights (n, n) and side, nm.

    The contact is at the minima of its heights and periodic, so the scan is turned upside down and made periodic.

    Raises
    ------
    InputError : pixels that are not square.
    """
    px, py = scan.pixel_nm
    if abs(px / py - 1) > OBLONG:
        raise InputError(
            f"{scan.name}: pixels of {px:.3g} nm x {py:.3g} nm; accepted are square pixels, "
            "or switch topography.press_scans off"
        )
    nx, ny = scan.heights_nm.shape
    n = min(nx, ny)
    i, j = (nx - n) // 2, (ny - n) // 2
    square = scan.heights_nm[i : i + n, j : j + n]
    return -periodic_part(square - square.mean()), n * px


def periodic_part(heights: np.ndarray) -> np.ndarray:
    """Heights less the smoothest surface that has their jumps across the edges (doi:10.1007/s10851-010-0227-1).

    What is left meets itself across the edges without a jump, and is nearly unchanged away from them.
    """
    nx, ny = heights.shape
    jumps = np.zeros_like(heights)
    jumps[0] += heights[-1] - heights[0]
    jumps[-1] -= heights[-1] - heights[0]
    jumps[:, 0] += heights[:, -1] - heights[:, 0]
    jumps[:, -1] -= heights[:, -1] - heights[:, 0]
    laplace = 2 * np.cos(2 * np.pi * np.fft.fftfreq(nx))[:, None] + 2 * np.cos(2 * np.pi * np.fft.rfftfreq(ny)) - 4
    laplace[0, 0] = 1.0
    smooth = np.asarray(scipy.fft.rfft2(jumps)) / laplace
    smooth[0, 0] = 0.0
    return heights - np.asarray(scipy.fft.irfft2(smooth, s=heights.shape))


def surfaces(
    scan: Scan, fitted: RoughSpectrum, settings: TopographySettings, contact: ContactSettings
) -> Iterator[tuple[str, np.ndarray, ContactSettings, float]]:
    """Surfaces to press: a key of `SURFACES`, heights (nm), contact settings and largest force (nN).

    All have the scan's grid and RMS height, and carry the nominal pressure that the settings' largest force is.

    Parameters
    ----------
    scan : cleaned.
    fitted : eq. 9 of all scans, or of this one where they share no spectrum.
    """
    heights, side = contacting_heights(scan)
    chosen = contact.model_copy(update={"pixels": len(heights), "length_nm": side})
    force = contact.max_force_nN * (side / contact.length_nm) ** 2
    rms, seed = float(np.std(heights)), NOMINAL_SEED
    yield "measured", heights, chosen, force
    spectrum = radial_spectrum(heights, (side, side), SECTIONS, SECTION_SIDE, flat=0.0)
    scan_psd = SpectrumTable(spectrum.q, spectrum.psd).psd
    yield "own spectrum", synthesize_spectrum(len(heights), side, scan_psd, rms, seed), chosen, force
    power_law = RoughSpectrum(fitted.plateau, fitted.q0, fitted.slope, math.inf).psd
    yield "eq. 9", synthesize_spectrum(len(heights), side, power_law, rms, seed), chosen, force


@dataclass(frozen=True)
class PressedSurface:
    """One surface of a scan, closed and opened; `surface` is a key of `SURFACES`."""

    scan: str
    surface: str
    pixels: int
    max_force_nN: float
    cycle: Cycle
    law: Outcome

    @property
    def description(self) -> dict[str, Any]:
        """What both branches share, as the attributes of curves/scans.h5 and the columns of law/scans.csv."""
        return {
            "surface": self.surface,
            "cell_area_nm2": self.cycle.cell_area_nm2,
            "pixels": self.pixels,
            "rms_nm": self.cycle.inputs.rms,
            "max_force_nN": self.max_force_nN,
            "converged": self.cycle.converged,
            "first_contact_nm": self.cycle.first_contact_nm,
        }

    def rows(self) -> list[dict[str, Any]]:
        """Rows of law/scans.csv, one per branch."""
        fits = {"closing": self.law.closing, "opening": self.law.opening}
        return [
            {"scan": self.scan, **self.description, "branch": branch, **row_of(fit)} for branch, fit in fits.items()
        ]


def press_scan(
    raw: Scan,
    fitted: RoughSpectrum,
    misfit: float,
    inputs: ContactInputs,
    settings: TopographySettings,
    contact: ContactSettings,
    law: LawSettings,
) -> Iterator[PressedSurface]:
    """Press the surfaces of one scan (see `surfaces`), each at its own RMS height.

    Parameters
    ----------
    raw : as loaded, before levelling.
    fitted, misfit : eq. 9 of all scans and how badly it fits them (1); above MAX_MISFIT this scan's own fit is used,
        if it has one.
    inputs : of the contact; RMS height and spectrum are replaced by those of the surfaces.
    """
    fit_of_scan = likelihood.fit([trusted_scan(raw, settings)]) if misfit > MAX_MISFIT else None
    if fit_of_scan is not None:  # None also where this scan does not determine a spectrum
        fitted = fit_of_scan.spectrum(math.inf)
    scan = clean(raw, settings)
    for surface, heights, chosen, force in surfaces(scan, fitted, settings, contact):
        scan_inputs = replace(inputs, rms=float(np.std(heights)))
        cycle = run_cycle(scan_inputs, chosen, NOMINAL_SEED, force, heights, contact_at="lowest")
        outcome = fit_cycle(cycle, law)
        yield PressedSurface(scan.name, surface, chosen.pixels, force, cycle, outcome)
