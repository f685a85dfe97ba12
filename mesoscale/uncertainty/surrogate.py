"""Responses in Legendre polynomials: their values, and plain JSON."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def legendre(u: Array, highest: int) -> Array:
    """Legendre polynomials P_0 .. P_highest (P_n(1) = 1), (highest + 1, ...) of u."""
    values = [np.ones_like(u), u]
    for n in range(1, highest):
        rising = (2 * n + 1) * u * values[n]
        values.append((rising - n * values[n - 1]) / (n + 1))
    return np.stack(values[: highest + 1])


def basis_matrix(u: Array, degrees: NDArray[np.int_]) -> Array:
    """Products of Legendre polynomials.

    Parameters
    ----------
    u : points in [-1, 1]^n, shape (m, n).
    degrees : degree of each term in each input, shape (terms, n).

    Returns
    -------
    shape (m, terms).
    """
    highest = max(1, int(degrees.max(initial=0)))
    powers = legendre(np.ascontiguousarray(u.T), highest)
    columns = np.ones((len(degrees), len(u)))
    # most terms are of one or two inputs
    for term, k in zip(*np.nonzero(degrees), strict=True):
        columns[term] *= powers[degrees[term, k], k]
    return np.ascontiguousarray(columns.T)


def scaled(x: Array, ranges: Array) -> Array:
    """Inputs (m, n), of ranges (n, 2), in -1 .. 1 and beyond; an input of no width gives 0."""
    low = ranges[:, 0]
    high = ranges[:, 1]
    width = high - low
    divisor = np.where(width > 0, width, 1.0)
    return np.where(width > 0, 2 * (x - low) / divisor - 1, 0.0)


@dataclass(frozen=True)
class Surrogate:
    """y = transform( sum_t coefficient_t prod_k P_{degree_tk}(u_k) ), u = -1 .. 1 over the range.

    Attributes
    ----------
    ranges : range of each input, shape (n, 2).
    degrees : shape (terms, n); the first row is the constant.
    coefficients : shape (terms,).
    transform : identity, or log: the sum is the logarithm of the output.
    """

    ranges: Array
    degrees: NDArray[np.int_]
    coefficients: Array
    transform: str = "identity"

    def __call__(self, x: Array) -> Array:
        """Output at inputs x of shape (m, n)."""
        matrix = basis_matrix(scaled(np.atleast_2d(x), self.ranges), self.degrees)
        total = matrix @ self.coefficients
        if self.transform == "log":
            return np.exp(total)
        return total


@dataclass(frozen=True)
class Below:
    """y = above - drop, which nowhere exceeds `above`: the drop is the exponential of a sum.

    Attributes
    ----------
    above_name : output whose response `above` is.
    """

    above_name: str
    above: Surrogate
    drop: Surrogate

    @property
    def degrees(self) -> NDArray[np.int_]:
        """Degrees of the drop's terms, shape (terms, n)."""
        return self.drop.degrees

    def __call__(self, x: Array) -> Array:
        """Output at inputs x of shape (m, n)."""
        return self.above(x) - self.drop(x)


Response = Surrogate | Below


def evaluate(responses: Sequence[Callable[[Array], Array] | None], x: Array) -> Array:
    """Responses at inputs x (m, n), shape (m, responses); NaN where there is no response."""
    columns = []
    for response in responses:
        columns.append(response(x) if response else np.full(len(x), np.nan))
    return np.stack(columns, axis=1)


def to_json(response: Response) -> dict[str, Any]:
    """The response as plain values; docs/uncertainty.md has a ten-line reader."""
    content: dict[str, Any] = {}
    if isinstance(response, Below):
        content["below"] = response.above_name
        response = response.drop
    content["transform"] = response.transform
    degrees = response.degrees.tolist()
    pairs = zip(degrees, response.coefficients.tolist(), strict=True)
    content["terms"] = [{"degrees": term, "coefficient": value} for term, value in pairs]
    return content
