"""Is the cached-grid SCF exact, and how much faster is it than PySCF's own?

A five-point PBE curve of β-Si3N4 (±3 %, 28 atoms, one thread) beside PySCF's multigrid.  The
multigrid evaluates its potential twice at the cached grid's density of the first point; its curve
is estimated as the faster of the two, as often as the cached grid needs a potential.  Then the
difference to PySCF's FFTDF of the energy of 14 atoms at one density: for LDA the same discrete
expression; for GGA FFTDF takes gradients of orbitals, so they differ by the mesh. The first rows
were copied from a page of their commit, to the digits that it gave.
"""

import time
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from ase import Atoms
from ase.units import Hartree

from atomistic.elastic.dft import FUNCTIONALS, PyscfGamma, build_cell, commensurate_mesh
from atomistic.elastic.gamma_scf import CachedGrid
from atomistic.elastic.networks import crystal
from atomistic.elastic.relaxation import strained
from atomistic.materials import load_material
from evidence.record import ROOT

STRAINS = (0.0, 0.015, -0.015, 0.03, -0.03)  # in the order of the elastic stage
BASIS, SMALL_BASIS = "gth-dzvp-molopt-sr", "gth-szv-molopt-sr"


def arguments(parser: ArgumentParser) -> None:
    """Cut-off of the density."""
    parser.add_argument("--cutoff", type=float, default=100.0, help="hartree")


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """The curve beside the multigrid's, then energies beside FFTDF's."""
    material = load_material(ROOT / "config" / "materials" / "silicon_nitride.yaml")
    small, cell = (crystal(material, "beta", (1, 1, cells)) for cells in (1, 2))
    yield {
        "atoms": len(cell),
        "cutoff_Ha": given.cutoff,
        "xc": "GGA",
        **beside_multigrid(cell, given.cutoff),
    }
    for xc in ("LDA", "GGA"):
        apart = difference_to_fftdf(small, xc, given.cutoff)
        head = {"atoms": len(small), "cutoff_Ha": given.cutoff, "xc": xc, "other": "FFTDF"}
        yield {**head, "curve_s": None, "other_curve_s": None, "difference_Ha_atom": apart}


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Difference to FFTDF at 100 hartree, and how many times faster a curve at 80 is."""
    apart = {
        row["xc"]: abs(float(row["difference_Ha_atom"])) for row in rows if _is(row, "FFTDF", 100)
    }
    fast = next(row for row in reversed(rows) if _is(row, "multigrid", 80))
    return {
        "LDA": f"{apart['LDA']:.0e} Ha/atom",
        "GGA": f"{apart['GGA']:.0e} Ha/atom",
        "faster": f"{float(fast['other_curve_s']) / float(fast['curve_s']):.0f}",
    }


def _is(row: Mapping[str, str], other: str, cutoff_Ha: float) -> bool:
    return row["other"] == other and float(row["cutoff_Ha"]) == cutoff_Ha


def beside_multigrid(cell: Atoms, cutoff_Ha: float) -> dict[str, Any]:
    """Seconds of a PBE curve by both, and the difference of their energies at one density."""
    from pyscf import lib
    from pyscf.pbc import dft

    mesh = commensurate_mesh(cell.cell.array * (1 + max(STRAINS)), cutoff_Ha)
    engine = PyscfGamma(xc="GGA", basis=BASIS, mesh=mesh, tolerance_Ha=1e-6)
    seconds, potentials, energies, orbitals = 0.0, 0, [], []
    for strain in STRAINS:
        trial = strained(cell, strain)
        trial.calc = engine
        start = time.perf_counter()
        energies.append(trial.get_potential_energy())
        seconds += time.perf_counter() - start
        potentials += engine.scf_cycles + 1
        orbitals.append(engine.history[-1].orbitals)
    pyscf_cell = build_cell(cell, "GGA", BASIS, mesh)
    mf: Any = dft.RKS(pyscf_cell, xc=FUNCTIONALS["GGA"][0]).multigrid_numint()
    c = orbitals[0]
    density = lib.tag_array(2 * c @ c.T, mo_coeff=c, mo_occ=np.full(c.shape[1], 2.0))
    core, times, potential = mf.get_hcore(), [], None
    for _ in range(2):
        start = time.perf_counter()
        potential = mf.get_veff(pyscf_cell, density)
        times.append(time.perf_counter() - start)
    apart = energies[0] / Hartree - float(mf.energy_tot(density, core, potential))
    other = {"other": "multigrid", "curve_s": seconds, "other_curve_s": min(times) * potentials}
    return {**other, "difference_Ha_atom": apart / len(cell)}


def difference_to_fftdf(cell: Atoms, xc: str, cutoff_Ha: float) -> float:
    """Energy of the cached grid minus that of FFTDF at the cached grid's converged density,
    Ha/atom.
    """
    from pyscf.pbc import dft
    from pyscf.pbc.dft import numint

    pyscf_cell = build_cell(cell, xc, SMALL_BASIS, commensurate_mesh(cell.cell.array, cutoff_Ha))
    mf: Any = dft.RKS(pyscf_cell, xc=FUNCTIONALS[xc][0])
    mf.verbose = 0
    mf._numint = CachedGrid(pyscf_cell)
    energy = mf.kernel()
    density = np.asarray(mf.make_rdm1())
    other: Any = dft.RKS(pyscf_cell, xc=FUNCTIONALS[xc][0])
    other.grids.build()
    exc = numint.NumInt().nr_rks(pyscf_cell, other.grids, other.xc, density)[1]
    hartree = other.with_df.get_jk(density, with_k=False)[0]
    reference = (
        np.einsum("ij,ji", other.get_hcore() + 0.5 * hartree, density)
        + exc
        + pyscf_cell.energy_nuc()
    )
    return float(energy - reference) / len(cell)
