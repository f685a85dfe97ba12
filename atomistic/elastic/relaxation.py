"""Relaxation of the ions of a cell, or of ions and cell together, from springs on its bonds; eV and Å."""

from typing import Any, NamedTuple

import numpy as np
from ase import Atoms
from ase.calculators.calculator import Calculator

BOND_A, EDGE_A = 2.3, 3.2  # longest Si-N bond, longest edge of a tetrahedron of N
# of springs along bonds, across them, along edges and under every coordinate, after the forces that a glass met on its
# way to rest; only the speed depends on them
ALONG_EV_A2, ACROSS_EV_A2, EDGE_EV_A2, FLOOR_EV_A2 = 14.0, 2.5, 3.5, 2.0
LONGEST_STEP_A = 0.3
COORDINATE_EV_A2, CELL_STIFFNESS_EV_A3 = 25.0, 1.5  # of a bond, and 240 GPa: by these a strain counts as a coordinate


def strained(atoms: Atoms, strain: float) -> Atoms:
    """The structure under isotropic linear strain, ions keeping their fractional coordinates."""
    result = Atoms(atoms.get_chemical_symbols(), positions=atoms.positions, cell=atoms.cell.array, pbc=True)
    result.set_cell(atoms.cell.array * (1 + strain), scale_atoms=True)
    return result


def cell_scale_A(atoms: Atoms) -> float:
    """Length by which a strain becomes a coordinate as stiff as a bond."""
    return float(np.sqrt(atoms.get_volume() * CELL_STIFFNESS_EV_A3 / COORDINATE_EV_A2))


def spring_hessian(atoms: Atoms) -> np.ndarray:
    """Hessian of ions and cell by springs along and across bonds between unlike atoms and along edges between N.

    Shape (3n + 9, 3n + 9), eV/Å²; the last nine are the strain's components times `cell_scale_A`.
    """
    from ase.neighborlist import neighbor_list

    n, scale = len(atoms), cell_scale_A(atoms)
    symbols = np.array(atoms.get_chemical_symbols())
    stretched = []  # weighted slopes of the springs' lengths by every coordinate
    for i, j, vector in zip(*neighbor_list("ijD", atoms, EDGE_A), strict=True):
        if i > j:
            continue  # the list names every pair twice
        length = np.linalg.norm(vector)
        projector = np.outer(vector, vector) / length**2
        if symbols[i] == symbols[j] == "N":
            directions = np.sqrt(EDGE_EV_A2) * projector
        elif symbols[i] != symbols[j] and length <= BOND_A:
            directions = np.sqrt(ALONG_EV_A2) * projector + np.sqrt(ACROSS_EV_A2) * (np.eye(3) - projector)
        else:
            continue
        for direction in directions:
            slope = np.zeros((n + 3, 3))
            slope[j] += direction
            slope[i] -= direction
            strain = np.outer(vector, direction) / scale
            slope[n:] += 0.5 * (strain + strain.T)  # a turn costs nothing
            stretched.append(slope.ravel())
    slopes = np.array(stretched).reshape(-1, 3 * n + 9)
    return slopes.T @ slopes + FLOOR_EV_A2 * np.eye(3 * n + 9)


class Rest(NamedTuple):
    """Where a relaxation of ions ended.

    Attributes
    ----------
    steps : ionic steps
    force_left_eV_A, converged : largest force left, and whether it is below the goal
    hessian_eV_A2 : as the optimiser has it in the end, (3n, 3n), or (3n + 9, 3n + 9) where the cell relaxes
    """

    steps: int
    force_left_eV_A: float
    converged: bool
    hessian_eV_A2: np.ndarray


def relax_ions(atoms: Atoms, force_eV_A: float, max_steps: int) -> Rest:
    """Quasi-Newton relaxation of the ions (BFGS), cell fixed.

    It starts from the Hessian of the springs: from ASE's own start, a multiple of the unit matrix, a cell takes about
    three times as many steps.
    """
    n = 3 * len(atoms)
    return _minimise(atoms, atoms, force_eV_A, max_steps, spring_hessian(atoms)[:n, :n])


def relax_cell(atoms: Atoms, force_eV_A: float, max_steps: int, hessian: np.ndarray | None = None) -> Rest:
    """Quasi-Newton relaxation of ions and cell together until forces and all stresses nearly vanish.

    Parameters
    ----------
    force_eV_A : largest force left on an atom; a stress counts as the force that its strain exerts on a coordinate as
        stiff as a bond, in a cell of 28 atoms 0.1 eV/Å for 0.2 GPa
    hessian : of ions and cell to start from, as a former relaxation left it; None takes springs
    """
    from ase.filters import FrechetCellFilter

    target = FrechetCellFilter(atoms, exp_cell_factor=cell_scale_A(atoms))
    return _minimise(target, atoms, force_eV_A, max_steps, spring_hessian(atoms) if hessian is None else hessian)


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

    with Cautious(target, logfile=None, maxstep=LONGEST_STEP_A) as optimizer:
        optimizer.H0 = hessian
        converged = bool(optimizer.run(fmax=force_eV_A, steps=max_steps))
        forces = target.get_forces()
        final = np.asarray(optimizer.H0)
        if optimizer.state is not None:
            optimizer.update(target.get_positions().ravel(), forces.ravel(), optimizer.pos0, optimizer.forces0)
            final = np.asarray(optimizer.H)
        left = float(np.linalg.norm(atoms.get_forces(), axis=1).max())
        return Rest(int(optimizer.nsteps), left, converged, final)


def last_gap_eV(calculator: Calculator) -> float:
    """Gap between occupied and empty levels that a calculator found last; NaN if its engine does not tell."""
    return float(getattr(calculator, "gap_eV", np.nan))
