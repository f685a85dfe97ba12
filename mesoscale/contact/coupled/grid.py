"""Pressures between bounds on a whole grid: active sets, with the half-space applied by FFT.

The problem is that of `dense`. Here the linear system of each step is solved by conjugate gradients that are
preconditioned with the stiffness of the free half-space, without layers E* abs(q) / 2 (Vollebregt,
doi:10.1007/s10957-013-0433-z).
"""

from collections.abc import Callable

import numpy as np
from numba import njit
from scipy import fft

from mesoscale.contact.coupled import dense, half_space
from mesoscale.settings.contact import Body

NEWTON_STEPS = 60
FACE_STEPS = 500
GRADIENT_STEPS = 20000
SINGLE_SHARE = 1e-4  # single precision gets a linear system at least this far
FACE_SHARE = 0.3  # each linear system is solved to this share of its first gap: the sets change before more pays

Apply = Callable[[np.ndarray], np.ndarray]


class Grid:
    """A half-space of N x N sites, for pressures and displacements of shape (N^2,)."""

    def __init__(self, pixels: int, length: float, e_star: float, bodies: tuple[Body, ...] = ()):
        self.shape = (pixels, pixels)
        number = half_space.wave_numbers(pixels) / half_space.softness(pixels, length, bodies)
        number[0, 0] = 1.0  # a preconditioner must not swallow the mean
        self.stiffness = (number * (np.pi * e_star / length)).astype(np.float32)
        number[0, 0] = np.inf
        self.compliance = (length / (np.pi * e_star)) / number
        self.single_compliance = self.compliance.astype(np.float32)

    def displacement(self, pressure: np.ndarray) -> np.ndarray:
        """Displacement (nm) by a pressure (GPa), mean zero, in the precision of the pressure."""
        single = pressure.dtype == np.float32
        return self._filtered(pressure, self.single_compliance if single else self.compliance)

    def pressure(self, displacement: np.ndarray) -> np.ndarray:
        """Pressure (GPa) that makes a displacement (nm), but for its mean, which none makes; single precision."""
        return self._filtered(displacement, self.stiffness)

    def _filtered(self, values: np.ndarray, factor: np.ndarray) -> np.ndarray:
        spectrum = np.asarray(fft.rfft2(values.reshape(self.shape)))
        spectrum *= factor
        return np.asarray(fft.irfft2(spectrum, s=self.shape, overwrite_x=True)).reshape(-1)


def solve(
    grid: Grid, gap: np.ndarray, limit: np.ndarray, stiffness: float, tolerance: float, guess: np.ndarray
) -> tuple[np.ndarray, np.ndarray, int, bool]:
    """Pressures and displacements of a whole grid.

    Parameters
    ----------
    gap, limit, guess : (N^2,), gap of the undeformed surface (nm), largest and first pressures (GPa)
    stiffness : what makes a pressure of a gap in the residual, GPa/nm
    tolerance : of the residual over the largest pressure

    Returns
    -------
    Pressures (GPa) and displacements (nm), Newton steps, and whether they settled.
    """
    pressure = np.clip(guess, 0.0, limit)
    displacement = grid.displacement(pressure)
    state = np.full(gap.size, 1, np.int8)
    for step in range(NEWTON_STEPS):
        moved = dense.classify(gap, pressure, displacement, limit, stiffness, gap.size, state) > 0 or step == 0
        _bind(pressure, limit, state)
        displacement = grid.displacement(pressure)
        if dense.residual(gap, pressure, displacement, limit, stiffness, gap.size) <= tolerance:
            return pressure, displacement, step, True
        free = state == 1
        if free.any():
            goal = 0.1 * tolerance * float(pressure.max()) / stiffness
            _close_gaps(grid, free, gap, pressure, displacement, goal, FACE_SHARE if moved else 0.0)
            if free.all():  # a uniform pressure moves nothing: take the least, so that the sets can change
                pressure -= pressure.min()
    return pressure, displacement, NEWTON_STEPS, False


@njit(cache=True)
def _bind(pressure, limit, state):
    """Put the sites apart and those at their limit on their bounds, the others between them."""
    for k in range(pressure.size):
        if state[k] == 0:
            pressure[k] = 0.0
        elif state[k] == 2:
            pressure[k] = limit[k]
        else:
            pressure[k] = min(max(pressure[k], 0.0), limit[k])


def _close_gaps(
    grid: Grid,
    free: np.ndarray,
    gap: np.ndarray,
    pressure: np.ndarray,
    displacement: np.ndarray,
    goal: float,
    share: float,
) -> None:
    """Change the pressures of the free sites, and with them the displacements, so that the gaps there close.

    Both change in place. Single precision is three times as fast; the next step starts from gaps in double precision.
    """
    first = np.where(free, -(gap + displacement), 0.0)
    largest = float(np.abs(first).max())
    goal = max(goal / largest, share, SINGLE_SHARE)
    r = (first / largest).astype(np.float32)
    x, u, d = np.zeros_like(r), np.zeros_like(r), np.zeros_like(r)
    last = 1.0
    for _ in range(FACE_STEPS):
        z = grid.pressure(r)
        rz = _turn(z, r, free, last, d)
        last = rz
        q = grid.displacement(d)
        dq = float(d @ q)
        if not dq > 1e-7 * rz:  # rounding of what moves nothing
            break
        if _advance(np.float32(rz / dq), d, q, free, x, u, r) <= goal:
            break
    pressure += largest * x.astype(float)
    displacement += largest * u.astype(float)


@njit(cache=True, fastmath=dense.FAST)
def _turn(z, r, free, last, d):
    """Next direction d from the preconditioned residual z of the free sites; returns r z."""
    rz = 0.0
    for k in range(r.size):
        if free[k]:
            rz += r[k] * z[k]
    factor = np.float32(rz / last)
    for k in range(r.size):
        d[k] = factor * d[k] + z[k] if free[k] else np.float32(0.0)
    return rz


@njit(cache=True, fastmath=dense.FAST)
def _advance(step, d, q, free, x, u, r):
    """Go a step along d, whose displacement is q; returns the largest residual that is left."""
    largest = np.float32(0.0)
    for k in range(r.size):
        x[k] += step * d[k]
        u[k] += step * q[k]
        if free[k]:
            r[k] -= step * q[k]
            largest = max(largest, abs(r[k]))
    return largest


def project(
    apply: Apply, norm: float, gap: np.ndarray, limit: np.ndarray, stiffness: float, tolerance: float, guess: np.ndarray
) -> tuple[np.ndarray, np.ndarray, int, bool]:
    """The same by modified proportioning with reduced gradient projections, which converges from any guess.

    Dostal and Schoeberl, doi:10.1007/s10589-005-5395-6. `apply` makes displacements of pressures, `norm` bounds its
    largest eigenvalue (nm/GPa).
    """
    fixed = 1.0 / norm
    pressure = np.clip(guess, 0.0, limit)
    displacement = apply(pressure)
    d = np.zeros_like(pressure)
    fresh = True
    for step in range(GRADIENT_STEPS):
        if step % 100 == 99:  # rounding adds up
            displacement = apply(pressure)
        if dense.residual(gap, pressure, displacement, limit, stiffness, gap.size) <= tolerance:
            return pressure, displacement, step, True
        gradient = gap + displacement
        low, high = pressure <= 0.0, pressure >= limit
        free = np.where(low | high, 0.0, gradient)
        chopped = np.where(low, np.minimum(gradient, 0.0), np.where(high, np.maximum(gradient, 0.0), 0.0))
        # the part of the free gradient that a step of fixed length can follow
        reduced = np.clip(free, (pressure - limit) / fixed, pressure / fixed)
        if chopped @ chopped > free @ reduced:  # let sites off their bounds
            length = float(chopped @ chopped) / float(chopped @ apply(chopped))
            pressure = np.clip(pressure - length * chopped, 0.0, limit)
            displacement = apply(pressure)
            fresh = True
            continue
        if fresh:
            d = free
        q = apply(d)
        dq = float(d @ q)
        best = float(free @ d) / dq if dq > 0.0 else np.inf
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.where(d > 0.0, pressure / d, np.where(d < 0.0, (pressure - limit) / d, np.inf))
        longest = float(room.min())
        if best <= longest:
            pressure = pressure - best * d
            displacement = displacement + -best * q
            inside = (pressure > 0.0) & (pressure < limit)
            free = np.where(inside, gap + displacement, 0.0)
            d = free - (float(free @ q) / dq) * d
            fresh = False
        else:  # to the bound, and on along the projected gradient
            pressure = np.clip(pressure - longest * d, 0.0, limit)
            gradient = gap + displacement - longest * q
            inside = (pressure > 0.0) & (pressure < limit)
            pressure = np.clip(pressure - fixed * np.where(inside, gradient, 0.0), 0.0, limit)
            displacement = apply(pressure)
            fresh = True
    return pressure, displacement, GRADIENT_STEPS, False
