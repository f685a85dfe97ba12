"""Equations of state: bulk modulus and equilibrium volume from E(V), with checks.

Birch–Murnaghan (third order, Phys. Rev. 71, 809 (1947)),

    E = E0 + (9/16) V0 B0 { (x−1)³ B′ + (x−1)² (6 − 4x) },  x = (V0/V)^{2/3},

is a cubic polynomial in V^{−2/3}, hence one linear least-squares problem with an analytic minimum.

Vinet (PRB 35, 1945 (1987)),

    E = E0 + (9 B0 V0/c²) { 1 − [1 − c(1−η)] e^{c(1−η)} },  c = 3(B′−1)/2,  η = (V/V0)^{1/3}.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from asperity.guards.errors import InputError
from atomistic.constants import EV_PER_A3_IN_GPA

MIN_POINTS = 5
# outside it, a solid this side of melting is unlikely and the fit suspect
B_PRIME_RANGE = (2.0, 7.0)
FORMS_AGREE = 0.02  # Birch–Murnaghan and Vinet must give the same B within this


@dataclass(frozen=True)
class EquationOfState:
    """A fitted equation of state.

    Attributes
    ----------
    V0_A3, B_GPa, B_prime : equilibrium volume, bulk modulus and its pressure derivative
    B_vinet_GPa : bulk modulus by Vinet's form
    B_error_GPa : standard error of B by the misfit
    residual_meV : root mean square misfit of the Birch–Murnaghan fit, per cell
    points : number of points fitted
    flags : what is wrong, in words; empty when the numbers can be trusted
    """

    V0_A3: float
    B_GPa: float
    B_prime: float
    B_vinet_GPa: float
    B_error_GPa: float
    residual_meV: float
    points: int
    flags: tuple[str, ...]


def vinet(volume, V0, E0, B, B_prime):
    """E(V) in eV; B in eV/Å³."""
    eta = (np.asarray(volume) / V0) ** (1 / 3)
    c = 1.5 * (B_prime - 1)
    exponent = c * (1 - eta)
    return E0 + 9 * B * V0 / c**2 * (1 - (1 - exponent) * np.exp(exponent))


def fit_equation_of_state(volumes_A3: ArrayLike, energies_eV: ArrayLike) -> EquationOfState:
    """Fit E(V) of one structure.

    Parameters
    ----------
    volumes_A3, energies_eV : (n,) converged points, n ≥ 5

    Raises
    ------
    InputError
        if there are fewer than five different volumes
    """
    volume = np.asarray(volumes_A3, float)
    energy = np.asarray(energies_eV, float)
    _check(volume, energy)
    centre = float(volume[np.argmin(energy)])
    basis = np.vander((volume / centre) ** (-2 / 3), 4, increasing=True)
    shift = energy.mean()
    coefficients, *_ = np.linalg.lstsq(basis, energy - shift, rcond=None)
    misfits = basis @ coefficients - (energy - shift)
    residual = float(np.sqrt(np.mean(misfits**2)) * 1000)
    V0, E0, B, B_prime = _minimum(coefficients, centre, volume)
    E0 += float(shift)
    if not np.isfinite(V0):
        nan = float("nan")
        no_minimum = ("E(V) has no minimum",)
        return EquationOfState(nan, nan, nan, nan, nan, residual, len(volume), no_minimum)
    flags: list[str] = []
    if not volume.min() < V0 < volume.max():
        flags.append(
            f"V0 {V0:.1f} Å3 outside the scanned {volume.min():.1f} to {volume.max():.1f} Å3"
        )
    if not B_PRIME_RANGE[0] <= B_prime <= B_PRIME_RANGE[1]:
        flags.append(f"B' {B_prime:.1f} outside {B_PRIME_RANGE[0]:g} to {B_PRIME_RANGE[1]:g}")
    unit = EV_PER_A3_IN_GPA
    B_vinet, settled = _vinet_modulus(volume, energy, V0, E0, B, B_prime)
    if not settled or abs(B_vinet / B - 1) > FORMS_AGREE:
        flags.append(
            f"Birch-Murnaghan {B * unit:.1f} and Vinet {B_vinet * unit:.1f} GPa differ by more than"
            f" {FORMS_AGREE:.0%}"
        )
    step = 1e-6 * (np.ptp(energy) or 1.0)
    error = _modulus_error(volume, basis, centre, coefficients, misfits, step)
    # beyond, it says less than the difference of the functionals, 8 % in silicon nitride
    if not error <= 0.1 * B:
        flags.append(
            f"B {B * unit:.0f} +- {error * unit:.0f} GPa: the energies scatter about the fitted"
            " curve"
        )
    moduli = (B * unit, B_prime, B_vinet * unit, error * unit)
    return EquationOfState(V0, *moduli, residual, len(volume), tuple(flags))


def _check(volume: np.ndarray, energy: np.ndarray) -> None:
    """Refuse points that no curve goes through."""
    different = len(np.unique(volume))
    if different < MIN_POINTS:
        raise InputError(
            f"equation of state: {different} different volumes, at least {MIN_POINTS} are needed"
        )
    if not (np.all(np.isfinite(energy)) and np.all(volume > 0)):
        raise InputError("equation of state: volumes must be positive and energies finite")


def _vinet_modulus(
    volume: np.ndarray, energy: np.ndarray, V0: float, E0: float, B: float, B_prime: float
) -> tuple[float, bool]:
    """B (eV/Å³) by Vinet's equation, from that by Birch and Murnaghan; whether its fit settled."""
    from scipy.optimize import least_squares

    scale = np.ptp(energy) or 1.0
    start_B_prime = 4.0
    if np.isfinite(B_prime):
        start_B_prime = max(B_prime, 1.5)
    start = np.array([1.0, 0.0, 1.0, start_B_prime])

    def misfit(p):
        fitted = vinet(volume, p[0] * V0, E0 + p[1] * scale, p[2] * B, p[3])
        return (fitted - energy) / scale

    solution = least_squares(misfit, start, method="lm")
    return float(solution.x[2] * B), bool(solution.success)


def _modulus_error(
    volume: np.ndarray,
    basis: np.ndarray,
    centre: float,
    coefficients: np.ndarray,
    misfits: np.ndarray,
    step: float,
) -> float:
    """Standard error of B (eV/Å³), where energies scatter about the curve as their misfits do.

    The error is sqrt(sum_k (dB/dE_k)²) times the scatter. The coefficients move by column k of the
    pseudoinverse of the basis when energy k does, and B with them. `step` (eV) is that of energies
    in the derivative.
    """
    B = _minimum(coefficients, centre, volume)[2]
    slopes = []
    for column in np.linalg.pinv(basis).T:
        moved = _minimum(coefficients + step * column, centre, volume)
        slopes.append((moved[2] - B) / step)
    freedom = len(volume) - len(coefficients)
    return float(np.linalg.norm(slopes) * np.linalg.norm(misfits) / np.sqrt(freedom))


def _minimum(
    coefficients: np.ndarray, centre: float, volume: np.ndarray
) -> tuple[float, float, float, float]:
    """V0, E(V0), B (eV/Å³) and B' of the cubic in x = (V/centre)^(-2/3); NaN without minimum."""
    a0, a1, a2, a3 = coefficients
    slope = np.polynomial.Polynomial([a1, 2 * a2, 3 * a3])
    real = [root.real for root in slope.roots() if abs(root.imag) < 1e-12 and root.real > 0]
    candidates = [root for root in real if slope.deriv()(root) > 0]
    if not candidates:
        nan = float("nan")
        return nan, nan, nan, nan
    middle = (np.mean([volume.min(), volume.max()]) / centre) ** (-2 / 3)
    x = min(candidates, key=lambda root: abs(root - middle))
    V = float(centre * x**-1.5)
    # derivatives in V by the chain rule, x = (V/centre)^(-2/3)
    d1 = a1 + 2 * a2 * x + 3 * a3 * x * x
    d2 = 2 * a2 + 6 * a3 * x
    d3 = 6 * a3
    x1 = -2 / 3 * x / V
    x2 = 10 / 9 * x / V**2
    x3 = -80 / 27 * x / V**3
    second = d2 * x1**2 + d1 * x2
    third = d3 * x1**3 + 3 * d2 * x1 * x2 + d1 * x3
    E = a0 + a1 * x + a2 * x**2 + a3 * x**3
    B_prime = -1 - V * third / second
    return V, float(E), float(V * second), float(B_prime)
