"""What would a GPU bring to contacts of whole grids?

`python evidence/contact/gpu.py` times a pair of FFTs and one elastic load at about 10 % contact, on all cores and on a
GPU. It needs NumPy and SciPy, and CuPy for the GPU. Both run the same lines: conjugate gradients on the sites under
pressure (Polonsky and Keer, doi:10.1016/S0043-1648(99)00113-1), preconditioned with the stiffness of the half-space.
The engine's own solve is not these lines. Its loops are compiled, and they skip sites that cannot touch.
"""

import importlib
import importlib.util
import os
import time
from functools import partial
from typing import Any

import numpy as np
from scipy import fft

PIXELS, LARGEST_CPU = (1024, 2048, 4096, 8192), 4096
RMS_NM, Q0, DEPTH = 5.0, 0.025, 1.3  # sites of 1 nm; below the mean plane, in RMS heights, is the flat
TOLERANCE, STEPS = 1e-6, 300


def surface(pixels):
    """Heights (nm) and stiffness of the waves, pi abs(q) L / L, in E* = 1, shape (pixels, pixels // 2 + 1)."""
    q = 2 * np.pi * np.hypot(np.fft.fftfreq(pixels)[:, None], np.fft.rfftfreq(pixels)[None])
    noise = fft.rfft2(np.random.default_rng(1).standard_normal((pixels, pixels)), workers=-1)
    heights = np.asarray(fft.irfft2(noise * np.where(q < 0.3, (q**2 + Q0**2) ** -0.9, 0.0), workers=-1))
    return heights * (RMS_NM / heights.std()), np.where(q > 0, q, q[0, 1]) / 2


def pair(transforms, options, values, factor):
    """Values filtered wave by wave: a transform there and back."""
    spectrum = transforms.rfft2(values, **options) * factor
    return transforms.irfft2(spectrum, s=values.shape, **options)


def press(xp, pair, gap, stiffness):
    """Pressures (E* = 1) that close a gap where they press, and the steps taken."""
    compliance = 1 / stiffness
    compliance[0, 0] = 0
    pressure, direction, last, step = xp.maximum(-gap, 0) * Q0 / 2, xp.zeros_like(gap), 1.0, 0
    while step < STEPS:
        step += 1
        open_gap = gap + pair(pressure, compliance)
        wanted = xp.maximum(pressure - open_gap, 0)
        if float(xp.max(xp.abs(pressure - wanted))) <= TOLERANCE * float(xp.max(pressure)):
            break
        touching = pressure > 0
        residual = xp.where(touching, -open_gap, 0)
        z = xp.where(touching, pair(residual, stiffness), 0)
        rz = float(xp.sum(residual * z))
        direction = z + (rz / last) * xp.where(touching, direction, 0)
        length = float(xp.sum(residual * direction)) / float(xp.sum(direction * pair(direction, compliance)))
        pressure = xp.maximum(pressure + length * direction, 0)
        new = (pressure == 0) & (open_gap < 0)
        pressure = xp.where(new, -Q0 / 2 * open_gap, pressure)
        last = np.inf if bool(xp.any(new)) else rz  # new sites: the next direction is a fresh one
    return pressure, step


def timed(wait, repeats, work, *of):
    """What some work gives, and its least seconds."""
    found: Any = None
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        found = work(*of)
        wait()
        seconds.append(time.perf_counter() - start)
    return found, min(seconds)


def main():
    """Print a row for each grid and device."""
    print("pixels device pair_ms single_pair_ms load_s steps contact difference")
    devices = [("cpu", np, partial(pair, fft, {"workers": os.cpu_count()}), lambda: None, np.asarray)]
    if importlib.util.find_spec("cupy"):
        cupy, transforms = importlib.import_module("cupy"), importlib.import_module("cupyx.scipy.fft")
        wait = cupy.cuda.Device().synchronize
        devices.append(("gpu", cupy, partial(pair, transforms, {}), wait, cupy.asnumpy))
    for pixels in PIXELS:
        heights, waves = surface(pixels)
        known = None
        for name, xp, filtered, wait, back in devices:
            gap, stiffness = xp.asarray(heights) + DEPTH * RMS_NM, xp.asarray(waves)
            _, double_s = timed(wait, 3, filtered, gap, stiffness)
            _, single_s = timed(wait, 3, filtered, gap.astype(xp.float32), stiffness.astype(xp.float32))
            row = [pixels, name, f"{1e3 * double_s:.3g}", f"{1e3 * single_s:.3g}"]
            if name == "gpu" or pixels <= LARGEST_CPU:
                (pressure, steps), load_s = timed(wait, 1 + (name == "gpu"), press, xp, filtered, gap, stiffness)
                found = back(pressure)
                apart = np.nan if known is None else np.abs(found - known).max() / known.max()
                known = found
                row += [f"{load_s:.3g}", steps, f"{(found > 0).mean():.3f}", f"{apart:.1e}"]
            print(*row, flush=True)


if __name__ == "__main__":
    main()
