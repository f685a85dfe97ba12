"""From the spectrum along a line to the two-dimensional one of an isotropic surface.

A line across an isotropic surface of spectrum C(q) has the spectrum (Nayak 1971,
doi:10.1115/1.3451608; Jacobs, Junge and Pastewka 2017, doi:10.1088/2051-672X/aa51f8)

    C1(k) = integral of C(sqrt(k^2 + p^2)) over all p
          = 2 integral_k^inf C(q) q dq / sqrt(q^2 - k^2),

in nm^3 at k in 1/nm. Its inverse takes a derivative of noisy data. For a power law it is a factor,
which is wrong on a plateau. So that C is sought whose C1 fits: straight between nodes in ln q and
ln C, by Whittle's (Gamma) likelihood. A prior holds small what the slope changes from node to node.
"""

from dataclasses import dataclass

import numpy as np

from mesoscale.errors import InputError
from mesoscale.topography.measurements.profiles import Profile
from mesoscale.topography.spectrum import FLOOR, Spectrum

TAPERS = 3
"""Sine tapers of a line (Riedel and Sidorenko 1995, doi:10.1109/78.365298)."""
COVER = 2 * TAPERS / (2 * TAPERS + 1)
"""Independent modes that they give to each wave number."""
SPREAD = np.sqrt((TAPERS + 1) * (2 * TAPERS + 1) / 24)
"""Standard deviation, in wave numbers, of what each of these mixes."""
DECADE = np.log(10)
NODE_DISTANCE = DECADE / 10
"""Between nodes of ln C, in ln q."""
NODES_BEYOND = 15
"""Nodes above the data, 1.5 decades: short waves lift C1 everywhere."""
READ_AT = 160
"""Points at which C is read for one C1, by Gauss and Legendre."""
BEND_DEVIATION = 0.35
"""Prior: standard deviation by which the rise of ln C from node to node changes."""
SLOPE, SLOPE_DEVIATION, SLOPE_NODES = -0.75, 1.5, 5
"""Prior of d ln C / d ln q, where a line hardly determines it (its plateau), and how many nodes
share one such slope."""
MOST_STEPS = 60
"""Steps of a fit; most take ten, some creep."""
SETTLED = 1e-3
"""What the last step could gain in ln L: it moves ln C by a twentieth of its error."""
ALWAYS_THERE = 0.25
"""Error of ln C that no averaging removes: its mean about the knee, on slopes 2.3 to 3.6 (60 lines
each)."""


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
        smoothing's share of the information left out.
    """
    measured = binned_line(*line_spectrum(profile), low, high)
    nodes = _nodes(measured.q)
    heights, covariance, settled = _solve(nodes, measured)
    if not settled:
        raise InputError(
            f"{profile.name}: its two-dimensional spectrum does not settle in {MOST_STEPS} steps;"
            " give a longer or finer profile, or leave it out"
        )
    keep = (nodes >= np.log(low) - 1e-9) & (nodes <= np.log(high) + 1e-9)
    modes = _modes(nodes[keep], covariance[np.ix_(keep, keep)], measured)
    nyquist = np.pi / profile.step_nm
    q = np.exp(nodes[keep])
    psd = np.exp(heights[keep])
    return Spectrum(q, psd, modes, measured.spacing, nyquist, sharp=True)


def _nodes(q: np.ndarray) -> np.ndarray:
    """Nodes of ln C: ln q, evenly from the first of the data to `NODES_BEYOND` above the last."""
    steps = np.log(q[-1] / q[0]) / NODE_DISTANCE
    count = max(4, int(np.ceil(steps)) + 1)
    return np.log(q[0]) + NODE_DISTANCE * np.arange(count + NODES_BEYOND)


def _modes(nodes: np.ndarray, covariance: np.ndarray, measured: Spectrum) -> np.ndarray:
    """Independent modes that the error of ln C at each node (ln q) is worth."""
    distance = np.abs(nodes[:, None] - nodes)
    # errors of neighbouring nodes go together: sums have their error where each node has that of
    # its row's sum
    together = distance < 0.5 * DECADE
    variance = np.sum(covariance * together, axis=1)
    # neighbouring nodes, which the smoothing ties, have together no more than the wave numbers that
    # they lie among
    near_bins = np.abs(nodes[:, None] - np.log(measured.q)) < 0.2 * DECADE
    sharing = (distance < 0.2 * DECADE).sum(axis=1)
    modes = np.minimum(1 / np.maximum(variance, 1e-3), near_bins @ measured.modes / sharing)
    return modes / (1 + modes * ALWAYS_THERE**2)


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
    """Where C is read for C1 at each k (m,), and with which weight: q = k cosh t.

    Shape (m, `READ_AT`) each.
    """
    reach = np.arccosh(np.maximum(end / k, 1 + 1e-9))
    t, w = np.polynomial.legendre.leggauss(READ_AT)
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


@dataclass(frozen=True)
class _LineModel:
    """C1 on the bins of a measured line as it follows from ln C at nodes, and how well it fits.

    Attributes
    ----------
    measured : the line's spectrum on k bins
    weight, left, right_share : (k, m) of the points q at which each C1 reads C: their weight, the
        node to their left, and how far they are on the way to the next one
    prior, pull : (n, n) and (n,): ln of the prior density of y, ln C at n nodes, is -y prior y/2 +
        pull y
    """

    measured: Spectrum
    weight: np.ndarray
    left: np.ndarray
    right_share: np.ndarray
    prior: np.ndarray
    pull: np.ndarray

    def mean_and_slope(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """C1 (k,) and the derivative of its logarithm with respect to y, (k, n)."""
        log_c = y[self.left] * (1 - self.right_share) + y[self.left + 1] * self.right_share
        c = self.weight * np.exp(log_c)
        mean = c.sum(axis=1)
        slope = np.zeros((len(mean), len(y)))
        rows = np.repeat(np.arange(len(mean)), c.shape[1])
        left = self.left.ravel()
        on_left = c * (1 - self.right_share)
        on_right = c * self.right_share
        np.add.at(slope, (rows, left), on_left.ravel())
        np.add.at(slope, (rows, left + 1), on_right.ravel())
        return mean, slope / mean[:, None]

    def cost(self, y: np.ndarray, mean: np.ndarray) -> float:
        """Minus ln of likelihood and prior."""
        misfit = np.sum(self.measured.modes * (self.measured.psd / mean + np.log(mean)))
        return float(misfit + 0.5 * y @ self.prior @ y - self.pull @ y)

    def gradient(self, y: np.ndarray, mean: np.ndarray, slope: np.ndarray) -> np.ndarray:
        """Where the cost falls fastest, (n,)."""
        excess = self.measured.modes * (self.measured.psd / mean - 1)
        return slope.T @ excess - self.prior @ y + self.pull

    def information(self, slope: np.ndarray) -> np.ndarray:
        """Expected curvature of the cost, (n, n), a little above singular."""
        fisher = slope.T @ (self.measured.modes[:, None] * slope) + self.prior
        return fisher + 1e-9 * np.eye(len(fisher))


def _model_of(nodes: np.ndarray, measured: Spectrum) -> _LineModel:
    """The model of a line whose C is straight between nodes in ln q and ln C."""
    last = float(np.exp(nodes[-1]))
    tables = [_points(waves, last) for waves in spread(measured.q, measured.spacing)]
    points = np.concatenate([points for points, _ in tables], axis=1)
    weight = np.concatenate([weight for _, weight in tables], axis=1)
    weight /= len(tables)
    place = (np.log(points) - nodes[0]) / (nodes[1] - nodes[0])
    left = np.clip(place.astype(int), 0, len(nodes) - 2)
    right_share = np.clip(place - left, 0.0, 1.0)
    return _LineModel(measured, weight, left, right_share, *_prior(nodes))


def _prior(nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What is believed of ln C at nodes without the line: `prior` and `pull` of the model."""
    unit = np.eye(len(nodes))
    bends = np.diff(unit, 2, axis=0) / BEND_DEVIATION
    rise = np.diff(unit, axis=0) / (nodes[1] - nodes[0])
    slope_variance = SLOPE_DEVIATION**2 * SLOPE_NODES
    prior = bends.T @ bends + rise.T @ rise / slope_variance
    pull = rise.sum(axis=0) * SLOPE / slope_variance
    return prior, pull


def _solve(nodes: np.ndarray, measured: Spectrum) -> tuple[np.ndarray, np.ndarray, bool]:
    """ln C at the nodes (ln q), its covariance, and whether it settled; damped Fisher scoring."""
    model = _model_of(nodes, measured)
    # start from a power law: C = C1 / (2 k) to a factor of order one
    fall = np.polyfit(np.log(measured.q), np.log(measured.psd), 1)
    y = np.polyval(fall, nodes) - nodes - np.log(2)
    mean, slope = model.mean_and_slope(y)
    gain = np.inf
    for _ in range(MOST_STEPS):
        gradient = model.gradient(y, mean, slope)
        move = np.linalg.solve(model.information(slope), gradient)
        gain = float(gradient @ move)
        before = model.cost(y, mean)
        for size in 0.5 ** np.arange(14):
            trial = y + size * move
            trial_mean, trial_slope = model.mean_and_slope(trial)
            if model.cost(trial, trial_mean) <= before:
                y, mean, slope = trial, trial_mean, trial_slope
                break
        else:
            break  # no step lowers the cost
        if float(np.abs(size * move).max()) < 1e-6:
            break
    covariance = np.linalg.inv(model.information(slope))
    # what few modes allow is skewed: its mean is above the most likely value by 1 / 2n for n of
    # them
    variance = np.einsum("ki,ij,kj->k", slope, covariance, slope)
    skewed = slope.T @ (measured.modes * variance)
    return y + 0.5 * covariance @ skewed, covariance, gain <= SETTLED
