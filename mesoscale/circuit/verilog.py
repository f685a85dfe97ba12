"""A pad, and a lump of a switch on it, as Verilog-A modules."""

import numpy as np
from scipy.interpolate import PchipInterpolator

from mesoscale.circuit.lumps import Lumps
from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.circuit.spice import LUMP
from mesoscale.circuit.tables import Piece, Tables, note, tables_of
from mesoscale.pad.curves import PadCurves
from mesoscale.switch.beam_kernels import least_gap_nm
from mesoscale.units import VACUUM_PERMITTIVITY

FOLLOWING_S = 1e3
"""Conductance of following: large beside the 1e-12 S that simulators add to every node."""


def verilog_pad(pad: PadCurves, cells: int) -> str:
    """Verilog-A module `rough_pad` on a kinematic node."""
    tables = tables_of(pad, cubic=True)
    return f"""// Mean pressure of a pad of a rough contact that remembers its deepest closing (Asperity, docs/pad.md).
// {note(tables, cells)}
// s: mean separation (position in m) of the moving electrode above ref; the branch carries the force in N.
// closed: by how much (nm) the pad has been closed so far below {CIRCUIT.start_nm:g} nm; a state.
// Lengths in nm, pressures in GPa, hamaker in 1e-18 J; follow in s: much shorter than any motion.
`include "disciplines.vams"
`include "constants.vams"

module rough_pad(s, ref);
    inout s, ref;
    kinematic s, ref;
    electrical closed;

    parameter real area_nm2 = 1e+12 from (0:inf);
    parameter real follow = {CIRCUIT.follow_s:g} from (0:inf);
    parameter real hamaker = {pad.flats.hamaker:.12g} from [0:inf);
    parameter real offset_nm = {pad.flats.offset_nm:.12g} from [0:inf);

    real separation, further, deepest;
{verilog_pressure(tables)}
    analog begin
        separation = Pos(s, ref) * 1.0e9;
        further = {CIRCUIT.start_nm:.1f} - separation - V(closed);
        I(closed) <+ {FOLLOWING_S:.1f} * (follow * ddt(V(closed)) + {CIRCUIT.leak:g} * V(closed)
            - max(further, 0.0));

        deepest = min({CIRCUIT.start_nm:.1f} - V(closed), separation);
        if (deepest < {tables.depth_nm[0]:.7g})
            $strobe("rough_pad: closed to %g nm, the table ends at {tables.depth_nm[0]:.4g} nm", deepest);

        // 1 GPa nm^2 = 1 nN; a positive pressure pushes s away from ref
        F(s, ref) <+ -area_nm2 * pressure(separation, deepest, hamaker, offset_nm) * 1.0e-9;
    end
endmodule
"""


def verilog_pressure(tables: Tables) -> str:
    """Verilog-A functions of the net pressure (GPa) by separation and deepest closing (nm), and of
    the flats.
    """
    functions = [
        _function("closing_push", tables.closing[0]),
        _function("closing_pull", tables.closing[1]),
    ]
    for k, (push, pull) in enumerate(tables.opening):
        functions += [_function(f"repel{k}", push), _function(f"attract{k}", pull)]
    depths = tables.depth_nm
    last = tables.depth_nm.size - 1
    between = [
        f"""if (deepest < {depths[k + 1]:.7g}) begin
                share = max((deepest - {depths[k]:.7g}) / {depths[k + 1] - depths[k]:.7g}, 0.0);
                push = push + (1.0 - share) * repel{k}(risen) + share * repel{k + 1}(risen);
                pull = pull + (1.0 - share) * attract{k}(risen) + share * attract{k + 1}(risen);
            end"""
        for k in range(last)
    ]
    between.append(f"""begin
                share = max(1.0 - (deepest - {depths[last]:.7g}) / {CIRCUIT.fade_nm:.1f}, 0.0);
                push = push + share * repel{last}(risen);
                pull = pull + share * attract{last}(risen);
                if (deepest > {depths[last]:.7g}) begin
                    push = push + (1.0 - share) * (closing_push(separation) - closing_push(deepest));
                    pull = pull + (1.0 - share) * (closing_pull(separation) - closing_pull(deepest));
                end
            end""")
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
            flats = hamaker / (6.0 * `M_PI * pow(max(separation, {tables.closing[0].x[0]:.7g}) + offset, 3.0)) + {tables.floor_GPa:g};
            pressure = exp(push) - {tables.faint_GPa:.7g} - flats * exp(pull);
        end
    endfunction
"""


def _function(name: str, piece: Piece) -> str:
    """A Verilog-A function of the cubic pieces through nodes; beyond the ends it goes on straight,
    then level.

    Branches choose the piece, which stands once: compilers write functions out wherever they are
    called.
    """
    cubic = PchipInterpolator(piece.x, piece.y)
    before = [piece.x[0], piece.y[0], float(cubic.derivative()(piece.x[0])), 0.0, 0.0]
    after = [piece.x[-1], piece.y[-1], 0.0, 0.0, 0.0]
    rows = [before, *np.vstack([piece.x[:-1], cubic.c[::-1]]).T, after]
    chosen = [
        " ".join(
            f"{letter} = {value:.9g};" for letter, value in zip(("x0", *"abcd"), row, strict=True)
        )
        for row in rows
    ]
    branches = [
        f"if (x < {x:.9g}) begin {row} end" for x, row in zip(piece.x, chosen, strict=False)
    ]
    body = "\n            else ".join([*branches, f"begin {chosen[-1]} end"])
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


def _uneven(lumps: Lumps) -> str:
    """The function of what uneven charge adds to the square of the voltage; nothing without it."""
    return _function("uneven", Piece(*lumps.uneven_V2)) if lumps.uneven_V2.size else ""


def verilog_lump(lumps: Lumps, pad: PadCurves, cells: int) -> str:
    """Verilog-A module `rough_lump`."""
    tables = tables_of(pad, cubic=True)
    width = f"{lumps.width_m:.9g}"
    felt_V2 = "(volts * volts + uneven(s))" if lumps.uneven_V2.size else "volts * volts"
    names = LUMP.replace(" ", ", ")
    return f"""// A pair of lumps of an electrostatic switch on a rough contact (Asperity, docs/circuit.md).
// {note(tables, cells)}
// It takes the place of the SPICE subcircuit rough_lump: same nodes, same units. hamaker in 1e-18 J, follow in s.
`include "disciplines.vams"
`include "constants.vams"

module rough_lump({names});
    inout {names};
    electrical {names}, closed, lost;

    parameter real rest = 1.0 from (0:inf);
    parameter real area = 1.0 from (0:inf);
    parameter real fringe = 0.0 from [0:inf);
    parameter real gas = {lumps.gas_Pa:.9g} from (0:inf);
    parameter real viscosity = {CIRCUIT.viscosity_Pa_s:g} from (0:inf);
    parameter real follow = {CIRCUIT.follow_s:g} from (0:inf);
    parameter real hamaker = {pad.flats.hamaker:.12g} from [0:inf);
    parameter real offset_nm = {pad.flats.offset_nm:.12g} from [0:inf);

    real volts, s, electric, deepest, film, excess, dense, thinner;
{verilog_pressure(tables)}{_uneven(lumps)}
    analog begin
        volts = V(top, bottom);
        s = rest - V(moved);
        electric = max(s + {lumps.dielectric_nm:.9g}, {least_gap_nm(lumps.dielectric_nm):.9g}) * 1.0e-9;
        deepest = min({CIRCUIT.start_nm:.1f} - V(closed), s);
        film = max(s, {CIRCUIT.least_film_nm:.1f});
        excess = (rest - V(lost)) / film - 1.0;
        dense = max(1.0 + excess, {CIRCUIT.least_density:g});
        thinner = 1.0 + 9.638 * pow({CIRCUIT.free_path_nm_Pa:.9g} / (gas * dense * film), 1.159);
        I(closed) <+ {FOLLOWING_S:.1f} * (follow * ddt(V(closed)) + {CIRCUIT.leak:g} * V(closed)
            - max({CIRCUIT.start_nm:.1f} - s - V(closed), 0.0));
        I(lost) <+ 1.0e-6 * ddt(V(lost)) - 1.0e-24 * gas * dense * excess * film * film * film
            * thinner / (viscosity * {lumps.width_m**2:.9g});
        I(charge) <+ -1.0e15 * volts * area * {VACUUM_PERMITTIVITY} * (1.0 / electric
            + fringe / {width} * ln(`M_PI * {width} / electric));
        V(drawn) <+ 0.5 * {VACUUM_PERMITTIVITY} * {felt_V2} * (1.0 + fringe * electric / {width})
            / (electric * electric) - 1.0e9 * pressure(s, deepest, hamaker, offset_nm) - gas * excess;
        if (deepest < {tables.depth_nm[0]:.7g})
            $strobe("rough_lump: closed to %g nm, the table ends at {tables.depth_nm[0]:.4g} nm", deepest);
    end
endmodule
"""
