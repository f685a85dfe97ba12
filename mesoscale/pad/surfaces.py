"""Surfaces of a pad's cells: pieces of one large film, not copies of its mean.

A cell of a periodic surface has no waves longer than its side, and `random_surface` gives every realisation the same
RMS height. Pieces of a large film differ in both: their mean planes scatter by the waves that are longer than a cell,
and their RMS heights by the few long waves that a cell holds. The highest pieces carry most of the load: without these
differences a pad has some 15 % too little pressure (docs/pad.md).
"""

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.surface import random_surface, shortest_wave, surface_spectrum
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings

Array = NDArray[np.float64]


class FilmPieces:
    """Surfaces of cells that are pieces of a film with the inputs' RMS height.

    Attributes
    ----------
    power : variance of each wave of the film (nm^2), shape (pixels, pixels // 2 + 1); in [0, 0] that of waves longer
        than a cell.
    """

    def __init__(self, inputs: ContactInputs, contact: ContactSettings):
        self.inputs, self.contact = inputs, contact
        step = 2.0 * np.pi / contact.length_nm
        waves = step * contact.pixels * np.fft.fftfreq(contact.pixels)
        q = np.hypot(waves[:, None], waves[None, : contact.pixels // 2 + 1])
        inside = q <= shortest_wave(contact) * (1.0 + 1e-9)
        # the spectrum is flat below the longest wave of a cell
        power = np.where(inside, surface_spectrum(inputs, contact)(np.maximum(q, step)), 0.0)
        # the half plane stands for the whole: all columns but the first (and the last of an even grid) count twice
        twice = np.full(q.shape[1], 2.0)
        twice[0] = 1.0
        if contact.pixels % 2 == 0:
            twice[-1] = 1.0
        other = contact.surface.counterface
        self.known = inside & (power > 0)
        self.known[0, 0] = False
        if not self.known.any():
            raise InputError(
                f"contact.pixels = {contact.pixels}, contact.length_nm = {contact.length_nm:g}: the spectrum has no "
                f"wave from {step:.3g} to {shortest_wave(contact):.3g} 1/nm, which is all that a cell has; "
                "give one that reaches there, or another grid"
            )
        variance = inputs.rms**2 + (other.rms_nm**2 if other else 0.0)
        self.power = power * (variance / float((power * twice).sum()))

    @property
    def plane_deviation_nm(self) -> float:
        """Standard deviation of the mean planes of cells (nm)."""
        return float(np.sqrt(self.power[0, 0]))

    def surface(self, seed: int) -> Array:
        """Heights (pixels, pixels) in nm of one cell, from the mean plane of the film; contact is at its minima."""
        heights = random_surface(self.inputs, self.contact, seed)
        # the realisation was scaled to its own RMS; its short waves, of which there are many, tell by how much
        realised = np.abs(np.fft.rfft2(heights)) ** 2 / heights.size**2
        ratio = float(np.mean(realised[self.known] / self.power[self.known]))
        rng = np.random.default_rng(np.random.SeedSequence([seed, 0x9A11]))
        return heights / np.sqrt(ratio) + self.plane_deviation_nm * rng.normal()
