"""Maps that were smoothed, filtered or interpolated: how they betray it, and what they show.

Three signs, each of which measured maps lack (evidence: `python -m evidence topography.treated`):

- *fall*: means, Gaussians and low passes let a spectrum fall faster than any roughness does. A tip
  leaves creases, of
  C ~ q^-5, and pixels fold short waves back, which makes a spectrum flatter.
- *repeats*: medians and repeated pixels leave neighbours of exactly the same height.
- *rhythm*: between points that were measured, an interpolated map is smoother than at them, with
  one period.

What a filter passes is taken as G = exp(-(q / q_f)^p): the spectrum that was smoothed is C / G, as
far as G is known.
"""

from dataclasses import dataclass, replace

import numpy as np

from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.spectrum import Spectrum

PASSED = 0.15
"""Share of C that a filter passes at the end of what is trusted. Up to there G is known to 30 %, on
made maps.
"""
STEEPEST = -8.5
OVER = 1.3
"""d ln C / d ln q, over this ratio of wave vectors, that no measured map has."""
FIRST_SHELL, SHELLS = 4.0, 4.0  # the first, and how many apart at least: single ones scatter
# of means, and of the Nyquist wave vector, where waves that a computer made may end
WIDTH, LAST = (0.12, 0.95)
# from a Gaussian to a wall
POWERS = (2.0, 2.5, 3.0, 4.0, 6.0, 10.0, 20.0, 40.0)
WALL = 6.0
NEAR = 2.5  # times below its end a fall is compared with a straight one: a knee lies further away
CREASED = 5.0  # -d ln C / d ln q of creases: a filter leaves less, all the way to the end
SLOPES = (1.5, CREASED)  # of -d ln C / d ln q of roughness
# of fourth differences over second ones: measured maps have 1.1 or more, Gaussians less than 0.5
LEFT = 0.9
EQUAL = 0.02  # share of neighbours of equal height; medians leave 0.04 to 0.13
MANY_LEVELS = 10.0  # steps of a digit that neighbours must differ by: else equal heights are chance
MEDIAN_FALL = 4.1  # q_f times the side of a median's window, on made maps
MOST_REPEATS = 25  # pixels
RHYTHM, RHYTHM_ALONE = 25.0, 400.0
"""Power of a period over that of others, along both axes or along one; 17 and 35 on 100 made maps
without.
"""
# of bends, and of roughness (`LEFT`): maps enlarged twofold or more have less
STRAIGHT, TWOFOLD_LEFT = (0.43, 0.6)
LONGEST_PERIOD = 12.0  # pixels
# of the roughness of pixels by that period; the smoothest interpolation leaves 0.2
MODULATION = 0.15
# of what all lines have in common over what differs, from which on a surface has a pattern
PATTERN = 3.0
DRIFTS = 3  # periods over a map, below which roughness merely differs from place to place
# of the Nyquist wave vector of the points measured, where a linear interpolation passes 0.66 of C
LINEAR = 0.5


@dataclass(frozen=True)
class Treatment:
    """What was done to a map.

    Attributes
    ----------
    kind : `smoothed`, `median` (or repeated pixels) or `interpolated`.
    end : largest trusted wave vector, 1/nm.
    fall_q, power : q_f (1/nm) and p of what the filter passes; infinite where that is not told.
    """

    kind: str
    end: float
    fall_q: float = np.inf
    power: float = 2.0

    def passed(self, q: np.ndarray) -> np.ndarray:
        """Share of C that is left at wave vectors q (1/nm)."""
        return np.exp(-np.minimum((q / self.fall_q) ** self.power, 700.0))


def treatment_of(raw: Scan, cleaned: Scan, spectrum: Spectrum) -> Treatment | None:
    """What was done to a map before it was read; None where nothing shows.

    Parameters
    ----------
    raw, cleaned : as loaded, and levelled.
    spectrum : of `cleaned`.
    """
    step_nm = max(cleaned.pixel_nm)
    signs = []
    if _is_smooth(cleaned.heights_nm):
        signs.append(_fall(spectrum))
    if size := repeated_pixels(raw.heights_nm):
        q_f = MEDIAN_FALL / (size * step_nm)
        signs.append(Treatment("median", q_f * np.log(1 / PASSED) ** 0.5, q_f))
    if period := rhythm(cleaned.heights_nm):
        signs.append(Treatment("interpolated", LINEAR * np.pi / (period * step_nm)))
    return min(filter(None, signs), key=lambda item: item.end, default=None)


def _is_smooth(heights: np.ndarray) -> bool:
    """Are most pixels smoother than their neighbourhood? A measured map is rough."""
    return min(_roughness_left(heights), _roughness_left(heights.T)) < LEFT


def _roughness_left(heights: np.ndarray) -> float:
    """Median fourth over median second difference along the first axis, tall points left out."""
    second = heights[1:-1] - (heights[:-2] + heights[2:]) / 2
    fourth = second[1:-1] - (second[:-2] + second[2:]) / 2
    tall = np.abs(heights - np.median(heights))
    usual = (tall < 4 * np.median(tall))[2:-2]
    second = second[1:-1][usual]
    fourth = fourth[usual]
    middle = float(np.median(np.abs(second - np.median(second))))
    if middle <= 0:
        return np.inf
    return float(np.median(np.abs(fourth - np.median(fourth)))) / middle


def restored(spectrum: Spectrum, treated: Treatment, rms_nm: float) -> tuple[Spectrum, float]:
    """Spectrum and RMS height (nm) of a map before a filter, as far as what it passed is known."""
    raised = np.maximum(treated.passed(spectrum.q), PASSED)
    psd = spectrum.psd / raised
    seen = spectrum.q <= treated.end
    taken = np.where(seen, psd - spectrum.psd, 0.0)
    added = float(np.trapezoid(2 * np.pi * spectrum.q * taken, spectrum.q))
    return replace(spectrum, psd=psd), float(np.sqrt(rms_nm**2 + added))


def _fall(spectrum: Spectrum) -> Treatment | None:
    """A filter by the fall of a spectrum."""
    q = spectrum.q
    log_psd = np.log(spectrum.psd)
    last = LAST * spectrum.nyquist / (1 + WIDTH) / OVER
    starts = np.geomspace(
        FIRST_SHELL * spectrum.spacing, max(last, FIRST_SHELL * spectrum.spacing), 100
    )
    if starts[-1] < 2 * starts[0]:
        return None
    centres = starts * np.maximum(OVER, 1 + SHELLS * spectrum.spacing / starts)
    low = _mean_about(q, log_psd, starts)
    high = _mean_about(q, log_psd, centres)
    slopes = (high - low) / np.log(centres / starts)
    falls = slopes < STEEPEST
    if not falls.any():
        return None
    first = int(np.argmax(falls))
    goes_on = [*(slopes[first:] < -CREASED), False]  # up to the first side lobe
    steepest = first + int(np.argmin(slopes[first : first + int(np.argmin(goes_on))]))
    start = float(starts[first])
    end = float(centres[steepest])
    behind = (q > end) & (q < LAST * spectrum.nyquist)
    level = log_psd[behind] + CREASED * np.log(q[behind] / start)
    # the fall behind the peak of a pattern
    if len(level) and np.mean(level) > low[first] - 0.5:
        return None
    return _fitted_filter(spectrum, end)


def _fitted_filter(spectrum: Spectrum, end: float) -> Treatment | None:
    """The filter of a spectrum that falls up to `end`; beyond are side lobes, or digits."""
    points = np.geomspace(max(2.5 * spectrum.spacing, end / 8), end, 60)
    log_psd = np.log(spectrum.psd)
    level = np.interp(np.log(points), np.log(spectrum.q), log_psd)
    if not _steepens(points / end, level):
        return None
    fits = [_fitted(points / end, level, power) for power in POWERS]
    _, strength, power = min(fits, key=lambda item: item[0])
    if strength <= 0:
        return None
    fall_q = end * strength ** (-1 / power)
    trusted = fall_q * np.log(1 / PASSED) ** (1 / power)
    if power >= WALL:  # nothing is taken before it, and nothing is left beyond
        trusted = fall_q * np.log(2) ** (1 / power)
        fall_q = np.inf
    if trusted >= spectrum.nyquist:
        return None
    return Treatment("smoothed", trusted, fall_q, power)


def _steepens(u: np.ndarray, level: np.ndarray) -> bool:
    """Does a spectrum bend down in its fall, so that no straight line does as well as a filter?"""
    near = u > 1 / NEAR
    log_u = np.log(u[near])
    level = level[near]
    straight = level - np.polyval(np.polyfit(log_u, level, 1), log_u)
    bent = min(_fitted(u[near], level, power)[0] for power in POWERS)
    return bool(bent < 0.5 * (straight @ straight))


def _mean_about(q: np.ndarray, values: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """Means of values over `WIDTH` to each side of centres, at least over the nearest shells."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    first = np.minimum(np.searchsorted(q, centres * (1 - WIDTH)), len(q) - 2)
    last = np.maximum(np.searchsorted(q, centres * (1 + WIDTH), side="right"), first + 2)
    last = np.minimum(last, len(q))
    return (total[last] - total[first]) / (last - first)


def _fitted(u: np.ndarray, level: np.ndarray, power: float) -> tuple[float, float, float]:
    """Squared misfit, strength, power of ln C = a - s ln u - strength u^power."""
    log_u = np.log(u)
    fall = u**power
    system = np.stack([np.ones_like(u), -log_u, -fall], axis=1)
    level_at_end, slope, strength = np.linalg.lstsq(system, level, rcond=None)[0]
    if not SLOPES[0] <= slope <= SLOPES[1]:
        slope = float(np.clip(slope, *SLOPES))
        straight = level + slope * log_u
        fitted = np.linalg.lstsq(system[:, ::2], straight, rcond=None)
        level_at_end, strength = fitted[0]
    misfit = level - system @ (level_at_end, slope, strength)
    return float(misfit @ misfit), float(strength), power


def repeated_pixels(heights: np.ndarray) -> int:
    """Side (pixels) of a median's window, or of repeated pixels; 0 where neighbours differ."""
    values, counts = np.unique(heights[np.isfinite(heights)], return_counts=True)
    if len(values) < 1000:
        return 0
    # a plateau at the end of a range is none
    differing = np.where(heights == values[np.argmax(counts)], np.nan, heights)
    return min(_repeats(differing), _repeats(differing.T))


def _repeats(heights: np.ndarray) -> int:
    """Pixels along the first axis over which a height repeats; 0 where digits explain it."""
    away = np.abs(np.diff(heights, axis=0))
    away = away[np.isfinite(away)]
    if len(away) == 0 or not away.any():
        return 0
    digit = away[away > 0].min()
    one_apart = np.mean((away > 0) & (away < 1.5 * digit))
    coarse = np.sqrt(np.mean(away**2)) < MANY_LEVELS * digit
    if coarse or np.mean(away == 0) < EQUAL + 2 * one_apart:
        return 0
    size = 2
    while size < min(MOST_REPEATS, len(heights) - 1):
        further = np.mean(heights[size:] == heights[:-size])
        if further < 1e-3 + one_apart:
            break
        size += 1
    return size


def rhythm(heights: np.ndarray) -> float:
    """Distance (pixels) of points between which heights were interpolated; 0 for none."""
    periods = [_period(heights), _period(heights.T)]
    powers = [power for power, _ in periods]
    frequencies = [frequency for _, frequency in periods]
    same = abs(frequencies[0] - frequencies[1]) < 1.5 / min(heights.shape)
    if same and min(powers) > RHYTHM:
        frequency = min(frequencies)
    elif max(powers) > RHYTHM_ALONE:
        frequency = frequencies[int(np.argmax(powers))]
    else:
        return 0.0
    # points further apart than two pixels have the same period as others that are nearer
    if _is_enlarged_twofold(heights):
        return 1 / frequency
    return 1 / (1 - frequency)


def _is_enlarged_twofold(heights: np.ndarray) -> bool:
    """Are interpolated heights smooth at most pixels, or straight?"""
    bends = heights[1:-1] - (heights[:-2] + heights[2:]) / 2
    bends = bends - np.median(bends, axis=1)[:, None]
    straight = np.median(np.abs(bends)) < STRAIGHT * bends.std()
    return bool(
        straight or min(_roughness_left(heights), _roughness_left(heights.T)) < TWOFOLD_LEFT
    )


def _period(heights: np.ndarray) -> tuple[float, float]:
    """Relative power and frequency (1/pixel) of the rhythm of roughness along the first axis."""
    bends = heights[1:-1] - (heights[:-2] + heights[2:]) / 2
    common = np.mean(bends, axis=1)
    roughness = np.var(bends, axis=1)
    if roughness.sum() == 0 or np.sum(common**2) > PATTERN * roughness.sum():
        return 0.0, 0.0
    count = len(roughness)
    relative = roughness / roughness.mean() - 1
    wave = np.abs(np.fft.rfft(relative * np.hanning(count))) ** 2
    frequency = np.arange(len(wave)) / count
    short = frequency > 1 / LONGEST_PERIOD
    first = int(np.argmax(np.where(short, wave, 0.0)))
    drifts = wave[DRIFTS:][~short[DRIFTS:]]
    if drifts.max(initial=0.0) > 0.1 * wave[first]:  # a pattern, and a harmonic of it
        return 0.0, 0.0
    below = wave[max(first - 8, 0) : max(first - 3, 0)]
    above = wave[first + 4 : first + 9]
    near = np.r_[below, above]
    usual = max(float(np.median(wave[short])), float(np.median(near)))
    modulation = 4 * float(np.sqrt(wave[first])) / count  # a Hann window halves a wave
    if usual == 0 or modulation < MODULATION:
        return 0.0, 0.0
    return float(wave[first]) / usual, float(frequency[first])
