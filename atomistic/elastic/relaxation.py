"""Relaxation of the ions of a glass cell by density functional theory; eV and Å."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from ase import Atoms
from ase.calculators.calculator import CalculationFailed, Calculator

from atomistic.settings import RelaxationSettings

Progress = Callable[[float, str], None]
BOND_A = 2.3
STRETCH_EV_A2, BEND_EV_A2, FLOOR_EV_A2 = 25.0, 4.0, 2.0  # of a Si-N bond, about; only the speed depends on them
CELL_STIFFNESS_EV_A3 = 1.5  # 240 GPa; likewise


def strained(atoms: Atoms, strain: float) -> Atoms:
    """The structure under isotropic linear strain, ions keeping their fractional coordinates."""
    result = Atoms(atoms.get_chemical_symbols(), positions=atoms.positions, cell=atoms.cell.array, pbc=True)
    result.set_cell(atoms.cell.array * (1 + strain), scale_atoms=True)
    return result


def bond_hessian(atoms: Atoms) -> np.ndarray:
    """Hessian of springs along and across every bond between unlike atoms, shape (3n, 3n), eV/Å²."""
    from ase.neighborlist import neighbor_list

    symbols = atoms.get_chemical_symbols()
    hessian = FLOOR_EV_A2 * np.eye(3 * len(atoms))
    for i, j, bond in zip(*neighbor_list("ijD", atoms, BOND_A), strict=True):
        if symbols[i] != symbols[j]:
            projection = np.outer(bond, bond) / (bond @ bond)
            spring = STRETCH_EV_A2 * projection + BEND_EV_A2 * (np.eye(3) - projection)
            hessian[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] += spring
            hessian[3 * i : 3 * i + 3, 3 * j : 3 * j + 3] -= spring
    return hessian


class Rest(NamedTuple):
    """Where a relaxation of ions ended.

    Attributes
    ----------
    steps : ionic steps
    force_left_eV_A, converged : largest force left, and whether it is below the goal
    hessian_eV_A2 : as the optimiser has it in the end, (3n, 3n); where the cell relaxes, nine rows of it follow
    depth_eV : how far the minimum lies below, by that Hessian and the forces left
    """

    steps: int
    force_left_eV_A: float
    converged: bool
    hessian_eV_A2: np.ndarray
    depth_eV: float


def relax_ions(atoms: Atoms, force_eV_A: float, max_steps: int, hessian: np.ndarray | None = None) -> Rest:
    """Quasi-Newton relaxation of the ions (BFGS), cell fixed.

    Parameters
    ----------
    hessian : to start from, eV/Å²; None is a spring on every bond.  With ASE's own start, a multiple of the unit
        matrix, a cell takes about three times as many steps
    """
    return _minimise(atoms, atoms, force_eV_A, max_steps, bond_hessian(atoms) if hessian is None else hessian)


def relax_cell(atoms: Atoms, force_eV_A: float, max_steps: int, hessian: np.ndarray | None = None) -> Rest:
    """Quasi-Newton relaxation of ions and cell together until forces and all stresses nearly vanish.

    Parameters
    ----------
    force_eV_A : largest force left on an atom; a stress counts as the force that its strain exerts on a coordinate as
        stiff as a bond, in a cell of 28 atoms 0.1 eV/Å for 0.2 GPa
    hessian : to start from, eV/Å²; of the ions, or of ions and cell as a former relaxation left it
    """
    from ase.filters import FrechetCellFilter

    n = 3 * len(atoms)
    scale = np.sqrt(atoms.get_volume() * CELL_STIFFNESS_EV_A3 / STRETCH_EV_A2)
    known = bond_hessian(atoms) if hessian is None else hessian
    whole = STRETCH_EV_A2 * np.eye(n + 9)
    whole[: len(known), : len(known)] = known
    return _minimise(FrechetCellFilter(atoms, exp_cell_factor=scale), atoms, force_eV_A, max_steps, whole)


def _minimise(target: Any, atoms: Atoms, force_eV_A: float, max_steps: int, hessian: np.ndarray) -> Rest:
    """BFGS on what moves, the atoms themselves or a filter of them."""
    from ase.optimize import BFGS

    class Cautious(BFGS):
        """BFGS whose soft directions are never taken for flat ones: no step overshoots along them."""

        def update(self, pos, forces, pos0, forces0):
            super().update(pos, forces, pos0, forces0)
            assert self.state is not None
            curvature, modes = np.linalg.eigh(self.state.hessian)
            self.state.hessian = modes * np.maximum(abs(curvature), FLOOR_EV_A2) @ modes.T

    with Cautious(target, logfile=None, maxstep=0.15) as optimizer:
        optimizer.H0 = hessian
        converged = bool(optimizer.run(fmax=force_eV_A, steps=max_steps))
        forces = target.get_forces()
        final = np.asarray(optimizer.H0)
        if optimizer.state is not None:
            optimizer.update(target.get_positions().ravel(), forces.ravel(), optimizer.pos0, optimizer.forces0)
            final = np.asarray(optimizer.H)
        depth = 0.5 * float(forces.ravel() @ np.linalg.solve(final, forces.ravel()))
        left = float(np.linalg.norm(atoms.get_forces(), axis=1).max())
        return Rest(int(optimizer.nsteps), left, converged, final, depth)


def extrapolated_ions(rested: Mapping[float, Atoms], strain: float) -> Atoms:
    """Start of a relaxation at `strain`: along the line through the two nearest strains where ions came to rest."""
    first, *others = sorted(rested, key=lambda known: abs(known - strain))
    start = strained(rested[first], (1 + strain) / (1 + first) - 1)
    if others:
        moved = rested[first].get_scaled_positions(wrap=False) - rested[others[0]].get_scaled_positions(wrap=False)
        start.set_scaled_positions(
            start.get_scaled_positions(wrap=False) + moved * (strain - first) / (first - others[0])
        )
    return start


@dataclass(frozen=True)
class Relaxation:
    """What the relaxation of a glass did.

    Attributes
    ----------
    steps : ionic steps
    force_left_eV_A, converged : largest force left, and whether that met the goal
    energy_gained_eV : below the quenched cell
    gap_eV : between the highest occupied and the lowest empty level at the end; NaN if the engine does not tell
    failure : why a calculation failed; the ions are then those of the quenched glass
    """

    steps: int
    force_left_eV_A: float
    converged: bool
    energy_gained_eV: float
    gap_eV: float
    failure: str = ""


UNTOUCHED = Relaxation(0, float("nan"), False, 0.0, float("nan"))


def relax_glass(
    atoms: Atoms, calculator: Calculator, settings: RelaxationSettings, progress: Progress | None = None
) -> tuple[Atoms, Relaxation, np.ndarray]:
    """Relax the ions of a glass in its cell, for as many steps as the settings afford.

    The cell keeps shape and size: its volume is found by the E(V) scan, stress anisotropy is left in it.

    Returns
    -------
    the relaxed cell, how it came to rest, and the Hessian of its ions, (3n, 3n), eV/Å²
    """
    current = strained(atoms, 0.0)
    springs = bond_hessian(atoms)
    if settings.max_steps == 0:
        return current, UNTOUCHED, springs
    current.calc = calculator
    if progress:
        progress(0.0, f"relaxing ions, at most {settings.max_steps} steps")
    try:
        current.get_forces()  # asked for first, so that the energy comes from the same calculation
        before = current.get_potential_energy()
        rest = relax_ions(current, settings.force_eV_A, settings.max_steps, springs)
        gained = float(before - current.get_potential_energy())
    except CalculationFailed as error:
        # the E(V) scan of this structure will meet the same trouble and name the strains; the others go on
        return strained(atoms, 0.0), replace(UNTOUCHED, failure=f"relaxation: {error}"), springs
    gap = float(getattr(calculator, "gap_eV", np.nan))
    done = Relaxation(rest.steps, rest.force_left_eV_A, rest.converged, gained, gap)
    return strained(current, 0.0), done, rest.hessian_eV_A2
