"""A wave on an elastic half-space that opens under attraction: its branch by Newton's method in one
dimension.

The gaps g >= 0 of one period make the energy 1/2 u K u + sum of W(g) least, with u = g - h - d, at
a given mean gap. Each step of separation starts from the last state. The branch ends where the
matrix of second derivatives is no longer positive, and there the wave jumps open.
"""

import numpy as np
from scipy.optimize import minimize

TOUCHING_NM = 1e-9
"""Gaps below are closed."""
ITERATIONS = 200


class Wave:
    """Sites of one period; lengths in nm, stresses in GPa.

    Parameters
    ----------
    heights : shape (n,).
    strength : A_H / (6 pi) of the attraction strength / (g + offset)^3.
    """

    def __init__(self, heights, length, e_star, strength, offset):
        count = len(heights)
        wave_numbers = 2 * np.pi * np.abs(np.fft.fftfreq(count, length / count))
        columns = np.fft.fft(np.eye(count), axis=0)
        self.stiffness = np.fft.ifft(0.5 * e_star * wave_numbers[:, None] * columns, axis=0).real
        self.heights, self.strength, self.offset = heights, strength, offset

    def slopes(self, gap, separation):
        """Of the energy over the gaps: elastic stress and attraction."""
        moved = gap - self.heights - separation
        return self.stiffness @ moved + self.strength / (gap + self.offset) ** 3

    def curvature(self, gap, free):
        """Second derivatives of the energy of sites that do not touch."""
        softening = -3 * self.strength / (gap[free] + self.offset) ** 4
        return self.stiffness[np.ix_(free, free)] + np.diag(softening)

    def least(self, separation):
        """Gaps of least energy near those of the undeformed wave."""
        highest = int(np.argmax(self.heights))
        total = (separation + self.heights.mean()) * len(self.heights)

        def energy(others):
            gap = np.insert(others, highest, total - others.sum())
            moved = gap - self.heights - separation
            slopes = self.slopes(gap, separation)
            elastic = 0.5 * moved @ self.stiffness @ moved
            adhesive = -0.5 * self.strength * np.sum((gap + self.offset) ** -2)
            return elastic + adhesive, np.delete(slopes, highest) - slopes[highest]

        start = np.delete(np.maximum(self.heights + separation, 0), highest)
        found = minimize(
            energy,
            start,
            jac=True,
            method="L-BFGS-B",
            bounds=[(0, None)] * len(start),
            options={"maxiter": 20_000, "maxfun": 40_000, "ftol": 1e-15, "gtol": 1e-10},
        )
        return np.insert(found.x, highest, total - found.x.sum())

    def stable(self, gap, separation):
        """Gaps and mean force on the flat of the state beside `gap`; None where there is none."""
        total = (separation + self.heights.mean()) * len(gap)
        gap = np.where(gap < TOUCHING_NM, 0.0, gap)
        force = 0.0  # the stress that keeps the mean gap
        for _ in range(ITERATIONS):
            free = gap > 0
            slopes = self.slopes(gap, separation)
            count = free.sum()
            matrix = np.ones((count + 1, count + 1))
            matrix[:count, :count] = self.curvature(gap, free)
            matrix[count, count] = 0.0
            change = np.linalg.solve(matrix, np.append(-force - slopes[free], total - gap.sum()))
            force += change[count]
            opened = np.maximum(gap[free] + change[:count], 0.0)
            moved = np.abs(opened - gap[free]).max()
            gap[free] = opened
            # sites that are pulled more than pressed leave, one by one
            pressure = np.where(gap > 0, np.inf, self.slopes(gap, separation) + force)
            if pressure.min() < 0:
                gap[np.argmin(pressure)] = TOUCHING_NM
            elif moved < TOUCHING_NM:
                return (gap, force) if self.is_stable(gap) else None
        return None

    def is_stable(self, gap):
        """Whether all changes that keep the mean gap cost energy."""
        free = gap > 0
        others = np.eye(free.sum())[:, 1:]
        keeping = np.linalg.qr(others - others.mean(axis=0))[0]
        return np.linalg.eigvalsh(keeping.T @ self.curvature(gap, free) @ keeping)[0] > 0


def opening(wave, separations):
    """Mean force on the flat (GPa) at rising separations, as far as the branch goes."""
    gap, forces = wave.least(separations[0]), []
    for separation in separations:
        state = wave.stable(gap, separation)
        if state is None:
            break
        gap, force = state
        forces.append(force)
    return np.array(forces)
