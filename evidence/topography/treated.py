"""Are maps found that a program smoothed or interpolated, and numbers that stand for missing
points, and no others?

Honest maps are of twelve kinds: slopes of 2.2 to 5, with grains, steps of 8 bits, blunt tips,
pixels that average, offsets of 1/f noise, a slow feedback, and surfaces stretched up to fivefold.
Treated ones begin as one of these. Of a filter that is found, `restored` is C at the end of what is
trusted, over C of the map before; `trusted` is that end over the Nyquist wave vector. Of missing
points, `restored` is the RMS height over that of the whole map.

Gaussians below 0.8 pixels change less than pixels do. `points` are numbers that stand for missing
points: spread, in patches or along lines. `dust` are honest maps with particles, pits and plateaus.
"""

import argparse
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from scipy import ndimage, signal

from evidence.record import load
from mesoscale.settings import TopographySettings
from mesoscale.topography.description.treatment import restored, treatment_of
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.measurements.missing import without_stand_ins
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.spectrum import hann_spectrum
from mesoscale.topography.synthetic_scans import dilate, surface_patch

Array = np.ndarray
Rng = np.random.Generator
SETTINGS = TopographySettings()
SIDES = (96, 128, 200, 256, 384)  # pixels
FACTORS = (1.5, 2.0, 3.0, 4.0)  # of enlarged maps
STAND_INS = (-9999.0, 9999.0, -32768.0, 0.0, 1e10, 3.4e38)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Sets."""
    parser.add_argument("--sets", type=int, default=20, help="maps of each honest kind; 0.1 s each")
    parser.add_argument("--treated", type=int, default=100, help="maps of each treatment")


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """One row for each map that the table does not have."""
    present = {
        (row["kind"], row["treatment"], int(row["set"])) for row in load("topography.treated")
    }
    kinds = list(HONEST)
    asked = [
        (kind, treatment, number)
        for kind in kinds
        for treatment in UNTREATED
        for number in range(given.sets)
    ]
    asked += [
        (kinds[k % len(kinds)], treatment, k)
        for treatment in TREATMENTS
        for k in range(given.treated)
    ]
    asked += [(kinds[k % len(kinds)], "points", k) for k in range(given.treated)]
    for case in asked:
        if case not in present:
            yield row_of(*case)


def row_of(kind: str, treatment: str, number: int) -> dict[str, Any]:
    """What is found on one map."""
    index = [*UNTREATED, *TREATMENTS, "points"].index(treatment)
    rng = np.random.default_rng([78, list(HONEST).index(kind), index, number])
    honest, length_nm = made(kind, rng)
    row: dict[str, Any] = {
        "kind": kind,
        "treatment": treatment,
        "set": number,
        "strength": "",
        "found": "",
    }
    row |= {"trusted": "", "restored": "", "missing": ""}
    if treatment == "points":
        return row | _found_points(honest, rng)
    heights, strength = honest, ""
    if treatment in TREATMENTS:
        heights, strength = TREATMENTS[treatment](honest, rng)
    elif treatment == "dust":
        heights = dusty(honest, rng)
    row["strength"] = strength
    row["missing"] = sum(item.count for item in without_stand_ins(heights)[1])
    scan = Scan(heights, (length_nm, length_nm), "map")
    cleaned = clean(scan, SETTINGS)
    spectrum = hann_spectrum(cleaned)
    treated = treatment_of(scan, cleaned, spectrum)
    if treated is None:
        return row
    row |= {"found": treated.kind, "trusted": float(treated.end / spectrum.nyquist)}
    # of these the map before has another size
    if treatment in TREATMENTS and treatment not in ("linear", "spline"):
        before = hann_spectrum(clean(Scan(honest, (length_nm, length_nm), "before"), SETTINGS))
        after, _ = restored(spectrum, treated, cleaned.rms_nm)
        near = [np.abs(item.q / treated.end - 0.95) < 0.06 for item in (after, before)]
        if near[0].any() and near[1].any():
            row["restored"] = float(after.psd[near[0]].mean() / before.psd[near[1]].mean())
    return row


def _found_points(honest: Array, rng: Rng) -> dict[str, Any]:
    """Numbers that stand for missing points: how many pixels differ from the true ones, and the RMS
    height left.
    """
    lost = lost_points(honest.shape, rng)
    value = float(rng.choice(STAND_INS))
    # 0 stands for missing far from the surface only
    heights = honest + 4 * np.ptp(honest) if value == 0.0 else honest
    found, numbers = without_stand_ins(np.where(lost, value, heights))
    side = float(len(honest))
    rms = [clean(Scan(item, (side, side), "map"), SETTINGS).rms_nm for item in (found, honest)]
    right = bool(np.array_equal(np.isnan(found), lost))
    known = {
        "found": "missing" if right else "other",
        "missing": sum(item.count for item in numbers),
    }
    return known | {"strength": value, "restored": float(rms[0] / rms[1])}


def lost_points(shape: tuple[int, ...], rng: Rng) -> Array:
    """Places without measurement: spread, in patches, or across lines."""
    lost = np.zeros(shape, dtype=bool)
    form = rng.integers(3)
    if form == 0:
        return rng.random(shape) < rng.uniform(0.002, 0.03)
    for _ in range(int(rng.integers(2, 5))):  # at most 5 % of the smallest map
        x, y = (int(rng.integers(0, side - 6)) for side in shape)
        if form == 1:
            lost[x : x + 5, y : y + 5] = True
        else:
            lost[x, :] = True
    return lost


def made(kind: str, rng: Rng) -> tuple[Array, float]:
    """Heights (n, n) in nm of an honest map, and its side."""
    pixels, length = int(rng.choice(SIDES)), float(np.exp(rng.uniform(np.log(200), np.log(20_000))))
    slope = float(rng.uniform(4.2, 5.0)) if kind == "steep" else float(rng.uniform(2.2, 4.6))
    knee = 2 * np.pi / length * float(np.exp(rng.uniform(np.log(0.5), np.log(20))))
    rms = length * float(np.exp(rng.uniform(np.log(5e-4), np.log(1e-2))))
    truth = RoughSpectrum.from_rms(
        rms, knee, slope, np.pi * pixels / length * float(rng.uniform(1.5, 4))
    )
    heights = HONEST[kind](truth, pixels, length, rng)
    if kind != "noiseless":
        noise = heights.std() * float(np.exp(rng.uniform(np.log(1e-4), np.log(0.05))))
        heights = heights + noise * rng.standard_normal(heights.shape)
    digits = {"steps": rng.integers(2000, 60_000), "eight_bit": 255}.get(kind)
    if digits:
        step = np.ptp(heights) / digits
        heights = np.round(heights / step) * step
    tilt = np.linspace(0, length * np.tan(np.radians(rng.uniform(-1, 1))), pixels)
    return heights + tilt[:, None], length


def _stretched(truth: RoughSpectrum, pixels: int, length: float, rng: Rng) -> Array:
    factor = float(rng.uniform(1.5, 5))
    larger = surface_patch(truth, int(pixels * factor) + 2, length * factor, rng)
    return larger[:pixels, (np.arange(pixels) * factor).astype(int)]


def _grainy(truth: RoughSpectrum, pixels: int, length: float, rng: Rng) -> Array:
    return truth.rms_nm * np.exp(
        rng.uniform(0.2, 0.5) * surface_patch(truth, pixels, length, rng) / truth.rms_nm
    )


def _with_tip(blunt: float) -> Callable[[RoughSpectrum, int, float, Rng], Array]:
    def seen(truth: RoughSpectrum, pixels: int, length: float, rng: Rng) -> Array:
        heights, step = surface_patch(truth, pixels, length, rng), length / pixels
        curvature = np.std(np.diff(heights, 2, axis=0)) / step**2
        return dilate(
            heights, float(np.exp(rng.uniform(np.log(0.3), np.log(blunt))) / curvature), step
        )

    return seen


def _averaged(truth: RoughSpectrum, pixels: int, length: float, rng: Rng) -> Array:
    return (
        surface_patch(truth, 2 * pixels, length, rng)
        .reshape(pixels, 2, pixels, 2)
        .mean(axis=(1, 3))
    )


def _drifting(truth: RoughSpectrum, pixels: int, length: float, rng: Rng) -> Array:
    """1/f noise in the time of a scan."""
    heights = surface_patch(truth, pixels, length, rng)
    frequency = np.fft.rfftfreq(heights.size)[1:]
    waves = (
        rng.standard_normal(len(frequency)) + 1j * rng.standard_normal(len(frequency))
    ) / np.sqrt(frequency)
    noise = np.fft.irfft(np.concatenate([[0.0], waves]), heights.size).reshape(heights.shape).T
    return heights + rng.uniform(0.02, 0.3) * heights.std() / noise.std() * noise


def _lagging(truth: RoughSpectrum, pixels: int, length: float, rng: Rng) -> Array:
    """A feedback that follows within 0.3 to 1.5 pixels."""
    heights, kept = surface_patch(truth, pixels, length, rng), np.exp(-1 / rng.uniform(0.3, 1.5))
    return np.asarray(
        signal.lfilter([1 - kept], [1, -kept], heights, axis=0, zi=heights[:1] * kept)[0]
    )


HONEST: dict[str, Callable[[RoughSpectrum, int, float, Rng], Array]] = {
    **dict.fromkeys(("plain", "steep", "noiseless", "steps", "eight_bit"), surface_patch),
    "stretched": _stretched,
    "grainy": _grainy,
    "tip": _with_tip(3.0),
    "blunt": _with_tip(30.0),
    "averaged": _averaged,
    "drifting": _drifting,
    "lagging": _lagging,
}


def dusty(heights: Array, rng: Rng) -> Array:
    """A map with particles, pits, a plateau where the highest are worn, or dust."""
    count, scale = len(heights), heights.std()
    x = np.arange(count)
    form = rng.integers(4)
    if form == 0:
        return np.asarray(np.minimum(heights, np.quantile(heights, 0.995)))
    changed = heights.copy()
    for _ in range(int(rng.integers(1, 30))):
        centre, wide = rng.uniform(0, count, 2), float(rng.uniform(2.0, 6.0))
        bump = np.exp(
            -((x[:, None] - centre[0]) ** 2 + (x[None, :] - centre[1]) ** 2) / (2 * wide**2)
        )
        changed += (-1 if form == 1 else 1) * float(rng.uniform(5, 40)) * scale * bump
    return changed


def _lowpass(heights: Array, rng: Rng) -> tuple[Array, float]:
    share = float(rng.uniform(0.15, 0.6))
    ramp = np.linspace(0, 1, len(heights))[:, None] * np.ones_like(heights)
    system = np.stack([np.ones(heights.size), ramp.ravel()], axis=1)
    tilt = (system @ np.linalg.lstsq(system, heights.ravel(), rcond=None)[0]).reshape(heights.shape)
    q = [2 * np.abs(np.fft.fftfreq(side)) for side in heights.shape]
    kept = np.hypot(q[0][:, None], q[1][None, :]) < share
    return tilt + np.real(np.fft.ifft2(np.fft.fft2(heights - tilt) * kept)), share


def _enlarged(order: int) -> Callable[[Array, Rng], tuple[Array, float]]:
    def enlarge(heights: Array, rng: Rng) -> tuple[Array, float]:
        factor = float(rng.choice(FACTORS))
        part = int(len(heights) / factor)
        larger = ndimage.zoom(heights[:part, :part], factor, order=order, mode="nearest")
        return np.asarray(larger), factor

    return enlarge


def _gaussian(low: float, high: float) -> Callable[[Array, Rng], tuple[Array, float]]:
    def smooth(heights: Array, rng: Rng) -> tuple[Array, float]:
        sigma = float(rng.uniform(low, high))
        return np.asarray(ndimage.gaussian_filter(heights, sigma)), sigma

    return smooth


def _mean(heights: Array, rng: Rng) -> tuple[Array, float]:
    size = int(rng.choice([3, 5, 7, 9]))
    return np.asarray(ndimage.uniform_filter(heights, size)), float(size)


def _median(heights: Array, rng: Rng) -> tuple[Array, float]:
    size = int(rng.choice([3, 5, 7, 9]))
    return np.asarray(ndimage.median_filter(heights, size)), float(size)


UNTREATED = ("", "dust")
TREATMENTS: dict[str, Callable[[Array, Rng], tuple[Array, float]]] = {
    "gaussian": _gaussian(1.0, 5.0),
    "weak_gaussian": _gaussian(0.6, 1.0),
    "mean": _mean,
    "median": _median,
    "lowpass": _lowpass,
    "linear": _enlarged(1),
    "spline": _enlarged(3),
}


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Shares found and false alarms, and middle and 90 % range of what is restored."""
    found: dict[str, str] = {}
    for treatment in (*UNTREATED, *TREATMENTS, "points"):
        mine = [row for row in rows if row["treatment"] == treatment]
        if not mine:
            continue
        name = treatment or "honest"
        found[f"{name}_maps"] = str(len(mine))
        if treatment == "points":
            found["points_right"] = f"{np.mean([row['found'] == 'missing' for row in mine]):.1%}"
        else:
            found[f"{name}_found"] = f"{np.mean([bool(row['found']) for row in mine]):.1%}"
            found[f"{name}_missing"] = f"{np.mean([row['missing'] != '0' for row in mine]):.1%}"
        if known := [float(row["restored"]) for row in mine if row["restored"]]:
            low, middle, high = np.quantile(known, (0.05, 0.5, 0.95))
            found[f"{name}_restored"] = f"{middle:.2f} ({low:.2f} to {high:.2f})"
    return found
