"""How a structure answers to small strains: elastic constants with ions clamped and relaxed; eV and Å inside.

Each strain is one calculation with clamped ions: its stress gives the clamped constants, its forces say where the ions
want to go.  What they gain by going there needs the Hessian K of the ions only along the six directions K⁻¹Λ, Λ the
slope of the forces by the strain::

    C_relaxed = C_clamped − Λᵀ K⁻¹ Λ / V          (Wu, Vanderbilt and Hamann, Phys. Rev. B 72, 035105 (2005), eq. 17)

K is measured by small displacements along a growing set of directions W that starts from a rough Hessian M: W = M⁻¹Λ,
then M⁻¹ of what is left.  The gain inside W is found exactly (Galerkin), a lower bound whose error is of second order
in the forces R that are left; Rᵀ M⁻¹ R estimates it and is added.

Differences are taken between both signs of a strain or displacement, each against the state at rest.  The two signs may
come from two engines, each with its own state at rest: one on a mesh and one on the mesh half a step aside, whose
ripples have opposite signs, so the mean of the two slopes has neither the ripple nor the next order of elasticity.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from ase import Atoms
from ase.calculators.calculator import Calculator

from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.elastic.tensor import Stiffness, deformation, fit_stiffness, green_lagrange, strain_states
from atomistic.errors import InputError

Progress = Callable[[float, str], None]
STRAIN = 0.005  # of the six strains, taken with both signs; 0.02 instead of 0.002 moves G of β-Si3N4 by 0.1 %
DISPLACEMENT_A = 0.01  # largest of an atom where the Hessian is measured; 0.1 moves G by 1.5 %
ROUNDS = 4  # times six directions; two are enough for most glasses, not for a soft one
TOLERANCE_GPA = 5.0  # of a constant's softening that may be estimated: a third of it is wrong, 1 % of G
NEGLIGIBLE = 0.01  # part of a direction that earlier ones leave: less is noise and not measured again


class InternalStrain(NamedTuple):
    """What ions gain by following a strain.

    Attributes
    ----------
    softening_eV : (6, 6) ΛᵀK⁻¹Λ, with an estimate of what the directions tried leave out
    left_eV : (6, 6) that estimate; without it the softening is a lower bound
    directions : along which the Hessian was measured
    softest_eV_A2 : least curvature along the directions tried
    """

    softening_eV: np.ndarray
    left_eV: np.ndarray
    directions: int
    softest_eV_A2: float


@dataclass(frozen=True)
class Response:
    """Elastic constants of a structure, GPa.

    Attributes
    ----------
    clamped : with ions at fixed fractional coordinates
    relaxed : (6, 6) with ions that follow
    relaxed_left : (6,) what of the softening of the diagonal of `relaxed` is estimated and not measured
    calculations : states at rest, strained and displaced that were computed
    softest_eV_A2 : least curvature met along the ions' displacements
    """

    clamped: Stiffness
    relaxed: np.ndarray
    relaxed_left: np.ndarray
    calculations: int
    softest_eV_A2: float


def elastic_response(
    atoms: Atoms,
    sides: tuple[Calculator, Calculator],
    hessian: np.ndarray,
    strain: float = STRAIN,
    displacement_A: float = DISPLACEMENT_A,
    rounds: int = ROUNDS,
    tolerance_GPa: float = TOLERANCE_GPA,
    progress: Progress | None = None,
) -> Response:
    """Elastic constants of a structure at rest, with clamped and with relaxed ions.

    Parameters
    ----------
    atoms : a structure whose forces nearly vanish
    sides : engines of the positive and of the negative strains and displacements; twice the same one, or two meshes
    hessian : rough Hessian of ions and cell as `relax_cell` leaves it, eV/Å²; the better, the fewer displacements.
        Only the ions' part, its first 3n rows and columns, is used
    strain : size of the strains
    displacement_A : largest displacement of an atom where the Hessian is measured
    rounds, tolerance_GPa : at most so many times six directions; fewer once no constant can fall by more than this

    Raises
    ------
    InputError
        strain beyond elasticity, a calculator without stress, or ions at a saddle
    CalculationFailed
        where the engine fails
    """
    states = strain_states(strain)
    if "stress" not in sides[0].implemented_properties:
        raise InputError(
            f"elastic constants: {type(sides[0]).__name__} gives no stress; choose an engine that does "
            "(elastic.dft.engine)"
        )
    rest = [strained_state(atoms, side, np.zeros(6)) for side in dict.fromkeys(sides)]
    at_rest = [rest[0], rest[-1]]
    stresses, forces = [], []
    for done, state in enumerate(states):
        if progress:
            progress(0.5 * done / len(states), f"strain {done + 1} of {len(states)}")
        side = int(state.sum() < 0)
        stress, force = strained_state(atoms, sides[side], state)
        stresses.append(stress + 0.5 * (at_rest[1 - side][0] - at_rest[side][0]))
        forces.append(force - at_rest[side][1])
    clamped = fit_stiffness(states, stresses)
    eta = np.array([green_lagrange(state) for state in states])
    follow = np.linalg.lstsq(np.hstack([np.ones((len(eta), 1)), eta]), np.array(forces), rcond=None)[0][1:]
    volume = atoms.get_volume()

    def push(direction: np.ndarray) -> np.ndarray:
        """K times a direction, by differences to both sides."""
        step = displacement_A / np.linalg.norm(direction.reshape(-1, 3), axis=1).max()
        up, down = (
            _forces(atoms, side, sign * step * direction) - force
            for side, sign, (_, force) in zip(sides, (1, -1), at_rest, strict=True)
        )
        return (down - up) / (2 * step)

    ions = 3 * len(atoms)
    inside = internal_strain(
        follow.T, push, hessian[:ions, :ions], rounds, tolerance_GPa / EV_PER_A3_IN_GPA * volume, progress
    )
    unit = EV_PER_A3_IN_GPA
    return Response(
        Stiffness(clamped.C * unit, clamped.stress * unit, clamped.error * unit),
        (clamped.C - inside.softening_eV / volume) * unit,
        np.diag(inside.left_eV) / volume * unit,
        len(rest) + len(states) + 2 * inside.directions,
        inside.softest_eV_A2,
    )


def strained_state(atoms: Atoms, calculator: Calculator, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cauchy's stress (6,), eV/Å³, and forces (3n,), eV/Å, pulled back to the unstrained frame, ions clamped."""
    F = deformation(strain)
    trial = Atoms(atoms.get_chemical_symbols(), positions=atoms.positions, cell=atoms.cell.array, pbc=True)
    trial.set_cell(atoms.cell.array @ F, scale_atoms=True)
    trial.calc = calculator
    stress = np.asarray(trial.get_stress())
    return stress, (trial.get_forces() @ F).ravel()


def _forces(atoms: Atoms, calculator: Calculator, moved: np.ndarray) -> np.ndarray:
    trial = Atoms(atoms.get_chemical_symbols(), positions=atoms.positions, cell=atoms.cell.array, pbc=True)
    trial.positions += moved.reshape(-1, 3)
    trial.calc = calculator
    return trial.get_forces().ravel()


def internal_strain(
    slope: np.ndarray,
    push: Callable[[np.ndarray], np.ndarray],
    hessian: np.ndarray,
    rounds: int,
    tolerance_eV: float,
    progress: Progress | None = None,
) -> InternalStrain:
    """What ions gain by following a strain, by block Galerkin steps.

    Parameters
    ----------
    slope : (3n, 6) Λ, the forces per strain, eV/Å
    push : K times a displacement (3n,), eV/Å²
    hessian : (3n, 3n) rough K, positive definite

    Raises
    ------
    InputError
        if the ions lie at a saddle, not at a minimum
    """
    size = len(slope)
    rigid = np.tile(np.eye(3), (size // 3, 1)) / np.sqrt(size / 3)
    slope = slope - rigid @ (rigid.T @ slope)
    directions, pushed = np.empty((size, 0)), np.empty((size, 0))
    left, softening, softest = slope, np.zeros((6, 6)), float("inf")
    for done in range(rounds):
        trial = np.linalg.solve(hessian, left)
        trial -= rigid @ (rigid.T @ trial)
        wanting = np.flatnonzero(np.einsum("ij,ij->j", left, trial) >= tolerance_eV)
        if not len(wanting):
            break
        for k in wanting:
            fresh = trial[:, k] - directions @ (directions.T @ trial[:, k])
            fresh -= directions @ (directions.T @ fresh)
            norm = np.linalg.norm(fresh)
            if norm < NEGLIGIBLE * np.linalg.norm(trial[:, k]):
                continue  # by symmetry, or because another strain brought it
            if progress:
                progress(0.5 + 0.5 * done / rounds, f"displacement {directions.shape[1] + 1}")
            directions = np.hstack([directions, fresh[:, None] / norm])
            pushed = np.hstack([pushed, push(fresh / norm)[:, None]])
        pushed -= rigid @ (rigid.T @ pushed)
        curvature = directions.T @ pushed
        curvature = 0.5 * (curvature + curvature.T)
        softest = float(np.linalg.eigvalsh(curvature)[0])
        if softest <= 0:
            raise InputError(
                f"elastic constants: the ions lie at a saddle, curvature {softest:.2g} eV/A2 along a displacement; "
                "relax them further"
            )
        weights = np.linalg.solve(curvature, directions.T @ slope)
        softening = (directions.T @ slope).T @ weights
        left = slope - pushed @ weights
    estimate = left.T @ np.linalg.solve(hessian, left)
    softening = softening + estimate
    softening, estimate = (0.5 * (matrix + matrix.T) for matrix in (softening, estimate))
    return InternalStrain(softening, estimate, directions.shape[1], softest)
