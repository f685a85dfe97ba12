"""The whole switch for circuit simulators: `mesoscale.device.lumps` on the tables of `mesoscale.device.pad_export`.

The module has the terminals `top` and `bottom` of the two electrodes, and `middle`: by how much mid-span has come down
(1 V = 1 nm). Inside, voltages are nm and nm/us and currents pressures in Pa, so that the tolerances of simulators fit.
All internal voltages are zero for the open switch at rest, where simulators begin.
"""

import numpy as np
from numpy.typing import NDArray

from mesoscale.device.beam_kernels import least_gap_nm
from mesoscale.device.lumps import LEAST_NM, VISCOSITY, FREE_PATH_nm_Pa, Lumps, Study
from mesoscale.device.pad_export import (
    FOLLOW_S,
    FOLLOWING,
    LEAK,
    START_NM,
    note,
    tables_of,
    verilog_pressure,
)
from mesoscale.device.switch import VACUUM_PERMITTIVITY
from mesoscale.pad.memory import PadLaw

Array = NDArray[np.float64]


def verilog_switch(lumps: Lumps, study: Study, law: PadLaw, cells: int) -> str:
    """Verilog-A module `rough_switch`."""
    tables = tables_of(law, cubic=True)
    numbers, (stiffness, shapes) = range(lumps.count), lumps.modes
    share = shapes * (lumps.area_m2 / lumps.area_m2.sum())[:, None]
    inside = ", ".join(f"{name}{k}" for k in numbers for name in ("mode", "speed", "closed", "lost"))
    body = []
    for k in numbers:
        rest, area = f"{lumps.rest_nm[k]:.9g}", f"{lumps.area_m2[k]:.9g}"
        body.append(f"""
        s = {rest} - ({_sum("mode", shapes[k])});
        electric = max(s + {lumps.dielectric_nm:.9g}, {least_gap_nm(lumps.dielectric_nm):.9g}) * 1.0e-9;
        capacitance = capacitance + {VACUUM_PERMITTIVITY} * {area} * (1.0 / electric
            + fringe / {lumps.width_m:.9g} * ln(`M_PI * {lumps.width_m:.9g} / electric));
        pull = 0.5 * {VACUUM_PERMITTIVITY} * volts * volts * (1.0 + fringe * electric / {lumps.width_m:.9g})
            / (electric * electric);
        deepest = min({START_NM:.1f} - V(closed{k}), s);
        lowest = min(lowest, deepest);
        film = max(s, {LEAST_NM:.1f});
        excess = ({rest} - V(lost{k})) / film - 1.0;
        thinner = 1.0 + 9.638 * pow({FREE_PATH_nm_Pa:.9g} / (gas_Pa * max(1.0 + excess, 1.0e-6) * film), 1.159);
        I(closed{k}) <+ {FOLLOWING:.1f} * (follow * ddt(V(closed{k})) + {LEAK:g} * V(closed{k})
            - max({START_NM:.1f} - s - V(closed{k}), 0.0));
        I(lost{k}) <+ 1.0e-6 * ddt(V(lost{k})) - 1.0e-24 * gas_Pa * (1.0 + excess) * excess * film * film * film
            * thinner / (viscosity * {lumps.width_m**2:.9g});
        drawn{k} = pull - 1.0e9 * pressure(s, deepest, hamaker, offset_nm) - gas_Pa * excess;""")
    for k in numbers:
        body.append(f"""
        I(mode{k}) <+ 1.0e-6 * ddt(V(mode{k})) - V(speed{k});
        I(speed{k}) <+ 1.0e-3 * mass * ddt(V(speed{k})) + {stiffness[k]:.12g} * (V(mode{k}) + loss * V(speed{k}))
            - ({_sum("drawn", share[:, k], "{}")});""")
    return f"""// An electrostatic switch on a rough contact (Asperity, docs/switch.md).
// {_said(lumps, study)}
// {note(tables, cells)}
// top, bottom: the electrodes; middle: by how much (nm) mid-span has come down.
// Inside: nm, nm/us and Pa. mass per area in kg/m2, loss in us, viscosity in Pa s, hamaker in 1e-18 J, follow in s.
// fringe: 0 as in Asperity's answer; 0.6366 for a thin strip over a plane.
`include "disciplines.vams"
`include "constants.vams"

module rough_switch(top, bottom, middle);
    inout top, bottom, middle;
    electrical top, bottom, middle;
    electrical {inside};

    parameter real fringe = {lumps.fringe:.9g} from [0:inf);
    parameter real gas_Pa = {lumps.gas_Pa:.9g} from (0:inf);
    parameter real viscosity = {VISCOSITY:g} from (0:inf);
    parameter real mass = {lumps.mass_kg_m2:.9g} from (0:inf);
    parameter real loss = {lumps.loss_us:.9g} from [0:inf);
    parameter real follow = {FOLLOW_S:g} from (0:inf);
    parameter real hamaker = {law.flats.hamaker:.12g} from [0:inf);
    parameter real offset_nm = {law.flats.offset_nm:.12g} from [0:inf);

    real volts, capacitance, lowest, s, electric, pull, deepest, film, excess, thinner;
    real {", ".join(f"drawn{k}" for k in numbers)};
{verilog_pressure(tables)}
    analog begin
        volts = V(top, bottom);
        capacitance = 0.0;
        lowest = {START_NM:.1f};
{"".join(body)}

        I(top, bottom) <+ ddt(volts * capacitance);
        V(middle) <+ {lumps.rest_nm[-1]:.9g} - s;
        if (lowest < {tables.depth_nm[0]:.7g})
            $strobe("rough_switch: closed to %g nm, the table ends at {tables.depth_nm[0]:.4g} nm", lowest);
    end
endmodule
"""


def _sum(name: str, weights: Array, of: str = "V({})") -> str:
    """A weighted sum of nodes or variables."""
    return _wrapped([f"{weight:+.12g}*{of.format(f'{name}{k}')}" for k, weight in enumerate(weights)])


def _wrapped(terms: list[str]) -> str:
    """A sum, four terms a line; the plus that goes on in SPICE is a sign in Verilog-A."""
    return "".join(("\n+ " if k % 4 == 0 else " ") + term for k, term in enumerate(terms))


def _said(lumps: Lumps, study: Study) -> str:
    """What it is made of, and how near to the finite elements."""
    if lumps.count == 1:
        return "the electrode: one plate on a spring"
    return (
        f"the electrode: {lumps.count} pairs of lumps; beside finite elements pull-in differs by {study.pull_in:.2%}, "
        f"release by {study.release:.2%}, capacitance by {study.capacitance:.2%}"
    )
