"""Sparse polynomial chaos fitted to scattered runs (least angle regression by OpenTURNS)."""

import numpy as np
from numpy.typing import NDArray

from mesoscale.extras import needs
from mesoscale.uncertainty.surrogate import Surrogate, basis_matrix, scaled

Array = NDArray[np.float64]

MEAN = 10.0
"""Mean of what LARS selects terms for, in deviations. At a mean of 0 rounding alone gives the sign
of the constant term, by which LARS takes one way or another. Far from 0 the constant enters
first."""

LEAST = 1e-9
"""Coefficient of a term, in deviations. Where few terms reproduce all values, LARS takes others
from what rounding left of them."""


def sparse_chaos(
    x: Array, y: Array, ranges: Array, transform: str = "identity", degree: int = 3
) -> Surrogate:
    """Sparse Legendre expansion of y, averaged over the scatter that x does not explain.

    Linear terms of all inputs are kept, if the runs allow it; those of higher degree are selected.

    Parameters
    ----------
    x : inputs of the runs, shape (m, n); values outside `ranges` are clipped to them.
    y : outputs, shape (m,); runs with NaN (and, for `log`, without positive value) are left out.
    ranges : shape (n, 2).
    transform : log fits ln y, then scales the response so that its mean over the runs is theirs (it
        would be too low by the scatter that x does not explain).
    degree : highest total degree; 1 to 3 differ by less than the study can tell (evidence
        uncertainty.work_precision). Terms of many inputs are thinned by the hyperbolic norm.

    Raises
    ------
    ValueError : fewer usable runs than twice the inputs.
    """
    with needs("uncertainty"):
        import openturns as ot

    usable = np.isfinite(y) & ((y > 0) | (transform == "identity"))
    inputs = x.shape[1]
    if usable.sum() < 2 * inputs:
        raise ValueError(
            f"{int(usable.sum())} usable runs for {inputs} inputs; at least {2 * inputs} are needed"
        )
    u = np.clip(scaled(x[usable], ranges), -1.0, 1.0)
    target = y[usable]
    if transform == "log":
        target = np.log(target)
    # in units of its deviation, because LARS stops at absolute tolerances
    centre = target.mean()
    width = target.std() or 1.0

    # an input that does not vary has no terms, and would make the least squares singular
    varying = np.flatnonzero(np.ptp(u, axis=0) > 0)
    if not len(varying):
        return Surrogate(ranges, np.zeros((1, inputs), int), np.array([centre]), transform)
    enumerate_terms = ot.HyperbolicAnisotropicEnumerateFunction(len(varying), 0.7)
    basis = ot.OrthogonalProductPolynomialFactory(
        [ot.LegendreFactory()] * len(varying), enumerate_terms
    )
    most_terms = max(2, int(0.8 * usable.sum()))
    size = min(enumerate_terms.getBasisSizeFromTotalDegree(degree), most_terms)
    selection = ot.LeastSquaresMetaModelSelectionFactory(ot.LARS(), ot.CorrectedLeaveOneOut())
    standard = (target - centre) / width + MEAN
    uniform = ot.JointDistribution([ot.Uniform(-1, 1)] * len(varying))
    chaos = ot.FunctionalChaosAlgorithm(
        ot.Sample(u[:, varying]),
        ot.Sample(standard[:, None]),
        uniform,
        ot.FixedStrategy(basis, size),
        ot.LeastSquaresStrategy(selection),
    )
    chaos.run()
    result = chaos.getResult()
    shares = np.abs(np.array(result.getCoefficients())[:, 0])
    chosen = [int(k) for k in np.array(result.getIndices())[shares > LEAST]]
    degrees = np.zeros((len(chosen), inputs), int)
    terms = np.array([list(enumerate_terms(k)) for k in chosen], int)
    degrees[:, varying] = terms.reshape(-1, len(varying))
    # an input that the selection left out would have an index of zero with an interval of no width
    needed = [np.zeros(inputs, int), *np.eye(inputs, dtype=int)[varying]]
    missing = [term for term in needed if not (degrees == term).all(axis=1).any()]
    if len(degrees) + len(missing) > most_terms:
        missing = [term for term in missing if not term.any()]  # few runs: the constant alone
    return refit(u, target, ranges, np.vstack([*missing, degrees]), transform)


def refit(
    u: Array, target: Array, ranges: Array, degrees: NDArray[np.int_], transform: str
) -> Surrogate:
    """Least-squares coefficients of given terms.

    Parameters
    ----------
    u : points in [-1, 1]^n, shape (m, n).
    target : y, or ln y for `log`.
    """
    matrix = basis_matrix(u, degrees)
    coefficients = np.asarray(np.linalg.lstsq(matrix, target, rcond=None)[0], float)
    if transform == "log":
        ratio = np.exp(target).mean() / np.exp(matrix @ coefficients).mean()
        shift = np.log(ratio)
        coefficients = coefficients + np.where(degrees.sum(axis=1) == 0, shift, 0.0)
    return Surrogate(ranges, degrees, coefficients, transform)
