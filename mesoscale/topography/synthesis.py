"""Random rough surfaces with the spectrum of the paper's eq. 9.

The noise is drawn in Fourier space, shell by shell from long to short waves: a seed gives the same
long waves whatever the parameters *and* whatever the grid, so that parameter changes and grid
refinements can be compared on one and the same surface (common random numbers).
"""

from typing import Literal

import numpy as np
from numba import njit
from scipy import fft

from mesoscale.errors import InputError

Convention = Literal["profile", "areal"]


def spectral_slope(hurst: float, convention: Convention) -> float:
    """Fall-off s of the two-dimensional PSD, C(q) ~ q^-s, for a Hurst exponent.

    ``profile``: s = 2H + 1, the paper's eq. 9 (the slope of a one-dimensional profile, used on the
    two-dimensional spectrum); ``areal``: s = 2H + 2, the slope of an isotropic surface.
    """
    return 2.0 * hurst + (1.0 if convention == "profile" else 2.0)


def synthesize(
    pixels: int,
    length_nm: float,
    q0: float,
    hurst: float,
    rms: float,
    seed: int,
    convention: Convention = "profile",
    q1: float | None = None,
) -> np.ndarray:
    """Periodic Gaussian surface with plateau, roll-off, power law and cut-off (section 4, eq. 9).

    Parameters
    ----------
    pixels, length_nm
        Grid points per side and side length in nm.
    q0, q1
        Roll-off and cut-off wave vectors in 1/nm; ``q1=None`` is the grid's Nyquist limit.
    hurst, convention
        Exponent and how it is read, see `spectral_slope`.
    rms
        Root-mean-square height in nm; met exactly by every realisation.
    seed
        Any non-negative integer.

    Returns
    -------
    heights : (pixels, pixels) array in nm, mean zero.
    """
    step = 2.0 * np.pi / length_nm
    highest = (pixels - 1) // 2
    cutoff = np.inf if q1 is None else q1
    cutoff = min(cutoff, np.pi * pixels / length_nm)
    last = int(np.floor((cutoff / step) ** 2 * (1.0 + 1e-12)))
    if last < 1:
        raise InputError(
            f"q1 = {cutoff:g} 1/nm leaves no wave on a surface of {length_nm:g} nm; "
            f"accepted: at least {step:g} 1/nm; raise q1 or length_nm"
        )
    squared = np.arange(1, last + 1, dtype=float)
    amplitude = np.empty(last + 1)
    amplitude[0] = 0.0
    # (q/q0)^(-s/2) for q > q0, as exp/log: NumPy has fast vector code for these but not for power
    decay = np.log(squared * (step / q0) ** 2)
    np.exp(
        np.minimum(decay, np.inf, out=decay).clip(min=0.0) * (-0.25 * spectral_slope(hurst, convention)),
        out=amplitude[1:],
    )
    modes = 2 * highest * (highest + 1)
    normals = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed))).standard_normal(2 * modes)
    spectrum = np.zeros((pixels, pixels // 2 + 1), dtype=complex)
    power = _fill_spectrum(spectrum, normals, amplitude, highest)
    spectrum *= rms * pixels**2 / np.sqrt(power)
    return np.asarray(fft.irfft2(spectrum, s=(pixels, pixels), overwrite_x=True))


@njit(cache=True)
def _fill_spectrum(spectrum, normals, amplitude, highest):
    """Filter the noise into the half spectrum; returns the sum of |c|^2 over the whole spectrum.

    Mode (k1, k2) of shell s = max(|k1|, k2) has number 2 s (s-1) + its place in the shell, for the
    half plane k2 > 0 or (k2 = 0 and k1 > 0); the other half is its complex conjugate.
    """
    n = spectrum.shape[0]
    last = amplitude.size - 1
    power = 0.0
    for row in range(-highest, highest + 1):
        for col in range(highest + 1):
            squared = row * row + col * col
            if squared > last or squared == 0 or (col == 0 and row < 0):
                continue
            s = max(abs(row), col)
            if col == s:
                place = row + s
            elif row > 0:
                place = 2 * s + 1 + col
            else:
                place = 3 * s + col
            mode = 2 * s * (s - 1) + place
            re = amplitude[squared] * normals[2 * mode]
            im = amplitude[squared] * normals[2 * mode + 1]
            power += 2.0 * (re * re + im * im)
            spectrum[row if row >= 0 else row + n, col] = complex(re, im)
            if col == 0:
                spectrum[n - row, 0] = complex(re, -im)
    return power
