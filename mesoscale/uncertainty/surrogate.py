"""Responses in Legendre polynomials: their values, and plain JSON."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def legendre(u: Array, highest: int) -> Array:
    """Legendre polynomials P_0 .. P_highest (P_n(1) = 1), shape (highest + 1, ...) with that of
    u.
    """
    values = [np.ones_like(u), u]
    for n in range(1, highest):
        values.append(((2 * n + 1) * u * values[n] - n * values[n - 1]) / (n + 1))
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
    powers = legendre(np.ascontiguousarray(u.T), max(1, int(degrees.max(initial=0))))
    columns = np.ones((len(degrees), len(u)))
    # most terms are of one or two inputs
    for term, k in zip(*np.nonzero(degrees), strict=True):
        columns[term] *= powers[degrees[term, k], k]
    return np.ascontiguousarray(columns.T)


def scaled(x: Array, ranges: Array) -> Array:
    """Inputs (m, n), of ranges (n, 2), in -1 .. 1, and beyond where they leave them; an input of no
    width gives 0.
    """
    low = ranges[:, 0]
    high = ranges[:, 1]
    width = high - low
    return np.where(width > 0, 2 * (x - low) / np.where(width > 0, width, 1.0) - 1, 0.0)


@dataclass(frozen=True)
class Surrogate:
    """y = transform( sum_t coefficient_t prod_k P_{degree_tk}(u_k) ), u = 2 (x - low)/(high - low)
    - 1.

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
        total = (
            basis_matrix(scaled(np.atleast_2d(x), self.ranges), self.degrees) @ self.coefficients
        )
        return np.exp(total) if self.transform == "log" else total


@dataclass(frozen=True)
class Below:
    """y = above - drop, a response that nowhere exceeds another one: the drop is the exponential of
    a sum.

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
    return np.stack(
        [response(x) if response else np.full(len(x), np.nan) for response in responses], axis=1
    )


def to_json(response: Response) -> dict[str, Any]:
    """The response as plain values; docs/uncertainty.md has a ten-line reader."""
    surrogate = response.drop if isinstance(response, Below) else response
    return {
        **({"below": response.above_name} if isinstance(response, Below) else {}),
        "transform": surrogate.transform,
        "terms": [
            {"degrees": degrees, "coefficient": coefficient}
            for degrees, coefficient in zip(
                surrogate.degrees.tolist(), surrogate.coefficients.tolist(), strict=True
            )
        ],
    }
