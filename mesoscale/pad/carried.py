"""The curves of one pad, carried to other inputs.

The closed form knows how a pad changes with its inputs; its own wells have 0.2 to 0.7 of the depth of the curves'. So
the curves are divided by the closed form at their own inputs, repulsion and attraction apart. These factors then
multiply the closed form at other inputs, at the place that has the same load at the deepest closing, and has lost the
same part of it since. At the inputs of the curves this gives the curves.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mesoscale.pad.compact import CompactPad
from mesoscale.pad.memory import Flats, FLOOR_GPa, PadLaw, rows_at

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Factors:
    """Logarithms of the curves over the closed form, for repulsion and attraction.

    Attributes
    ----------
    load : logarithm of the closed form's load at the separations of the table, rising, shape (n,).
    closing : while closing, shape (2, n).
    depth_load : the same load at the depths of the table, rising, shape (k,).
    opening : from each depth, the decay of the load (m,), rising, and what opening adds to the factors of closing
        (2, m).
    """

    load: Array
    closing: Array
    depth_load: Array
    opening: tuple[tuple[Array, Array], ...]


def factors_of(law: PadLaw, compact: CompactPad) -> Factors:
    """The curves of a pad over its closed form."""
    s = law.separation_nm
    # a fitted parabola may turn back at small separations, where the pad was not closed to
    load = compact.log_load(s)
    rising = np.flatnonzero(np.diff(load) >= 0.0)
    used = slice(int(rising[-1]) + 1 if rising.size else 0, None)
    load, closing = load[used][::-1], _logarithm(law.closing, compact.closing_GPa(s))[:, used][:, ::-1]
    opening = []
    for depth, branch in zip(law.depth_nm, law.opening, strict=True):
        above = np.isfinite(branch[0])
        change = _logarithm(branch[:, above], compact.opening_GPa(s[above], depth))
        decay = np.maximum.accumulate(compact.decay(s[above], depth))
        opening.append((decay, change - rows_at(compact.log_load(depth), load, closing)[:, None]))
    order = np.argsort(compact.log_load(law.depth_nm), kind="stable")
    return Factors(load, closing, compact.log_load(law.depth_nm)[order], tuple(opening[k] for k in order))


@dataclass(frozen=True)
class CarriedPad:
    """A pad at some inputs: its closed form times the factors of the curves; beyond the curves, those at their end."""

    compact: CompactPad
    factors: Factors

    @property
    def flats(self) -> Flats:
        """What the pad is from far away."""
        return self.compact.flats

    def closing_GPa(self, separation_nm: ArrayLike) -> tuple[Array, Array]:
        """Repulsion and attraction (negative) while closing."""
        load = self.compact.log_load(separation_nm)
        return self._times(
            self.compact.closing_GPa(separation_nm), rows_at(load, self.factors.load, self.factors.closing)
        )

    def opening_GPa(self, separation_nm: Array, deepest_nm: float) -> tuple[Array, Array]:
        """Repulsion and attraction (negative) at separations not below the deepest closing."""
        load = float(self.compact.log_load(deepest_nm))
        decay = self.compact.decay(separation_nm, deepest_nm)
        known = self.factors.depth_load
        upper = int(np.clip(np.searchsorted(known, load), min(1, known.size - 1), known.size - 1))
        lower = max(upper - 1, 0)
        apart = known[upper] - known[lower]
        share = float(np.clip((load - known[lower]) / apart, 0.0, 1.0)) if apart > 0 else 0.0
        light, heavy = (rows_at(decay, *self.factors.opening[k]) for k in (lower, upper))
        change = (1.0 - share) * light + share * heavy
        started = rows_at(load, self.factors.load, self.factors.closing)
        return self._times(self.compact.opening_GPa(separation_nm, deepest_nm), started[:, None] + change)

    @staticmethod
    def _times(form: tuple[Array, Array], logarithm: Array) -> tuple[Array, Array]:
        pushes, pulls = (part * np.exp(change) for part, change in zip(form, logarithm, strict=True))
        return np.where(pushes > 2.0 * FLOOR_GPa, pushes, 0.0), pulls


def _logarithm(curves: ArrayLike, form: ArrayLike) -> Array:
    """Logarithm of curves over the closed form, of one shape; 0 where both are nothing."""
    curve, smooth = (np.log(np.maximum(np.abs(np.asarray(part, float)), FLOOR_GPa)) for part in (curves, form))
    return curve - smooth
