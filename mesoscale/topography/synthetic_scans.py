"""A synthetic AFM: surfaces of known spectrum, with tip, noise, tilt, drift, digital steps."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy.fft
from pydantic import Field

from mesoscale.settings import SyntheticScanSettings
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.roughness_spectrum import RoughSpectrum


class ScanSet(SyntheticScanSettings):
    """A set of synthetic scans: what a scene says of them, and the fixed surface and artefacts."""

    seed: int = 1
    small_length_nm: float = 1000.0
    large_length_nm: float = 10_000.0
    q0: float = Field(default=0.025, description="1/nm, the middle of the paper's range")
    q1: float = Field(default=3.2, description="1/nm, end of the power law")
    slope: float = Field(default=2.84, description="C ~ q^-slope, the paper's H of 0.92 as 2H+1")
    rms_nm: float = Field(default=6.0, description="of a typical place")
    rms_variation: float = Field(
        default=0.4, description="standard deviation of ln RMS; the paper has 1.8 to 14 nm"
    )
    tip_radius_nm: float = Field(default=5.0, description="of a paraboloid")
    noise_nm: float = Field(default=0.03, description="white, of each pixel")
    line_noise_nm: float = Field(default=0.3, description="random offset of each scan line")
    tilt_deg: float = Field(default=0.5, description="largest, of sample to scanner")
    drift_nm: float = Field(default=5.0, description="slow and vertical, over a scan")
    step_nm: float = Field(default=0.01, description="height of one digital step")


@dataclass(frozen=True)
class SyntheticScan:
    """A synthetic scan and the truth behind it."""

    scan: Scan
    truth: RoughSpectrum


def synthetic_scans(settings: ScanSet) -> Iterator[SyntheticScan]:
    """The scans of a set, small ones first; scan k is the same whatever the number of scans."""
    groups = {
        "small": (0, settings.small_scans, settings.small_length_nm),
        "large": (1, settings.large_scans, settings.large_length_nm),
    }
    for size, (key, count, length) in groups.items():
        for number in range(count):
            rng = np.random.default_rng(
                np.random.SeedSequence(settings.seed, spawn_key=(key, number))
            )
            rms = settings.rms_nm * math.exp(settings.rms_variation * rng.standard_normal())
            truth = RoughSpectrum.from_rms(rms, settings.q0, settings.slope, settings.q1)
            # the tip meets the surface on pixels of 5 nm, or twice as fine as the scan's
            finer = 2 if settings.tip_radius_nm > 0 and length / settings.pixels > 5.0 else 1
            surface = surface_patch(truth, finer * settings.pixels, length, rng)
            traced = dilate(surface, settings.tip_radius_nm, length / len(surface))
            surface = traced[::finer, ::finer]
            name = f"{size}_{number + 1:02d}"
            yield SyntheticScan(measure(surface, length, settings, rng, name), truth)


def surface_patch(
    truth: RoughSpectrum, pixels: int, length_nm: float, rng: np.random.Generator
) -> np.ndarray:
    """Heights (pixels, pixels) in nm of a Gaussian surface sampled at points, not periodic.

    The spectrum is folded at the Nyquist wave vector as point sampling folds it, so that a coarse
    scan of a surface that is rough below its pixels is exact, RMS included.
    """
    # the periodic surface is larger, so that scans are not periodic
    least_pixels = math.ceil(1.25 * pixels)
    n = scipy.fft.next_fast_len(least_pixels, True) or least_pixels
    step = length_nm / pixels
    qx = 2 * np.pi * np.fft.fftfreq(n, step)
    qy = 2 * np.pi * np.fft.rfftfreq(n, step)
    folded = _folded_psd(truth, qx, qy, 2 * np.pi / step)
    noise = np.asarray(scipy.fft.rfft2(rng.standard_normal((n, n))))
    filtered = noise * np.sqrt(folded) * (2 * np.pi / step)
    surface = np.asarray(scipy.fft.irfft2(filtered, s=(n, n)))
    return surface[:pixels, :pixels]


def _folded_psd(
    truth: RoughSpectrum, qx: np.ndarray, qy: np.ndarray, sampling: float
) -> np.ndarray:
    """Sum of C over the images of each wave vector at multiples of the sampling wave vector."""
    images = min(12, math.ceil(truth.q1 / sampling + 0.5))
    # the images vary slowly over the grid: a coarse one and linear interpolation do
    nodes = np.linspace(-sampling / 2, sampling / 2, 33)
    far = np.zeros((33, 33))
    for i in range(-images, images + 1):
        for j in range(-images, images + 1):
            if (i, j) != (0, 0):
                image_x = nodes[:, None] + i * sampling
                image_y = nodes[None, :] + j * sampling
                far += truth.psd(np.hypot(image_x, image_y))
    unit = np.eye(33)
    along_x = np.stack([np.interp(qx, nodes, row) for row in unit], axis=1)
    along_y = np.stack([np.interp(qy, nodes, row) for row in unit], axis=1)
    near = truth.psd(np.hypot(qx[:, None], qy[None, :]))
    return near + along_x @ far @ along_y.T


def measure(
    surface: np.ndarray,
    length_nm: float,
    settings: ScanSet,
    rng: np.random.Generator,
    name: str,
) -> Scan:
    """Scan what the tip traces (pixels, pixels; nm): tilt, drift, line offsets, noise, steps."""
    pixels = surface.shape[0]
    position = np.linspace(-0.5, 0.5, pixels)
    tilt = np.tan(np.radians(settings.tilt_deg * rng.uniform(-1, 1, 2))) * length_nm
    heights = surface + tilt[0] * position[:, None] + tilt[1] * position[None, :]
    # drift acts in time, that is along the slow axis: a smooth curve of three random cosines
    phases = rng.uniform(0, 2 * np.pi, 3)
    cosines = [
        np.cos(np.pi * (k + 1) * position + phase) / (k + 1) for k, phase in enumerate(phases)
    ]
    drift = sum(cosines)
    heights += settings.drift_nm / 2 * np.asarray(drift)[None, :]
    heights += settings.line_noise_nm * rng.standard_normal(pixels)[None, :]
    heights += settings.noise_nm * rng.standard_normal((pixels, pixels))
    if settings.step_nm > 0:
        heights = np.round(heights / settings.step_nm) * settings.step_nm
    return Scan(heights, (length_nm, length_nm), name)


def dilate(surface: np.ndarray, tip_radius_nm: float, step_nm: float) -> np.ndarray:
    """What a paraboloidal tip of the given radius traces: max over u of h(x+u) - u^2 / 2R.

    A paraboloid separates into one pass per axis. What lies below the pixels does not touch the
    tip.
    """
    if tip_radius_nm <= 0:
        return surface.copy()
    reach = math.sqrt(2 * tip_radius_nm * np.ptp(surface)) / step_nm
    image = surface
    for axis in (0, 1):
        source = np.moveaxis(image, axis, 0)
        result = source.copy()
        for shift in range(1, min(int(reach), len(source) - 1) + 1):
            drop = (shift * step_nm) ** 2 / (2 * tip_radius_nm)
            np.maximum(result[shift:], source[:-shift] - drop, out=result[shift:])
            np.maximum(result[:-shift], source[shift:] - drop, out=result[:-shift])
        image = np.moveaxis(result, 0, axis)
    return image
