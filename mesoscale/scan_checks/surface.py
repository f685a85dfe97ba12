"""A measured scan as a surface that the contact model can press."""

from typing import TypeGuard

import numpy as np
import scipy.fft

from mesoscale.errors import InputError
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.profiles import Profile

OBLONG = 0.01  # pixels that differ more in their sides do not fit the square grid of the contact


def has_square_pixels(data: Scan | Profile) -> TypeGuard[Scan]:
    """Can this be pressed: a scan whose pixels are square?"""
    return isinstance(data, Scan) and abs(data.pixel_nm[0] / data.pixel_nm[1] - 1) <= OBLONG


def contacting_heights(scan: Scan) -> tuple[np.ndarray, float]:
    """The largest centred square of a cleaned scan for the contact: heights (n, n), side in nm.

    The contact is at the minima of its heights and periodic, so the scan is turned upside down and
    made periodic.

    Raises
    ------
    InputError : pixels that are not square.
    """
    px, py = scan.pixel_nm
    if abs(px / py - 1) > OBLONG:
        raise InputError(
            f"{scan.name}: pixels of {px:.3g} nm x {py:.3g} nm; accepted are square pixels"
        )
    nx, ny = scan.heights_nm.shape
    n = min(nx, ny)
    i = (nx - n) // 2
    j = (ny - n) // 2
    square = scan.heights_nm[i : i + n, j : j + n]
    return -periodic_part(square - square.mean()), n * px


def periodic_part(heights: np.ndarray) -> np.ndarray:
    """Heights less the smoothest surface with their jumps (doi:10.1007/s10851-010-0227-1).

    What is left meets itself across the edges without a jump, and is nearly unchanged away from
    them.
    """
    nx, ny = heights.shape
    jumps = np.zeros_like(heights)
    jumps[0] += heights[-1] - heights[0]
    jumps[-1] -= heights[-1] - heights[0]
    jumps[:, 0] += heights[:, -1] - heights[:, 0]
    jumps[:, -1] -= heights[:, -1] - heights[:, 0]
    wave_x = 2 * np.cos(2 * np.pi * np.fft.fftfreq(nx))[:, None]
    wave_y = 2 * np.cos(2 * np.pi * np.fft.rfftfreq(ny))
    laplace = wave_x + wave_y - 4
    laplace[0, 0] = 1.0
    smooth = np.asarray(scipy.fft.rfft2(jumps)) / laplace
    smooth[0, 0] = 0.0
    return heights - np.asarray(scipy.fft.irfft2(smooth, s=heights.shape))
