"""The curves of a pad as tables for circuit simulators, with the deepest closing as a state.

The state is `closed` = start - (smallest separation so far) >= 0. It follows start - s upward with
the time constant `follow` and stays where it is while the pad opens, but for a leak that a
simulator needs to find its first balance.

Closing gives the logarithms of push and pull at the deepest separation. An opening from there adds
how both change with the rise above it, interpolated between the depths that were computed.
Verilog-A gets monotone cubic pieces (Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300),
so that force and slope are continuous; SPICE gets straight ones.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.pad.curves import FLOOR, Flats, PadCurves, rows_at

Array = NDArray[np.float64]

OF_PULL = 0.05
"""Error that tables may have beside the curves far out, of the pull."""
FAINT = 1e-3
"""A push of this share of the shallowest well counts as none, so that its logarithm stays
finite."""


@dataclass(frozen=True)
class Piece:
    """A curve through nodes: places (nm) and values, shape (n,) each."""

    x: Array
    y: Array


@dataclass(frozen=True)
class Tables:
    """A pad as pieces: logarithms of push (less `faint_GPa`) and of pull over that of flats.

    Attributes
    ----------
    closing : push and pull at the deepest separation.
    depth_nm : separations from which the pad was opened, shape (k,).
    opening : from each depth, how both change with the rise above it.
    of_well : largest error on opening near the well (`CIRCUIT.near_wells`), over the well.
    of_net : largest error elsewhere, over the net pressure.
    """

    closing: tuple[Piece, Piece]
    depth_nm: Array
    opening: list[tuple[Piece, Piece]]
    faint_GPa: float
    floor_GPa: float
    of_well: float
    of_net: float


def tables_of(pad: PadCurves, cubic: bool, looser: float = 1.0) -> Tables:
    """Tables of the curves of a pad, of cubic or straight pieces.

    Parameters
    ----------
    looser : so many times the usual errors are allowed beside the curves.
    """
    wells = np.array([-min(np.nanmin(opened.sum(axis=0)), 0.0) for opened in pad.opening])
    shallowest_well = float(wells.min())
    floor = pad.floor_GPa
    faint = max(FAINT * shallowest_well, 1e2 * floor)
    s = pad.separation_nm
    closing = _Curve(pad.flats, s, pad.closing, floor, faint, shallowest_well or faint)
    at_depths = [int(abs(s - depth).argmin()) for depth in pad.depth_nm]
    fitted = closing.fitted(s, np.zeros(2), cubic, looser, at_depths)
    largest_of_well = 0.0
    largest_of_net = fitted.of_net
    opening = []
    for depth, opened, well in zip(pad.depth_nm, pad.opening, wells, strict=True):
        known = np.isfinite(opened[0])
        curve = _Curve(pad.flats, s[known], opened[:, known], floor, faint, well or faint)
        # pieces over the rise, from where the opening starts
        rise = curve.fitted(s[known] - depth, curve.logarithms[:, 0], cubic, looser)
        opening.append(rise.pieces)
        largest_of_well = max(largest_of_well, rise.of_well)
        largest_of_net = max(largest_of_net, rise.of_net)
    return Tables(
        closing=fitted.pieces,
        depth_nm=pad.depth_nm,
        opening=opening,
        faint_GPa=faint,
        floor_GPa=floor,
        of_well=largest_of_well,
        of_net=largest_of_net,
    )


class _Fitted(NamedTuple):
    """Pieces of push and pull, and their largest errors near the well and elsewhere."""

    pieces: tuple[Piece, Piece]
    of_well: float
    of_net: float


class _Curve:
    """One curve of a pad, closing or opening, which pieces are fitted to.

    Parameters
    ----------
    separation_nm : shape (n,).
    pressures : repulsive and attractive (GPa, attraction negative), shape (2, n).
    well_GPa : depth of its well, to which errors are compared.
    """

    def __init__(
        self,
        flats: Flats,
        separation_nm: Array,
        pressures: Array,
        floor_GPa: float,
        faint_GPa: float,
        well_GPa: float,
    ) -> None:
        self.faint = faint_GPa
        self.well = well_GPa
        self.flats = flats.pull_GPa(separation_nm) + floor_GPa
        pull_over_flats = (floor_GPa - pressures[1]) / self.flats
        self.logarithms = np.log(
            np.stack([pressures[0] + faint_GPa, np.maximum(pull_over_flats, FLOOR)])
        )
        pull = self.flats * np.exp(self.logarithms[1])
        self.net = np.exp(self.logarithms[0]) - faint_GPa - pull
        self.allowed = (
            np.minimum(CIRCUIT.of_well * well_GPa, OF_PULL * pull)
            + CIRCUIT.of_net * abs(self.net)
            + floor_GPa
        )

    def missed(self, logarithms: Array) -> Array:
        """By how much (GPa) the net pressure by other logarithms differs from that of the curve."""
        push = np.exp(logarithms[0]) - self.faint
        return abs(push - self.flats * np.exp(logarithms[1]) - self.net)

    def fitted(
        self, x: Array, start: Array, cubic: bool, looser: float, nodes: Sequence[int] = ()
    ) -> _Fitted:
        """Pieces over places x, as near to the curve as allowed.

        Parameters
        ----------
        start : logarithms of push and pull from which the pieces count.
        nodes : positions in x that have a node at least.
        """

        def over_allowed(logarithms: Array) -> Array:
            return self.missed(logarithms) / (looser * self.allowed)

        places, by_pieces = _nodes(x, self.logarithms, over_allowed, nodes, cubic)
        push, pull = (
            Piece(x[places], logarithm[places] - first)
            for logarithm, first in zip(self.logarithms, start, strict=True)
        )
        missed = self.missed(by_pieces)
        near = abs(self.net) < CIRCUIT.near_wells * self.well
        of_well = missed / self.well
        of_net = missed / np.maximum(abs(self.net), self.faint)
        return _Fitted(
            (push, pull),
            of_well=float(of_well.max(initial=0.0, where=near)),
            of_net=float(of_net.max(initial=0.0, where=~near)),
        )


def _nodes(
    x: Array, values: Array, error: Callable[[Array], Array], nodes: Sequence[int], cubic: bool
) -> tuple[list[int], Array]:
    """Nodes, added where pieces miss the values most until `error` is below 1; and what the pieces
    give at x.
    """
    chosen = {0, x.size // 2, x.size - 1, *nodes}
    while True:
        places = sorted(chosen)
        by_pieces = _interpolated(x, x[places], values[:, places], cubic)
        missed = error(by_pieces)
        missed[places] = 0.0
        if missed.max() <= 1.0:
            return places, by_pieces
        chosen.add(int(missed.argmax()))


def _interpolated(x: Array, nodes: Array, values: Array, cubic: bool) -> Array:
    """Values at nodes, shape (2, nodes), at other places by cubic or straight pieces."""
    if cubic:
        return PchipInterpolator(nodes, values, axis=1)(x)
    return rows_at(x, nodes, values)


def curves_of_tables(tables: Tables, pad: PadCurves, cubic: bool) -> PadCurves:
    """The pad as its tables have it, at the separations of its curves."""

    def logarithms(pieces: tuple[Piece, Piece], at_nm: Array) -> Array:
        if cubic:
            return np.stack([PchipInterpolator(piece.x, piece.y)(at_nm) for piece in pieces])
        return np.stack([np.interp(at_nm, piece.x, piece.y) for piece in pieces])

    def pressures(logarithms: Array, at_nm: Array) -> Array:
        push = np.exp(logarithms[0]) - tables.faint_GPa
        flats = pad.flats.pull_GPa(at_nm) + tables.floor_GPa
        pull = flats * np.exp(logarithms[1]) - tables.floor_GPa
        return np.stack([np.maximum(push, 0.0), -np.maximum(pull, 0.0)])

    s = pad.separation_nm
    closing = pressures(logarithms(tables.closing, s), s)
    opening = np.full_like(pad.opening, np.nan)
    for number, (depth, pieces) in enumerate(zip(tables.depth_nm, tables.opening, strict=True)):
        computed = np.isfinite(pad.opening[number, 0])
        start = logarithms(tables.closing, np.array([depth]))
        above = s[computed]
        opening[number][:, computed] = pressures(start + logarithms(pieces, above - depth), above)
    return PadCurves(s, closing, pad.depth_nm, opening, pad.flats)


def note(tables: Tables, cells: int) -> str:
    """One line on what the tables were made of, and how near they are to the curves."""
    return (
        f"from {cells} cells, closed to {tables.depth_nm[0]:.4g} .. {tables.depth_nm[-1]:.4g} nm;"
        f" beside the curves at most {tables.of_well:.1%} of the well near it, {tables.of_net:.1%}"
        " of the net pressure beyond"
    )
