"""From the spectrum along a line to the two-dimensional one of an isotropic surface.

A line across an isotropic surface of spectrum C(q) has the spectrum (Nayak 1971,
doi:10.1115/1.3451608; Jacobs, Junge and Pastewka 2017, doi:10.1088/2051-672X/aa51f8)

    C1(k) = integral of C(sqrt(k^2 + p^2)) over all p = 2 integral_k^inf C(q) q dq / sqrt(q^2 -
    k^2),

nm^3 at k in 1/nm. Its inverse takes a derivative of noisy data, and what a power law turns into, a
factor, fails on a plateau. So C is sought instead whose C1 fits: straight between nodes in log q
and log C, by Whittle's (Gamma) likelihood, with changes of the logarithmic slope from node to node
held small.
"""

import numpy as np

from mesoscale.errors import InputError
from mesoscale.topography.measurements.profiles import Profile
from mesoscale.topography.spectrum import FLOOR, Spectrum

# sine tapers (Riedel and Sidorenko 1995, doi:10.1109/78.365298): n of them give 2 n/(2 n + 1)
# independent modes per wave number, and spread each over a variance of (n + 1)(2 n + 1)/24 wave
# numbers
TAPERS = 3
MOST_STEPS = 60  # of the fit of a spectrum; most take ten, some creep
SETTLED = 1e-3  # of ln L: what the last step could gain; it moves ln C by a twentieth of its error
COVER = 2 * TAPERS / (2 * TAPERS + 1)
SPREAD = np.sqrt((TAPERS + 1) * (2 * TAPERS + 1) / 24)


def line_spectrum(profile: Profile) -> tuple[np.ndarray, np.ndarray]:
    """Spectrum along a levelled profile, mean over `TAPERS`: k (m,) in 1/nm and C1 (m,) in nm^3.

    The sum of C1 2 pi / L over positive and negative k is the mean square height.
    """
    n = len(profile.heights_nm)
    waves = np.pi * np.arange(1, TAPERS + 1)[:, None]
    tapers = np.sqrt(2) * np.sin(waves * (np.arange(n) + 0.5) / n)
    z = np.fft.rfft((profile.heights_nm - profile.heights_nm.mean()) * tapers)
    power = np.mean(np.abs(z) ** 2, axis=0)
    c1 = power * profile.step_nm**2 / (2 * np.pi * profile.length_nm)
    k = 2 * np.pi * np.fft.rfftfreq(n, profile.step_nm)
    last = n // 2 if n % 2 == 0 else len(k)  # at an even Nyquist number there is half a mode
    return k[1:last], np.maximum(c1[1:last], FLOOR)


def isotropic_spectrum(profile: Profile, low: float, high: float) -> Spectrum:
    """Two-dimensional spectrum of the isotropic surface that a levelled profile runs across.

    Parameters
    ----------
    low, high : wave vectors between which the profile is trusted, 1/nm; others do not enter.

    Returns
    -------
    spectrum : at nodes even in log q between these; `modes` is what its error is worth, the
        smoothing's share of
        the information left out.
    """
    measured = binned_line(*line_spectrum(profile), low, high)
    bins, modes = measured.q, measured.modes
    distance = np.log(10) / 10  # nodes a decade
    decades = np.log(bins[-1] / bins[0]) / distance
    count = max(4, int(np.ceil(decades)) + 1)
    # C is continued for 1.5 decades beyond the data, because short waves lift C1 everywhere
    nodes = np.log(bins[0]) + distance * np.arange(count + 15)
    heights, covariance, settled = _solve(nodes, measured)
    if not settled:
        raise InputError(
            f"{profile.name}: its two-dimensional spectrum does not settle in {MOST_STEPS} steps;"
            " give a longer or finer profile, or leave it out"
        )
    keep = (nodes >= np.log(low) - 1e-9) & (nodes <= np.log(high) + 1e-9)
    # errors of neighbouring nodes go together: sums have their error where each node has that of
    # its row's sum
    apart = np.abs(nodes[keep][:, None] - nodes[keep])
    together = apart < 0.5 * np.log(10)
    variance = np.sum(covariance[np.ix_(keep, keep)] * together, axis=1)
    # neighbouring nodes, which the smoothing ties, have together no more than the wave numbers that
    # they lie among
    near = np.abs(nodes[keep][:, None] - np.log(bins)) < 0.2 * np.log(10)
    sharing = (apart < 0.2 * np.log(10)).sum(axis=1)
    worth = np.minimum(1 / np.maximum(variance, 1e-3), near @ modes / sharing)
    # error of ln C that no averaging removes: its mean about the knee, on slopes 2.3 to 3.6 (60
    # lines each)
    worth /= 1 + worth * 0.25**2
    nyquist = np.pi / profile.step_nm
    q = np.exp(nodes[keep])
    psd = np.exp(heights[keep])
    return Spectrum(q, psd, worth, measured.spacing, nyquist, sharp=True)


def binned_line(k: np.ndarray, c1: np.ndarray, low: float, high: float) -> Spectrum:
    """C1 (nm^3) of a line at k from `low` to `high` (1/nm) on bins, as the tapers spread it."""
    inside = (k >= low) & (k <= high)
    bins, modes, means = _binned(k[inside], c1[inside])
    return Spectrum(bins, means, modes, float(k[0]), float(k[-1]))


def spread(k: np.ndarray, step: np.ndarray | float) -> np.ndarray:
    """(2, m) wave vectors (1/nm) for the tapers' average at k (m,); `step` is 2 pi/L."""
    away = SPREAD * np.asarray(step)
    return np.stack([np.maximum(k - away, 0.1 * k), k + away])


def projected(q: np.ndarray, psd: np.ndarray, k: np.ndarray) -> np.ndarray:
    """C1 (nm^3) at k (1/nm) of points (q in 1/nm, C in nm^4), zero beyond the last."""
    points, weight = _points(k, float(q[-1]))
    log_psd = np.interp(np.log(points), np.log(q), np.log(psd))
    return np.sum(weight * np.exp(log_psd), axis=1)


def _points(k: np.ndarray, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Where C is read for C1 at each k (m,), and with which weight: (m, 160) each; q = k cosh t."""
    reach = np.arccosh(np.maximum(end / k, 1 + 1e-9))
    t, w = np.polynomial.legendre.leggauss(160)
    t = 0.5 * (t + 1)[None, :] * reach[:, None]
    points = k[:, None] * np.cosh(t)
    return points, points * w[None, :] * reach[:, None]  # 2 * (reach / 2)


def _binned(k: np.ndarray, c1: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """20 bins a decade of k: mean k, independent modes and mean C1 of each."""
    grid = np.floor(np.log10(k) * 20).astype(int)
    _, index = np.unique(grid, return_inverse=True)
    count = np.bincount(index)
    centre = np.exp(np.bincount(index, np.log(k)) / count)
    return centre, np.maximum(count * COVER, 0.5), np.bincount(index, c1) / count


def _solve(nodes: np.ndarray, measured: Spectrum) -> tuple[np.ndarray, np.ndarray, bool]:
    """ln C at the nodes (ln q), its covariance, and whether it settled; damped Fisher scoring."""
    k, c1, modes = measured.q, measured.psd, measured.modes
    last = float(np.exp(nodes[-1]))
    tables = [_points(waves, last) for waves in spread(k, measured.spacing)]
    points = np.concatenate([points for points, _ in tables], axis=1)
    weight = np.concatenate([weight for _, weight in tables], axis=1)
    weight /= len(tables)
    place = (np.log(points) - nodes[0]) / (nodes[1] - nodes[0])
    left = np.clip(place.astype(int), 0, len(nodes) - 2)
    right_share = np.clip(place - left, 0.0, 1.0)
    # standard deviation of the change of slope times the node distance, from node to node
    unit = np.eye(len(nodes))
    bends = np.diff(unit, 2, axis=0) / 0.35
    rise = np.diff(unit, axis=0) / (nodes[1] - nodes[0])
    # the logarithmic slope is -0.75 +- 1.5 where a line hardly determines it (its plateau); five
    # nodes share one
    prior = bends.T @ bends + rise.T @ rise / (1.5**2 * 5)
    pull = rise.sum(axis=0) * -0.75 / (1.5**2 * 5)
    rows = np.repeat(np.arange(len(k)), points.shape[1])

    def model(y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        c = weight * np.exp(y[left] * (1 - right_share) + y[left + 1] * right_share)
        mean = c.sum(axis=1)
        slope = np.zeros((len(k), len(y)))
        on_left = c * (1 - right_share)
        on_right = c * right_share
        np.add.at(slope, (rows, left.ravel()), on_left.ravel())
        np.add.at(slope, (rows, left.ravel() + 1), on_right.ravel())
        return mean, slope / mean[:, None]

    def cost(y: np.ndarray, mean: np.ndarray) -> float:
        misfit = np.sum(modes * (c1 / mean + np.log(mean)))
        return float(misfit + 0.5 * y @ prior @ y - pull @ y)

    # start from a power law: C = C1 / (2 k) to a factor of order one
    fall = np.polyfit(np.log(k), np.log(c1), 1)
    y = np.polyval(fall, nodes) - nodes - np.log(2)
    mean, slope = model(y)
    gain = np.inf
    for _ in range(MOST_STEPS):
        gradient = slope.T @ (modes * (c1 / mean - 1)) - prior @ y + pull
        information = slope.T @ (modes[:, None] * slope) + prior
        move = np.linalg.solve(information + 1e-9 * np.eye(len(y)), gradient)
        gain = float(gradient @ move)
        before = cost(y, mean)
        for size in 0.5 ** np.arange(14):
            trial = y + size * move
            trial_mean, trial_slope = model(trial)
            if cost(trial, trial_mean) <= before:
                y, mean, slope = trial, trial_mean, trial_slope
                break
        else:
            break  # no step lowers the cost
        if float(np.abs(size * move).max()) < 1e-6:
            break
    information = slope.T @ (modes[:, None] * slope) + prior
    covariance = np.linalg.inv(information + 1e-9 * np.eye(len(y)))
    # what few modes allow is skewed: its mean is above the most likely value by 1 / 2n for n of
    # them
    skewed = slope.T @ (modes * np.einsum("ki,ij,kj->k", slope, covariance, slope))
    return y + 0.5 * covariance @ skewed, covariance, gain <= SETTLED
