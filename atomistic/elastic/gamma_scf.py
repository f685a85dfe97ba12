"""Γ-point Kohn–Sham potential with all orbitals kept on one uniform grid, for PySCF's `RKS`.

PySCF's multigrid evaluates every pair of Gaussians again in each cycle.  For cells of tens of atoms
the orbital values on the grid fit into memory (4 or 8 B × grid points × orbitals; 0.4 GB for 28
atoms of Si3N4 at 100 Ha), so here they are computed once per geometry and everything after that is
matrix algebra and FFTs::

    ρ(r) = Σ_i |Σ_µ C_µi φ_µ(r)|²,   V_µν = Σ_r w φ_µ(r) v(r) φ_ν(r),
    v = v_loc + v_Hartree + ∂f/∂ρ − ∇·(2 ∂f/∂σ ∇ρ),

with the GTH local pseudopotential v_loc, v_Hartree and all gradients by FFT.  For LDA this is
PySCF's FFTDF exactly, on the same grid.  For GGA, ∇ρ here is the derivative of the gridded density
(as in PySCF's multigrid and in plane-wave codes), whereas FFTDF takes it from orbital gradients:
the two differ by the error of the mesh. Because gradient and divergence are each other's negative
adjoints on the grid, V is the exact derivative of the discrete energy, and so are forces.  Atomic
units throughout.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.fft
from pyscf import lib
from pyscf.pbc.dft.multigrid import MultiGridNumInt2
from pyscf.pbc.gto import ewald_methods
from pyscf.pbc.gto.pseudo import pp_int
from pyscf.pbc.lib.kpts_helper import is_gamma_point

from atomistic.elastic.orbitals_on_grid import atom_orbitals, collocate, pulay_term

if TYPE_CHECKING:
    from pyscf.pbc.gto import Cell

# share of the electrons that may have moved since the last full matrix; 0.02 costs a cycle now and
# then
LAG = 0.002
BLOCK = 4096  # grid points per matrix product: a block of 364 orbitals stays in the cache


class CachedGrid(MultiGridNumInt2):
    """Numerical integration of `RKS` on a cached uniform grid (Γ point, closed shells, LDA or GGA).

    Use it as ``mf._numint = CachedGrid(cell)``; the local pseudopotential and the Hartree term are
    then part of `get_veff`, and `get_pp` returns the nonlocal pseudopotential only.

    Parameters
    ----------
    cell : built PySCF cell, all atoms with GTH pseudopotentials; its `mesh` is the grid
    precision : of the orbitals on the grid and of products with them; single precision rounds the
        energy by some 1e-7 hartree per atom, much the same for neighbouring geometries, and leaves
        1e-8 hartree from cycle to cycle

    Attributes
    ----------
    waves : orbitals of the last density on the grid, (orbitals, grid points)
    basis_overlap : of the basis functions, None until it is set; with it only the first potential
        of an SCF is a full matrix (`_matrix_of`)
    """

    def __init__(self, cell: "Cell", precision: type[np.floating] = np.float64):
        super().__init__(cell)
        self.precision = precision
        self.mesh = np.array(cell.mesh)
        self.points = int(np.prod(self.mesh))
        self.weight = cell.vol / self.points
        self.lattice = cell.lattice_vectors()
        self.atoms = atom_orbitals(cell, max(cell.precision, float(np.finfo(precision).eps)))
        self.orbitals = collocate(self.atoms, self.lattice, tuple(self.mesh), cell.nao, precision)
        self.wave_vectors = _wave_vectors(cell, self.mesh)
        g2 = np.einsum("xijk,xijk->ijk", self.wave_vectors[1], self.wave_vectors[1])
        self.coulomb = np.divide(4 * np.pi, g2, out=np.zeros_like(g2), where=g2 > 0)
        self.local_form = {s: local_pseudopotential(cell._pseudo[s], g2) for s in cell._pseudo}
        local = np.zeros(g2.shape, dtype=complex)
        for atom in range(cell.natm):
            local += self.local_form[cell.atom_symbol(atom)] * self._phase(cell.atom_coords()[atom])
        self.local = self._to_grid(local) / self.weight  # v_loc(r), hartree
        self.waves = np.empty((0, self.points), precision)
        self.basis_overlap: np.ndarray | None = None
        self._full: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None

    # -- Fourier helpers: half spectrum of real fields
    def _to_grid(self, spectrum: np.ndarray) -> np.ndarray:
        field = np.asarray(scipy.fft.irfftn(spectrum, s=tuple(self.mesh), axes=(-3, -2, -1)))
        return field.reshape(*spectrum.shape[:-3], -1)

    def _spectrum(self, field: np.ndarray) -> np.ndarray:
        on_mesh = field.reshape(*field.shape[:-1], *self.mesh)
        return np.asarray(scipy.fft.rfftn(on_mesh, axes=(-3, -2, -1)))

    def _phase(self, position: np.ndarray) -> np.ndarray:
        """exp(-iG·R) on the half spectrum."""
        fraction = position @ np.linalg.inv(self.lattice)
        n0, n1, n2 = self.mesh
        x = np.exp(-2j * np.pi * fraction[0] * scipy.fft.fftfreq(n0, 1 / n0))
        y = np.exp(-2j * np.pi * fraction[1] * scipy.fft.fftfreq(n1, 1 / n1))
        z = np.exp(-2j * np.pi * fraction[2] * scipy.fft.rfftfreq(n2, 1 / n2))
        return x[:, None, None] * y[None, :, None] * z

    def gradient(self, field: np.ndarray) -> np.ndarray:
        """∇ of a real field by FFT, shape (3, grid points)."""
        return self._to_grid(1j * self.wave_vectors[0] * self._spectrum(field))

    def divergence(self, vector: np.ndarray) -> np.ndarray:
        """∇· of a real vector field by FFT, shape (grid points,)."""
        return self._to_grid(
            np.einsum("xijk,xijk->ijk", 1j * self.wave_vectors[0], self._spectrum(vector))
        )

    # -- density and potential
    def occupied_orbitals(self, density_matrix: Any) -> tuple[np.ndarray, np.ndarray]:
        """Factor F (orbitals, n) and signs s with D = F diag(s) Fᵀ, from known orbitals."""
        coefficients = getattr(density_matrix, "mo_coeff", None)
        if coefficients is not None:
            occupation = density_matrix.mo_occ
            filled = occupation > 0
            orbitals = coefficients[:, filled] * np.sqrt(occupation[filled])
            return orbitals, np.ones(int(filled.sum()))
        values, vectors = np.linalg.eigh(np.asarray(density_matrix))
        keep = abs(values) > 1e-10 * abs(values).max()
        kept_values = values[keep]
        return vectors[:, keep] * np.sqrt(abs(kept_values)), np.sign(kept_values)

    def density(self, density_matrix: np.ndarray) -> np.ndarray:
        """ρ on the grid, shape (grid points,); `waves` then holds the orbitals it is made of."""
        factor, sign = self.occupied_orbitals(density_matrix)
        rows = factor.T.astype(self.precision)
        sign = sign.astype(self.precision)
        if self.waves.shape != (len(rows), self.points):
            self.waves = np.empty((len(rows), self.points), self.precision)
        rho = np.empty(self.points)
        for start in range(0, self.points, BLOCK):
            block = slice(start, start + BLOCK)
            waves = rows @ self.orbitals[:, block]
            self.waves[:, block] = waves
            np.multiply(waves, waves, out=waves)
            rho[block] = sign @ waves
        return rho

    def matrix(self, potential: np.ndarray) -> np.ndarray:
        """Σ_r w φ_µ v φ_ν, shape (orbitals, orbitals).

        Products of a block run in single precision and are summed in double: the energy is
        stationary in the orbitals and feels this error (1e-6 hartree per element) only squared.
        """
        total = np.zeros((len(self.orbitals),) * 2)
        weights = (self.weight * potential).astype(np.float32)
        for start in range(0, self.points, BLOCK):
            orbitals = self.orbitals[:, start : start + BLOCK].astype(np.float32, copy=False)
            total += (orbitals * weights[start : start + BLOCK]) @ orbitals.T
        return 0.5 * (total + total.T)

    def exchange_correlation(self, xc_code: str, rho: np.ndarray) -> tuple[float, np.ndarray]:
        """Energy (hartree) and potential on the grid."""
        if self._xc_type(xc_code) == "LDA":
            energy, potential = self.eval_xc_eff(xc_code, rho, deriv=1, xctype="LDA")[:2]
            return float(self.weight * (rho @ energy)), potential[0]
        if self._xc_type(xc_code) != "GGA":
            raise NotImplementedError(f"functional {xc_code}: only LDA and GGA")
        fields = np.concatenate([rho[None], self.gradient(rho)])
        energy, potential = self.eval_xc_eff(xc_code, fields, deriv=1, xctype="GGA")[:2]
        functional = potential[0] - self.divergence(potential[1:4])
        return float(self.weight * (rho @ energy)), functional

    def potential(self, xc_code: str, rho: np.ndarray) -> tuple[np.ndarray, float, float]:
        """Local potential, its electrostatic energy (Hartree + local pseudopotential) and E_xc."""
        hartree = self._to_grid(self.coulomb * self._spectrum(rho))
        electrostatic = float(self.weight * (rho @ (self.local + 0.5 * hartree)))
        exc, vxc = self.exchange_correlation(xc_code, rho)
        return self.local + hartree + vxc, electrostatic, exc

    # -- what PySCF's RKS calls
    def nr_rks(self, cell, grids, xc_code, dm_kpts, relativity=0, hermi=1, kpts=None, *_, **__):
        if kpts is not None and not is_gamma_point(kpts):
            raise NotImplementedError("CachedGrid is for the Γ point only: use a supercell")
        rho = self.density(dm_kpts)
        v, electrostatic, exc = self.potential(xc_code, rho)
        matrix = self._matrix_of(dm_kpts, rho, v)
        veff = lib.tag_array(matrix, ecoul=electrostatic, exc=exc, vj=None, vk=None)
        return float(rho.sum() * self.weight), exc, veff

    def _matrix_of(self, density_matrix: Any, rho: np.ndarray, potential: np.ndarray) -> np.ndarray:
        """`matrix` of a potential; after the first one only what touches occupied orbitals is new.

        With c the occupied orbitals, S the overlap, P = c cᵀ S and Q = 1 - P, the change δ of the
        matrix is replaced by

            δ - Qᵀ δ Q = U + Uᵀ,   U = (δ c - S c cᵀ δ c / 2) (S c)ᵀ,

        which is half the work or less. What lies between empty orbitals stays as it was in the last
        full matrix. The gradient of the orbitals is exact, so the SCF ends at the same solution.
        """
        has_orbitals = getattr(density_matrix, "mo_coeff", None) is not None
        if self.basis_overlap is not None and has_orbitals and self._full:
            full_matrix, old_rho, old_potential = self._full
            moved_electrons = self.weight * float(abs(rho - old_rho).sum())
            if moved_electrons < LAG * self.cell.nelectron:
                # orbitals and waves are of two electrons each
                orbitals, _ = self.occupied_orbitals(density_matrix)
                occupied = orbitals * np.sqrt(0.5)
                delta_c = np.sqrt(0.5) * self._onto_waves(potential - old_potential)
                overlap_c = self.basis_overlap @ occupied
                update = (delta_c - 0.5 * overlap_c @ (occupied.T @ delta_c)) @ overlap_c.T
                return full_matrix + update + update.T
        matrix = self.matrix(potential)
        self._full = (matrix, rho, potential)
        return matrix

    def _onto_waves(self, potential: np.ndarray) -> np.ndarray:
        """Σ_r w φ_µ v ψ_i with orbitals ψ of the last density, (basis functions, orbitals)."""
        weighted = (self.weight * potential).astype(self.precision)
        total = np.zeros((len(self.orbitals), len(self.waves)))
        for start in range(0, self.points, BLOCK):
            block = slice(start, start + BLOCK)
            total += self.orbitals[:, block] @ (self.waves[:, block] * weighted[block]).T
        return total

    def get_pp(self, kpts=None, return_full=False):
        return np.asarray(pp_int.get_pp_nl(self.cell)).real

    # -- forces
    def forces(self, mf: Any) -> np.ndarray:
        """Forces (atoms, 3), hartree/bohr: the exact derivative of the discrete energy.

        The grid breaks translation symmetry a little ("egg box"), so forces sum to ~1e-3: their
        mean is subtracted.
        """
        cell = self.cell
        dm = np.asarray(mf.make_rdm1())
        energy_weighted = (mf.mo_coeff * (mf.mo_occ * mf.mo_energy)) @ mf.mo_coeff.T
        gradient = ewald_methods.ewald_nuc_grad(cell) + nonlocal_slopes(cell, dm)
        # hermi 2: antihermitian, so PySCF computes half
        kinetic = -np.asarray(cell.pbc_intor("int1e_ipkin", hermi=2))
        overlap = -np.asarray(cell.pbc_intor("int1e_ipovlp", hermi=2))
        factor, _ = self.occupied_orbitals(mf.make_rdm1())
        rho = self.density(mf.make_rdm1())
        v, _, _ = self.potential(mf.xc, rho)
        weighted_waves = self.waves * (self.weight * v).astype(self.precision)
        spectrum = self._spectrum(rho)
        mesh = tuple(self.mesh)
        slices = cell.aoslice_by_atom()
        for atom in range(cell.natm):
            first, end = slices[atom, 2:]  # its orbitals
            kinetic_slope = np.real(kinetic[:, first:end])
            overlap_slope = np.real(overlap[:, first:end])
            on_grid = factor[first:end].astype(self.precision) @ weighted_waves
            energy_of_atom = energy_weighted[first:end]
            gradient[atom] += 2 * np.einsum("xuv,uv->x", kinetic_slope, dm[first:end])
            gradient[atom] -= 2 * np.einsum("xuv,uv->x", overlap_slope, energy_of_atom)
            gradient[atom] -= 2 * pulay_term(self.atoms[atom], self.lattice, mesh, on_grid)
            gradient[atom] += self._local_slope(atom, spectrum)
        return -(gradient - gradient.mean(axis=0))

    def _local_slope(self, atom: int, spectrum: np.ndarray) -> np.ndarray:
        """dE/dR of an atom's local pseudopotential in a density of that spectrum, (3,)."""
        # half spectrum: every wave vector but those in the planes k_z = 0 and Nyquist stands for
        # two
        twice = np.full(spectrum.shape[-1], 2.0)
        twice[0] = 1.0
        if self.mesh[2] % 2 == 0:
            twice[-1] = 1.0
        form = self.local_form[self.cell.atom_symbol(atom)]
        shifted = form * self._phase(self.cell.atom_coords()[atom])
        product = np.imag(shifted * spectrum.conj()) * twice
        return np.einsum("xijk,ijk->x", self.wave_vectors[1], product) / self.points


def nonlocal_slopes(cell: Any, dm: np.ndarray) -> np.ndarray:
    """dE/dR of ions, E = Σ D_µν <µ|p> h <p|ν> (PRB 58, 3641 (1998)), (ions, 3) hartree/bohr.

    An overlap of a projector and an orbital depends on the vector between their centres alone.

    Parameters
    ----------
    cell : PySCF's
    dm : density matrix, (orbitals, orbitals)
    """
    projectors, strengths = pp_int.fake_cell_vnl(cell)
    gamma = np.zeros((1, 3))
    overlaps = pp_int._int_vnl(cell, projectors, strengths, gamma)
    # <p|∇µ>; the first <∇p|µ>
    slopes = pp_int._int_vnl(
        cell,
        projectors,
        strengths,
        gamma,
        ("int1e_ipovlp", "int1e_r2_origi_ip2", "int1e_r4_origi_ip2"),
        3,
    )
    # of every orbital
    orbitals = np.diff(cell.aoslice_by_atom()[:, 2:]).ravel()
    atoms = np.repeat(np.arange(cell.natm), orbitals)
    by_ion = np.zeros((cell.natm, 3))
    taken = [0, 0, 0]
    for block, strength in enumerate(strengths):
        rows = []
        for i in range(len(strength)):
            rows.append(slice(taken[i], taken[i] + 2 * projectors.bas_angular(block) + 1))
            taken[i] = rows[i].stop
        onto = [np.real(overlaps[j][0][rows[j]]) @ dm for j in range(len(strength))]
        for i, row in enumerate(rows):
            # 2 from bra and ket; the orbital's centre moves against ∇µ
            sign = -2 if i else 2
            weight = sign * sum(
                h * projection for h, projection in zip(strength[i], onto, strict=True)
            )
            per_orbital = np.einsum("xpu,pu->ux", np.real(slopes[i][0][:, row]), weight)
            np.add.at(by_ion, atoms, per_orbital)
            by_ion[projectors.bas_atom(block)] -= per_orbital.sum(axis=0)
    return by_ion


def local_pseudopotential(pseudo: list, g2: np.ndarray) -> np.ndarray:
    """Fourier transform of the local GTH pseudopotential (PRB 54, 1703 (1996), eq. 5).

    Parameters
    ----------
    pseudo : PySCF's parsed GTH entry
    g2 : squared length of G, 1/bohr²; at G = 0 the divergence is left out (it cancels against
        Hartree and Ewald terms)
    """
    charge = sum(pseudo[0])
    radius, n, c = pseudo[1:4]
    c = list(c[:n]) + [0.0] * (4 - n)
    x2 = g2 * radius**2
    constant_term = c[0] + c[1] * (3 - x2)
    fourth = 15 - 10 * x2 + x2**2
    sixth = 105 - 105 * x2 + 21 * x2**2 - x2**3
    polynomial = constant_term + c[2] * fourth + c[3] * sixth
    gauss = np.exp(-0.5 * x2)
    at_zero = np.full_like(g2, 2 * np.pi * charge * radius**2)
    numerator = -4 * np.pi * charge * gauss
    coulomb = np.divide(numerator, g2, out=at_zero, where=g2 > 0)
    return coulomb + (2 * np.pi) ** 1.5 * radius**3 * gauss * polynomial


def _wave_vectors(cell: "Cell", mesh: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Half-spectrum wave vectors, (3, n0, n1, n2//2+1): Nyquist zeroed, and as they are."""
    indices = [scipy.fft.fftfreq(mesh[0], 1 / mesh[0]), scipy.fft.fftfreq(mesh[1], 1 / mesh[1])]
    indices.append(scipy.fft.rfftfreq(mesh[2], 1 / mesh[2]))
    odd = []
    for k, count in zip(indices, mesh, strict=True):
        odd.append(np.where(abs(2 * k) == count, 0.0, k))
    reciprocal = cell.reciprocal_vectors()

    def vectors(ks):
        grid = np.stack(np.meshgrid(*ks, indexing="ij"))
        return np.einsum("cijk,cx->xijk", grid, reciprocal)

    return vectors(odd), vectors(indices)
