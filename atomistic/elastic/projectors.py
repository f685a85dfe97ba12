"""Nonlocal part of GTH pseudopotentials at the Γ point: how its energy changes with the ions and with strain."""

from typing import Any

import numpy as np
from pyscf.pbc.gto.pseudo import pp_int

SLOPES = ("int1e_ipovlp", "int1e_r2_origi_ip2", "int1e_r4_origi_ip2")  # <p|∇µ>; the first with ∇ on the projector


def nonlocal_slopes(cell: Any, dm: np.ndarray, step_of_k: float | None) -> tuple[np.ndarray, np.ndarray]:
    """dE/dR of every ion and dE/dε of E = Σ D_µν <µ|p> h <p|ν> (Hartwigsen et al., PRB 58, 3641 (1998)).

    An overlap of a projector and an orbital depends on the vector between their centres alone.  Under a strain that
    vector changes by ε times itself; the lattice vectors in it come from the slope by k of the Bloch sums.

    Parameters
    ----------
    cell : PySCF's
    dm : density matrix, (orbitals, orbitals)
    step_of_k : 1/bohr, a small one; None asks for no strain

    Returns
    -------
    (ions, 3) hartree/bohr and (3, 3) hartree, zero without `step_of_k`
    """
    k_points = np.vstack([np.zeros(3), (step_of_k or 0.0) * np.eye(3)])[: 1 if step_of_k is None else 4]
    projectors, strengths = pp_int.fake_cell_vnl(cell)
    overlaps = pp_int._int_vnl(cell, projectors, strengths, k_points[:1])
    slopes = pp_int._int_vnl(cell, projectors, strengths, k_points, SLOPES, 3)
    centres, atoms = cell.atom_coords(), orbital_atoms(cell)
    by_ion, by_strain = np.zeros((cell.natm, 3)), np.zeros((3, 3))
    taken = [0, 0, 0]
    for block, strength in enumerate(strengths):
        rows = []
        for i in range(len(strength)):
            rows.append(slice(taken[i], taken[i] + 2 * projectors.bas_angular(block) + 1))
            taken[i] = rows[i].stop
        ion = projectors.bas_atom(block)
        onto = [np.real(overlaps[j][0][rows[j]]) @ dm for j in range(len(strength))]
        for i, row in enumerate(rows):
            # 2 from bra and ket; the orbital's centre moves against ∇µ
            weight = (-2 if i else 2) * sum(h * part for h, part in zip(strength[i], onto, strict=True))
            per_orbital = np.einsum("xpu,pu->ux", np.real(slopes[i][0][:, row]), weight)
            np.add.at(by_ion, atoms, per_orbital)
            by_ion[ion] -= per_orbital.sum(axis=0)
            by_strain += per_orbital.T @ (centres[atoms] - centres[ion])
            for axis, slope in enumerate(slopes[i][1:]):
                by_strain[:, axis] += np.einsum("xpu,pu->x", np.imag(slope[:, row]), weight) / step_of_k
    return by_ion, by_strain


def orbital_atoms(cell: Any) -> np.ndarray:
    """The atom of every orbital, (orbitals,)."""
    return np.repeat(np.arange(cell.natm), np.diff(cell.aoslice_by_atom()[:, 2:]).ravel())
