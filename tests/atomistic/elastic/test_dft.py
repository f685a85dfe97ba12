"""The cached-grid Γ-point potential against PySCF's own FFTDF, and its forces against energy
differences.
"""

from typing import Any

import numpy as np
import pytest
from ase.build import bulk
from ase.units import Hartree

from atomistic.elastic.dft import (
    FUNCTIONALS,
    PyscfGamma,
    Solution,
    build_cell,
    extrapolated_orbitals,
)
from atomistic.elastic.orbitals_on_grid import atom_orbitals, collocate

MESH = (24, 24, 24)


def silicon(moved_A=0.1):
    atoms = bulk("Si", "diamond", 5.43)
    atoms.positions[0, 0] += moved_A
    return atoms


def test_orbitals_on_the_grid_are_pyscfs():
    cell = build_cell(silicon(), "GGA", "gth-dzvp-molopt-sr", MESH)
    values = collocate(atom_orbitals(cell), cell.lattice_vectors(), MESH, cell.nao)
    reference = cell.pbc_eval_gto("GTOval", cell.get_uniform_grids(MESH)).T
    # many periodic images of this small cell are each cut off at the cell's precision of 1e-8
    assert abs(values - reference).max() < 1e-6


@pytest.mark.parametrize(("xc", "tolerance_Ha"), [("LDA", 1e-7), ("GGA", 5e-4)])
def test_energy_at_fixed_density_against_fftdf(xc, tolerance_Ha):
    """LDA: the same discrete expression.  GGA: FFTDF takes gradients of orbitals, which differs by
    the mesh error.
    """
    from pyscf.pbc import dft
    from pyscf.pbc.dft import numint

    from atomistic.elastic.gamma_scf import CachedGrid

    cell = build_cell(silicon(), xc, "gth-szv", MESH)
    mf: Any = dft.RKS(cell, xc=FUNCTIONALS[xc][0])
    mf.verbose = 0
    mf._numint = CachedGrid(cell)
    energy = mf.kernel()
    dm = np.asarray(mf.make_rdm1())
    other: Any = dft.RKS(cell, xc=FUNCTIONALS[xc][0])
    other.grids.build()
    exc = numint.NumInt().nr_rks(cell, other.grids, other.xc, dm)[1]
    vj = other.with_df.get_jk(dm, with_k=False)[0]
    reference = np.einsum("ij,ji", other.get_hcore() + 0.5 * vj, dm) + exc + cell.energy_nuc()
    assert abs(energy - reference) / cell.natm < tolerance_Ha


def test_a_potential_that_lags_between_empty_orbitals_is_exact_on_filled_ones(monkeypatch):
    from pyscf.pbc import dft

    from atomistic.elastic import gamma_scf

    monkeypatch.setattr(gamma_scf, "LAG", 1.0)  # even far from the last full matrix
    cell = build_cell(silicon(), "GGA", "gth-dzvp-molopt-sr", MESH)
    mf: Any = dft.RKS(cell, xc="pbe")
    mf.verbose = 0
    mf._numint = grid = gamma_scf.CachedGrid(cell)
    mf.max_cycle = 1
    mf.kernel()
    first = mf.make_rdm1()
    mf.max_cycle = 20
    mf.kernel()
    second = mf.make_rdm1()
    filled = mf.mo_coeff[:, mf.mo_occ > 0]
    full = [np.asarray(grid.nr_rks(cell, None, "pbe", dm)[2]) for dm in (first, second)]
    grid.basis_overlap = mf.get_ovlp()
    grid._full = None
    lagging = [np.asarray(grid.nr_rks(cell, None, "pbe", dm)[2]) for dm in (first, second)]
    assert np.array_equal(lagging[0], full[0])
    assert abs(full[1] - full[0]).max() > 1e-4
    assert lagging[1] @ filled == pytest.approx(full[1] @ filled, abs=2e-6)
    assert lagging[1] == pytest.approx(lagging[1].T, abs=1e-12)
    assert abs(lagging[1] - full[1]).max() > 1e-5  # between empty orbitals


def test_an_scf_ends_the_same_whether_its_potentials_lag_or_not(monkeypatch):
    from atomistic.elastic import gamma_scf

    ends = []
    for lag in (0.0, 1.0):
        monkeypatch.setattr(gamma_scf, "LAG", lag)
        atoms = silicon(0.1)
        atoms.calc = PyscfGamma(basis="gth-dzvp-molopt-sr", mesh=MESH, tolerance_Ha=1e-9)
        ends.append((atoms.get_potential_energy(), atoms.get_forces()))
    for full, lagging, error in zip(*ends, (1e-6, 1e-3), strict=True):
        assert lagging == pytest.approx(full, abs=error)


def test_forces_are_the_slope_of_the_energy():
    calculator = PyscfGamma(basis="gth-szv", mesh=MESH, tolerance_Ha=1e-10)
    energies = []
    for moved in (0.105, 0.095):
        atoms = silicon(moved)
        atoms.calc = calculator
        energies.append(atoms.get_potential_energy())
    atoms = silicon(0.1)
    atoms.calc = calculator
    # the net force of the grid is removed from the forces (a few 1e-3 hartree/bohr)
    assert atoms.get_forces()[0, 0] == pytest.approx(-(energies[0] - energies[1]) / 0.01, abs=0.1)


def test_single_precision_moves_the_curvature_of_a_scan_by_less_than_a_ten_thousandth():
    """A hundredth of what the choices of the stage move; kernels of other processors round
    otherwise, by 1 to 3e-5.
    """
    energies_Ha = np.empty((2, 3))
    for row, tolerance in enumerate((1e-7, 0.99e-7)):  # single precision, and just below it double
        for column, strain in enumerate((-0.02, 0.0, 0.02)):
            atoms = silicon(0.05)
            atoms.set_cell(atoms.cell.array * (1 + strain), scale_atoms=True)
            atoms.calc = PyscfGamma(basis="gth-dzvp-molopt-sr", mesh=MESH, tolerance_Ha=tolerance)
            energies_Ha[row, column] = atoms.get_potential_energy() / Hartree
    single, double = energies_Ha @ np.array([1.0, -2.0, 1.0])
    assert np.abs(energies_Ha[0] - energies_Ha[1]).max() < 5e-7
    assert single == pytest.approx(double, rel=1e-4)


def test_replayed_series_is_the_same_to_the_last_bit_and_computes_nothing():
    store: dict = {}
    runs = []
    for _ in range(2):
        calculator = PyscfGamma(store=store, basis="gth-szv", mesh=MESH)
        energies = []
        for moved in (0.0, 0.05):
            atoms = silicon(moved)
            atoms.calc = calculator
            energies.append(atoms.get_potential_energy())
        runs.append((energies, calculator.scf_runs))
    assert runs[0][0] == runs[1][0]
    assert (runs[0][1], runs[1][1]) == (2, 0)


def test_a_nearly_dependent_basis_gives_the_energy_of_a_bound_solid():
    """GTH-DZVP is not optimised for solids: its functions overlap so much that the condition is
    large.
    """
    overlap = build_cell(silicon(), "GGA", "gth-dzvp", MESH).pbc_intor("int1e_ovlp")
    assert np.linalg.cond(overlap) > 1e3
    energies = []
    for basis in ("gth-dzvp", "gth-dzvp-molopt-sr"):
        atoms = silicon()
        atoms.calc = PyscfGamma(basis=basis, mesh=MESH, tolerance_Ha=1e-6)
        energies.append(atoms.get_potential_energy() / len(atoms))
    assert energies[0] == pytest.approx(energies[1], abs=1.0)


def test_orbitals_along_a_line_are_extrapolated_as_a_polynomial():
    """Rotating orbitals in a basis whose overlap changes: the start comes nearer with every former
    point.
    """

    def solution(t):
        overlap = np.eye(6) + 0.2 * np.outer(*2 * [np.cos(np.arange(6) + t)])
        raw = np.array([[np.cos(t * k / 2), np.sin(t * (5 - k) / 2 + k)] for k in range(6)])
        values, vectors = np.linalg.eigh(raw.T @ overlap @ raw)
        return Solution(overlap, raw @ (vectors / np.sqrt(values)) @ vectors.T)

    goal = solution(0.4)
    density = goal.orbitals @ goal.orbitals.T
    errors = []
    for count in (1, 2, 3):
        start = extrapolated_orbitals(
            [solution(t) for t in (0.25, 0.3, 0.35)[-count:]], goal.overlap
        )
        assert start is not None
        assert np.allclose(start.T @ goal.overlap @ start, np.eye(2))
        errors.append(np.linalg.norm(start @ start.T - density))
    assert errors[0] > 2 * errors[1] > 4 * errors[2]
    assert extrapolated_orbitals([], goal.overlap) is None

    # one geometry twice: overlaps alike but for rounding, orbitals not
    twin = solution(0.35)
    other = solution(0.1)._replace(overlap=twin.overlap + 1e-15 * np.eye(6))
    start = extrapolated_orbitals([other, twin], goal.overlap)
    assert start is not None
    assert np.linalg.norm(start @ start.T - density) == pytest.approx(errors[0])
