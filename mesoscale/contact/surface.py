"""The rough surface that a contact cycle starts from."""

import math
from collections.abc import Callable
from typing import Literal, get_args

import numpy as np

from mesoscale.checks import check_number, check_periodic, checked_heights
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings

ContactAt = Literal["highest", "lowest"]
"""Which of given heights touch the flat first."""
CUT_OUT = 10.0
"""Longest roll-off over the cell: a cell without plateau is a part of a film; a longer one acts on
no wave at all.
"""


def random_surface(inputs: ContactInputs, settings: ContactSettings, seed: int) -> np.ndarray:
    """Heights (pixels, pixels) in nm by the inputs' q0, hurst and rms and by `settings.surface`.

    Contact is at the minima of the heights, so a surface of positive skewness (tall peaks) has deep
    minima here.

    Raises
    ------
    InputError : q0 or the cut-off beyond what the cell holds and the grid resolves.
    """
    from mesoscale.topography.synthesis import synthesize, synthesize_spectrum

    pixels = settings.pixels
    length = settings.length_nm
    q1 = settings.q1_per_nm
    shape = settings.surface
    if q1 is not None:
        check_number(
            "q1", q1, 0.0, settings.nyquist_per_nm * (1.0 + 1e-9), "1/nm (what the grid resolves)"
        )
    if shape.heights:
        from mesoscale.topography.height_synthesis import synthesize_heights

        psd = surface_spectrum(inputs, settings)
        return -synthesize_heights(pixels, length, psd, shape.heights, inputs.rms, seed, q1)
    if shape.spectrum is None:
        _check_roll_off(inputs.q0, settings)
        convention = settings.reading.convention
        q0, hurst = inputs.q0, inputs.hurst
        return synthesize(pixels, length, q0, hurst, inputs.rms, seed, convention, q1)
    return synthesize_spectrum(
        pixels, length, surface_spectrum(inputs, settings), inputs.rms, seed, q1
    )


def _check_roll_off(q0: float, settings: ContactSettings) -> None:
    """Refuse a roll-off far beyond the waves of the cell, where it does not act: another unit."""
    longest = 2.0 * math.pi / settings.length_nm
    shortest = settings.nyquist_per_nm
    if not longest / CUT_OUT <= q0 <= shortest * (1.0 + 1e-9):
        raise InputError(
            f"q0 = {q0:.4g} 1/nm: a cell of {settings.length_nm:g} nm and {settings.pixels} pixels"
            f" has waves of {longest:.4g} .. {shortest:.4g} 1/nm; accepted are"
            f" {longest / CUT_OUT:.4g} .. {shortest:.4g} 1/nm"
        )


def surface_spectrum(
    inputs: ContactInputs, settings: ContactSettings
) -> Callable[[np.ndarray], np.ndarray]:
    """Two-dimensional spectrum, nm^4 at 1/nm, from which `random_surface` draws."""
    from mesoscale.topography.roughness_spectrum import (
        RoughSpectrum,
        SpectrumTable,
        slope_from_hurst,
    )

    shape = settings.surface
    cutoff = shortest_wave(settings)
    convention = settings.reading.convention
    slope = slope_from_hurst(inputs.hurst, convention)
    if shape.spectrum is None:
        return RoughSpectrum.from_rms(inputs.rms, inputs.q0, slope, cutoff).psd
    table = SpectrumTable(shape.spectrum.q, shape.spectrum.psd)
    if shape.spectrum.q0 is not None and shape.spectrum.hurst is not None:
        pivot_slope = slope_from_hurst(shape.spectrum.hurst, convention)
        pivot_form = _form(table.q, shape.spectrum.q0, pivot_slope)
        own_form = _form(table.q, inputs.q0, slope)
        table = SpectrumTable(table.q, table.values * own_form / pivot_form)
    return table.scaled(inputs.rms, cutoff).psd


def _form(q: np.ndarray, q0: float, slope: float) -> np.ndarray:
    """Eq. 9 without plateau height and end."""
    return np.maximum(q / q0, 1.0) ** -slope


def shortest_wave(settings: ContactSettings) -> float:
    """Largest wave vector of a random surface, 1/nm: q1, at most the grid's Nyquist limit."""
    return min(settings.q1_per_nm or math.inf, settings.nyquist_per_nm)


def shared_wave(settings: ContactSettings) -> float:
    """Largest wave vector that finer grids show alike, 1/nm: without waves of just two pixels.

    Of these a grid holds no phase, so that they are others on a finer grid.
    """
    return min(shortest_wave(settings), settings.nyquist_per_nm * (1.0 - 1e-6))


def given_surface(
    heights: np.ndarray | None,
    length_nm: float | None,
    contact_at: ContactAt | None,
    settings: ContactSettings,
) -> tuple[np.ndarray | None, ContactSettings]:
    """The heights that a caller gives, checked, lowest in contact, and settings of their grid.

    Raises
    ------
    InputError : heights that are no surface in nm, or whose side of contact is not stated; a side
        without heights; a grid other than the settings' where no side is given.
    """
    if heights is None:
        if length_nm is not None:
            raise InputError(
                "length_nm is the side of heights; give both, or settings.length_nm alone"
            )
        return None, settings
    side_nm = settings.length_nm if length_nm is None else length_nm
    surface = checked_heights(heights, side_nm)
    check_periodic(surface)
    if contact_at not in get_args(ContactAt):
        raise InputError(
            f"contact_at = {contact_at}: say where heights touch the flat: highest, as an"
            " instrument measures them; lowest, as random_surface, contacting_heights and"
            " Cycle.heights give them"
        )
    if contact_at == "highest":
        surface = -surface
    pixels = len(surface)
    if length_nm is None:
        if pixels != settings.pixels:
            raise InputError(
                f"heights: {pixels} x {pixels} sites, but settings.pixels = {settings.pixels}; "
                "give length_nm, the side of the surface"
            )
        return surface, settings
    return surface, settings.model_copy(update={"pixels": pixels, "length_nm": float(length_nm)})
