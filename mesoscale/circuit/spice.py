"""The switch as a SPICE netlist, which ngspice runs as it is.

A netlist has three subcircuits. `rough_switch` is the electrode. It has an instance of `rough_lump`
for each pair of lumps, and this one of `rough_pad`. They integrate the equations of
`mesoscale.circuit.lumps`. `mesoscale.circuit.verilog` has the same lump as a module, which is
compiled once.

Terminals are `top` and `bottom` of the two electrodes, and `middle`, by how much mid-span has come
down (1 V = 1 nm). All nodes are zero for the open switch at rest, where simulators begin. A state
is the voltage of a capacitor. What follows from other nodes is a current into 1 Ohm: voltage
sources would double the equations.

Nodes of `rough_switch`, for lump k:

    moved{k}   m, nm         way down from rest                 dm/dt = v
    speed{k}   v, nm/us      its speed                          rho t dv/dt = sum of pressures (Pa)
    bent{k}    b, nm         m + loss v                         the stiffness acts on it, which damps
    turn{k}                  what b adds to the slope of the beam, in units of `TURN_PER_V`
    lean{k}                  what slopes pass on of the elongation, in units of `LEAN_PER_V`
    slope{k}   D (b - z0)    minus the slope of the elongation  in units of `SLOPE_PER_V`
    longer     nm            elongation since rest              ((b - z0) D (b - z0) - z0 D z0) / 2
    drawn{k}   Pa            pressure that draws the lump down  from `rough_lump`
    charge     fC            of all lumps
    felt       V             of the electrode, less the shift by even charge; without it that of `top`

The pressures on a lump of area A are drawn, -K b / A and -S longer slope / A.

`slow_switch` is the same electrode for slow voltages. It has no mass and no gas, so that bent{k} is
its only state: -c db/dt is the sum of these pressures. The drag c is that of the softest motion
times `settles`.

K and D are full. Slopes of the beam stand for them, so that a node sees its neighbours alone and a
simulator's matrix stays sparse: with the parts of `springs` and `pulled` by heights (h) and slopes
(s),

    Ssh b + Sss turn = 0                            K b = Shh b + Shs turn
    Sss lean = Psh b + Pss turn                     D b = Phh b + Phs turn - Shs lean

Nodes of `rough_lump`:

    up         nm            separation less that at rest, -m, which the pad reads
    push       Pa            pressure of the pad
    lost       nm            film of gas that has flowed out, rest - n
    excess     1             pressure of the gas over that around it, less one
"""

import numpy as np

from mesoscale.circuit.lumps import LumpErrors, Lumps
from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.circuit.tables import Piece, Tables, note, tables_of
from mesoscale.pad.curves import PadCurves
from mesoscale.switch.beam_kernels import least_gap_nm
from mesoscale.units import NM, VACUUM_PERMITTIVITY

LUMP = "top bottom moved drawn charge"
"""Terminals of `rough_lump`."""
SPEED_F = 1e-3
"""Capacitance of a speed (nm/us) per mass (kg/m2): 1 Pa on 1 kg/m2 gives 1 m/s2, 1e3 nm/us in a
second."""
FLOW = 1e-24
"""nm3 Pa / (Pa s m2) is 1e-18 nm/s, on a capacitor of 1 uF."""
FORCE_A = 1e-5
"""Current of a pressure of 1 Pa on a lump: the `abstol` of a simulator is then small beside what
moves it."""
SLOPE_PER_V = 1e-2
"""Slope of the electrode of 1 V, so that a simulator's `vntol` is small beside slopes, too."""
TURN_PER_V = 1e-6
"""Slope (rad) of 1 V."""
LEAN_PER_V = 1e-9
"""Length (m) of 1 V, over the stiffness of a slope against moments."""
BEGINS = 1.5
"""Closing counts from so many times the separation at which a pad begins to repel."""
MEMORY_F = 1e-6
"""Capacitance of the state of a pad, whatever its time constant. With a slow memory a capacitance
of its conductance drew kiloamperes at the landing, and ngspice shrank its steps to nothing."""
LOW_V = -100.0
"""From here the capacitance of the state is charged. A simulator allows an error of a charge in
proportion to it: with none at the landing, ngspice made its steps shorter until it stopped."""
REACH_NM = 20.0
"""Way below the deepest computed closing over which the repulsion of a pad goes on to grow."""
MOST_FOLDS = 8.0
"""It grows by so many e-folds at most: wild steps of a simulator stay finite."""


def spice_switch(
    lumps: Lumps, errors: LumpErrors, pad: PadCurves, cells: int, pull_in_V: float
) -> str:
    """SPICE netlist (ngspice) of the subcircuits `rough_switch`, `slow_switch`, and their parts."""
    pairs = "\n".join(_pair(lumps, k) for k in range(lumps.count))
    slow_pairs = "\n".join(_slow_pair(lumps, k) for k in range(lumps.count))
    return f"""* An electrostatic switch on a rough contact (Asperity, docs/circuit.md).
* the electrode: {lumps.count} pairs of lumps; beside finite elements pull-in differs by {errors.pull_in:.2%},
* release by {errors.release:.2%}, capacitance by {errors.capacitance:.2%}; these err by {errors.reference:.2%}
* top, bottom: the electrodes; middle: by how much (nm) mid-span has come down, 1 V = 1 nm.
* Inside: nm, nm/us, Pa, fC. What moves a lump: 1 A for {1.0 / FORCE_A:g} Pa.
* mass per area in kg/m2, loss in us, viscosity in Pa s, gas in Pa.
* follow: s, until the pad remembers.
* fringe: of the field at the sides; 0.6366 for a thin strip over a plane.
* pull_in_V: of this switch, for decks that include this file: a step of {{1.2*pull_in_V}} closes it.
.param pull_in_V={pull_in_V:.6g}
.subckt rough_switch top bottom middle params: fringe={lumps.fringe:.9g} gas={lumps.gas_Pa:.9g}
+   viscosity={CIRCUIT.viscosity_Pa_s:g} mass={lumps.mass_kg_m2:.9g} loss={lumps.loss_us:.9g}
+   follow={CIRCUIT.follow_s:g}
{pairs}
{_elongation(lumps)}
Emiddle middle 0 moved{lumps.count - 1} 0 1
{_drawn_charge(lumps)}.ends rough_switch

* The same for slow voltages: no mass, no gas. settles: s, in which the beam at rest forgets a push.
.subckt slow_switch top bottom middle params: fringe={lumps.fringe:.9g} settles={CIRCUIT.settles_s:g}
+   follow={CIRCUIT.follow_s:g}
{slow_pairs}
{_elongation(lumps)}
Emiddle middle 0 bent{lumps.count - 1} 0 1
{_drawn_charge(lumps)}.ends slow_switch

{_slow_lump(lumps)}

{_lump(lumps)}

{spice_pad(pad, cells)}"""


def _pair(lumps: Lumps, k: int) -> str:
    """Elements of a pair of lumps in `rough_switch`: its lump, states, and what acts on its speed."""
    force = FORCE_A
    area_m2 = lumps.area_m2[k]
    lines = [
        f"Xlump{k} {_electrode(lumps)} bottom moved{k} drawn{k} charge rough_lump",
        f"+   rest={lumps.rest_nm[k]:.9g} area={area_m2:.9g}",
        "+   gas={gas} viscosity={viscosity} fringe={fringe} follow={follow}",
        f"Cmoved{k} moved{k} 0 1u",
        f"Gmoved{k} 0 moved{k} speed{k} 0 1",
        f"Gbent{k} 0 bent{k} moved{k} 0 1",
        f"Gmore{k} 0 bent{k} speed{k} 0 {{loss}}",
        f"Rbent{k} bent{k} 0 1",
        f"Cspeed{k} speed{k} 0 {{{SPEED_F * force:g}*mass}}",
        f"Gdrawn{k} 0 speed{k} drawn{k} 0 {force:g}",
        *_bending(lumps, k, "speed"),
    ]
    return "\n".join(lines)


def _slow_pair(lumps: Lumps, k: int) -> str:
    """Elements of a pair of lumps in `slow_switch`: what acts on it moves it against a drag."""
    drag_F = FORCE_A * lumps.slowest_Pa_m * NM
    lines = [
        f"Xlump{k} {_electrode(lumps)} bottom bent{k} drawn{k} charge slow_lump",
        f"+   rest={lumps.rest_nm[k]:.9g} area={lumps.area_m2[k]:.9g}",
        "+   fringe={fringe} follow={follow}",
        f"Cbent{k} bent{k} 0 {{{drag_F:.6g}*settles}}",
        f"Gdrawn{k} 0 bent{k} drawn{k} 0 {FORCE_A:g}",
        *_bending(lumps, k, "bent"),
    ]
    return "\n".join(lines)


def _bending(lumps: Lumps, k: int, moved: str) -> list[str]:
    """Elements with which the bent and stretched beam acts on a lump.

    Parameters
    ----------
    moved : node, less its number, into which the current of a pressure flows.
    """
    n = lumps.count
    slope_at_rest = -(lumps.drawn_m[k] @ lumps.height_nm) * NM / SLOPE_PER_V
    lines = [f"Rslope{k} slope{k} 0 1", f"Islope{k} 0 slope{k} {slope_at_rest:.16g}"]
    heights = lumps.springs[k] * FORCE_A / lumps.area_m2[k]
    lines += _currents(f"{moved}{k} 0", "bent", heights[:n] * NM)
    lines += _currents(f"{moved}{k} 0", "turn", heights[n:] * TURN_PER_V)
    stretch = FORCE_A * lumps.stretching_N_m * NM * SLOPE_PER_V / lumps.area_m2[k]
    lines += [
        f"Bstretch{k} {moved}{k} 0 I = {stretch:.12g} * V(longer) * V(slope{k})",
        f"Blonger{k} 0 longer I = {0.5 * SLOPE_PER_V:g}"
        f" * (V(bent{k}) + {-lumps.height_nm[k]:.9g}) * V(slope{k})",
    ]
    pulled = lumps.pulled[k] / SLOPE_PER_V
    lines += _currents(f"0 slope{k}", "bent", pulled[:n] * NM)
    lines += _currents(f"0 slope{k}", "turn", pulled[n:] * TURN_PER_V)
    if lumps.springs.shape[0] == n:
        return lines
    against_moment = np.diag(lumps.springs)[n:]
    passed = lumps.springs[k, n:] * LEAN_PER_V / against_moment / SLOPE_PER_V
    lines += _currents(f"slope{k} 0", "lean", passed)
    # Ohm's law is the diagonal of both equations of slopes
    others = np.arange(n) != k
    moments = lumps.springs[n + k]
    lines += [f"Rturn{k} turn{k} 0 1", f"Rlean{k} lean{k} 0 1"]
    per_slope = against_moment[k] * TURN_PER_V
    lines += _currents(f"turn{k} 0", "bent", moments[:n] * NM / per_slope)
    lines += _currents(f"turn{k} 0", "turn", moments[n:] * others / against_moment[k])
    lines += _currents(f"lean{k} 0", "lean", moments[n:] * others / against_moment)
    passing = lumps.pulled[n + k] / LEAN_PER_V
    lines += _currents(f"0 lean{k}", "bent", passing[:n] * NM)
    lines += _currents(f"0 lean{k}", "turn", passing[n:] * TURN_PER_V)
    return lines


def _currents(between: str, nodes: str, conductances: np.ndarray) -> list[str]:
    """Currents from one node to another by the voltages of numbered ones; none where it is 0."""
    name = f"G{between.replace(' ', '')}_{nodes}"
    return [
        f"{name}{j} {between} {nodes}{j} 0 {conductances[j]:.16g}"
        for j in np.flatnonzero(conductances)
    ]


def _electrode(lumps: Lumps) -> str:
    """Node whose voltage the lumps feel."""
    return "felt" if lumps.shift_V else "top"


def _shift(lumps: Lumps) -> str:
    """The source that takes the shift by even charge off the drive; nothing without it."""
    return f"Vshift top felt {lumps.shift_V:.9g}\n" if lumps.shift_V else ""


def _elongation(lumps: Lumps) -> str:
    """Node `longer`, to which each pair adds, less what the beam at rest has."""
    heights = lumps.height_nm
    at_rest = 0.5 * NM * heights @ lumps.drawn_m @ heights
    return f"Rlonger longer 0 1\nIlonger longer 0 {at_rest:.16g}"


def _drawn_charge(lumps: Lumps) -> str:
    """What the drive gives: the charge of all lumps; and the shift of what they feel."""
    return f"""Rcharge charge 0 1
Ccharge charge sense 1f
Vcharge sense 0 0
Fcharge top bottom Vcharge 1
{_shift(lumps)}"""


def _slow_lump(lumps: Lumps) -> str:
    """The subcircuit `slow_lump`: a lump without gas."""
    return f""".subckt slow_lump {LUMP} params: rest=1 area=1 fringe=0 follow={CIRCUIT.follow_s:g}
{_pad_and_pull(lumps)} - V(push)
.ends slow_lump"""


def _lump(lumps: Lumps) -> str:
    """The subcircuit `rough_lump`: what draws a pair of lumps down, and its charge."""
    width = lumps.width_m
    # thickness of the gas (nm), its density over that around
    # viscosity in a narrow gap is lower by 1 + 9.638 Kn^1.159 (Veijola, see `lumps`)
    film = f"max({{rest}} - V(moved), {CIRCUIT.least_film_nm:g})"
    dense = f"max(1 + V(excess), {CIRCUIT.least_density:g})"
    knudsen = f"{{{CIRCUIT.free_path_nm_Pa:.9g}/gas}} / ({dense} * {film})"
    return f"""* A pair of lumps; Verilog-A has the same.
.subckt rough_lump {LUMP} params: rest=1 area=1 gas=1 viscosity=1 fringe=0 follow={CIRCUIT.follow_s:g}
Rexcess excess 0 1
Bexcess 0 excess I = ({{rest}} - V(lost)) / {film} - 1
Clost lost 0 1u
Blost 0 lost I = {{{FLOW:g}*gas/(viscosity*{width**2:.9g})}} * {dense} * V(excess) * {film}^3
+   * (1 + 9.638 * pow({knudsen}, 1.159))
{_pad_and_pull(lumps)} - V(push) - {{gas}} * V(excess)
.ends rough_lump"""


def _pad_and_pull(lumps: Lumps) -> str:
    """The pad of a lump, its charge, and the beginning of what draws it down: the pull."""
    width = lumps.width_m
    dielectric = lumps.dielectric_nm
    # electric gap (m)
    electric = f"(1e-9*max({{rest+{dielectric:.9g}}} - V(moved), {least_gap_nm(dielectric):.9g}))"
    felt_V2 = "V(top,bottom)^2"
    if lumps.uneven_V2.size:
        uneven = _pwl("{rest} - V(moved)", Piece(*lumps.uneven_V2))
        felt_V2 = f"(V(top,bottom)^2\n+   + {uneven})"
    return f"""Gup 0 up 0 moved 1
Rup up 0 1
Xpad up push rough_pad area=1e9 rest={{rest}} follow={{follow}}
Bcharge 0 charge I = 1e15 * V(top,bottom) * {{area*{VACUUM_PERMITTIVITY}}} * (1 / {electric}
+   + {{fringe/{width:.9g}}} * ln({np.pi * width:.9g} / {electric}))
Rdrawn drawn 0 1
Bdrawn 0 drawn I = {0.5 * VACUUM_PERMITTIVITY} * {felt_V2} * (1 + {{fringe/{width:.9g}}} * {electric})
+   / {electric}^2"""


def spice_pad(pad: PadCurves, cells: int) -> str:
    """SPICE subcircuit `rough_pad` (ngspice): node s 1 V = 1 nm, node force 1 V = 1 nN, positive =
    pushed away.

    The pressure of a pad at a separation s is

        p = exp(push) - faint - (A / (6 pi (s + offset)^3) + floor) exp(pull),

    with A the Hamaker constant of the flats. `push` and `pull` are pieces over the deepest
    separation and, of what they change by while the pad opens, over the rise above it. Nodes hold
    them less their values far out (`far`), so that they are zero where simulators begin.
    """
    tables = tables_of(pad, cubic=False)
    # closing counts from a little farther out than the pad repels: a lump that begins to count is a
    # corner for ngspice
    repels = pad.separation_nm[pad.closing[0] > 0.0]
    start = BEGINS * float(repels.max(initial=tables.depth_nm[-1] + CIRCUIT.fade_nm))
    deepest = f"{start:g} - V(near)"
    far = [piece.y[-1] for piece in tables.closing]
    push, pull = (Piece(piece.x, piece.y - piece.y[-1]) for piece in tables.closing)
    openings = _openings(tables, deepest)
    pushes = [_pwl("V(risen)", push_change) for push_change, _ in tables.opening]
    pulls = [_pwl("V(risen)", pull_change) for _, pull_change in tables.opening]
    apart = "V(s) + {rest}"
    push_sum = _weighted(
        _pwl(deepest, push, REACH_NM), openings, pushes, _back(tables, push, deepest, apart)
    )
    pull_sum = _weighted(_pwl(deepest, pull), openings, pulls, _back(tables, pull, deepest, apart))
    largest = [piece.y.max() + MOST_FOLDS for piece in tables.closing]
    return f"""* Mean pressure of a pad of a rough contact that remembers its deepest closing (Asperity, docs/pad.md).
* {note(tables, cells)}
* nodes     s      mean separation less rest, 1 V = 1 nm
*           force  force on the moving electrode, 1 V = 1 nN, positive = pushed away
* closed    by how much (nm) the pad has been closed so far below {start:g} nm; a state
* follow    time constant (s) of that state: much shorter than any motion; integrate by backward Euler
*           (.options method=gear maxord=1), because what overshoots is remembered
* Nodes are 0 for a pad that is far away, where simulators begin.
.subckt rough_pad s force params: area=1e+12 follow={CIRCUIT.follow_s:g}
+   hamaker={pad.flats.hamaker:.12g} offset_nm={pad.flats.offset_nm:.12g} rest=0
Cclosed closed low {MEMORY_F:g}
Vlow low 0 {LOW_V:g}
Rleak closed 0 {{follow/{MEMORY_F * CIRCUIT.leak:g}}}
Rdeeper deeper 0 1
Bdeeper 0 deeper I = {{{start:g}-rest}} - V(s) - V(closed)
Bclosed 0 closed I = {{{MEMORY_F:g}/follow}} * max(V(deeper), 0)
Rnear near 0 1
Bnear 0 near I = max(V(closed), {{{start:g}-rest}} - V(s))
Rrisen risen 0 1
Brisen 0 risen I = V(s) + V(near) + {{rest-{start:g}}}
Rpush push 0 1
Bpush 0 push I = {push_sum}
Rpull pull 0 1
Bpull 0 pull I = {pull_sum}
Rforce force 0 1
Bforce 0 force I = {{area}} * (exp(min(V(push) + {far[0]:.7g}, {largest[0]:.4g})) - {tables.faint_GPa:.7g}
+   - ({{hamaker/(6*3.14159265358979324)}} / pow(max(V(s) + {{rest}}, {tables.closing[0].x[0]:.7g}) + {{offset_nm}}, 3) + {tables.floor_GPa:g})
+   * exp(min(V(pull) + {far[1]:.7g}, {largest[1]:.4g})))
.ends rough_pad
"""


def _openings(tables: Tables, deepest: str) -> list[tuple[str, str]]:
    """How much the opening from each computed depth counts, and where it does: hats over the
    deepest separation.
    """
    depths = tables.depth_nm
    # a pad that was hardly closed opens as it closed
    nodes = np.append(depths, depths[-1] + CIRCUIT.fade_nm)
    openings: list[tuple[str, str]] = []
    for k, depth in enumerate(depths):
        around = nodes[max(k - 1, 0) : k + 2]
        weight = _pwl(deepest, Piece(around, (around == depth).astype(float)))
        counts = f"{deepest} < {around[-1]:.7g}"
        if k:
            counts = f"{deepest} > {around[0]:.7g} && {counts}"
        openings.append((weight, counts))
    return openings


def _back(tables: Tables, closing: Piece, deepest: str, apart: str) -> str:
    """Text of how a closing changes from the deepest separation to that at hand, as far as a pad
    opens as it closed.
    """
    shallowest = tables.depth_nm[-1]
    ends = np.array([shallowest, shallowest + CIRCUIT.fade_nm])
    share = _pwl(deepest, Piece(ends, np.array([0.0, 1.0])))
    change = f"({_pwl(apart, closing)} - {_pwl(deepest, closing)})"
    return f"({deepest} > {shallowest:.7g} ? {share}*{change} : 0)"


def _weighted(closed: str, openings: list[tuple[str, str]], opened: list[str], back: str) -> str:
    """Text of a closing, the openings that count, each with its weight, and the way back.

    Comparisons choose them, since simulators take longest for the pieces.
    """
    terms = [
        f"({counts} ? {weight}*{opening} : 0)"
        for (weight, counts), opening in zip(openings, opened, strict=True)
    ]
    return "\n+   + ".join([closed, *terms, back])


def _pwl(variable: str, piece: Piece, below: float = 0.0) -> str:
    """Straight pieces of ngspice over a variable, four nodes a line; beyond the ends the first and
    last value hold.

    Parameters
    ----------
    below : length below the first node over which its slope goes on, before the value holds; 0:
        none.
    """
    x = piece.x
    y = piece.y
    first = (x[0] - 1e3, y[0])
    if below:
        first = (x[0] - below, y[0] - below * (y[1] - y[0]) / (x[1] - x[0]))
    last = (x[-1] + 1e3, y[-1])
    places = [first, *zip(x, y, strict=True), last]
    nodes = [f"{place:.7g},{value:.7g}" for place, value in places]
    lines = [", ".join(nodes[k : k + 4]) for k in range(0, len(nodes), 4)]
    return ",\n+   ".join([f"pwl({variable}", *lines]) + ")"
