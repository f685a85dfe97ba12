"""Time E(V) of β-Si3N4 by the cached-grid SCF beside PySCF's own multigrid, in one run, on one thread.

python -m benchmarks.elastic [--atoms 14|28] [--cutoff 100] [--whole]

Prints, for PBE, a five-point curve (±3 %) of each engine with its B; without --whole the multigrid evaluates its
potential twice at the cached grid's density of the first point, and its curve is estimated as the faster of the two, as
often as the cached grid needs a potential.  Then the difference to PySCF's FFTDF of the energy at one and the same
density, for LDA and PBE.
"""

import argparse
import os

os.environ.setdefault("OMP_NUM_THREADS", "1")  # before any library starts its threads

import time
from pathlib import Path
from typing import Any

import numpy as np
from ase import Atoms
from ase.units import Hartree

from atomistic.elastic.dft import FUNCTIONALS, PyscfGamma, Solution, build_cell, commensurate_mesh
from atomistic.elastic.equation_of_state import fit_equation_of_state
from atomistic.elastic.networks import crystal
from atomistic.elastic.relaxation import strained
from atomistic.materials import load_material

STRAINS = (0.0, 0.015, -0.015, 0.03, -0.03)  # in the order of the elastic stage
BASIS = "gth-dzvp-molopt-sr"
MATERIAL = Path(__file__).parents[1] / "config/materials/silicon_nitride.yaml"


def beta(atoms: int) -> Atoms:
    """β-Si3N4 with 14 atoms per repeat along c."""
    return crystal(load_material(MATERIAL), "beta", (1, 1, atoms // 14))


def curve(cell: Atoms, numerics: str, cutoff_Ha: float) -> tuple[list[dict[str, float]], list[Solution]]:
    """A PBE curve: volume, energy, cycles and wall time of each, and the orbitals."""
    mesh = commensurate_mesh(cell.cell.array * (1 + max(STRAINS)), cutoff_Ha)
    engine = PyscfGamma(xc="GGA", basis=BASIS, mesh=mesh, tolerance_Ha=1e-6, numerics=numerics)
    rows = []
    for strain in STRAINS:
        trial = strained(cell, strain)
        trial.calc = engine
        start = time.perf_counter()
        energy = trial.get_potential_energy()
        seconds = time.perf_counter() - start
        rows.append({"V": trial.get_volume(), "E": energy, "cycles": engine.scf_cycles, "s": seconds})
        print(
            f"  {numerics:12} strain {strain:+.3f}: {energy:.5f} eV, {engine.scf_cycles} cycles, {seconds:.1f} s",
            flush=True,
        )
    return rows, engine.history


def multigrid_potential(cell: Atoms, cutoff_Ha: float, solution: Solution) -> tuple[float, float]:
    """Wall time of one potential by PySCF's multigrid, s, and its energy at the density of `solution`, eV."""
    from pyscf import lib
    from pyscf.pbc import dft

    pyscf_cell = build_cell(cell, "GGA", BASIS, commensurate_mesh(cell.cell.array * (1 + max(STRAINS)), cutoff_Ha))
    mf: Any = dft.RKS(pyscf_cell, xc=FUNCTIONALS["GGA"][0]).multigrid_numint()
    c = solution.orbitals
    density = lib.tag_array(2 * c @ c.T, mo_coeff=c, mo_occ=np.full(c.shape[1], 2.0))
    core = mf.get_hcore()
    seconds: list[float] = []
    potential: Any = None
    for _ in range(2):
        start = time.perf_counter()
        potential = mf.get_veff(pyscf_cell, density)
        seconds.append(time.perf_counter() - start)
        print(f"  multigrid    one potential: {seconds[-1]:.1f} s", flush=True)
    return min(seconds), float(mf.energy_tot(density, core, potential)) * Hartree


def difference_to_fftdf(cell: Atoms, xc: str, cutoff_Ha: float) -> float:
    """Energy of the cached grid minus that of FFTDF at the cached grid's converged density, Ha/atom."""
    from pyscf.pbc import dft
    from pyscf.pbc.dft import numint

    from atomistic.elastic.gamma_scf import CachedGrid

    pyscf_cell = build_cell(cell, xc, "gth-szv-molopt-sr", commensurate_mesh(cell.cell.array, cutoff_Ha))
    mf: Any = dft.RKS(pyscf_cell, xc=FUNCTIONALS[xc][0])
    mf.verbose = 0
    mf._numint = CachedGrid(pyscf_cell)
    energy = mf.kernel()
    density = np.asarray(mf.make_rdm1())
    other: Any = dft.RKS(pyscf_cell, xc=FUNCTIONALS[xc][0])
    other.grids.build()
    exc = numint.NumInt().nr_rks(pyscf_cell, other.grids, other.xc, density)[1]
    hartree = other.with_df.get_jk(density, with_k=False)[0]
    reference = np.einsum("ij,ji", other.get_hcore() + 0.5 * hartree, density) + exc + pyscf_cell.energy_nuc()
    return float(energy - reference) / len(cell)


def modulus(rows: list[dict[str, float]]) -> str:
    fit = fit_equation_of_state([row["V"] for row in rows], [row["E"] for row in rows])
    return f"B {fit.B_GPa:.1f} GPa, V0 {fit.V0_A3:.2f} A3, residual {fit.residual_meV:.3f} meV"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--atoms", type=int, choices=(14, 28), default=28, help="atoms of the cell")
    parser.add_argument("--cutoff", type=float, default=100.0, help="plane-wave cutoff, hartree")
    parser.add_argument("--whole", action="store_true", help="all five points by the multigrid too (many minutes)")
    options = parser.parse_args()
    cell = beta(options.atoms)
    ours, orbitals = curve(cell, "cached-grid", options.cutoff)
    total = sum(row["s"] for row in ours)
    if options.whole:
        theirs = curve(cell, "multigrid", options.cutoff)[0]
        other, energy, how = sum(row["s"] for row in theirs), theirs[0]["E"], modulus(theirs)
    else:
        seconds, energy = multigrid_potential(cell, options.cutoff, orbitals[0])
        potentials = sum(row["cycles"] + 1 for row in ours)
        other, how = seconds * potentials, f"estimated as {potentials:.0f} potentials"
    print(f"cached grid  {total:8.1f} s a curve; {modulus(ours)}")
    print(f"multigrid    {other:8.1f} s a curve; {how}; {other / total:.1f} times the cached grid's")
    apart = (ours[0]["E"] - energy) / options.atoms * 1000
    print(f"same geometry, cached grid - multigrid: {apart:+.3f} meV/atom")
    small = beta(14)
    for xc in ("LDA", "GGA"):
        apart = difference_to_fftdf(small, xc, options.cutoff)
        print(f"energy at fixed density, cached grid - FFTDF, {xc}: {apart:+.1e} Ha/atom")


if __name__ == "__main__":
    main()
