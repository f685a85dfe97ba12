"""Pressures between bounds on a whole grid: active sets, with the half-space applied by FFT.

The problem is that of `dense`. Here the linear system of each step is solved by conjugate gradients that are
preconditioned with the stiffness of the free half-space, E* abs(q) / 2 (Vollebregt, doi:10.1007/s10957-013-0433-z).
"""

from collections.abc import Callable

import numpy as np
from scipy import fft

from mesoscale.contact.coupled import half_space

NEWTON_STEPS = 60
FACE_STEPS = 500
GRADIENT_STEPS = 20000
FACE_SHARE = 0.3  # each linear system is solved to this share of its first gap: the sets change before more pays

Apply = Callable[[np.ndarray], np.ndarray]


class Grid:
    """A half-space of N x N sites, for pressures and displacements of shape (N^2,)."""

    def __init__(self, pixels: int, length: float, e_star: float):
        self.shape = (pixels, pixels)
        number = half_space.wave_numbers(pixels)
        number[0, 0] = 1.0  # a preconditioner must not swallow the mean
        self.stiffness = number * (np.pi * e_star / length)
        number[0, 0] = np.inf
        self.compliance = (length / (np.pi * e_star)) / number

    def displacement(self, pressure: np.ndarray) -> np.ndarray:
        """Displacement (nm) by a pressure (GPa), mean zero."""
        return self._filtered(pressure, self.compliance)

    def pressure(self, displacement: np.ndarray) -> np.ndarray:
        """Pressure (GPa) that makes a displacement (nm), but for its mean, which none makes."""
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
        value = pressure - stiffness * (gap + displacement)
        new = (value > 0.0).astype(np.int8)
        new[value >= limit] = 2
        new[np.abs(new - state) == 2] = 1  # see `dense`
        moved = step == 0 or not np.array_equal(new, state)
        state = new
        pressure = np.where(state == 1, np.clip(pressure, 0.0, limit), np.where(state == 2, limit, 0.0))
        displacement = grid.displacement(pressure)
        largest = float(pressure.max())
        if residual(gap, pressure, displacement, limit, stiffness) <= tolerance:
            return pressure, displacement, step, True
        free = state == 1
        if free.any():
            goal = 0.1 * tolerance * largest / stiffness
            _close_gaps(grid, free, gap, pressure, displacement, goal, FACE_SHARE if moved else 0.0)
            if free.all():  # a uniform pressure moves nothing: take the least, so that the sets can change
                pressure -= pressure.min()
    return pressure, displacement, NEWTON_STEPS, False


def residual(
    gap: np.ndarray, pressure: np.ndarray, displacement: np.ndarray, limit: np.ndarray, stiffness: float
) -> float:
    """Largest abs(p - min(max(p - k g, 0), limit)) over the largest pressure: 0 where all conditions are met."""
    wanted = np.clip(pressure - stiffness * (gap + displacement), 0.0, limit)
    worst, largest = float(np.abs(pressure - wanted).max()), float(pressure.max())
    if largest > 0.0:
        return worst / largest
    return np.inf if worst > 0.0 else 0.0


def _close_gaps(
    grid: Grid,
    free: np.ndarray,
    gap: np.ndarray,
    pressure: np.ndarray,
    displacement: np.ndarray,
    goal: float,
    share: float,
) -> None:
    """Change the pressures of the free sites, in place, so that their gaps close."""
    r = np.where(free, -(gap + displacement), 0.0)
    goal = max(goal, share * float(np.abs(r).max()))
    d = np.zeros_like(r)
    last = 1.0
    for _ in range(FACE_STEPS):
        if np.abs(r).max() <= goal:
            return
        z = grid.pressure(r)
        z *= free
        rz = float(r @ z)
        d *= rz / last
        d += z
        last = rz
        q = grid.displacement(d)
        dq = float(d @ q)
        if not dq > 1e-14 * rz:  # rounding of what moves nothing
            return
        pressure += (rz / dq) * d
        displacement += (rz / dq) * q
        q *= free
        r -= (rz / dq) * q


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
        if residual(gap, pressure, displacement, limit, stiffness) <= tolerance:
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
