"""Relaxation of the ions of a cell, from springs on its bonds; eV and Å."""

from dataclasses import dataclass

import numpy as np
from ase import Atoms
from ase.calculators.calculator import Calculator


@dataclass(frozen=True)
class Springs:
    """Springs after the forces that a glass met on its way to rest; only the speed depends on them.

    Attributes
    ----------
    bond_A, edge_A : longest Si-N bond, longest edge of a tetrahedron of N
    along_eV_A2, across_eV_A2, along_edge_eV_A2 : springs along bonds, across them, and along edges
    floor_eV_A2 : spring under every coordinate
    longest_step_A : of an atom
    """

    bond_A: float = 2.3
    edge_A: float = 3.2
    along_eV_A2: float = 14.0
    across_eV_A2: float = 2.5
    along_edge_eV_A2: float = 3.5
    floor_eV_A2: float = 2.0
    longest_step_A: float = 0.3


SPRINGS = Springs()


def strained(atoms: Atoms, strain: float) -> Atoms:
    """The structure under isotropic linear strain, ions keeping their fractional coordinates."""
    result = Atoms(
        atoms.get_chemical_symbols(), positions=atoms.positions, cell=atoms.cell.array, pbc=True
    )
    result.set_cell(atoms.cell.array * (1 + strain), scale_atoms=True)
    return result


def spring_hessian(atoms: Atoms, springs: Springs = SPRINGS) -> np.ndarray:
    """Hessian by springs on unlike bonds and on edges between N, (3n, 3n), eV/Å²."""
    from ase.neighborlist import neighbor_list

    symbols = np.array(atoms.get_chemical_symbols())
    stretched = []  # weighted slopes of the springs' lengths by every coordinate
    for i, j, vector in zip(*neighbor_list("ijD", atoms, springs.edge_A), strict=True):
        if i > j:
            continue  # the list names every pair twice
        length = np.linalg.norm(vector)
        projector = np.outer(vector, vector) / length**2
        if symbols[i] == symbols[j] == "N":
            directions = np.sqrt(springs.along_edge_eV_A2) * projector
        elif symbols[i] != symbols[j] and length <= springs.bond_A:
            across = np.sqrt(springs.across_eV_A2) * (np.eye(3) - projector)
            directions = np.sqrt(springs.along_eV_A2) * projector + across
        else:
            continue
        for direction in directions:
            slope = np.zeros((len(atoms), 3))
            slope[j] += direction
            slope[i] -= direction
            stretched.append(slope.ravel())
    slopes = np.array(stretched).reshape(-1, 3 * len(atoms))
    return slopes.T @ slopes + springs.floor_eV_A2 * np.eye(3 * len(atoms))


@dataclass(frozen=True)
class Relaxation:
    """What the relaxation of a glass did; by default nothing.

    Attributes
    ----------
    steps : ionic steps
    force_left_eV_A, converged : largest force left, and whether that met the goal
    energy_gained_eV : below the quenched cell
    gap_eV : between the highest occupied and the lowest empty level at the end; NaN if the engine
        does not tell
    failure : why a calculation failed; the ions are then those of the quenched glass
    """

    steps: int = 0
    force_left_eV_A: float = float("nan")
    converged: bool = False
    energy_gained_eV: float = 0.0
    gap_eV: float = float("nan")
    failure: str = ""


def relax_ions(atoms: Atoms, force_eV_A: float, max_steps: int) -> Relaxation:
    """Quasi-Newton relaxation of the ions (BFGS), cell fixed.

    It starts from the Hessian of the springs: from ASE's own start, a multiple of the unit matrix,
    a cell takes about three times as many steps.

    Raises
    ------
    CalculationFailed : of the engine.
    """
    from ase.optimize import BFGS

    class Cautious(BFGS):
        """BFGS whose soft directions are never taken for flat: no step overshoots along them."""

        def update(self, pos, forces, pos0, forces0):
            super().update(pos, forces, pos0, forces0)
            assert self.state is not None
            curvature, modes = np.linalg.eigh(self.state.hessian)
            self.state.hessian = modes * np.maximum(abs(curvature), SPRINGS.floor_eV_A2) @ modes.T

    atoms.get_forces()  # asked for first, so that the energy comes from the same calculation
    before = atoms.get_potential_energy()
    with Cautious(atoms, logfile=None, maxstep=SPRINGS.longest_step_A) as optimizer:
        optimizer.H0 = spring_hessian(atoms)
        converged = bool(optimizer.run(fmax=force_eV_A, steps=max_steps))
        left = float(np.linalg.norm(atoms.get_forces(), axis=1).max())
        gained = float(before - atoms.get_potential_energy())
        return Relaxation(int(optimizer.nsteps), left, converged, gained, last_gap_eV(atoms.calc))


def last_gap_eV(calculator: Calculator | None) -> float:
    """Gap between occupied and empty levels of a calculator; NaN if its engine does not tell."""
    return float(getattr(calculator, "gap_eV", np.nan))
