"""Change of slope in a stress curve, with its significance under correlated noise.

The paper reads hardness off where the slope of contact stress against contact length drops.  A hinge fits
noise as well, so a kink counts only if a smooth curve with noise of the same size and correlation would
rarely gain as much from a hinge.
"""

from dataclasses import dataclass

import numpy as np

SIGNIFICANCE = 0.02
SIMULATIONS = 400


@dataclass(frozen=True)
class Kink:
    """A change of slope at (`x`, `y`); `low`, `high` bound y (68 %), `p_value`: chance of a false one."""

    x: float
    y: float
    low: float
    high: float
    slope_before: float
    slope_after: float
    p_value: float


def find_kink(x: np.ndarray, y: np.ndarray, min_points: int, seed: int = 0) -> Kink | None:
    """Find where the slope of y(x) drops, or None.

    Parameters
    ----------
    x, y : shape (n,), in the order of loading (the noise is correlated along it).
    min_points : points needed on each side.

    Notes
    -----
    Least squares over all hinge positions.  The null distribution of the gain over a straight line comes from
    smooth elastic loading (`_smooth_loading`) with first-order autoregressive noise fitted to the residuals
    of the hinge; so does the interval of y.  Required: slope before > 0, slope after < half of it, p < 0.02.
    """
    hinges = _hinge_positions(x, min_points)
    if len(hinges) == 0:
        return None
    designs = [np.column_stack([np.ones_like(x), x - h, np.maximum(x - h, 0.0)]) for h in hinges]
    bases = np.stack([np.linalg.qr(design)[0] for design in designs])
    line = np.linalg.qr(np.column_stack([np.ones_like(x), x]))[0]
    best, gain = _best(y[:, None], bases, line)
    k = int(best[0])
    offset, before, change = np.linalg.lstsq(designs[k], y, rcond=None)[0]
    after = before + change
    if before <= 0 or after >= 0.5 * before:
        return None
    residual = y - designs[k] @ np.array([offset, before, change])
    rng = np.random.default_rng(np.random.SeedSequence([seed, 7]))
    noise = _correlated_noise(residual, SIMULATIONS, rng)
    _, gains_without_kink = _best(_smooth_loading(x, y)[:, None] + noise, bases, line)
    p_value = float((1 + np.sum(gains_without_kink >= gain[0])) / (1 + SIMULATIONS))
    if p_value >= SIGNIFICANCE:
        return None
    again = designs[k] @ np.array([offset, before, change])
    best_again, _ = _best(again[:, None] + noise, bases, line)
    heights = [
        np.linalg.lstsq(designs[m], again + noise[:, j], rcond=None)[0][0] for j, m in enumerate(best_again.tolist())
    ]
    low, high = np.quantile(heights, [0.16, 0.84])
    return Kink(float(hinges[k]), float(offset), float(low), float(high), float(before), float(after), p_value)


def _smooth_loading(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The elastic curve nearest to the data: offset + scale x^n, n from 0.6 to 1 (straight: a sphere)."""
    fits = []
    for exponent in (0.6, 0.7, 0.8, 0.9, 1.0):
        design = np.column_stack([np.ones_like(x), np.sign(x) * np.abs(x) ** exponent])
        curve = design @ np.linalg.lstsq(design, y, rcond=None)[0]
        fits.append((float(np.sum((y - curve) ** 2)), exponent, curve))
    return min(fits, key=lambda fit: fit[:2])[2]


def _hinge_positions(x: np.ndarray, min_points: int) -> np.ndarray:
    """Candidates between the data, with enough points on each side."""
    ordered = np.sort(x)
    if len(x) < 2 * min_points:
        return np.empty(0)
    low, high = ordered[min_points - 1], ordered[len(x) - min_points]
    return np.linspace(low, high, 40) if high > low else np.empty(0)


def _best(samples: np.ndarray, bases: np.ndarray, line: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Best hinge of each column of `samples` and its relative gain over the straight line."""
    total = np.sum(samples**2, axis=0)
    projected = np.sum(np.einsum("hij,is->hjs", bases, samples) ** 2, axis=1)
    best = np.argmax(projected, axis=0)
    rest = np.maximum(total - projected[best, np.arange(samples.shape[1])], 1e-12 * total)
    rest_line = total - np.sum((line.T @ samples) ** 2, axis=0)
    return best, rest_line / rest - 1


def _correlated_noise(residual: np.ndarray, samples: int, rng: np.random.Generator) -> np.ndarray:
    """Autoregressive noise with the variance and (bias-corrected) correlation of the residuals."""
    n = len(residual)
    centred = residual - residual.mean()
    raw = float(np.sum(centred[1:] * centred[:-1]) / max(np.sum(centred**2), 1e-30))
    phi = float(np.clip((n * raw + 1) / (n - 3), 0.0, 0.95))  # Kendall's correction for a short series
    variance = float(np.sum(centred**2) / max(n - 4, 1))
    shocks = rng.normal(0, np.sqrt(variance * (1 - phi**2)), (n, samples))
    noise = np.empty_like(shocks)
    noise[0] = rng.normal(0, np.sqrt(variance), samples)
    for k in range(1, n):
        noise[k] = phi * noise[k - 1] + shocks[k]
    return noise
