"""Equation 8 as it is printed."""

import numpy as np


def power_spectrum(heights: np.ndarray, lengths_nm: tuple[float, float]) -> np.ndarray:
    """C(qx, qy) in nm^4 of heights (nx, ny) in nm, without window, in FFT order."""
    nx, ny = heights.shape
    # eq. 7
    amplitude = lengths_nm[0] * lengths_nm[1] / (2 * np.pi * nx * ny) * np.fft.fft2(heights)
    return np.abs(amplitude) ** 2 / (lengths_nm[0] * lengths_nm[1])
