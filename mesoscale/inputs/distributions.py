"""Distributions of the uncertain inputs: quantiles, support, joint samples with correlation."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mesoscale.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Distribution:
    """A one-dimensional distribution of one of the kinds of `InputRow.distribution`.

    Attributes
    ----------
    kind : uniform, log_uniform (uniform in the logarithm), normal, truncated_normal, samples or
        fixed.
    a : lower end, mean or fixed value.
    b : upper end or standard deviation.
    low : lower truncation.
    high : upper truncation.
    values : sorted samples, shape (n,), of kind `samples`.
    """

    kind: str
    a: float = np.nan
    b: float = np.nan
    low: float = -np.inf
    high: float = np.inf
    values: Array = field(default_factory=lambda: np.empty(0))

    def quantile(self, probability: ArrayLike) -> Array:
        """The value below which a share `probability` (any shape, in [0, 1]) lies."""
        p = np.asarray(probability, float)
        if self.kind == "fixed":
            return np.full_like(p, self.a)
        if self.kind == "uniform":
            return self.a + p * (self.b - self.a)
        if self.kind == "log_uniform":
            return self.a * (self.b / self.a) ** p
        if self.kind == "samples":
            return np.quantile(self.values, p)
        from scipy.special import ndtr, ndtri  # light, unlike scipy.stats

        if self.b == 0:
            return np.full_like(p, self.a)
        below = ndtr((self.low - self.a) / self.b)
        above = ndtr((self.high - self.a) / self.b)
        values = self.a + self.b * ndtri(below + p * (above - below))
        return np.clip(values, self.low, self.high)

    def scaled(self, factor: float) -> "Distribution":
        """The distribution of `factor` times the value."""
        numbers = {
            name: factor * getattr(self, name) for name in ("a", "b", "low", "high", "values")
        }
        return Distribution(self.kind, **numbers)

    def span(self, central_share: float = 0.999) -> tuple[float, float]:
        """Ends of the range that responses cover.

        All of a bounded distribution; the central share of an unbounded one.
        """
        share = 1.0
        if self.kind == "normal":
            share = central_share
        low, high = self.quantile(np.array([(1 - share) / 2, (1 + share) / 2]))
        return float(low), float(high)


@dataclass(frozen=True)
class UncertainInput:
    """One row of the table of inputs.

    Attributes
    ----------
    origin : literature, hardness, elastic or topography.
    source : reference or result file.
    varies : common (one unknown value for all devices) or each (another for each of them).
    """

    name: str
    unit: str
    distribution: Distribution
    origin: str
    source: str
    varies: str = "common"


@dataclass(frozen=True)
class InputTable:
    """The uncertain inputs in use with their dependence.

    Attributes
    ----------
    correlation : Spearman's rank correlation, shape (n, n).
    """

    rows: tuple[UncertainInput, ...]
    correlation: Array

    def __repr__(self) -> str:
        medians = self.medians()
        return (
            "InputTable, medians:"
            f" {', '.join(f'{row.name} {medians[row.name]:.4g} {row.unit}' for row in self.rows)}"
        )

    @property
    def names(self) -> list[str]:
        """Names of the inputs in order."""
        return [row.name for row in self.rows]

    def medians(self) -> dict[str, float]:
        """Central values by name, in the inputs' units (means of symmetric distributions)."""
        return {row.name: float(row.distribution.quantile(0.5)) for row in self.rows}

    def ranges(self) -> Array:
        """Range that responses cover, shape (n, 2)."""
        return np.array([row.distribution.span() for row in self.rows])

    def transform(self, unit_points: Array) -> Array:
        """Points of the unit cube (m, n) to correlated values of the inputs (Gaussian copula)."""
        if not np.array_equal(self.correlation, np.eye(len(self.rows))):
            from scipy.special import ndtr, ndtri

            # the copula's linear correlation that gives this rank correlation; OpenTURNS'
            # NormalCopula has the same points to 4e-16, but takes as many lines and belongs to an
            # extra
            linear = 2 * np.sin(np.pi / 6 * self.correlation)
            factor = np.linalg.cholesky(linear)
            inside = np.clip(unit_points, 1e-15, 1 - 1e-15)
            unit_points = ndtr(ndtri(inside) @ factor.T)
        columns = [row.distribution.quantile(unit_points[:, k]) for k, row in enumerate(self.rows)]
        return np.stack(columns, axis=1)

    def sample(self, count: int, seed: int) -> Array:
        """Independent random samples of the inputs, shape (count, n)."""
        rng = np.random.default_rng(np.random.SeedSequence([seed, 0x1A]))
        return self.transform(rng.random((count, len(self.rows))))


def correlation_matrix(names: list[str], pairs: dict[tuple[str, str], float]) -> Array:
    """Rank correlation matrix from pairs of names.

    Raises
    ------
    InputError : the pairs contradict one another (matrix not positive definite).
    """
    matrix = np.eye(len(names))
    for (first, second), rank in pairs.items():
        i = names.index(first)
        j = names.index(second)
        matrix[i, j] = matrix[j, i] = rank
    # correlation of the normal variables behind the ranks (Pearson 1907)
    identity = np.eye(len(names))
    normal = 2 * np.sin(np.pi / 6 * matrix) * (1 - identity) + identity
    if np.linalg.eigvalsh(normal)[0] <= 0:
        raise InputError(
            f"inputs.correlations: {', '.join(f'{a}-{b} {r:g}' for (a, b), r in pairs.items())}"
            " contradict one another (not positive definite); make them weaker"
        )
    return matrix
