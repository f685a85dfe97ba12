"""A closed form of a pad that closes, opens and remembers how deep it was closed: known pads for
checks.

With s the separation, D the deepest closing so far, r = s - D and p_0 = 1 MPa,

    closing     p_c(s) = exp(-c0 - c1 s - c2 s^2)
    opening     p_c(D) g,   g = exp(-(b0 + b1 D) r - b2 r^2)
    attraction  -A_H / (6 pi (s + offset)^3) - beta p_0 (p_c(D) / p_0)^m g^n (1 + lifted (1 - g)^3)

(while closing, D = s and g = 1).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mesoscale.pad.curves import Flats, PadCurves

Array = NDArray[np.float64]

UNIT_GPa = 1e-3


@dataclass(frozen=True)
class ClosedForm:
    """The numbers of the closed form, in GPa and nm."""

    c0: float
    c1_per_nm: float
    c2_per_nm2: float
    b0_per_nm: float
    b1_per_nm2: float
    b2_per_nm2: float
    beta: float
    m: float
    n: float
    lifted: float
    hamaker: float
    offset_nm: float

    @property
    def flats(self) -> Flats:
        """What the pad is from far away."""
        return Flats(self.hamaker, self.offset_nm)

    def closing_GPa(self, separation_nm: ArrayLike) -> tuple[Array, Array]:
        """Repulsion and attraction (negative) while closing."""
        return self.opening_GPa(separation_nm, separation_nm)

    def opening_GPa(self, separation_nm: ArrayLike, deepest_nm: ArrayLike) -> tuple[Array, Array]:
        """Repulsion and attraction (negative) at separations not below the deepest closing."""
        s, deep = np.asarray(separation_nm, float), np.asarray(deepest_nm, float)
        load = np.exp(-self.c0 - self.c1_per_nm * deep - self.c2_per_nm2 * deep**2)
        decay = (self.b0_per_nm + self.b1_per_nm2 * deep) * (s - deep) + self.b2_per_nm2 * (
            s - deep
        ) ** 2
        left = np.exp(-decay)
        rim = self.beta * UNIT_GPa * (load / UNIT_GPa) ** self.m * left**self.n
        return load * left, -self.flats.pull_GPa(s) - rim * (
            1.0 + self.lifted * np.maximum(1.0 - left, 0.0) ** 3
        )

    def curves(self, separation_nm: Array, depth_nm: Array) -> PadCurves:
        """Its curves at rising separations, opened from rising depths."""
        opening = np.full((len(depth_nm), 2, separation_nm.size), np.nan)
        for k, depth in enumerate(depth_nm):
            above = separation_nm >= depth - 1e-9
            opening[k][:, above] = self.opening_GPa(separation_nm[above], depth)
            # what was flattened never pushes harder than it did on the way down
            opening[k, 0, above] = np.minimum(
                opening[k, 0, above], self.closing_GPa(separation_nm[above])[0]
            )
        return PadCurves(
            separation_nm, np.stack(self.closing_GPa(separation_nm)), depth_nm, opening, self.flats
        )

    def pressed(self, wanted_GPa: Array, separation_nm: Array, depths: int = 24) -> PadCurves:
        """Its curves from where closing carries what is wanted at rising separations, or the most
        that it does.
        """
        net = np.add(*self.closing_GPa(separation_nm))
        deep = np.flatnonzero(net >= wanted_GPa)
        s = separation_nm[deep[-1] if deep.size else int(net.argmax()) :]
        load = self.closing_GPa(s)[0]
        shallow = np.flatnonzero(load > 1e-4 * load[0])[-1]
        return self.curves(s, s[np.unique(np.linspace(0, shallow, depths).round().astype(int))])
