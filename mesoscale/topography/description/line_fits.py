"""The paper's line fits for q0, q1, slope and their bounds (section 4.2), made precise.

The paper fits straight lines of log C against log q by least squares: from the lowest wave vector
up to a variable q to find where the plateau ends (q0), and from q0 up to a variable q to find where
the power law ends (q1).  Made precise here:

- all points are means over bins of equal width in log q, one per scan and bin, inside the trusted
  range;
- the plateau *ends* at the last bin for which the slope of [q_L, q] is not significantly negative
  (one-sided
  t test at 1 %, for this bin and every later one); this literal reading lies above the knee,
  because the line needs some points of the slope to notice it, so that
- *q0* is where the plateau's mean level and the power law's line meet;
- *q1* is the largest q for which the slope of [q0, q] differs from its median by no more than its
  own
  standard error times the same threshold, or by 0.05.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mesoscale.topography.description.trusted_range import TrustedSpectrum, blur

MOST_ROUNDS = 20  # of the search for the knee, which settles in a few or swings


@dataclass(frozen=True)
class Points:
    """One mean of log C per scan and bin: ln q, ln C, scan number, bin number (ascending in q)."""

    log_q: np.ndarray
    log_c: np.ndarray
    scan: np.ndarray
    bin: np.ndarray


@dataclass(frozen=True)
class LineFit:
    """Result of the line fits.

    Attributes
    ----------
    plateau, q0, slope : level (nm^4), knee (1/nm) and fall of the pooled spectrum.
    q1 : end of the constant slope, 1/nm; `q1_limited` when that is merely the end of the trusted
        range.
    slope_low, slope_high : slopes of the lines through the knee that bound the scans' points.
    plateau_low, plateau_high : lowest and highest level of a scan, nm^4.
    settled : the search for the knee ended; else it swings between two places.
    """

    plateau: float
    q0: float
    slope: float
    q1: float
    q1_limited: bool
    slope_low: float
    slope_high: float
    plateau_low: float
    plateau_high: float
    settled: bool = True


def points(spectra: Sequence[TrustedSpectrum], q0: float = np.inf, slope: float = 0.0) -> Points:
    """Mean ln C of each scan on common bins of ln q, inside each scan's trusted range.

    Once knee and slope are known roughly, the window's blur beyond `q0` is taken out.
    """
    rows = [np.empty((4, 0))]
    for number, item in enumerate(spectra):
        q = item.spectrum.q[item.trusted]
        modes = item.spectrum.modes[item.trusted]
        log_c = np.log(item.corrected_psd()[item.trusted])
        log_c = log_c - np.where(q > q0, blur(slope, q / item.spectrum.spacing), 0)
        bins, index = np.unique(np.floor(12 * np.log10(q)), return_inverse=True)  # 12 a decade
        worth = np.bincount(index, modes)
        log_q = np.bincount(index, modes * np.log(q)) / worth
        log_c = np.bincount(index, modes * log_c) / worth
        # the mean of ln C lies below ln of the mean by about 1/(2 n)
        log_c = log_c + 0.5 / np.maximum(worth, 1.0)
        rows.append(np.stack([log_q, log_c, np.full(len(bins), number), bins]))
    table = np.concatenate(rows, axis=1)
    table = table[:, np.lexsort((table[2], table[3]))]
    log_q, log_c, scan, bins = table
    return Points(log_q, log_c, scan.astype(int), bins.astype(int))


def pooled(data: Points) -> tuple[np.ndarray, np.ndarray]:
    """Mean over scans in each bin: ln q and ln C, with the differing levels of the scans taken out.

    Scans of different places differ in level; a bin that only some of them reach would step. Levels
    are estimated together with the bins' means (two-way least squares).
    """
    bins, index = np.unique(data.bin, return_inverse=True)
    scans, member = np.unique(data.scan, return_inverse=True)
    equations = np.zeros((len(data.log_c) + 1, len(bins) + len(scans)))
    rows = np.arange(len(data.log_c))
    equations[rows, index] = 1
    equations[rows, len(bins) + member] = 1
    # levels sum to zero: the pooled spectrum is that of the typical place
    equations[-1, len(bins) :] = 1
    right = np.append(data.log_c, 0.0)
    solution = np.linalg.lstsq(equations, right, rcond=None)[0]
    count = np.bincount(index)
    return np.bincount(index, data.log_q) / count, solution[: len(bins)]


def line(x: np.ndarray, y: np.ndarray) -> tuple[float, float, float]:
    """Least-squares line: intercept at x = 0, slope, standard error of the slope."""
    centre = x - x.mean()
    spread = float(centre @ centre)
    slope = float(centre @ y) / spread
    residual = y - y.mean() - slope * centre
    error = float(np.sqrt(residual @ residual / max(len(x) - 2, 1) / spread))
    return float(y.mean() - slope * x.mean()), slope, error


def fit_lines(spectra: Sequence[TrustedSpectrum]) -> LineFit | None:
    """The paper's procedure on the trusted spectra; None without a plateau or a power law."""
    rough = _fit_points(points(spectra))
    if rough is None:
        return None
    return _fit_points(points(spectra, rough.q0, rough.slope))


def _fit_points(data: Points) -> LineFit | None:
    """Plateau, knee, power law and their bounds from the scans' points."""
    if len(np.unique(data.bin)) < 8:
        return None
    x, y = pooled(data)
    end = plateau_end(x, y)
    if end is None:
        return None
    knee = _knee(x, y, end)
    if knee is None:
        return None
    log_q0, level, settled = knee
    first = int(np.searchsorted(x, log_q0 + 0.15))
    last_bins = range(first + 4, len(x) + 1)
    fits = np.array([line(x[first:last], y[first:last]) for last in last_bins])
    if not len(fits):
        return None
    reference = float(np.median(fits[len(fits) // 3 :, 1]))
    allowed = np.maximum(0.05, _threshold(len(x) - first) * fits[:, 2])
    last = int(np.flatnonzero(np.abs(fits[:, 1] - reference) <= allowed).max())
    intercept = fits[last, 0]
    slope = -float(fits[last, 1])
    log_q0 = (intercept - level) / slope
    shape = -slope * np.maximum(data.log_q - log_q0, 0)
    scan_levels = data.log_c - shape
    levels = [np.mean(scan_levels[data.scan == scan]) for scan in np.unique(data.scan)]
    falling = data.log_q > log_q0 + np.log(2)
    if not falling.any():
        return None
    slopes = (level - data.log_c[falling]) / (data.log_q[falling] - log_q0)
    return LineFit(
        plateau=float(np.exp(level)),
        q0=float(np.exp(log_q0)),
        slope=slope,
        q1=float(np.exp(x[first + 3 + last])),
        q1_limited=last == len(fits) - 1,
        slope_low=float(slopes.min()),
        slope_high=float(slopes.max()),
        plateau_low=float(np.exp(min(levels))),
        plateau_high=float(np.exp(max(levels))),
        settled=settled,
    )


def plateau_end(x: np.ndarray, y: np.ndarray) -> int | None:
    """Index of the last bin up to which the slope of y(x) is not significantly negative."""
    lengths = range(3, len(x) + 1)
    fits = np.array([line(x[:length], y[:length]) for length in lengths])
    thresholds = np.array([_threshold(k) for k in range(1, len(x) - 1)])
    slopes = fits[:, 1]
    errors = fits[:, 2]
    flat = np.flatnonzero((slopes >= -thresholds * errors) | (slopes >= -0.1))
    if len(flat) == 0 or flat[-1] == len(fits) - 1:  # flat all the way: no power law
        return None
    return int(flat[-1]) + 2


def _threshold(freedom: int) -> float:
    """Of Student's distribution at 1 %, one-sided."""
    from scipy.special import stdtrit

    return float(stdtrit(max(freedom, 1), 0.99))


def _knee(x: np.ndarray, y: np.ndarray, end: int) -> tuple[float, float, bool] | None:
    """Meeting point of plateau and power law: ln q0, the plateau's level, and whether it settled.

    The bins of both lines depend on the knee, so that it may swing between two places.
    """
    log_q0 = float(x[end]) - 0.2
    level = 0.0
    settled = False
    for _ in range(MOST_ROUNDS):
        flat = x < log_q0 - 0.1
        fall = x > log_q0 + 0.15
        if flat.sum() < 2 or fall.sum() < 4:
            return None
        level = float(y[flat].mean())
        intercept, slope, _ = line(x[fall], y[fall])
        if slope >= -0.3:
            return None
        new = (level - intercept) / slope
        if abs(new - log_q0) < 1e-6:
            settled = True
            break
        log_q0 = new
    return log_q0, level, settled
