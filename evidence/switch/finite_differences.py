"""A clamped beam by finite differences, written apart from the product: a plain twin for its
answers.
"""

import numpy as np
from scipy.linalg import solve_banded

from mesoscale.pad.local import LocalPad

EPS0 = 8.8541878128e-12


class Beam:
    """Lengths in m, loads in N/m; `nodes` inner points of the deflection w, positive away from the
    dielectric.
    """

    def __init__(self, settings, nodes=399):
        self.length, self.width = settings.length_um * 1e-6, settings.width_um * 1e-6
        thick, modulus = settings.thickness_um * 1e-6, settings.youngs_modulus_GPa * 1e9
        plate = settings.bends_as == "plate" or (
            settings.bends_as is None and self.width >= 5 * thick
        )
        self.bending = (
            modulus / (1 - settings.poisson_ratio**2 if plate else 1) * self.width * thick**3 / 12
        )
        give = 1e-6 * settings.anchor_um_per_N
        self.axial = 1.0 / (self.length / (modulus * self.width * thick) + give)
        self.tension = (
            settings.residual_stress_MPa * 1e6 * (1 - settings.poisson_ratio) * self.width * thick
        )
        self.h = self.length / (nodes + 1)
        share = np.arange(1, nodes + 1) / (nodes + 1)
        self.shape0 = settings.shape_at_rest_nm(share) * 1e-9
        self.gap = settings.gap_um * 1e-6 + self.shape0
        self.thin = settings.dielectric_nm * 1e-9 / settings.permittivity
        self.edge = settings.fringe / self.width
        one = np.ones(nodes)
        # fourth difference; a clamped end mirrors the first inner point, and one that turns by
        # EI w'' = k w' mirrors a part of it
        give = 2.0 * self.bending * 1e6 * settings.anchor_rad_per_uN_m / self.h
        mirrored = (1.0 - give) / (1.0 + give)
        self.fourth = np.array([0 * one, -4 * one, 6 * one, -4 * one, 0 * one])
        self.fourth[0], self.fourth[4] = one, one
        self.fourth[2, 0] = self.fourth[2, -1] = 6.0 + mirrored
        self.second = np.array([0 * one, one, -2 * one, one, 0 * one])

    def times(self, bands, w):
        """Product of five bands with w; rows are stored by diagonals, superdiagonals first."""
        out = bands[2] * w
        out[:-1] += bands[1, 1:] * w[1:]
        out[1:] += bands[3, :-1] * w[:-1]
        out[:-2] += bands[0, 2:] * w[2:]
        out[2:] += bands[4, :-2] * w[:-2]
        return out

    def longer(self, w):
        """Elongation by the slopes between points, ends at rest."""
        z0, moved = np.pad(self.shape0, 1), np.pad(w, 1)
        return float(0.5 * (np.diff(moved + z0) ** 2 - np.diff(z0) ** 2).sum() / self.h)

    def pull(self, s, squared):
        """Electrostatic pull per length and its derivative by s."""
        e = np.maximum(s + self.thin, 0.1 * self.thin + 1e-10)
        q = 0.5 * EPS0 * self.width * squared
        return q * (1 / e**2 + self.edge / e), -q * (2 / e**3 + self.edge / e**2)

    def step(self, w, load, slope, inertia=0.0, other=None):
        """Newton step of EI w'''' - N z'' + N0 z0'' = load, and the answer to another load."""
        n0, stretch = self.tension, self.axial * self.longer(w)
        curve = self.times(self.second, w + self.shape0) / self.h**2
        left = load - self.bending / self.h**4 * self.times(self.fourth, w)
        left += n0 * self.times(self.second, w) / self.h**2 + stretch * curve
        bands = self.bending / self.h**4 * self.fourth - (n0 + stretch) / self.h**2 * self.second
        bands[2] += inertia - slope
        right = np.stack([left, np.zeros_like(w) if other is None else other, curve], axis=1)
        x, y, c = solve_banded((2, 2), bands, right).T
        # the force grows by -axial h sum(z'' dw), the matrix by the product of z'' with itself
        factor = self.axial * self.h / (1 + self.axial * self.h * float(curve @ c))
        return x - factor * float(curve @ x) * c, y - factor * float(curve @ y) * c

    def pull_in(self, steps=80):
        """Pull-in, and the shape one step beyond it, lowering mid-span over a bare dielectric."""
        w, squared, kept, shapes = np.zeros_like(self.gap), 0.0, [0.0], []
        middle = w.size // 2
        for target in np.linspace(0, self.gap[middle], steps + 1)[1:-1]:
            for _ in range(40):
                q, dq = self.pull(self.gap + w, squared)
                unit = -self.pull(self.gap + w, 1.0)[0]
                x, y = self.step(w, -q, -dq, other=unit)
                more = (-target - w[middle] - x[middle]) / y[middle]
                w, squared = w + x + more * y, squared + more
                if abs(more) < 1e-10 * abs(squared):
                    break
            kept.append(squared)
            shapes.append(w)
            if len(kept) > 3 and kept[-1] < 0.98 * max(kept):
                break
        top = int(np.argmax(kept))
        a, b, c = kept[top - 1 : top + 2]
        return float(np.sqrt(b + (a - c) ** 2 / (8 * (2 * b - a - c)))), shapes[top].copy()


def settle(beam, w, deepest_nm, pad, voltage, largest_nm=0.25):
    """Overdamped motion to balance at a voltage; the shape, the depths, and whether it is still
    closed.
    """
    speed, fastest, last = 1e-3, 1e9, np.zeros_like(w)
    for _ in range(200000):
        s = (beam.gap + w) * 1e9
        push, steep = (of[:, 0] for of in pad(s[:, None], deepest_nm[:, None]))
        q, dq = beam.pull(beam.gap + w, voltage**2)
        load, slope = beam.width * push * 1e9 - q, beam.width * steep * 1e18 - dq
        inertia = beam.width * 1e9 / speed
        x, _ = beam.step(w, load, slope, inertia)
        allowed = np.maximum(0.25 * (s - pad.curves.separation_nm[0] - 40.0), largest_nm).clip(
            max=50.0
        )
        over = np.max(abs(x) * 1e9 / allowed)
        if over > 1.0:
            speed *= max(0.8 / over, 0.1)
            continue
        w = w + x
        deepest_nm = np.minimum(deepest_nm, (beam.gap + w) * 1e9)
        low = float(((beam.gap + w) * 1e9).min())
        if low > 0.7 * beam.gap.min() * 1e9:
            return w, deepest_nm, False
        # a step back: straight pieces of the curves, between which it would swing
        fastest = 0.1 * speed if float(x @ last) < 0 else min(1.03 * fastest, 1e9)
        speed, last = min(1.5 * speed if over < 0.5 else speed, fastest), x
        if np.abs(x).max() < 1e-12 and np.abs(x).max() * 1e9 / speed < 1.0:
            return w, deepest_nm, low < 200.0
    raise AssertionError("no balance")


def release(settings, law, nodes=399, tolerance=1e-3):
    """Pull-in and release (0: sticks) of the beam that the settings describe on a pad."""
    beam, pad = Beam(settings, nodes), LocalPad(law)
    pull_in, w = beam.pull_in()
    hold = settings.hold_voltage_V or pull_in
    w, deepest, closed = settle(beam, w, np.full(w.shape, np.inf), pad, hold)
    assert closed
    low, high = 0.0, hold
    if settle(beam, w, deepest, pad, 0.0)[2]:
        return pull_in, 0.0
    while high - low > tolerance * high:
        middle = 0.5 * (low + high)
        found = settle(beam, w, deepest, pad, middle)
        if found[2]:
            high, w, deepest = middle, found[0], found[1]
        else:
            low = middle
    return pull_in, high
