"""Elastic constants of one structure: 6×6 in Voigt's order (xx, yy, zz, yz, xz, xy) with engineering shears.

Strains are deformations F = 1 + ε with symmetric ε.  Constants are the slope of the second Piola–Kirchhoff stress by
the Green–Lagrange strain: symmetric under any stress, and the slope of Cauchy's stress where that vanishes
(Wallace, Thermodynamics of Crystals, 1972).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from ase.stress import full_3x3_to_voigt_6_stress, voigt_6_to_full_3x3_stress

from atomistic.errors import InputError

LARGEST_STRAIN = 0.03  # beyond it the next order of elasticity is a tenth of the stress and more
SHEARS = np.array([1, 1, 1, 2, 2, 2])


def deformation(strain: Sequence[float] | np.ndarray) -> np.ndarray:
    """F = 1 + ε of a strain in Voigt's order, shape (3, 3)."""
    return np.eye(3) + voigt_6_to_full_3x3_stress(np.asarray(strain, float) / SHEARS)


def green_lagrange(strain: Sequence[float] | np.ndarray) -> np.ndarray:
    """Green–Lagrange strain (FᵀF − 1)/2 in Voigt's order, shape (6,)."""
    F = deformation(strain)
    return full_3x3_to_voigt_6_stress(0.5 * (F.T @ F - np.eye(3))) * SHEARS


def piola_kirchhoff(strain: Sequence[float] | np.ndarray, stress: np.ndarray) -> np.ndarray:
    """Second Piola–Kirchhoff stress det F · F⁻¹σF⁻ᵀ of Cauchy's stress in the strained state, shape (6,)."""
    F = deformation(strain)
    inverse = np.linalg.inv(F)
    return full_3x3_to_voigt_6_stress(np.linalg.det(F) * inverse @ voigt_6_to_full_3x3_stress(stress) @ inverse.T)


def strain_states(size: float) -> list[np.ndarray]:
    """Both signs of each of the six strains, (6,) each: the least that gives all constants to second order.

    Raises
    ------
    InputError
        if `size` is zero or beyond elasticity
    """
    if not 0 < size <= LARGEST_STRAIN:
        raise InputError(
            f"elastic constants: strain {size:g}; give more than 0 and at most {LARGEST_STRAIN:g}, beyond which "
            "a stress is no longer proportional to its strain"
        )
    return [sign * size * row for row in np.eye(6) for sign in (1, -1)]


@dataclass(frozen=True)
class Stiffness:
    """Constants fitted to strains and stresses.

    Attributes
    ----------
    C : (6, 6) symmetric, in the unit of the stresses
    stress : (6,) at no strain
    error : (6, 6) half of what C_ij and C_ji of the unconstrained fit differ by; on the diagonal the root mean square
        of the others
    """

    C: np.ndarray
    stress: np.ndarray
    error: np.ndarray


def fit_stiffness(strains: Sequence[np.ndarray], stresses: Sequence[np.ndarray]) -> Stiffness:
    """All 36 constants and the stress at no strain by least squares; no symmetry is assumed.

    Parameters
    ----------
    strains, stresses : (n, 6) Voigt strains and Cauchy's stresses of the strained states

    Raises
    ------
    InputError
        if the strains leave a constant undetermined
    """
    eta = np.array([green_lagrange(strain) for strain in strains]).reshape(-1, 6)
    equations = np.hstack([np.ones((len(eta), 1)), eta / max(float(abs(eta).max(initial=0.0)), 1e-30)])
    rank = int(np.linalg.matrix_rank(equations, tol=1e-6))
    if rank < 7:
        raise InputError(
            f"elastic constants: {len(eta)} strain states determine {rank} of 7 unknowns of each stress component; "
            "give both signs of all six strains"
        )
    tension = np.array([piola_kirchhoff(strain, stress) for strain, stress in zip(strains, stresses, strict=True)])
    solution = np.linalg.lstsq(np.hstack([np.ones((len(eta), 1)), eta]), tension, rcond=None)[0]
    return with_symmetry_error(solution[1:].T, solution[0])


def with_symmetry_error(raw: np.ndarray, stress: np.ndarray) -> Stiffness:
    """The symmetric part of a fitted matrix, its antisymmetric part as the error."""
    error = 0.5 * abs(raw - raw.T)
    np.fill_diagonal(error, np.sqrt(np.sum(error**2) / 30))
    return Stiffness(0.5 * (raw + raw.T), stress, error)


@dataclass(frozen=True)
class Isotropic:
    """Moduli of the isotropic body of randomly turned pieces of a structure (Hill, Proc. Phys. Soc. A 65, 349 (1952)).

    Attributes
    ----------
    B, G : bulk and shear modulus, means of Voigt's and Reuss's bounds
    B_error, G_error : half of the distance between the bounds
    """

    B: float
    G: float
    B_error: float
    G_error: float

    @property
    def E(self) -> float:
        """Young's modulus."""
        return float(young(self.B, self.G))

    @property
    def nu(self) -> float:
        """Poisson's ratio."""
        return float(poisson(self.B, self.G))


def young(B, G):
    """Young's modulus from bulk and shear modulus; arrays broadcast."""
    return 9 * B * G / (3 * B + G)


def poisson(B, G):
    """Poisson's ratio from bulk and shear modulus; arrays broadcast."""
    return (3 * B - 2 * G) / (2 * (3 * B + G))


def isotropic(C: np.ndarray) -> Isotropic:
    """Voigt–Reuss–Hill moduli of a matrix of elastic constants.

    Raises
    ------
    InputError
        if C is not positive definite: the structure would gain energy by straining
    """
    values, vectors = np.linalg.eigh(C)
    if not values[0] > 0:
        strain = " ".join(f"{x:+.2f}" for x in vectors[:, 0])
        raise InputError(
            f"elastic constants: eigenvalue {values[0]:.3g} GPa along strain ({strain}): the structure is unstable; "
            "relax its cell further or leave it out"
        )
    S = np.linalg.inv(C)
    B_voigt = C[:3, :3].sum() / 9
    G_voigt = (3 * np.trace(C[:3, :3]) - C[:3, :3].sum() + 6 * np.trace(C[3:, 3:])) / 30
    B_reuss = 1 / S[:3, :3].sum()
    G_reuss = 15 / (6 * np.trace(S[:3, :3]) - 2 * S[:3, :3].sum() + 3 * np.trace(S[3:, 3:]))
    return Isotropic(
        float(B_voigt + B_reuss) / 2,
        float(G_voigt + G_reuss) / 2,
        float(B_voigt - B_reuss) / 2,
        float(G_voigt - G_reuss) / 2,
    )
