"""The law in forms that other tools read: a table, a SPICE subcircuit, a Verilog-A module.

The closed form (eqs 10 to 13) is written out, so a circuit or device simulator needs neither this code nor an
interpolation table; every parameter, sampled or nominal, is an instance parameter.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from mesoscale.device.contact_law import column, onset_nm, pressure_GPa, slope_GPa_nm
from mesoscale.law.compact import Law
from mesoscale.law.parameters import BRANCHES, PARAMETERS

QUANTILE_COLUMNS = {"pressure_q05_GPa": 0.05, "pressure_q50_GPa": 0.5, "pressure_q95_GPa": 0.95}
MAX_EXPONENT = 300.0  # keeps a simulator's wild Newton steps within the range of doubles


def law_table(nominal: Mapping[str, Law], samples: Mapping[str, Law], points: int = 301) -> Iterator[dict[str, Any]]:
    """Rows of device/law.csv: the nominal pressure and its spread over the samples, branch by branch.

    Parameters
    ----------
    nominal, samples : by branch; the samples hold arrays of shape (samples,)
    """
    for branch in BRANCHES:
        law, many = nominal[branch], column(samples[branch])
        contact, onset = float(np.asarray(law.d_c_nm)), float(onset_nm(law))
        deepest = max(contact - 8 * float(np.asarray(law.rho_r_nm)), 0.0)
        far = np.geomspace(max(onset, 1.0), max(1000.0, 4 * onset), points // 3)
        # the kinks are among the points, so that a table's user meets them exactly
        gaps = np.unique(np.concatenate([np.linspace(deepest, onset, points - far.size - 1), [contact], far]))
        quantiles = [
            np.quantile(pressure_GPa(gap, many), list(QUANTILE_COLUMNS.values())) for gap in gaps[:, None, None]
        ]
        for gap, pressure, derivative, spread in zip(
            gaps, pressure_GPa(gaps, law), slope_GPa_nm(gaps, law), quantiles, strict=True
        ):
            yield {
                "branch": branch,
                "gap_nm": float(gap),
                "pressure_GPa": float(pressure),
                "derivative_GPa_nm": float(derivative),
                **dict(zip(QUANTILE_COLUMNS, map(float, spread), strict=True)),
            }


def spice_subcircuit(nominal: Mapping[str, Law], area_nm2: float, note: str = "") -> str:
    """SPICE subcircuit `asperity_contact` (ngspice, LTspice): the law as one behavioural source.

    Parameters
    ----------
    note : one line for the header: how well the law holds the adhesion of its curves.
    """
    defaults = " ".join(f"{name}={value:.12g}" for name, value in _instance_parameters(nominal).items())
    pick = {name: f"(opening > 0.5 ? {name}_opening : {name}_closing)" for name in PARAMETERS}
    return f"""* Force-separation law of a rough metal-dielectric contact (Asperity; eqs 10-13 of
* Kim et al., Modelling Simul. Mater. Sci. Eng. 21 (2013) 085002).
* {note}
* nodes     s      mean separation, 1 V = 1 nm
*           force  force on the moving electrode, 1 V = 1 nN, positive = pushed away
* branch    opening=0: first closing, opening=1: after the largest load
* area      nominal contact area in nm^2 (1e6 = 1 um^2); landed: share of it that lands
* adhesion  factor on the attraction; the law's own is near ten times measured dry adhesion
* hamaker   1e-18 J = nN nm; d_c, rho_r, rho_a, shield in nm; C_a in GPa/nm; C_r in GPa
.subckt asperity_contact s force params: opening=0 area={area_nm2:.12g} landed=1 adhesion=1 {defaults}
.param d_c={{{pick["d_c_nm"]}}}
.param c_a={{{pick["C_a_GPa_nm"]}}}
.param c_r={{{pick["C_r_GPa"]}}}
.param rho_r={{{pick["rho_r_nm"]}}}
.param far={{hamaker/(6*3.14159265358979324)}}
.param cube={{shield_nm*shield_nm*shield_nm}}
Bforce force 0 V = {{area*landed}} * (
+   {{c_r}} * (exp(min(max({{d_c}} - V(s), 0) / {{rho_r}}, {MAX_EXPONENT:g})) - 1)
+ - {{adhesion}} * ({{far}} / (max(V(s), 0)*max(V(s), 0)*max(V(s), 0) + {{cube}})
+                 + {{c_a}} * max({{d_c + rho_a_nm}} - V(s), 0)))
.ends asperity_contact
"""


def spice_testbench(subcircuit_file: str, data_file: str, separations_nm: np.ndarray) -> str:
    """Deck that sweeps the separation for both branches and writes the forces with full precision."""
    start, stop, step = separations_nm[0], separations_nm[-1], separations_nm[1] - separations_nm[0]
    return f"""* both branches of the exported law against separation
.include {subcircuit_file}
.options reltol=1e-9 vntol=1e-9 abstol=1e-15
Vs s 0 0
Xclosing s closing asperity_contact params: opening=0
Xopening s opening asperity_contact params: opening=1
.dc Vs {start:.12g} {stop:.12g} {step:.12g}
.control
set wr_singlescale
set numdgt=16
run
wrdata {data_file} v(closing) v(opening)
quit
.endc
.end
"""


def verilog_module(nominal: Mapping[str, Law], area_nm2: float, note: str = "") -> str:
    """Verilog-A module `asperity_contact` on a kinematic node; parameters and note as in the SPICE subcircuit."""
    lines = []
    for name, value in _instance_parameters(nominal).items():
        bounds = "" if name.startswith(("d_c", "C_a", "hamaker")) else " from (0:inf)"
        lines.append(f"    parameter real {name} = {value:.12g}{bounds};")
    parameters = "\n".join(lines)
    return f"""// Force-separation law of a rough metal-dielectric contact (Asperity; eqs 10-13 of
// Kim et al., Modelling Simul. Mater. Sci. Eng. 21 (2013) 085002).
// {note}
// s: mean separation (position in m) of the moving electrode above ref; the branch carries the force in N.
// opening = 0: first closing; 1: after the largest load.
// Lengths in nm, pressures in GPa, hamaker in 1e-18 J.
`include "disciplines.vams"
`include "constants.vams"

module asperity_contact(s, ref);
    inout s, ref;
    kinematic s, ref;

    parameter real opening = 0 from [0:1];
    parameter real area_nm2 = {area_nm2:.12g} from (0:inf);
    parameter real landed = 1.0 from [0:1];
    parameter real adhesion = 1.0 from [0:inf);
{parameters}

    real d_c, C_a, C_r, rho_r;            // parameters of the branch in use
    real separation, positive, cube, near, depth, attraction, repulsion;

    analog begin
        d_c   = (opening > 0.5) ? d_c_nm_opening     : d_c_nm_closing;
        C_a   = (opening > 0.5) ? C_a_GPa_nm_opening : C_a_GPa_nm_closing;
        C_r   = (opening > 0.5) ? C_r_GPa_opening    : C_r_GPa_closing;
        rho_r = (opening > 0.5) ? rho_r_nm_opening   : rho_r_nm_closing;

        separation = Pos(s, ref) * 1.0e9;
        positive = max(separation, 0.0);
        near = max(d_c + rho_a_nm - separation, 0.0);
        depth = min(max(d_c - separation, 0.0) / rho_r, {MAX_EXPONENT:.1f});

        cube = positive * positive * positive + shield_nm * shield_nm * shield_nm;
        attraction = hamaker / (6.0 * `M_PI * cube) + C_a * near;
        repulsion = C_r * (exp(depth) - 1.0);

        // 1 GPa nm^2 = 1 nN; a positive pressure pushes s away from ref
        F(s, ref) <+ -area_nm2 * landed * (repulsion - adhesion * attraction) * 1.0e-9;
    end
endmodule
"""


def _instance_parameters(nominal: Mapping[str, Law]) -> dict[str, float]:
    parameters = {
        f"{name}_{branch}": float(getattr(nominal[branch], name)) for branch in BRANCHES for name in PARAMETERS
    }
    closing = nominal["closing"]
    return parameters | {
        "hamaker": float(np.asarray(closing.hamaker)),
        "rho_a_nm": float(closing.rho_a_nm),
        "shield_nm": float(closing.shield_nm),
    }
