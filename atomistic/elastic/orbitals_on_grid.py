"""Contracted Gaussian orbitals on a periodic grid: values, and the force of a potential.

Atomic units throughout (bohr, hartree).  The orbitals are PySCF's: real solid harmonics times
contracted Gaussians, in PySCF's order, summed over all periodic images within `radius`.  Along a
grid line the Gaussians follow a two-term recurrence (exp of a quadratic), which is why this is an
order of magnitude faster than evaluating each point by itself.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numba
import numpy as np

if TYPE_CHECKING:
    from pyscf.pbc.gto import Cell

S0 = 0.282094791773878143  # sqrt(1/4π)
P0 = 0.488602511902919921  # sqrt(3/4π)
D0 = 1.092548430592079070  # sqrt(15/4π)
D1 = 0.315391565252520002  # sqrt(5/16π)
D2 = 0.546274215296039535  # sqrt(15/16π)
# sums in any order; what compiled loops call is put into them (forceinline): each library has a
# copy of its own, and which of them runs, and so the last digits, would depend on what was compiled
# and what was loaded
FAST = {"contract", "reassoc"}


@dataclass(frozen=True)
class AtomOrbitals:
    """Orbitals of one atom that share a set of exponents.

    Attributes
    ----------
    centre : (3,) position, bohr
    exponents : (n_primitives,) 1/bohr²
    angular : (n_radial,) angular momentum of each contracted radial function
    contraction : (n_radial, n_primitives) coefficients
    first : (n_radial,) index of the first of its 2l + 1 orbitals
    radius : beyond it every orbital is below the cell's precision, bohr
    """

    centre: np.ndarray
    exponents: np.ndarray
    angular: np.ndarray
    contraction: np.ndarray
    first: np.ndarray
    radius: float


def atom_orbitals(cell: "Cell", precision: float | None = None) -> list[AtomOrbitals]:
    """Orbitals of a PySCF cell, atom by atom.

    Parameters
    ----------
    precision : orbital values (bohr^-3/2) below this are cut off; default: the precision of the
        cell

    Raises
    ------
    NotImplementedError
        for functions beyond d, or Cartesian ones
    """
    if cell.cart:
        raise NotImplementedError("Cartesian orbitals; use spherical ones")
    smallest = float(precision or cell.precision)
    return [_orbitals_of(cell, atom, smallest) for atom in range(cell.natm)]


def _orbitals_of(cell: "Cell", atom: int, precision: float) -> AtomOrbitals:
    """Orbitals of one atom of a PySCF cell."""
    first_orbital_of_shell = cell.ao_loc_nr()
    shells = [shell for shell in range(cell.nbas) if cell.bas_atom(shell) == atom]
    exponents = np.unique(np.concatenate([cell.bas_exp(shell) for shell in shells]))
    angular: list[int] = []
    first: list[int] = []
    rows: list[np.ndarray] = []
    for shell in shells:
        degree = cell.bas_angular(shell)
        if degree > 2:
            raise NotImplementedError(
                f"angular momentum {degree} of {cell.atom_symbol(atom)}; s, p and d are supported"
            )
        places = np.searchsorted(exponents, cell.bas_exp(shell))
        for k, coefficients in enumerate(cell._libcint_ctr_coeff(shell).T):
            row = np.zeros(len(exponents))
            np.add.at(row, places, coefficients)
            rows.append(row)
            angular.append(degree)
            first.append(int(first_orbital_of_shell[shell]) + k * (2 * degree + 1))
    contraction = np.array(rows)
    radius = _radius(exponents, np.array(angular), contraction, precision)
    return AtomOrbitals(
        cell.atom_coords()[atom], exponents, np.array(angular), contraction, np.array(first), radius
    )


def _radius(
    exponents: np.ndarray, angular: np.ndarray, contraction: np.ndarray, precision: float
) -> float:
    """Distance (bohr) beyond which r^l R(r) of every radial function is below `precision`."""
    radii = np.linspace(0.5, 40.0, 1581)
    gaussians = np.exp(-np.outer(radii**2, exponents))
    radial = np.abs(gaussians @ contraction.T)
    largest = np.max(radial * radii[:, None] ** angular, axis=1)
    large = np.nonzero(largest > precision)[0]
    if not len(large):
        return float(radii[0])
    return float(radii[min(large[-1] + 1, len(radii) - 1)])


def collocate(
    orbitals: list[AtomOrbitals],
    lattice: np.ndarray,
    mesh: tuple[int, int, int],
    n_orbitals: int,
    precision: type[np.floating] = np.float64,
):
    """Values of all orbitals on the grid, (orbitals, grid points), grid in C order of `mesh`."""
    values = np.zeros((n_orbitals, int(np.prod(mesh))), dtype=precision)
    for atom in orbitals:
        _collocate_atom(values, lattice, np.array(mesh), *_arguments(atom, lattice, mesh))
    return values


def pulay_term(
    atom: AtomOrbitals,
    lattice: np.ndarray,
    mesh: tuple[int, int, int],
    potential_density: np.ndarray,
) -> np.ndarray:
    """What a potential does to the orbitals of one atom when it moves, shape (3,).

    It is the sum over grid points and orbitals µ of ∇φ_µ(r) times the potential density of µ at r.

    Parameters
    ----------
    potential_density : (orbitals of this atom in PySCF's order, grid points), w v(r) Σ_ν D_µν
        φ_ν(r)
    """
    relative = replace(atom, first=atom.first - atom.first.min())
    return _contract_gradient(
        potential_density, lattice, np.array(mesh), *_arguments(relative, lattice, mesh)
    )


def _arguments(atom: AtomOrbitals, lattice: np.ndarray, mesh: tuple[int, int, int]):
    """Grid-index box of the sphere around the atom, and what the kernels need of the atom."""
    inverse = np.linalg.inv(lattice)
    fraction = atom.centre @ inverse
    reach = atom.radius * np.linalg.norm(inverse, axis=0)
    low = np.ceil((fraction - reach) * np.array(mesh)).astype(np.int64)
    high = np.floor((fraction + reach) * np.array(mesh)).astype(np.int64)
    return (
        atom.centre,
        atom.exponents,
        atom.angular,
        atom.contraction,
        atom.first,
        atom.radius,
        low,
        high,
    )


@numba.njit(cache=True, error_model="numpy")
def _closest(centre, lattice, mesh, i, j, radius):
    """First point of grid line (i, j) relative to the atom, its step, indices in the sphere."""
    step = lattice[2] / mesh[2]
    in_plane = lattice[0] * (i / mesh[0]) + lattice[1] * (j / mesh[1])
    origin = in_plane - centre
    s2 = step[0] ** 2 + step[1] ** 2 + step[2] ** 2
    projection = origin[0] * step[0] + origin[1] * step[1] + origin[2] * step[2]
    closest = -projection / s2
    distance2 = origin[0] ** 2 + origin[1] ** 2 + origin[2] ** 2 - closest * closest * s2
    room = radius * radius - distance2
    if room <= 0.0:
        return origin, step, 0, 0, -1
    half = np.sqrt(room / s2)
    begin = int(np.ceil(closest - half))
    end = int(np.floor(closest + half))
    return origin, step, int(np.rint(closest)), begin, end


@numba.njit(cache=True, error_model="numpy")
def _gaussians(out, exponents, origin, step, middle, begin, end):
    """exp(-exponent r²) at points begin…end of a line, out[p, k - begin].

    The recurrence runs outwards from the closest point: every factor is ≤ 1, nothing can overflow.
    """
    s2 = step[0] ** 2 + step[1] ** 2 + step[2] ** 2
    for sign in (1, -1):
        start = min(max(middle, begin), end)
        if sign == -1:
            start -= 1
        if start < begin:
            continue
        point = origin + start * step
        r2 = point[0] ** 2 + point[1] ** 2 + point[2] ** 2
        projection = point[0] * step[0] + point[1] * step[1] + point[2] * step[2]
        rs = sign * projection
        count = start - begin + 1
        if sign == 1:
            count = end - start + 1
        for p in range(exponents.size):
            value = np.exp(-exponents[p] * r2)
            ratio = np.exp(-exponents[p] * (2.0 * rs + s2))
            factor = np.exp(-2.0 * exponents[p] * s2)
            k = start - begin
            for _ in range(count):
                out[p, k] = value
                value *= ratio
                ratio *= factor
                k += sign


@numba.njit(cache=True, error_model="numpy")
def _add_line(row, line, begin, count):
    """Add an unwrapped line to the periodic grid row."""
    n = row.size
    k = 0
    place = begin % n
    while k < count:
        run = min(n - place, count - k)
        for m in range(run):
            row[place + m] += line[k + m]
        k += run
        place = 0


@numba.njit(cache=True, error_model="numpy")
def _take_line(line, row, begin, count):
    """Unwrapped copy of a periodic grid row."""
    n = row.size
    k = 0
    place = begin % n
    while k < count:
        run = min(n - place, count - k)
        for m in range(run):
            line[k + m] = row[place + m]
        k += run
        place = 0


@numba.njit(cache=True, fastmath=FAST, error_model="numpy")
def _collocate_atom(
    values, lattice, mesh, centre, exponents, angular, contraction, first, radius, low, high
):
    """Add the orbitals of one atom to their rows of `values`, line by line of the grid.

    x, y, z: points of a line from the atom's centre; f: a radial function on them.
    """
    n_radial, n_primitives = contraction.shape
    longest = high[2] - low[2] + 2
    gaussians = np.empty((n_primitives, longest))
    f, x, y, z, line = np.empty((5, longest))
    for i in range(low[0], high[0] + 1):
        for j in range(low[1], high[1] + 1):
            origin, step, middle, begin, end = _closest(centre, lattice, mesh, i, j, radius)
            n = end - begin + 1
            if n <= 0:
                continue
            row = ((i % mesh[0]) * mesh[1] + j % mesh[1]) * mesh[2]
            _gaussians(gaussians, exponents, origin, step, middle, begin, end)
            for k in range(n):
                x[k] = origin[0] + (begin + k) * step[0]
                y[k] = origin[1] + (begin + k) * step[1]
                z[k] = origin[2] + (begin + k) * step[2]
            for s in range(n_radial):
                # R(r), the contracted Gaussians
                f[:n] = 0.0
                for p in range(n_primitives):
                    c = contraction[s, p]
                    if c != 0.0:
                        for k in range(n):
                            f[k] += c * gaussians[p, k]
                # times the harmonics of its 2l + 1 orbitals
                for m in range(2 * angular[s] + 1):
                    _harmonic_times(line, angular[s], m, x, y, z, f, n)
                    _add_line(values[first[s] + m, row : row + mesh[2]], line, begin, n)


@numba.njit(cache=True, fastmath=FAST, error_model="numpy", forceinline=True)
def _harmonic_times(out, degree, m, x, y, z, f, n):
    """out = S_lm(x, y, z) f, real solid harmonic (x, y, z; xy, yz, z², xz, x²-y²)."""
    if degree == 0:
        for k in range(n):
            out[k] = S0 * f[k]
    elif degree == 1:
        axis = x if m == 0 else (y if m == 1 else z)
        for k in range(n):
            out[k] = P0 * axis[k] * f[k]
    elif m == 0:
        for k in range(n):
            out[k] = D0 * x[k] * y[k] * f[k]
    elif m == 1:
        for k in range(n):
            out[k] = D0 * y[k] * z[k] * f[k]
    elif m == 2:
        for k in range(n):
            out[k] = D1 * (2.0 * z[k] * z[k] - x[k] * x[k] - y[k] * y[k]) * f[k]
    elif m == 3:
        for k in range(n):
            out[k] = D0 * x[k] * z[k] * f[k]
    else:
        for k in range(n):
            out[k] = D2 * (x[k] * x[k] - y[k] * y[k]) * f[k]


@numba.njit(cache=True, fastmath=FAST, error_model="numpy")
def _contract_gradient(
    field, lattice, mesh, centre, exponents, angular, contraction, first, radius, low, high
):
    """Sum over orbitals and grid points of `field` times ∇φ, with φ = R(r) S_lm(x, y, z).

    ∇φ = (R'/r) S_lm (x, y, z) + R ∇S_lm.  On a line of the grid `radial` gathers the factor of
    (x, y, z) in the first term, and gx, gy, gz the second; f is R, slope is R'/r, and a0 to a4 are
    the field of the 2l + 1 orbitals.
    """
    n_radial, n_primitives = contraction.shape
    longest = high[2] - low[2] + 2
    gaussians = np.empty((n_primitives, longest))
    f, slope, x, y, z, radial, gx, gy, gz, a0, a1, a2, a3, a4 = np.empty((14, longest))
    total = np.zeros(3)
    for i in range(low[0], high[0] + 1):
        for j in range(low[1], high[1] + 1):
            origin, step, middle, begin, end = _closest(centre, lattice, mesh, i, j, radius)
            n = end - begin + 1
            if n <= 0:
                continue
            start = ((i % mesh[0]) * mesh[1] + j % mesh[1]) * mesh[2]
            stop = start + mesh[2]
            _gaussians(gaussians, exponents, origin, step, middle, begin, end)
            for k in range(n):
                x[k] = origin[0] + (begin + k) * step[0]
                y[k] = origin[1] + (begin + k) * step[1]
                z[k] = origin[2] + (begin + k) * step[2]
            radial[:n] = 0.0
            gx[:n] = 0.0
            gy[:n] = 0.0
            gz[:n] = 0.0
            for s in range(n_radial):
                # R and R'/r; of a Gaussian exp(-α r²) the latter is -2 α times itself
                f[:n] = 0.0
                slope[:n] = 0.0
                for p in range(n_primitives):
                    c = contraction[s, p]
                    d = -2.0 * exponents[p] * c
                    if c != 0.0:
                        for k in range(n):
                            f[k] += c * gaussians[p, k]
                            slope[k] += d * gaussians[p, k]
                a = first[s]
                # s: S = S0, which has no gradient of its own
                if angular[s] == 0:
                    _take_line(a0, field[a, start:stop], begin, n)
                    for k in range(n):
                        radial[k] += slope[k] * S0 * a0[k]
                # p: S = P0 x, P0 y, P0 z
                elif angular[s] == 1:
                    _take_line(a0, field[a, start:stop], begin, n)
                    _take_line(a1, field[a + 1, start:stop], begin, n)
                    _take_line(a2, field[a + 2, start:stop], begin, n)
                    for k in range(n):
                        radial[k] += slope[k] * P0 * (x[k] * a0[k] + y[k] * a1[k] + z[k] * a2[k])
                        gx[k] += f[k] * P0 * a0[k]
                        gy[k] += f[k] * P0 * a1[k]
                        gz[k] += f[k] * P0 * a2[k]
                # d: S = D0 xy, D0 yz, D1 (2z² - x² - y²), D0 xz, D2 (x² - y²)
                else:
                    _take_line(a0, field[a, start:stop], begin, n)
                    _take_line(a1, field[a + 1, start:stop], begin, n)
                    _take_line(a2, field[a + 2, start:stop], begin, n)
                    _take_line(a3, field[a + 3, start:stop], begin, n)
                    _take_line(a4, field[a + 4, start:stop], begin, n)
                    for k in range(n):
                        radial[k] += slope[k] * (
                            D0 * (x[k] * y[k] * a0[k] + y[k] * z[k] * a1[k] + x[k] * z[k] * a3[k])
                            + D1 * (2.0 * z[k] * z[k] - x[k] * x[k] - y[k] * y[k]) * a2[k]
                            + D2 * (x[k] * x[k] - y[k] * y[k]) * a4[k]
                        )
                        gx[k] += f[k] * (
                            D0 * (y[k] * a0[k] + z[k] * a3[k])
                            + 2.0 * x[k] * (D2 * a4[k] - D1 * a2[k])
                        )
                        gy[k] += f[k] * (
                            D0 * (x[k] * a0[k] + z[k] * a1[k])
                            - 2.0 * y[k] * (D2 * a4[k] + D1 * a2[k])
                        )
                        gz[k] += f[k] * (
                            D0 * (y[k] * a1[k] + x[k] * a3[k]) + 4.0 * D1 * z[k] * a2[k]
                        )
            # the first term along (x, y, z)
            for k in range(n):
                gx[k] += radial[k] * x[k]
                gy[k] += radial[k] * y[k]
                gz[k] += radial[k] * z[k]
            total[0] += _sum(gx, n)
            total[1] += _sum(gy, n)
            total[2] += _sum(gz, n)
    return total


@numba.njit(cache=True, fastmath=FAST, error_model="numpy", forceinline=True)
def _sum(values, n):
    """Sum of the first n values; in a loop of its own it is fast, and rounds as it always did."""
    s = 0.0
    for k in range(n):
        s += values[k]
    return s
