"""The curves of a pad as tables for circuit simulators, with the deepest closing as a state.

The state is `closed` = start - (smallest separation so far) >= 0. It follows start - s upward with the time constant
`follow` and stays where it is while the pad opens, but for a leak that a simulator needs to find its first balance.

Closing gives the logarithms of push and pull at the deepest separation. An opening from there adds how both change with
the rise above it, interpolated between the depths that were computed. Verilog-A gets monotone cubic pieces (Fritsch and
Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300), so that force and slope are continuous; SPICE gets straight ones.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from mesoscale.pad.memory import FLOOR_GPa, PadLaw, rows_at

Array = NDArray[np.float64]

START_NM = 200.0
"""Separation from which closing counts; a pad is not in contact so far out."""
FOLLOWING = 1e3
"""Conductance of following (S) in Verilog-A: large beside the 1e-12 S that simulators add to every node."""
MEMORY_F = 1e-6
"""Capacitance of the state in SPICE, whatever its time constant. With a slow memory a capacitance of its conductance
drew kiloamperes at the landing, and ngspice shrank its steps to nothing."""
FOLLOW_S = 1e-9
"""Time constant (s): much shorter than any motion."""
LEAK = 1e-15
"""Conductance of the leak over that of following: the state falls by 1e-15 of itself per time constant."""
OF_WELL, OF_NET, OF_PULL = 0.003, 0.0005, 0.05
"""Error that tables may have beside the curves: of the well and of the net pressure; far out, of the pull."""
NEAR = 10.0
"""Net pressures up to so many wells are near the well."""
REACH_NM = 20.0
"""So far below its deepest closing the repulsion of a pad goes on to grow in SPICE, at most `MOST` e-folds."""
MOST = 8.0
FADE_NM = 5.0
"""So much above the shallowest depth, a pad opens as it closed: it has not been in contact."""
FAINT = 1e-3
"""A push of this part of the shallowest well counts as none, so that its logarithm stays finite."""


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
    of_well : largest error on opening where the net pressure is below `NEAR` wells, over the well.
    of_net : largest error elsewhere, over the net pressure.
    """

    closing: tuple[Piece, Piece]
    depth_nm: Array
    opening: list[tuple[Piece, Piece]]
    faint_GPa: float
    of_well: float
    of_net: float


def tables_of(law: PadLaw, cubic: bool, looser: float = 1.0) -> Tables:
    """Tables of the curves of a pad; `cubic` or straight pieces; `looser` times the errors that they may have."""
    wells = np.array([-min(np.nanmin(opened.sum(axis=0)), 0.0) for opened in law.opening])
    faint = max(FAINT * float(wells.min()), 1e2 * FLOOR_GPa)
    s = law.separation_nm

    def logarithms(pressures: Array, at_nm: Array) -> Array:
        pull = (FLOOR_GPa - pressures[1]) / (FLOOR_GPa + law.flats.pull_GPa(at_nm))
        return np.log(np.stack([pressures[0] + faint, np.maximum(pull, FLOOR_GPa)]))

    def fitted(
        x: Array, values: Array, at_nm: Array, start: Array, well: float, nodes: Sequence[int] = ()
    ) -> tuple[tuple[Piece, Piece], float, float]:
        flats = law.flats.pull_GPa(at_nm) + FLOOR_GPa
        push, pull = np.exp(values[0]) - faint, flats * np.exp(values[1])
        net = push - pull

        def missed(made: Array) -> Array:
            return abs(np.exp(made[0]) - faint - flats * np.exp(made[1]) - net)

        allowed = np.minimum(OF_WELL * well, OF_PULL * pull) + OF_NET * abs(net) + FLOOR_GPa
        at, made = _nodes(x, values, lambda made: missed(made) / (looser * allowed), nodes, cubic)
        near = abs(net) < NEAR * well
        of_well, of_net = missed(made) / well, missed(made) / np.maximum(abs(net), faint)
        first, second = (Piece(x[at], row[at] - shift) for row, shift in zip(values, start, strict=True))
        return (first, second), float(of_well.max(initial=0.0, where=near)), float(of_net.max(initial=0.0, where=~near))

    at_depths = [int(abs(s - depth).argmin()) for depth in law.depth_nm]
    closing, _, of_closing = fitted(
        s, logarithms(law.closing, s), s, np.zeros(2), float(wells.min()) or faint, at_depths
    )
    opening, errors = [], []
    for depth, opened, well in zip(law.depth_nm, law.opening, wells, strict=True):
        known = np.isfinite(opened[0])
        values = logarithms(opened[:, known], s[known])
        pieces, *missed = fitted(s[known] - depth, values, s[known], values[:, 0], well or faint)
        opening.append(pieces)
        errors.append(missed)
    of_well, of_net = np.max(errors, axis=0)
    return Tables(closing, law.depth_nm, opening, faint, float(of_well), max(float(of_net), of_closing))


def _nodes(
    x: Array, values: Array, error: Callable[[Array], Array], nodes: Sequence[int], cubic: bool
) -> tuple[list[int], Array]:
    """Nodes, added where pieces miss the values most until `error` is below 1; and what the pieces give at x."""
    chosen = {0, x.size // 2, x.size - 1, *nodes}
    while True:
        at = sorted(chosen)
        made = PchipInterpolator(x[at], values[:, at], axis=1)(x) if cubic else rows_at(x, x[at], values[:, at])
        missed = error(made)
        missed[at] = 0.0
        if missed.max() <= 1.0:
            return at, made
        chosen.add(int(missed.argmax()))


def verilog_pad(law: PadLaw, cells: int, area_nm2: float = 1e12) -> str:
    """Verilog-A module `rough_pad` on a kinematic node."""
    tables = tables_of(law, cubic=True)
    return f"""// Mean pressure of a pad of a rough contact that remembers its deepest closing (Asperity, docs/pad.md).
// {note(tables, cells)}
// s: mean separation (position in m) of the moving electrode above ref; the branch carries the force in N.
// closed: by how much (nm) the pad has been closed so far below {START_NM:g} nm; a state.
// Lengths in nm, pressures in GPa, hamaker in 1e-18 J; follow in s: much shorter than any motion.
`include "disciplines.vams"
`include "constants.vams"

module rough_pad(s, ref);
    inout s, ref;
    kinematic s, ref;
    electrical closed;

    parameter real area_nm2 = {area_nm2:.12g} from (0:inf);
    parameter real follow = {FOLLOW_S:g} from (0:inf);
    parameter real hamaker = {law.flats.hamaker:.12g} from [0:inf);
    parameter real offset_nm = {law.flats.offset_nm:.12g} from [0:inf);

    real separation, further, deepest;
{verilog_pressure(tables)}
    analog begin
        separation = Pos(s, ref) * 1.0e9;
        further = {START_NM:.1f} - separation - V(closed);
        I(closed) <+ {FOLLOWING:.1f} * (follow * ddt(V(closed)) + {LEAK:g} * V(closed) - max(further, 0.0));

        deepest = min({START_NM:.1f} - V(closed), separation);
        if (deepest < {tables.depth_nm[0]:.7g})
            $strobe("rough_pad: closed to %g nm, the table ends at {tables.depth_nm[0]:.4g} nm", deepest);

        // 1 GPa nm^2 = 1 nN; a positive pressure pushes s away from ref
        F(s, ref) <+ -area_nm2 * pressure(separation, deepest, hamaker, offset_nm) * 1.0e-9;
    end
endmodule
"""


def verilog_pressure(tables: Tables) -> str:
    """Verilog-A functions of the net pressure (GPa) by separation and deepest closing (nm), and of the flats."""
    functions = [_function("closing_push", tables.closing[0]), _function("closing_pull", tables.closing[1])]
    for k, (push, pull) in enumerate(tables.opening):
        functions += [_function(f"repel{k}", push), _function(f"attract{k}", pull)]
    depths, last = tables.depth_nm, tables.depth_nm.size - 1
    between = [
        f"""if (deepest < {depths[k + 1]:.7g}) begin
                share = max((deepest - {depths[k]:.7g}) / {depths[k + 1] - depths[k]:.7g}, 0.0);
                push = push + (1.0 - share) * repel{k}(risen) + share * repel{k + 1}(risen);
                pull = pull + (1.0 - share) * attract{k}(risen) + share * attract{k + 1}(risen);
            end"""
        for k in range(last)
    ]
    between.append(
        f"""begin
                share = max(1.0 - (deepest - {depths[last]:.7g}) / {FADE_NM:.1f}, 0.0);
                push = push + share * repel{last}(risen);
                pull = pull + share * attract{last}(risen);
            end"""
    )
    return f"""
{"".join(functions)}
    analog function real pressure;
        input separation, deepest, hamaker, offset;
        real separation, deepest, hamaker, offset, risen, share, push, pull, flats;
        begin
            risen = separation - deepest;
            push = closing_push(deepest);
            pull = closing_pull(deepest);
            {" else ".join(between)}
            flats = hamaker / (6.0 * `M_PI * pow(max(separation, 1.0) + offset, 3.0)) + {FLOOR_GPa:g};
            pressure = exp(push) - {tables.faint_GPa:.7g} - flats * exp(pull);
        end
    endfunction
"""


def _function(name: str, piece: Piece) -> str:
    """A Verilog-A function of the cubic pieces through nodes; beyond the ends it goes on straight, then level.

    Branches choose the piece, which stands once: compilers write functions out wherever they are called.
    """
    cubic = PchipInterpolator(piece.x, piece.y)
    before = [piece.x[0], piece.y[0], float(cubic.derivative()(piece.x[0])), 0.0, 0.0]
    after = [piece.x[-1], piece.y[-1], 0.0, 0.0, 0.0]
    rows = [before, *np.vstack([piece.x[:-1], cubic.c[::-1]]).T, after]
    chosen = [" ".join(f"{of} = {value:.9g};" for of, value in zip(("x0", *"abcd"), row, strict=True)) for row in rows]
    ends = [f"if (x < {x:.9g}) begin {row} end" for x, row in zip(piece.x, chosen, strict=False)]
    body = "\n            else ".join([*ends, f"begin {chosen[-1]} end"])
    return f"""
    analog function real {name};
        input x;
        real x, x0, a, b, c, d;
        begin
            {body}
            x0 = x - x0;
            {name} = a + x0 * (b + x0 * (c + x0 * d));
        end
    endfunction
"""


def spice_pad(law: PadLaw, cells: int, area_nm2: float = 1e12) -> str:
    """SPICE subcircuit `rough_pad` (ngspice): node s 1 V = 1 nm, node force 1 V = 1 nN, positive = pushed away."""
    tables = tables_of(law, cubic=False)
    depths = tables.depth_nm
    deepest, far = f"{START_NM:g} - V(near)", [piece.y[-1] for piece in tables.closing]
    push, pull = (Piece(piece.x, piece.y - piece.y[-1]) for piece in tables.closing)
    weights, places = [], np.append(depths, depths[-1] + FADE_NM)
    for k in range(depths.size):
        at = places[max(k - 1, 0) : k + 2]
        weights.append(_pwl(deepest, Piece(at, (at == depths[k]).astype(float))))
    sums = []
    for way, closed in enumerate((_pwl(deepest, push, REACH_NM), _pwl(deepest, pull))):
        rises = (_pwl("V(risen)", pieces[way]) for pieces in tables.opening)
        terms = [f"({weight} > 0 ? {weight}*{rise} : 0)" for weight, rise in zip(weights, rises, strict=True)]
        sums.append("\n+   + ".join([closed, *terms]))
    most = [piece.y.max() + MOST for piece in tables.closing]  # wild steps of a simulator stay finite
    return f"""* Mean pressure of a pad of a rough contact that remembers its deepest closing (Asperity, docs/pad.md).
* {note(tables, cells)}
* nodes     s      mean separation less rest, 1 V = 1 nm
*           force  force on the moving electrode, 1 V = 1 nN, positive = pushed away
* closed    by how much (nm) the pad has been closed so far below {START_NM:g} nm; a state
* follow    time constant (s) of that state: much shorter than any motion; integrate by backward Euler
*           (.options method=gear maxord=1), because what overshoots is remembered
* Nodes are 0 for a pad that is far away, where simulators begin.
.subckt rough_pad s force params: area={area_nm2:.12g} follow={FOLLOW_S:g}
+   hamaker={law.flats.hamaker:.12g} offset_nm={law.flats.offset_nm:.12g} rest=0
Cclosed closed 0 {MEMORY_F:g}
Rleak closed 0 {{follow/{MEMORY_F * LEAK:g}}}
Bclosed 0 closed I = {{{MEMORY_F:g}/follow}} * max({{{START_NM:g}-rest}} - V(s) - V(closed), 0)
Rnear near 0 1
Bnear 0 near I = max(V(closed), {{{START_NM:g}-rest}} - V(s))
Rrisen risen 0 1
Brisen 0 risen I = V(s) + V(near) + {{rest-{START_NM:g}}}
Rpush push 0 1
Bpush 0 push I = {sums[0]}
Rpull pull 0 1
Bpull 0 pull I = {sums[1]}
Rforce force 0 1
Bforce 0 force I = {{area}} * (exp(min(V(push) + {far[0]:.7g}, {most[0]:.4g})) - {tables.faint_GPa:.7g}
+   - ({{hamaker/(6*3.14159265358979324)}} / pow(max(V(s) + {{rest}}, 1) + {{offset_nm}}, 3) + {FLOOR_GPa:g})
+   * exp(min(V(pull) + {far[1]:.7g}, {most[1]:.4g})))
.ends rough_pad
"""


def _pwl(of: str, piece: Piece, below: float = 0.0) -> str:
    """Straight pieces of ngspice, the ends held, four nodes a line; `below` the first node, the slope of the first."""
    x, y = piece.x, piece.y
    held = [(x[0] - 1e3, y[0]), *zip(x, y, strict=True), (x[-1] + 1e3, y[-1])]
    if below:
        held[0] = x[0] - below, y[0] - below * (y[1] - y[0]) / (x[1] - x[0])
    nodes = [f"{x:.7g},{y:.7g}" for x, y in held]
    return f"pwl({of}" + "".join((",\n+   " if k % 4 == 0 else ", ") + node for k, node in enumerate(nodes)) + ")"


def note(tables: Tables, cells: int) -> str:
    """One line on what the tables were made of, and how near they are to the curves."""
    return (
        f"from {cells} cells, closed to {tables.depth_nm[0]:.4g} .. {tables.depth_nm[-1]:.4g} nm; beside the curves at "
        f"most {tables.of_well:.1%} of the well near it, {tables.of_net:.1%} of the net pressure beyond"
    )
