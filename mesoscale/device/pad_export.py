"""The closed form of a pad for circuit simulators, with the deepest closing as a state.

The state is `closed` = start - (smallest separation so far) >= 0. It follows start - s upward with the time constant
`follow` and stays where it is while the pad opens, but for a leak that a simulator needs to find its first balance.
"""

from dataclasses import asdict

from mesoscale.errors import InputError
from mesoscale.pad.compact import CompactPad, fit_compact, well_status, wells_of
from mesoscale.pad.memory import PadLaw

START_NM = 200.0
"""Separation from which closing counts; a pad is not in contact so far out."""
FOLLOWING = 1e3
"""Conductance of following (S): large beside the 1e-12 S that simulators add to every node."""
LEAK = 1e-15
"""Conductance of the leak over that of following: the state falls by 1e-15 of itself per time constant."""


def verilog_pad(law: PadLaw, cells: int, area_nm2: float = 1e12) -> str:
    """Verilog-A module `rough_pad` on a kinematic node; a comment says why where the curves give no closed form."""
    fitted, note = _closed_form(law, cells)
    if fitted is None:
        return f"// {note}\n"
    parameters = "\n".join(f"    parameter real {name} = {value:.17g};" for name, value in asdict(fitted).items())
    return f"""// Mean pressure of a pad of a rough contact that remembers its deepest closing (Asperity, docs/pad.md).
// {note}
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
    parameter real follow = 1.0e-9 from (0:inf);
{parameters}

    real separation, further, deepest, risen, load, decay, lift, far, near;

    analog begin
        separation = Pos(s, ref) * 1.0e9;
        further = {START_NM:.1f} - separation - V(closed);
        I(closed) <+ {FOLLOWING:.1f} * (follow * ddt(V(closed)) + {LEAK:g} * V(closed) - max(further, 0.0));

        deepest = min({START_NM:.1f} - V(closed), separation);
        risen = separation - deepest;
        load = exp(-c0 - c1_per_nm * deepest - c2_per_nm2 * deepest * deepest);
        decay = (b0_per_nm + b1_per_nm2 * deepest) * risen + b2_per_nm2 * risen * risen;
        far = hamaker / (6.0 * `M_PI * pow(max(separation, 1.0) + offset_nm, 3.0));
        lift = 1.0 + lifted * pow(max(1.0 - exp(-decay), 0.0), 3.0);
        near = beta * 1.0e-3 * exp(m * ln(load / 1.0e-3) - n * decay) * lift;

        // 1 GPa nm^2 = 1 nN; a positive pressure pushes s away from ref
        F(s, ref) <+ -area_nm2 * (load * exp(-decay) - far - near) * 1.0e-9;
    end
endmodule
"""


def spice_pad(law: PadLaw, cells: int, area_nm2: float = 1e12) -> str:
    """SPICE subcircuit `rough_pad` (ngspice): node s 1 V = 1 nm, node force 1 V = 1 nN, positive = pushed away."""
    fitted, note = _closed_form(law, cells)
    if fitted is None:
        return f"* {note}\n"
    defaults = " ".join(f"{name}={value:.17g}" for name, value in asdict(fitted).items())
    load = "exp(-{c0} - {c1_per_nm}*V(deepest) - {c2_per_nm2}*V(deepest)*V(deepest))"
    return f"""* Mean pressure of a pad of a rough contact that remembers its deepest closing (Asperity, docs/pad.md).
* {note}
* nodes     s      mean separation, 1 V = 1 nm
*           force  force on the moving electrode, 1 V = 1 nN, positive = pushed away
* closed    by how much (nm) the pad has been closed so far below {START_NM:g} nm; a state
* follow    time constant (s) of that state: much shorter than any motion; integrate by backward Euler
*           (.options method=gear maxord=1), because what overshoots is remembered
.subckt rough_pad s force params: area={area_nm2:.12g} follow=1e-9 {defaults}
Cclosed closed 0 {{{FOLLOWING:g}*follow}}
Rleak closed 0 {1 / (FOLLOWING * LEAK):g}
Bclosed 0 closed I = {FOLLOWING:g} * max({START_NM:g} - V(s) - V(closed), 0)
Bdeepest deepest 0 V = min({START_NM:g} - V(closed), V(s))
Brisen risen 0 V = V(s) - V(deepest)
Bload load 0 V = {load}
Bdecay decay 0 V = ({{b0_per_nm}} + {{b1_per_nm2}}*V(deepest))*V(risen) + {{b2_per_nm2}}*V(risen)*V(risen)
Bgone gone 0 V = max(1 - exp(-V(decay)), 0)
Bwalls walls 0 V = max(V(s), 1) + {{offset_nm}}
Bfar far 0 V = {{hamaker/(6*3.14159265358979324)}} / (V(walls)*V(walls)*V(walls))
Bforce force 0 V = {{area}} * (V(load)*exp(-V(decay)) - V(far)
+   - {{beta*1e-3}} * exp({{m}}*ln(V(load)/1e-3) - {{n}}*V(decay)) * (1 + {{lifted}}*V(gone)*V(gone)*V(gone)))
.ends rough_pad
"""


def _closed_form(law: PadLaw, cells: int) -> tuple[CompactPad | None, str]:
    """The closed form, None where there is none, and one line on it."""
    try:
        fitted, residuals = fit_compact(law)
    except InputError as error:
        return None, str(error)
    low, high = float(law.depth_nm[0]), float(law.depth_nm[-1])
    return fitted, (
        f"from {cells} cells, closed to {low:.4g} .. {high:.4g} nm; misfit {residuals.closing:.0%} closing, "
        f"{residuals.opening:.0%} opening, {residuals.attraction_opening:.0%} attraction on opening; "
        f"well: {well_status(wells_of(fitted, law))}"
    )
