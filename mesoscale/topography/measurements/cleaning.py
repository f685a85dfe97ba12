"""An AFM scan and the explicit, recorded steps that make its heights ready for a spectrum."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from mesoscale.checks import MAX_LENGTH_NM, MIN_LENGTH_NM, check_number, checked_array
from mesoscale.errors import InputError
from mesoscale.settings import TopographySettings
from mesoscale.topography.measurements.missing import StandIn, without_stand_ins

FORM_TAKEN = "subtracted a quadratic fit, the form"
"""How the step begins that takes off a form by itself."""


LINES_CUT = "cut off the end of an aborted scan"
MARKED = "a mask marks"
STAND_INS = "took for missing"
MANY_SPIKES = "replaced many spikes"
"""How other steps begin of which the user should hear."""
MAX_MISSING = 0.05
"""Largest share of missing pixels that is filled from their neighbours."""
MANY = 1e-3
"""Share of spikes from which on the user should hear of them."""


@dataclass(frozen=True)
class Scan:
    """Heights measured on a regular grid.

    Attributes
    ----------
    heights_nm : (nx, ny); x (the first axis) is the fast scan direction, so `heights_nm[:, j]` is a
        scan line. Missing pixels are NaN.
    lengths_nm : (2,) physical size along x and y.
    name : what messages and results call the scan.
    steps : what has been done to the heights so far, in order, in words.
    """

    heights_nm: np.ndarray
    lengths_nm: tuple[float, float]
    name: str
    steps: tuple[str, ...] = field(default=())

    def __repr__(self) -> str:
        return "Scan {}: {} x {} points on {:.4g} x {:.4g} nm".format(
            self.name, *self.heights_nm.shape, *self.lengths_nm
        )

    def __post_init__(self):
        heights = checked_array(f"{self.name}: heights_nm", self.heights_nm, "nm", missing=True)
        if heights.ndim != 2:
            raise InputError(
                f"{self.name}: heights_nm has shape {heights.shape}; accepted is a map (nx, ny)"
            )
        for length in self.lengths_nm:
            check_number(f"{self.name}: lengths_nm", length, MIN_LENGTH_NM, MAX_LENGTH_NM, "nm")

    @property
    def pixel_nm(self) -> tuple[float, float]:
        """Distance of neighbouring pixels along x and y."""
        nx, ny = self.heights_nm.shape
        return self.lengths_nm[0] / nx, self.lengths_nm[1] / ny

    @property
    def length_nm(self) -> float:
        """The shorter side."""
        return min(self.lengths_nm)

    @property
    def rms_nm(self) -> float:
        """RMS height about the mean."""
        return float(np.nanstd(self.heights_nm))


def stand_in_steps(stand_ins: Sequence[StandIn], points: int) -> tuple[str, ...]:
    """In words: the numbers taken for missing points, and the share of `points` with them."""
    return tuple(
        f"{STAND_INS} {item.count / points:.2%} of the points ({item.count}), which lie "
        f"{'exactly at' if item.exact else 'far from all others, about'} {item.value_nm:.6g} nm"
        for item in stand_ins
    )


def without_missing(scan: Scan) -> Scan:
    """A scan whose missing points are NaN: numbers that stand for them are found and told."""
    heights, stand_ins = without_stand_ins(scan.heights_nm)
    if not stand_ins:
        return scan
    steps = stand_in_steps(stand_ins, heights.size)
    return replace(scan, heights_nm=heights, steps=(*scan.steps, *steps))


def measured_part(scan: Scan) -> Scan:
    """A scan without unmeasured lines: without a value, at one value, or a copy of the line before.

    At the ends, as an aborted scan has them, such lines are cut off, between others they are
    missing. A scan of nothing else stays as it is.

    Raises
    ------
    InputError : more lines between others than `MAX_MISSING` repeat the one before.
    """
    heights = scan.heights_nm
    repeats = (heights[:, 1:] == heights[:, :-1]).all(axis=0)
    same = np.append(False, repeats)
    empty = np.isnan(heights).all(axis=0)
    changing = np.ptp(heights, axis=0) != 0
    measured = np.flatnonzero(~same & ~empty & changing)
    lines = heights.shape[1]
    if len(measured) < 2 or len(measured) == lines:
        return scan
    first = measured[0]
    last = measured[-1] + 1
    copied = same & ~empty & changing
    repeated = float(np.mean(copied[first:last]))
    if repeated > MAX_MISSING:
        raise InputError(
            f"{scan.name}: {repeated:.0%} of the scan lines repeat the line before: the map was"
            " enlarged after it was measured; give it as it was measured"
        )
    lines_nm = np.array(heights[:, first:last], dtype=float)
    steps = scan.steps
    if last - first < lines:
        steps = (
            *steps,
            f"{LINES_CUT}: {lines - last + first} of {lines} scan lines, without measurement",
        )
    lost = np.setdiff1d(np.arange(first, last), measured) - first
    if len(lost):
        lines_nm[:, lost] = np.nan
        steps = (*steps, f"took {len(lost)} scan lines without measurement for missing")
    lengths_nm = scan.lengths_nm[0], scan.lengths_nm[1] * (last - first) / lines
    return replace(scan, heights_nm=lines_nm, lengths_nm=lengths_nm, steps=steps)


def clean(scan: Scan, settings: TopographySettings) -> Scan:
    """Level a scan, align its lines, remove spikes and fill missing pixels; every step is recorded.

    Raises
    ------
    InputError : more pixels are missing than `MAX_MISSING`, or the heights are cut off.
    """
    scan = measured_part(scan)
    heights = np.array(scan.heights_nm, dtype=float)
    steps = list(scan.steps)
    missing = ~np.isfinite(heights)
    share = float(missing.mean())
    if share > MAX_MISSING:
        raise InputError(
            f"{scan.name}: {share:.1%} of the pixels are missing; accepted are {MAX_MISSING:.0%};"
            " cut the scan to its largest rectangle without missing points (--crop; in a scene"
            " topography.instruments, crop: largest)"
        )
    if share > 0:
        heights[missing] = np.nan
    cut = cut_off_share(heights)
    if cut > 0.01:
        raise InputError(
            f"{scan.name}: {cut:.1%} of the pixels lie exactly at the highest or lowest height: the"
            " scan is cut off at the end of the scanner's range; measure again with a larger range"
        )
    heights, note = levelled(heights, settings)
    steps += note
    if settings.line_alignment == "median":
        heights -= _line_medians(heights)
        steps.append("subtracted the median of each scan line")
    if share > 0:
        heights = fill_missing(heights)
        steps.append(f"filled {int(missing.sum())} missing pixels from their neighbours")
    heights, spikes = without_spikes(heights)
    if spikes:
        words = "replaced spikes"
        if spikes > MANY * heights.size:
            words = MANY_SPIKES
        steps.append(
            f"{words} by the median of their neighbours: {spikes} of {heights.size} pixels"
        )
    heights -= heights.mean()
    return replace(scan, heights_nm=heights, steps=tuple(steps))


def alignment_effect(scan: Scan, settings: TopographySettings) -> tuple[float, float]:
    """Effect of aligning the lines of a raw scan: share of the RMS height taken, skewness added.

    Offsets between lines are the instrument's; where there are none, this is roughness that is
    lost. A line that crosses few grains has its median between them, so that aligning medians lifts
    grains or lowers them.
    """
    if settings.line_alignment == "none":
        return 0.0, 0.0
    scan = measured_part(scan)
    heights = np.where(np.isfinite(scan.heights_nm), scan.heights_nm, np.nan)
    heights, _ = levelled(heights, settings)
    aligned = heights - _line_medians(heights)
    before = float(np.nanstd(heights))
    after = float(np.nanstd(aligned))
    if min(before, after) == 0:
        return 0.0, 0.0
    skewness_before = _skewness(heights, before)
    return 1 - after / before, _skewness(aligned, after) - skewness_before


def _skewness(heights: np.ndarray, deviation: float) -> float:
    """Skewness of heights of a standard deviation; NaN are left out."""
    z = heights - np.nanmean(heights)
    return float(np.nanmean(z * z * z)) / deviation**3


def _line_medians(heights: np.ndarray) -> np.ndarray:
    """Median of each scan line of heights (nx, ny); NaN for empty lines, which are filled later."""
    if np.isfinite(heights).all():
        return np.median(np.ascontiguousarray(heights.T), axis=1)  # eight times as fast
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.nanmedian(heights, axis=0)


def levelled(
    heights: np.ndarray, settings: TopographySettings
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Heights (nx, ny) less tilt or form, and this step in words; NaN stay."""
    if settings.detrend == "none":
        return heights, ()
    if settings.detrend == "quadratic":
        return heights - fitted_trend(heights, order=2), ("subtracted a quadratic fit",)
    heights = heights - fitted_trend(heights, order=1)
    form = form_share(heights)
    # of 200 maps of C ~ q^-4.4 without a plateau none has 2, of 1000 of C ~ q^-4 neither
    if settings.detrend == "plane" or form < 2.0:
        return heights, ("subtracted a plane fit",)
    heights = heights - fitted_trend(heights, order=2)
    return heights, (form_step(form),)


def form_step(form: float) -> str:
    """The step that takes off a form, which is `form_share` of the heights."""
    return f"{FORM_TAKEN}, which has {-np.expm1(-form):.1%} of the mean square height"


def form_share(heights: np.ndarray) -> float:
    """ln of the mean square of levelled heights (nx, ny) over that less a parabola."""
    without_form = heights - fitted_trend(heights, order=2)
    before = float(np.nanvar(heights))
    after = float(np.nanvar(without_form))
    if after <= 0:
        return 0.0
    return float(np.log(before / after))


def cut_off_share(heights: np.ndarray) -> float:
    """Share of pixels at the very highest or lowest value; 0 where all heights are equal."""
    top = np.nanmax(heights)
    bottom = np.nanmin(heights)
    if top == bottom:
        return 0.0
    at_top = np.mean(heights == top)
    at_bottom = np.mean(heights == bottom)
    return float(max(at_top, at_bottom))


def fitted_trend(heights: np.ndarray, order: int) -> np.ndarray:
    """Least-squares plane (order 1) or quadratic (order 2) through heights (nx, ny) without NaN."""
    nx, ny = heights.shape
    powers = [(0, 0), (1, 0), (0, 1)]
    if order >= 2:
        powers += [(2, 0), (1, 1), (0, 2)]
    # all terms are products of powers of x and y
    degrees = range(2 * order + 1)
    x = np.linspace(-1, 1, nx)
    y = np.linspace(-1, 1, ny)
    x = np.stack([x**k for k in degrees])
    y = np.stack([y**k for k in degrees])
    known = np.isfinite(heights)
    weights = x @ known.astype(float) @ y.T
    sums = x @ np.where(known, heights, 0.0) @ y.T
    gram = np.array([[weights[i + k, j + m] for k, m in powers] for i, j in powers])
    right = np.array([sums[i, j] for i, j in powers])
    table = np.zeros((2 * order + 1, 2 * order + 1))
    fitted = np.linalg.lstsq(gram, right, rcond=None)
    table[tuple(np.transpose(powers))] = fitted[0]
    return x.T @ table @ y


def fill_missing(heights: np.ndarray) -> np.ndarray:
    """Fill NaN by linear interpolation along the scan line; empty lines become the mean."""
    filled = heights.copy()
    positions = np.arange(heights.shape[0])
    for j in np.flatnonzero(~np.isfinite(heights).all(axis=0)):
        known = np.isfinite(heights[:, j])
        if known.any():
            filled[:, j] = np.interp(positions, positions[known], heights[known, j])
    return np.where(np.isfinite(filled), filled, np.nanmean(filled))


def without_spikes(heights: np.ndarray) -> tuple[np.ndarray, int]:
    """Replace pixels far from the median of their 3 x 3 neighbourhood; heights and their number."""
    from scipy.ndimage import median_filter

    local = median_filter(heights.astype(np.float32), size=3, mode="nearest")
    away = np.abs(heights - local)
    # the scale is taken far out in the distribution: tips leave smooth scans with many sharp
    # creases, which a median absolute deviation would call spikes. Where one pixel in a hundred is
    # a spike, so is the far quantile: it is 1 to 2 times the near one on measured maps, 17 times on
    # a map of nothing but creases
    near, far = np.quantile(away[::2, ::2], (0.9, 0.99))
    scale = float(min(far / 2.576, 5.0 * near / 1.645))
    if scale == 0:
        return heights, 0
    spikes = away > 12.0 * scale  # robust standard deviations
    return np.where(spikes, local, heights), int(spikes.sum())
