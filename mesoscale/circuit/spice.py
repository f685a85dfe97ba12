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
    slope{k}   D (b - z0)    minus the slope of the elongation  in units of `SLOPE_PER_V`
    longer     nm            elongation since rest              ((b - z0) D (b - z0) - z0 D z0) / 2
    drawn{k}   Pa            pressure that draws the lump down  from `rough_lump`
    charge     fC            of all lumps
    felt       V             of the electrode, less the shift by even charge; without it that of `top`

The pressures on a lump of area A are drawn, -K b / A, -S longer slope / A, and -drag v.

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
BEGINS = 1.5
"""Closing counts from so many times the separation at which a pad begins to repel."""
MEMORY_F = 1e-6
"""Capacitance of the state of a pad, whatever its time constant. With a slow memory a capacitance
of its conductance drew kiloamperes at the landing, and ngspice shrank its steps to nothing."""
ONSET_NM = 0.01
"""Way over which following begins. Where it began with a corner, ngspice ended as soon as a second
lump came below the start: no step was small enough. A way of 0.1 nm forgets 0.05 nm of an impact."""
REACH_NM = 20.0
"""Way below the deepest computed closing over which the repulsion of a pad goes on to grow."""
MOST_FOLDS = 8.0
"""It grows by so many e-folds at most: wild steps of a simulator stay finite."""


def spice_switch(
    lumps: Lumps, errors: LumpErrors, pad: PadCurves, cells: int, pull_in_V: float
) -> str:
    """SPICE netlist (ngspice) of the subcircuits `rough_switch`, `rough_lump` and `rough_pad`."""
    pairs = "\n".join(_pair(lumps, k) for k in range(lumps.count))
    return f"""* An electrostatic switch on a rough contact (Asperity, docs/circuit.md).
* the electrode: {lumps.count} pairs of lumps; beside finite elements pull-in differs by {errors.pull_in:.2%},
* release by {errors.release:.2%}, capacitance by {errors.capacitance:.2%}; these err by {errors.reference:.2%}
* top, bottom: the electrodes; middle: by how much (nm) mid-span has come down, 1 V = 1 nm.
* Inside: nm, nm/us, Pa, fC. What moves a lump: 1 A for {1.0 / FORCE_A:g} Pa.
* mass per area in kg/m2, loss in us, viscosity in Pa s, gas in Pa.
* drag: 0; a large one (3e4 Pa us/nm) lands the electrode softly, for loops so slow that nothing else matters.
* follow: s, until the pad remembers; 1e-6 for such loops.
* fringe: of the field at the sides; 0.6366 for a thin strip over a plane.
* pull_in_V: of this switch, for decks that include this file: a step of {{1.2*pull_in_V}} closes it.
.param pull_in_V={pull_in_V:.6g}
.subckt rough_switch top bottom middle params: fringe={lumps.fringe:.9g} gas={lumps.gas_Pa:.9g}
+   viscosity={CIRCUIT.viscosity_Pa_s:g} mass={lumps.mass_kg_m2:.9g} loss={lumps.loss_us:.9g} drag=0
+   follow={CIRCUIT.follow_s:g}
{pairs}
{_elongation(lumps)}
Emiddle middle 0 moved{lumps.count - 1} 0 1
Rcharge charge 0 1
Ccharge charge sense 1f
Vcharge sense 0 0
Fcharge top bottom Vcharge 1
{_shift(lumps)}.ends rough_switch

{_lump(lumps)}

{spice_pad(pad, cells)}"""


def _pair(lumps: Lumps, k: int) -> str:
    """Elements of a pair of lumps in `rough_switch`: its lump, states, and what acts on its speed."""
    force = FORCE_A
    area_m2 = lumps.area_m2[k]
    springs = force * lumps.stiffness_N_m[k] * NM / area_m2
    slopes = _slopes(lumps)[k]
    slope_at_rest = -(slopes @ lumps.height_nm)
    stretch = force * lumps.stretching_N_m * NM * SLOPE_PER_V / area_m2
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
        f"Gdrag{k} speed{k} 0 speed{k} 0 {{{force:g}*drag}}",
        f"Gdrawn{k} 0 speed{k} drawn{k} 0 {force:g}",
        *(f"G{k}_{j} speed{k} 0 bent{j} 0 {spring:.12g}" for j, spring in enumerate(springs)),
        *(f"Gslope{k}_{j} 0 slope{k} bent{j} 0 {entry:.12g}" for j, entry in enumerate(slopes)),
        f"Islope{k} 0 slope{k} {slope_at_rest:.12g}",
        f"Rslope{k} slope{k} 0 1",
        f"Bstretch{k} speed{k} 0 I = {stretch:.12g} * V(longer) * V(slope{k})",
        f"Blonger{k} 0 longer I = {0.5 * SLOPE_PER_V:g}"
        f" * (V(bent{k}) + {-lumps.height_nm[k]:.9g}) * V(slope{k})",
    ]
    return "\n".join(lines)


def _electrode(lumps: Lumps) -> str:
    """Node whose voltage the lumps feel."""
    return "felt" if lumps.shift_V else "top"


def _shift(lumps: Lumps) -> str:
    """The source that takes the shift by even charge off the drive; nothing without it."""
    return f"Vshift top felt {lumps.shift_V:.9g}\n" if lumps.shift_V else ""


def _slopes(lumps: Lumps) -> np.ndarray:
    """D in units of `SLOPE_PER_V` and nm."""
    return lumps.drawn_m * NM / SLOPE_PER_V


def _elongation(lumps: Lumps) -> str:
    """Node `longer`, to which each pair adds, less what the beam at rest has."""
    heights = lumps.height_nm
    at_rest = 0.5 * SLOPE_PER_V * heights @ _slopes(lumps) @ heights
    return f"Rlonger longer 0 1\nIlonger longer 0 {at_rest:.12g}"


def _lump(lumps: Lumps) -> str:
    """The subcircuit `rough_lump`: what draws a pair of lumps down, and its charge."""
    width = lumps.width_m
    dielectric = lumps.dielectric_nm
    # electric gap (m), thickness of the gas (nm), its density over that around
    # viscosity in a narrow gap is lower by 1 + 9.638 Kn^1.159 (Veijola, see `lumps`)
    electric = f"(1e-9*max({{rest+{dielectric:.9g}}} - V(moved), {least_gap_nm(dielectric):.9g}))"
    film = f"max({{rest}} - V(moved), {CIRCUIT.least_film_nm:g})"
    dense = f"max(1 + V(excess), {CIRCUIT.least_density:g})"
    knudsen = f"{{{CIRCUIT.free_path_nm_Pa:.9g}/gas}} / ({dense} * {film})"
    felt_V2 = "V(top,bottom)^2"
    if lumps.uneven_V2.size:
        uneven = _pwl("{rest} - V(moved)", Piece(*lumps.uneven_V2))
        felt_V2 = f"(V(top,bottom)^2\n+   + {uneven})"
    return f"""* A pair of lumps; Verilog-A has the same.
.subckt rough_lump {LUMP} params: rest=1 area=1 gas=1 viscosity=1 fringe=0 follow={CIRCUIT.follow_s:g}
Gup 0 up 0 moved 1
Rup up 0 1
Xpad up push rough_pad area=1e9 rest={{rest}} follow={{follow}}
Bcharge 0 charge I = 1e15 * V(top,bottom) * {{area*{VACUUM_PERMITTIVITY}}} * (1 / {electric}
+   + {{fringe/{width:.9g}}} * ln({np.pi * width:.9g} / {electric}))
Rexcess excess 0 1
Bexcess 0 excess I = ({{rest}} - V(lost)) / {film} - 1
Clost lost 0 1u
Blost 0 lost I = {{{FLOW:g}*gas/(viscosity*{width**2:.9g})}} * {dense} * V(excess) * {film}^3
+   * (1 + 9.638 * pow({knudsen}, 1.159))
Rdrawn drawn 0 1
Bdrawn 0 drawn I = {0.5 * VACUUM_PERMITTIVITY} * {felt_V2} * (1 + {{fringe/{width:.9g}}} * {electric})
+   / {electric}^2 - V(push) - {{gas}} * V(excess)
.ends rough_lump"""


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
    weights = _weights(tables, deepest)
    pushes = [_pwl("V(risen)", push_change) for push_change, _ in tables.opening]
    pulls = [_pwl("V(risen)", pull_change) for _, pull_change in tables.opening]
    push_sum = _weighted(_pwl(deepest, push, REACH_NM), weights, pushes)
    pull_sum = _weighted(_pwl(deepest, pull), weights, pulls)
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
Cclosed closed 0 {MEMORY_F:g}
Rleak closed 0 {{follow/{MEMORY_F * CIRCUIT.leak:g}}}
Rdeeper deeper 0 1
Bdeeper 0 deeper I = {{{start:g}-rest}} - V(s) - V(closed)
Rbegun begun 0 1
Bbegun 0 begun I = min(max(V(deeper), 0), {ONSET_NM:g})
Bclosed 0 closed I = {{{MEMORY_F / ONSET_NM:g}/follow}} * V(begun) * (V(deeper) - 0.5*V(begun))
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
+   - ({{hamaker/(6*3.14159265358979324)}} / pow(max(V(s) + {{rest}}, 1) + {{offset_nm}}, 3) + {tables.floor_GPa:g})
+   * exp(min(V(pull) + {far[1]:.7g}, {largest[1]:.4g})))
.ends rough_pad
"""


def _weights(tables: Tables, deepest: str) -> list[str]:
    """How much the opening from each computed depth counts: hats over the deepest separation."""
    depths = tables.depth_nm
    # a pad that was hardly closed opens as it closed
    nodes = np.append(depths, depths[-1] + CIRCUIT.fade_nm)
    weights: list[str] = []
    for k, depth in enumerate(depths):
        around = nodes[max(k - 1, 0) : k + 2]
        weights.append(_pwl(deepest, Piece(around, (around == depth).astype(float))))
    return weights


def _weighted(closed: str, weights: list[str], opened: list[str]) -> str:
    """Text of a closing and the openings that count, each with its weight."""
    terms = [
        f"({weight} > 0 ? {weight}*{opening} : 0)"
        for weight, opening in zip(weights, opened, strict=True)
    ]
    return "\n+   + ".join([closed, *terms])


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
