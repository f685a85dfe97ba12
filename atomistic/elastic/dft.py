"""Periodic density functional theory behind ASE's interface: PySCF at a supercell's Γ point.

Energies in eV, lengths in Å, forces in eV/Å outside; PySCF's atomic units inside.  Pseudopotentials
are GTH, the basis a short-ranged MOLOPT one.  The real-space mesh can be held fixed while the cell
is strained: without that the number of grid points jumps along E(V) and so does the energy.
"""

import hashlib
from collections.abc import MutableMapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from ase import Atoms
from ase.calculators.calculator import CalculationFailed, Calculator, all_changes
from ase.units import Bohr, Hartree

from atomistic.settings import DftSettings

FUNCTIONALS = {
    # name: (PySCF functional, GTH pseudopotential generated with it)
    "GGA": ("pbe", "gth-pbe"),
    "LDA": ("lda_xc_teter93", "gth-pade"),
}

Store = MutableMapping[str, dict[str, np.ndarray]]
"""Finished calculations by key; the caller decides whether it lives in memory or on disk."""


@dataclass(frozen=True)
class ScfNumerics:
    """How tightly energies converge; no scene sets it."""

    energy_tolerance_Ha: float = 1e-6
    """Per cell; B of β-Si3N4 is then within 0.01 % of its value at 1e-8."""

    forces_tolerance_Ha: float = 1e-7
    """The same where forces are computed."""

    max_cycles: int = 50
    """A glass with a gap takes 8 to 14."""

    coarse: float = 0.6
    """Mesh on which an SCF without a former one starts, over the mesh: a fifth of the points."""

    coarse_tolerance_Ha: float = 1e-3
    """Of that start."""

    single_precision_Ha: float = 1e-7
    """SCF tolerance from which orbitals on the grid need no double precision."""

    rounding_Ha: float = 5e-8
    """Per atom: in single precision the energy's jitter from cycle to cycle is below it."""

    history: int = 5
    """Former solutions a start is extrapolated from."""

    guess_damping: float = 1e-7
    """Of the weights' normal equations."""


SCF = ScfNumerics()


class Solution(NamedTuple):
    """What the next calculation's start needs of a finished one: overlap and occupied orbitals."""

    overlap: np.ndarray
    orbitals: np.ndarray


class ScfNotConverged(CalculationFailed):
    """The self-consistent field did not converge (or ended in something that is not a number)."""


def commensurate_mesh(cell: np.ndarray, cutoff_Ha: float) -> tuple[int, int, int]:
    """Smallest FFT-friendly mesh whose plane waves all reach `cutoff_Ha` in this cell (Å)."""
    from scipy.fft import next_fast_len

    # the largest |G·a|/2π inside a sphere of radius G_max
    edges = np.linalg.norm(np.asarray(cell) / Bohr, axis=1)
    reach = np.sqrt(2 * cutoff_Ha) * edges / (2 * np.pi)
    counts = [2 * int(np.ceil(waves)) + 1 for waves in reach]
    a, b, c = (int(next_fast_len(count, real=True) or 1) for count in counts)
    return a, b, c


def build_cell(
    atoms: Atoms, xc: str, basis: str, mesh: tuple[int, int, int], precision: float = 1e-8
):
    """PySCF cell of an ASE structure; positions stay in the cell they were given in.

    Raises
    ------
    CalculationFailed
        for an odd number of electrons, which no closed shell holds
    """
    from pyscf.pbc import gto

    cell: Any = gto.Cell()  # PySCF declares its attributes as None
    cell.unit = "B"
    cell.a = atoms.cell.array / Bohr
    places = zip(atoms.get_chemical_symbols(), atoms.positions, strict=True)
    cell.atom = [(symbol, position / Bohr) for symbol, position in places]
    cell.basis = basis
    cell.pseudo = FUNCTIONALS[xc][1]
    cell.precision = precision
    cell.mesh = list(mesh)
    cell.verbose = 0
    cell.build(dump_input=False, parse_arg=False)
    if cell.nelectron % 2:
        raise CalculationFailed(
            f"{atoms.get_chemical_formula()} has an odd number of electrons: closed shells only;"
            " give it another atom"
        )
    return cell


class PyscfGamma(Calculator):
    """ASE calculator: closed-shell Kohn–Sham DFT of a supercell at its Γ point.

    The potential is that of `atomistic.elastic.gamma_scf`. Each calculation starts from the
    occupied orbitals of the last ones, extrapolated to the new geometry (`extrapolated_orbitals`),
    which saves more than half of the cycles. They are part of the key in `store`, so a series that
    is interrupted and replayed gives the same numbers to the last bit.

    Parameters
    ----------
    xc : "GGA" (PBE) or "LDA" (Teter–Padé, the functional of the GTH-PADE pseudopotentials)
    basis : PySCF's name of a GTH basis
    cutoff_Ha : plane-wave cutoff of the density mesh, hartree
    mesh : grid points along each lattice vector; None takes it from `cutoff_Ha` and the cell at
        hand
    tolerance_Ha : SCF convergence of the energy per cell, hartree
    max_cycles : SCF cycles before giving up
    store : finished calculations; one found there is not repeated
    """

    parameters: Any  # a dictionary with attributes (ASE)

    implemented_properties = ["energy", "forces"]  # noqa: RUF012 (ASE's interface)
    default_parameters: dict[str, Any] = {  # noqa: RUF012
        "xc": "GGA",
        "basis": "gth-dzvp-molopt-sr",
        "cutoff_Ha": 100.0,
        "mesh": None,
        "tolerance_Ha": 1e-7,
        "max_cycles": 60,
    }

    def __init__(self, store: Store | None = None, **parameters):
        super().__init__(**parameters)
        self.store: Store = store if store is not None else {}
        self.history: list[Solution] = []  # the last ones that converged, oldest first
        self.scf_runs = 0  # calculations really done, not taken from the store
        self.scf_cycles = 0
        self.gap_eV = float("nan")  # of the last calculation

    def calculate(self, atoms=None, properties=("energy",), system_changes=all_changes):
        super().calculate(atoms, properties, system_changes)
        assert self.atoms is not None
        p = self.parameters
        mesh = p.mesh or commensurate_mesh(self.atoms.cell.array, p.cutoff_Ha)
        quantity = "forces" if "forces" in properties else "energy"
        key = self._key(mesh, quantity)
        if key not in self.store:
            self.store[key] = self._solve(mesh, quantity)
            self.scf_runs += 1
        solved = self.store[key]
        self.scf_cycles = int(solved["cycles"])
        self.gap_eV = float(solved["gap_Ha"]) * Hartree
        if not bool(solved["converged"]):
            self.history = []
            raise ScfNotConverged(
                f"SCF not converged in {p.max_cycles} cycles (gap {self.gap_eV:.2f} eV)"
            )
        solution = Solution(solved["overlap"], solved["orbitals"])
        self.history = [*self.history, solution][-SCF.history :]
        energy = float(solved["energy_Ha"]) * Hartree
        self.results: dict[str, Any] = {"energy": energy, "free_energy": energy}
        if quantity == "forces":
            self.results["forces"] = solved["forces"] * Hartree / Bohr

    def check_state(self, atoms, tol=1e-15):
        return super().check_state(atoms, tol=tol)

    def _key(self, mesh, quantity: str) -> str:
        assert self.atoms is not None
        choices = (sorted(self.parameters.items()), tuple(mesh), quantity)
        digest = hashlib.sha256(repr(choices).encode())
        digest.update(" ".join(self.atoms.get_chemical_symbols()).encode())
        before = [solution.orbitals for solution in self.history]
        for array in (self.atoms.cell.array, self.atoms.positions, *before):
            digest.update(np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()[:32]

    def _mean_field(self, mesh) -> Any:
        """PySCF's calculation of the structure at hand on a mesh."""
        from pyscf.pbc import dft

        from atomistic.elastic.gamma_scf import CachedGrid

        p = self.parameters
        assert self.atoms is not None
        cell = build_cell(self.atoms, p.xc, p.basis, mesh)
        mf: Any = dft.RKS(cell)
        mf.xc = FUNCTIONALS[p.xc][0]
        mf.verbose = 0
        single = p.tolerance_Ha >= SCF.single_precision_Ha
        # the gradient feels no rounding and decides: its square is about the error of the energy
        mf.conv_tol = p.tolerance_Ha
        mf.conv_tol_grad = np.sqrt(p.tolerance_Ha) * 10
        if single:
            mf.conv_tol = max(p.tolerance_Ha, SCF.rounding_Ha * cell.natm)
            mf.conv_tol_grad = np.sqrt(p.tolerance_Ha)
        mf.max_cycle = p.max_cycles
        # the extra cycle after convergence would change the energy by less than the tolerance
        mf.conv_check = False
        mf._numint = CachedGrid(cell, np.float32 if single else np.float64)
        return mf

    def _solve(self, mesh, quantity: str) -> dict[str, np.ndarray]:
        mf = self._mean_field(mesh)
        # half the time of PySCF's own call
        overlap = np.asarray(mf.cell.pbc_intor("int1e_ovlp", hermi=1))
        self._keep_overlap(mf, overlap)
        energy = mf.kernel(self._guess(mf.cell, overlap))
        converged = bool(mf.converged) and bool(np.isfinite(energy))
        filled = np.asarray(mf.mo_occ) > 0
        levels = np.asarray(mf.mo_energy)
        occupied = np.asarray(mf.mo_coeff)[:, filled]
        gap_Ha = np.inf
        if not filled.all():
            gap_Ha = levels[~filled].min() - levels[filled].max()
        solved = {
            "energy_Ha": np.array(energy),
            "converged": np.array(converged),
            "cycles": np.array(mf.cycles),
            "orbitals": occupied,
            "overlap": overlap,
            "gap_Ha": np.array(gap_Ha),
        }
        if quantity == "forces" and converged:
            solved["forces"] = mf._numint.forces(mf)
        return solved

    @staticmethod
    def _keep_overlap(mf: Any, overlap: np.ndarray) -> None:
        mf.get_ovlp = lambda *_: overlap  # asked for again and again
        mf._numint.basis_overlap = overlap

    def _guess(self, cell, overlap: np.ndarray) -> Any:
        """Density matrix of extrapolated orbitals, else that of a loose SCF on a coarse mesh."""
        from pyscf import lib

        shape = (cell.nao, cell.nelectron // 2)
        c = extrapolated_orbitals(
            [old for old in self.history if old.orbitals.shape == shape], overlap
        )
        if c is not None:
            return lib.tag_array(2 * c @ c.T, mo_coeff=c, mo_occ=np.full(c.shape[1], 2.0))
        coarse = self._mean_field(tuple(int(np.ceil(SCF.coarse * n)) for n in cell.mesh))
        self._keep_overlap(coarse, overlap)
        coarse.conv_tol = SCF.coarse_tolerance_Ha
        coarse.conv_tol_grad = 10 * np.sqrt(SCF.coarse_tolerance_Ha)
        coarse.kernel()  # where it does not converge the fine mesh goes on from where it ended
        return coarse.make_rdm1()


def make_calculator(
    dft: DftSettings,
    xc: str,
    largest_cell: np.ndarray,
    store: Store | None = None,
    forces: bool = False,
) -> PyscfGamma:
    """The DFT engine of the settings.

    Parameters
    ----------
    xc : "GGA" or "LDA"
    largest_cell : (3, 3) Å; the mesh is fixed to what this cell needs, so that it does not jump
        along a scan
    store : finished calculations
    forces : whether forces are wanted, not only energies
    """
    cutoff_Ha = dft.forces_cutoff_Ha if forces else dft.cutoff_Ha
    return PyscfGamma(
        store=store,
        xc=xc,
        cutoff_Ha=cutoff_Ha,
        mesh=commensurate_mesh(largest_cell, cutoff_Ha),
        tolerance_Ha=SCF.forces_tolerance_Ha if forces else SCF.energy_tolerance_Ha,
        max_cycles=SCF.max_cycles,
    )


def extrapolated_orbitals(history: Sequence[Solution], overlap: np.ndarray) -> np.ndarray | None:
    """Occupied orbitals, orthonormal for the basis of `overlap`; None without a history.

    The overlap describes the geometry: the combination of former ones, with weights that add to
    one, which comes nearest to it also combines the former orbitals, once each set is rotated onto
    the last one.  Along a line this is polynomial extrapolation; after Polack et al., J. Chem.
    Theory Comput. 17, 6965 (2021).
    """
    if not history:
        return None
    *older, last = history
    c = last.orbitals
    if older:
        known = np.stack([(old.overlap - last.overlap).ravel() for old in older])
        target = (overlap - last.overlap).ravel()
        gram = known @ known.T
        # also by the size of what is wanted: former geometries that differ by rounding alone get no
        # weight
        gram += SCF.guess_damping * (np.trace(gram) + target @ target) * np.eye(len(older))
        weights = np.linalg.lstsq(gram, known @ target)[0]  # tolerates repeated geometries
        c = (1 - weights.sum()) * c
        for weight, old in zip(weights, older, strict=True):
            left, _, right = np.linalg.svd(old.orbitals.T @ old.overlap @ last.orbitals)
            c = c + weight * old.orbitals @ (left @ right)
    values, vectors = np.linalg.eigh(c.T @ overlap @ c)
    if values.min() < 1e-4:
        return None
    return c @ (vectors / np.sqrt(values)) @ vectors.T
