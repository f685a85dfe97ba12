"""The whole switch for circuit simulators: `mesoscale.device.lumps` on the tables of `mesoscale.device.pad_export`.

A netlist holds the electrode: its stiffness, and one instance of `rough_lump` for each pair of lumps. That lump is a
SPICE subcircuit, which ngspice runs as it is, or a Verilog-A module with the same nodes, which is compiled once.

Terminals are `top` and `bottom` of the two electrodes, and `middle`: by how much mid-span has come down (1 V = 1 nm).
Inside, voltages are nm, nm/us, Pa and fC. All are zero for the open switch at rest, where simulators begin. What
follows from others is a current into 1 Ohm: voltage sources would double the equations.
"""

import numpy as np

from mesoscale.device.beam_kernels import NM, least_gap_nm
from mesoscale.device.lumps import LEAST_GAS, LEAST_NM, VISCOSITY, FREE_PATH_nm_Pa, Lumps, Study
from mesoscale.device.pad_export import (
    FOLLOW_S,
    FOLLOWING,
    LEAK,
    START_NM,
    note,
    spice_pad,
    tables_of,
    verilog_pressure,
)
from mesoscale.device.switch import VACUUM_PERMITTIVITY
from mesoscale.pad.memory import PadLaw

FORCE = 1e-5
"""Current (A) of a pressure of 1 Pa on a lump: the `abstol` of a simulator is then small beside what moves it."""
SLOPE = 1e-2
"""Slope of the electrode of 1 V, so that a simulator's `vntol` is small beside slopes, too."""
LUMP = "top bottom moved drawn charge"
"""Nodes of a lump: the electrodes; how far it has moved (nm); what draws it down (Pa); its charge (fC), a
current into 1 Ohm."""


def spice_switch(lumps: Lumps, study: Study, law: PadLaw, cells: int) -> str:
    """SPICE netlist (ngspice) of the subcircuits `rough_switch`, `rough_lump` and `rough_pad`."""
    numbers, body, springs = range(lumps.count), [], FORCE * lumps.spring_Pa_nm
    drawn, heights = lumps.drawn_m * NM / SLOPE, lumps.height_nm
    sloped = FORCE * lumps.stretching_N_m * NM * SLOPE / lumps.area_m2
    for k in numbers:
        held = "\n".join(f"G{k}_{j} speed{k} 0 bent{j} 0 {springs[k, j]:.12g}" for j in numbers)
        if lumps.stretching_N_m:
            held += "\n" + "\n".join(f"Gslope{k}_{j} 0 slope{k} bent{j} 0 {drawn[k, j]:.12g}" for j in numbers)
            held += f"""
Islope{k} 0 slope{k} {-(drawn[k] @ heights):.12g}
Rslope{k} slope{k} 0 1
Bstretch{k} speed{k} 0 I = {sloped[k]:.12g} * V(longer) * V(slope{k})
Blonger{k} 0 longer I = {0.5 * SLOPE:g} * (V(bent{k}) + {-heights[k]:.9g}) * V(slope{k})"""
        of = f"rest={lumps.rest_nm[k]:.9g} area={lumps.area_m2[k]:.9g}"
        body.append(f"""Xlump{k} top bottom moved{k} drawn{k} charge rough_lump {of}
+   gas={{gas}} viscosity={{viscosity}} fringe={{fringe}} follow={{follow}}
Cmoved{k} moved{k} 0 1u
Gmoved{k} 0 moved{k} speed{k} 0 1
Gbent{k} 0 bent{k} moved{k} 0 1
Gmore{k} 0 bent{k} speed{k} 0 {{loss}}
Rbent{k} bent{k} 0 1
Cspeed{k} speed{k} 0 {{{1e-3 * FORCE:g}*mass}}
Gdrag{k} speed{k} 0 speed{k} 0 {{{FORCE:g}*drag}}
Gdrawn{k} 0 speed{k} drawn{k} 0 {FORCE:g}
{held}""")
    # longer: by how much (nm) the beam is longer than at rest; slopes are those of its elongation
    longer = ["Rlonger longer 0 1", f"Ilonger longer 0 {0.5 * SLOPE * heights @ drawn @ heights:.12g}"]
    width, dielectric = lumps.width_m, lumps.dielectric_nm
    electric = f"(1e-9*max({{rest+{dielectric:.9g}}} - V(moved), {least_gap_nm(dielectric):.9g}))"
    film, dense = f"max({{rest}} - V(moved), {LEAST_NM:g})", f"max(1 + V(excess), {LEAST_GAS:g})"
    return f"""* An electrostatic switch on a rough contact (Asperity, docs/switch.md).
* {_said(lumps, study)}
* top, bottom: the electrodes; middle: by how much (nm) mid-span has come down, 1 V = 1 nm.
* Inside: nm, nm/us, Pa, fC. What moves a lump: 1 A for {1.0 / FORCE:g} Pa.
* mass per area in kg/m2, loss in us, viscosity in Pa s, gas in Pa.
* drag: 0; a large one (3e4 Pa us/nm) lands the electrode softly, for loops so slow that nothing else matters.
* follow: s, until the pad remembers; 1e-6 for such loops.
* fringe: of the field at the sides; 0.6366 for a thin strip over a plane.
.subckt rough_switch top bottom middle params: fringe={lumps.fringe:.9g} gas={lumps.gas_Pa:.9g}
+   viscosity={VISCOSITY:g} mass={lumps.mass_kg_m2:.9g} loss={lumps.loss_us:.9g} drag={lumps.drag_Pa_us_nm:.9g}
+   follow={FOLLOW_S:g}
{chr(10).join([*body, *longer])}
Emiddle middle 0 moved{numbers[-1]} 0 1
Rcharge charge 0 1
Ccharge charge sense 1f
Vcharge sense 0 0
Fcharge top bottom Vcharge 1
.ends rough_switch

* A pair of lumps; Verilog-A has the same.
.subckt rough_lump {LUMP} params: rest=1 area=1 gas=1 viscosity=1 fringe=0 follow={FOLLOW_S:g}
Gup 0 up 0 moved 1
Rup up 0 1
Xpad up push rough_pad area=1e9 rest={{rest}} follow={{follow}}
Bcharge 0 charge I = 1e15 * V(top,bottom) * {{area*{VACUUM_PERMITTIVITY}}} * (1 / {electric}
+   + {{fringe/{width:.9g}}} * ln({np.pi * width:.9g} / {electric}))
Rexcess excess 0 1
Bexcess 0 excess I = ({{rest}} - V(lost)) / {film} - 1
Clost lost 0 1u
Blost 0 lost I = {{1e-24*gas/(viscosity*{width**2:.9g})}} * {dense} * V(excess) * {film}^3
+   * (1 + 9.638 * pow({{{FREE_PATH_nm_Pa:.9g}/gas}} / ({dense} * {film}), 1.159))
Rdrawn drawn 0 1
Bdrawn 0 drawn I = {0.5 * VACUUM_PERMITTIVITY} * V(top,bottom)^2 * (1 + {{fringe/{width:.9g}}} * {electric})
+   / {electric}^2 - V(push) - {{gas}} * V(excess)
.ends rough_lump

{spice_pad(law, cells)}"""


def verilog_lump(lumps: Lumps, law: PadLaw, cells: int) -> str:
    """Verilog-A module `rough_lump`."""
    tables, width = tables_of(law, cubic=True), f"{lumps.width_m:.9g}"
    names = LUMP.replace(" ", ", ")
    return f"""// A pair of lumps of an electrostatic switch on a rough contact (Asperity, docs/switch.md).
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
    parameter real viscosity = {VISCOSITY:g} from (0:inf);
    parameter real follow = {FOLLOW_S:g} from (0:inf);
    parameter real hamaker = {law.flats.hamaker:.12g} from [0:inf);
    parameter real offset_nm = {law.flats.offset_nm:.12g} from [0:inf);

    real volts, s, electric, deepest, film, excess, dense, thinner;
{verilog_pressure(tables)}
    analog begin
        volts = V(top, bottom);
        s = rest - V(moved);
        electric = max(s + {lumps.dielectric_nm:.9g}, {least_gap_nm(lumps.dielectric_nm):.9g}) * 1.0e-9;
        deepest = min({START_NM:.1f} - V(closed), s);
        film = max(s, {LEAST_NM:.1f});
        excess = (rest - V(lost)) / film - 1.0;
        dense = max(1.0 + excess, {LEAST_GAS:g});
        thinner = 1.0 + 9.638 * pow({FREE_PATH_nm_Pa:.9g} / (gas * dense * film), 1.159);
        I(closed) <+ {FOLLOWING:.1f} * (follow * ddt(V(closed)) + {LEAK:g} * V(closed)
            - max({START_NM:.1f} - s - V(closed), 0.0));
        I(lost) <+ 1.0e-6 * ddt(V(lost)) - 1.0e-24 * gas * dense * excess * film * film * film
            * thinner / (viscosity * {lumps.width_m**2:.9g});
        I(charge) <+ -1.0e15 * volts * area * {VACUUM_PERMITTIVITY} * (1.0 / electric
            + fringe / {width} * ln(`M_PI * {width} / electric));
        V(drawn) <+ 0.5 * {VACUUM_PERMITTIVITY} * volts * volts * (1.0 + fringe * electric / {width})
            / (electric * electric) - 1.0e9 * pressure(s, deepest, hamaker, offset_nm) - gas * excess;
        if (deepest < {tables.depth_nm[0]:.7g})
            $strobe("rough_lump: closed to %g nm, the table ends at {tables.depth_nm[0]:.4g} nm", deepest);
    end
endmodule
"""


def _said(lumps: Lumps, study: Study) -> str:
    """What it is made of, and how near to the finite elements."""
    if lumps.count == 1:
        return "the electrode: one plate on a spring"
    return (
        f"the electrode: {lumps.count} pairs of lumps; beside finite elements pull-in differs by {study.pull_in:.2%}, "
        f"release by {study.release:.2%}, capacitance by {study.capacitance:.2%}; these err by {study.reference:.2%}"
    )
