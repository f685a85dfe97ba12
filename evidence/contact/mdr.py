"""Does an elastic, plastic and adhesive sphere close and open as in the granular model `mdr` of
LAMMPS?

`mdr` (S. Zunker and K. Kamrin, doi:10.1016/j.jmps.2023.105492) lets a sphere on a rigid flat yield
at a mean pressure that falls with its depth, then recover elastically from an elliptic shape with
the adhesion of JKR. Two equal spheres meet here, so that their plane of symmetry is the flat. The
yield stress is chosen so that the pressure at the largest depth is our constant hardness. The
attraction of `mdr` has no range, ours has D0. Its sphere flattens as a whole, too; ours is a
sphere's shape on a periodic half-space. Its adhesion fades where a step lets the contact shrink by
less than 1 %, because its bonded radius then follows: 4000 steps back halve the pull-off that 400
have. A third answer is that of Mesarovic and Johnson (J. Mech. Phys. Solids 48 (2000) 2009).
"""

import subprocess
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

from atomistic.lammps import environment, executable
from evidence.contact.draws import MIDDLE
from mesoscale.contact import run_cycle
from mesoscale.contact.energy import pull_off
from mesoscale.settings import ContactSettings

E_STAR, HARDNESS, POISSON, RADIUS = 20.0, 1.0, 0.3, 60.0  # GPa, nm
CONTACT_NM = 20.0
LOAD_NN = np.pi * HARDNESS * CONTACT_NM**2
PIXELS, CELL_NM = 96, 72.0
WORKS_J_M2 = (0.02, 0.05, 0.1)
CUTOFF_NM = 0.3
STEPS_IN, STEPS_BACK = 4000, 400
SCRIPT = """
units lj
atom_style sphere
atom_modify map array
comm_modify vel yes
newton off
boundary f f f
region all block -{size} {size} -{size} {size} -{size} {size}
create_box 2 all
create_atoms 1 single 0 0 -{radius}
create_atoms 2 single 0 0 {radius}
set type * diameter {diameter} density 1
neighbor 2 bin
neigh_modify delay 0 every 1 check no
timestep 1
pair_style granular
pair_coeff * * mdr {young} {poisson} {strength} {work} 0.5 0 &
    damping mdr 1 tangential linear_nohistory 0 0
variable pull equal fz[2]
variable place equal z[2]
group upper type 2
fix record all print 1 "${{place}} ${{pull}}" file path.txt screen no
fix go upper move linear 0 0 -{speed}
run {steps}
unfix go
fix come upper move linear 0 0 {speed_back}
run {back}
"""


def rows(given: Any) -> Iterator[dict[str, Any]]:
    """A row for each work of adhesion."""
    for work_of in WORKS_J_M2:
        depth, force, least = _by_mdr(work_of)
        settings = ContactSettings(
            mechanics="adhesive",
            pixels=PIXELS,
            length_nm=CELL_NM,
            gap_cutoff_nm=CUTOFF_NM,
            max_force_nN=LOAD_NN,
        )
        inputs = replace(
            MIDDLE,
            hamaker=12 * np.pi * CUTOFF_NM**2 * work_of,
            e_star=E_STAR,
            h_macro=HARDNESS,
            h_prime=0.0,
        )
        x = (np.arange(PIXELS) - PIXELS // 2 + 0.37) * CELL_NM / PIXELS
        heights = RADIUS - np.sqrt(RADIUS**2 - x[:, None] ** 2 - x[None, :] ** 2)
        cycle = run_cycle(inputs, settings, 1, heights=heights, contact_at="lowest")
        yield {
            "work_J_m2": work_of,
            "load_nN": cycle.opening.net_nN[0],
            "load_mdr_nN": force,
            "depth_nm": cycle.first_contact_nm - cycle.opening.separation_nm[0],
            "depth_mdr_nm": depth,
            "contact_nm": np.sqrt(cycle.opening.contact_area_nm2[0] / np.pi),
            "pull_off_nN": pull_off(cycle.opening),
            "pull_off_mdr_nN": -least,
            "pull_off_closed_form_nN": _closed_form(work_of),
            "converged": cycle.converged,
        }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Pull-off over that of mdr and of the closed form, and the depths' ratio, over the works."""

    def span(ours: str, theirs: str) -> str:
        ratios = [float(row[ours]) / float(row[theirs]) for row in rows]
        return f"{min(ratios):.2f} to {max(ratios):.2f}"

    return {
        "pull_off": span("pull_off_nN", "pull_off_mdr_nN"),
        "closed_form": span("pull_off_nN", "pull_off_closed_form_nN"),
        "depth": span("depth_nm", "depth_mdr_nm"),
    }


def _closed_form(work_of: float) -> float:
    """Pull-off (nN) of a top that the hardness has flattened over the contact radius."""

    def force(share: float) -> float:
        pressed = np.arcsin(share) - share * np.sqrt(1.0 - share**2)
        edge = np.sqrt(8.0 * np.pi * work_of * E_STAR * (share * CONTACT_NM) ** 3)
        return 2.0 * HARDNESS * CONTACT_NM**2 * pressed - edge

    return -float(minimize_scalar(force, bounds=(1e-3, 1.0), method="bounded").fun)


def _by_mdr(work_of: float) -> tuple[float, float, float]:
    """Depth of a sphere (nm), force there, and least force on the way back (nN)."""
    strength, deepest = HARDNESS / 2.5, 0.5 * CONTACT_NM**2 / RADIUS
    for _ in range(8):
        deepest *= LOAD_NN / _path(work_of, strength, deepest, back=False)[1][-1]
        strength = HARDNESS / (1.75 * np.exp(-4.4 * deepest / RADIUS) + 1.0)
    depth, force = _path(work_of, strength, deepest, back=True)
    turn = int(np.argmax(depth))
    return float(depth[turn]), float(force[turn]), float(force[turn:].min())


def _path(
    work_of: float, strength: float, deepest: float, back: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Depths of one sphere (nm) and repulsive forces (nN) by `mdr`, on the way in and, if wanted,
    out.
    """
    script = SCRIPT.format(
        size=4 * RADIUS,
        radius=RADIUS,
        diameter=2 * RADIUS,
        young=E_STAR * (1 - POISSON**2),
        poisson=POISSON,
        strength=strength,
        work=work_of,
        speed=2 * deepest / STEPS_IN,
        speed_back=2 * deepest / STEPS_BACK,
        steps=STEPS_IN,
        back=STEPS_BACK if back else 0,
    )
    with tempfile.TemporaryDirectory() as folder:
        command = [str(executable()), "-log", "none", "-nocite"]
        subprocess.run(
            command,
            input=script,
            cwd=folder,
            env=environment(),
            text=True,
            check=True,
            capture_output=True,
        )
        place, force = np.loadtxt(Path(folder) / "path.txt").T
    return RADIUS - 0.5 * (place + RADIUS), force
