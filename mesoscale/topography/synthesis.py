"""Random rough surfaces with the spectrum of the paper's eq. 9 or any isotropic one.

The noise is drawn in Fourier space, shell by shell from long to short waves: a seed gives the same
long waves whatever the parameters *and* whatever the grid, so that parameter changes and grid
refinements can be compared on one and the same surface (common random numbers).
"""

from collections.abc import Callable
from numbers import Integral

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import fft

from mesoscale.checks import MAX_LENGTH_NM, MIN_LENGTH_NM, check_number, check_seed
from mesoscale.errors import InputError
from mesoscale.topography.roughness_spectrum import Convention, slope_from_hurst

Array = NDArray[np.float64]


def synthesize(
    pixels: int,
    length_nm: float,
    q0: float,
    hurst: float,
    rms: float,
    seed: int,
    convention: Convention = "areal",
    q1: float | None = None,
) -> Array:
    """Periodic Gaussian surface with plateau, roll-off, power law and cut-off (section 4, eq. 9).

    Parameters
    ----------
    pixels, length_nm
        Grid points per side and side length in nm.
    q0, q1
        Roll-off and cut-off wave vectors in 1/nm; ``q1=None`` is the grid's Nyquist limit.
    hurst, convention
        Exponent and how it is read, see `slope_from_hurst`.
    rms
        Root-mean-square height in nm; met exactly by every realisation.
    seed
        Any non-negative integer.

    Returns
    -------
    heights : (pixels, pixels) array in nm, mean zero.

    Raises
    ------
    InputError : a number that is no such parameter, or a cut-off that leaves no wave.
    """
    check_number("q0", q0, 1e-7, 1e3, "1/nm")
    check_number("hurst", hurst, 1e-6, 2.0, "1")
    squared, step = squared_waves(pixels, length_nm, q1)
    amplitude = np.empty(len(squared) + 1)
    amplitude[0] = 0.0
    # (q/q0)^(-s/2) for q > q0, as exp/log: NumPy has fast vector code for these but not for power
    decay = np.log(squared * (step / q0) ** 2)
    exponent = -0.25 * slope_from_hurst(hurst, convention)
    np.exp(decay.clip(min=0.0) * exponent, out=amplitude[1:])
    return filtered_noise(pixels, amplitude, rms, seed)


def synthesize_spectrum(
    pixels: int,
    length_nm: float,
    psd: Callable[[Array], Array],
    rms: float,
    seed: int,
    q1: float | None = None,
) -> Array:
    """Periodic Gaussian surface with the shape of any isotropic spectrum C(q), nm^4 at q in 1/nm.

    `RoughSpectrum.psd` and `SpectrumTable.psd` are such functions, their sum the spectrum of two
    rough surfaces. The rest is as in `synthesize`; the same seed gives the same noise.
    """
    squared, step = squared_waves(pixels, length_nm, q1)
    amplitude = np.concatenate([[0.0], np.sqrt(psd(step * np.sqrt(squared)))])
    if not np.isfinite(amplitude).all() or not amplitude.any():
        raise InputError(
            f"the spectrum has no power on a surface of {length_nm:g} nm with {pixels} pixels a"
            f" side; accepted are spectra that reach between {step:g} and"
            f" {np.pi * pixels / length_nm:g} 1/nm"
        )
    return filtered_noise(pixels, amplitude, rms, seed)


def squared_waves(pixels: int, length_nm: float, q1: float | None) -> tuple[Array, float]:
    """Squared wave numbers 1, 2, ... up to the cut-off, and wave vector of wave number 1 (1/nm)."""
    check_number("length_nm", length_nm, MIN_LENGTH_NM, MAX_LENGTH_NM, "nm")
    if isinstance(pixels, bool) or not isinstance(pixels, Integral) or pixels < 3:
        raise InputError(f"pixels = {pixels!r}: accepted is a whole number >= 3")
    step = 2.0 * np.pi / length_nm
    cutoff = np.pi * pixels / length_nm
    if q1 is not None:
        cutoff = min(q1, cutoff)
    last = int(np.floor((cutoff / step) ** 2 * (1.0 + 1e-12)))
    if last < 1:
        raise InputError(
            f"q1 = {cutoff:g} 1/nm leaves no wave on a surface of {length_nm:g} nm; "
            f"accepted: at least {step:g} 1/nm; raise q1 or length_nm"
        )
    return np.arange(1, last + 1, dtype=float), step


def filtered_noise(pixels: int, amplitude: Array, rms: float, seed: int) -> Array:
    """Surface of noise times `amplitude[n]`, n the squared wave number, of RMS `rms`."""
    check_seed(seed)
    check_number("rms", rms, 1e-5, 1e6, "nm", zero=True)
    highest = (pixels - 1) // 2
    modes = 2 * highest * (highest + 1)
    rng = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed)))
    normals = rng.standard_normal(2 * modes)
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
