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

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.pad.curves import FLOOR, PadCurves, rows_at

Array = NDArray[np.float64]


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
    floor = pad.floor_GPa
    faint = max(CIRCUIT.faint * float(wells.min()), 1e2 * floor)
    s = pad.separation_nm

    def logarithms(pressures: Array, at_nm: Array) -> Array:
        pull = (floor - pressures[1]) / (floor + pad.flats.pull_GPa(at_nm))
        return np.log(np.stack([pressures[0] + faint, np.maximum(pull, FLOOR)]))

    def fitted(
        x: Array, values: Array, at_nm: Array, start: Array, well: float, nodes: Sequence[int] = ()
    ) -> tuple[tuple[Piece, Piece], float, float]:
        flats = pad.flats.pull_GPa(at_nm) + floor
        push = np.exp(values[0]) - faint
        pull = flats * np.exp(values[1])
        net = push - pull

        def missed(made: Array) -> Array:
            return abs(np.exp(made[0]) - faint - flats * np.exp(made[1]) - net)

        allowed = (
            np.minimum(CIRCUIT.of_well * well, CIRCUIT.of_pull * pull)
            + CIRCUIT.of_net * abs(net)
            + floor
        )
        node_places, made = _nodes(
            x, values, lambda made: missed(made) / (looser * allowed), nodes, cubic
        )
        near = abs(net) < CIRCUIT.near_wells * well
        of_well = missed(made) / well
        of_net = missed(made) / np.maximum(abs(net), faint)
        first, second = (
            Piece(x[node_places], row[node_places] - shift)
            for row, shift in zip(values, start, strict=True)
        )
        return (
            (first, second),
            float(of_well.max(initial=0.0, where=near)),
            float(of_net.max(initial=0.0, where=~near)),
        )

    at_depths = [int(abs(s - depth).argmin()) for depth in pad.depth_nm]
    closing, _, of_closing = fitted(
        s, logarithms(pad.closing, s), s, np.zeros(2), float(wells.min()) or faint, at_depths
    )
    opening = []
    errors = []
    for depth, opened, well in zip(pad.depth_nm, pad.opening, wells, strict=True):
        known = np.isfinite(opened[0])
        values = logarithms(opened[:, known], s[known])
        pieces, *missed = fitted(s[known] - depth, values, s[known], values[:, 0], well or faint)
        opening.append(pieces)
        errors.append(missed)
    of_well, of_net = np.max(errors, axis=0)
    return Tables(
        closing, pad.depth_nm, opening, faint, floor, float(of_well), max(float(of_net), of_closing)
    )


def _nodes(
    x: Array, values: Array, error: Callable[[Array], Array], nodes: Sequence[int], cubic: bool
) -> tuple[list[int], Array]:
    """Nodes, added where pieces miss the values most until `error` is below 1; and what the pieces
    give at x.
    """
    chosen = {0, x.size // 2, x.size - 1, *nodes}
    while True:
        node_places = sorted(chosen)
        made = (
            PchipInterpolator(x[node_places], values[:, node_places], axis=1)(x)
            if cubic
            else rows_at(x, x[node_places], values[:, node_places])
        )
        missed = error(made)
        missed[node_places] = 0.0
        if missed.max() <= 1.0:
            return node_places, made
        chosen.add(int(missed.argmax()))


def curves_of_tables(tables: Tables, pad: PadCurves, cubic: bool) -> PadCurves:
    """The pad as its tables have it, at the separations of its curves."""

    def curves(pieces: tuple[Piece, Piece], at_nm: Array) -> Array:
        pairs = [(piece.x, piece.y) for piece in pieces]
        if cubic:
            return np.stack([PchipInterpolator(*pair)(at_nm) for pair in pairs])
        return np.stack([np.interp(at_nm, *pair) for pair in pairs])

    def pressures(logarithms: Array, at_nm: Array) -> Array:
        pull = (pad.flats.pull_GPa(at_nm) + tables.floor_GPa) * np.exp(
            logarithms[1]
        ) - tables.floor_GPa
        return np.stack(
            [np.maximum(np.exp(logarithms[0]) - tables.faint_GPa, 0.0), -np.maximum(pull, 0.0)]
        )

    s = pad.separation_nm
    closing = pressures(curves(tables.closing, s), s)
    opening = np.full_like(pad.opening, np.nan)
    for number, (depth, pieces) in enumerate(zip(tables.depth_nm, tables.opening, strict=True)):
        solved_places = np.isfinite(pad.opening[number, 0])
        start = curves(tables.closing, np.array([depth]))
        opening[number][:, solved_places] = pressures(
            start + curves(pieces, s[solved_places] - depth), s[solved_places]
        )
    return PadCurves(s, closing, pad.depth_nm, opening, pad.flats)


def note(tables: Tables, cells: int) -> str:
    """One line on what the tables were made of, and how near they are to the curves."""
    return (
        f"from {cells} cells, closed to {tables.depth_nm[0]:.4g} .. {tables.depth_nm[-1]:.4g} nm;"
        f" beside the curves at most {tables.of_well:.1%} of the well near it, {tables.of_net:.1%}"
        " of the net pressure beyond"
    )
