"""Measured scans as contacting surfaces."""

import numpy as np
import pytest

from mesoscale.errors import InputError
from mesoscale.scan_checks.surface import contacting_heights, periodic_part
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.synthesis import synthesize


def test_a_periodic_surface_is_nearly_left_alone():
    """Its neighbours across the edges differ no more than any neighbours do."""
    smooth = synthesize(128, 500.0, 0.05, 1.0, 3.0, 1, "areal", q1=0.2)
    assert np.std(periodic_part(smooth) - smooth) < 0.05 * 3.0


def test_a_tilted_surface_loses_its_jump_and_keeps_its_waves():
    surface = synthesize(128, 500.0, 0.1, 1.0, 1.0, 1, "areal", q1=0.4)
    tilted = surface + np.linspace(-10, 10, 128)[:, None]
    periodic = periodic_part(tilted)
    assert np.abs(periodic[0] - periodic[-1]).mean() < 0.03 * np.abs(tilted[0] - tilted[-1]).mean()
    # a tilt is the smoothest jump
    assert np.std(periodic - surface) < 0.05 * np.std(tilted - surface)


def test_the_largest_centred_square_is_turned_upside_down():
    heights = np.zeros((96, 64))
    heights[48, 32] = 5.0  # a peak in the middle
    surface, side = contacting_heights(Scan(heights, (960.0, 640.0), "a"))
    assert surface.shape == (64, 64)
    assert side == pytest.approx(640.0)
    assert np.unravel_index(np.argmin(surface), surface.shape) == (32, 32)
    with pytest.raises(InputError, match="square pixels"):
        contacting_heights(Scan(heights, (960.0, 700.0), "a"))
