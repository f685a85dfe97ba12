"""What does it change that atoms of a top follow the pull of the other body?

The hardness stage takes the cut-off D0 of the attraction from rigid tops (`atomistic.hardness.top_attraction`). Here
the smooth half-space is taken away from the relaxed tops of closing runs in small steps, and all atoms come to rest
after each. The same tops are also judged rigid, with all their atoms and with those below the contact alone. `slab` has
a rough body of atoms instead of the smooth one, above the rigid atoms below the contact: a slab of the same glass, cut
at random heights and shifted at random (registry). Atoms of both attract by the 12-6 potential whose sum over a
half-space is the 9-3 potential of the smooth body.
"""

import tempfile
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial import KDTree

from atomistic.hardness.closing import attraction_row, cut_body, oxide_bond
from atomistic.hardness.contact_area import Area, contact_map, shares_in_contact
from atomistic.hardness.glass import make_glass, write_forcefield
from atomistic.hardness.plateau import RULES
from atomistic.hardness.pressing import base_thickness_nm, plan_closing, prepare_body, press_body
from atomistic.hardness.readout import PressedCell, Readout
from atomistic.hardness.runs import PROTOCOL, planned_runs
from atomistic.hardness.top_attraction import (
    TopAttraction,
    attract_top,
    bulk_density_per_A3,
    combined_cutoffs_nm,
    contact_distance_A,
)
from atomistic.lammps import Atoms, Workspace, run_lammps, write_data
from atomistic.materials import load_materials, oxide_glasses
from atomistic.potentials import Potential, load_potential
from atomistic.settings import ClosingSettings, GlassSettings, HardnessSettings
from evidence.record import ROOT

HAMAKER_EV = 0.215 / 0.1602176634  # middle of the paper's Table 1; the free atoms feel it beside their bonds
STEP_A, REACH_A = 0.06, 5.0
SLABS, SLAB_A, PAIR_A = 12, 25.0, 20.0  # slabs above a top, their thickness, reach of the pairs


def arguments(parser: ArgumentParser) -> None:
    """Glasses, energies, potential and snapshots."""
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--energy-scales", type=float, nargs="+", default=[1.0, 0.5])
    parser.add_argument("--potential", default="pmmcs", choices=["pmmcs", "teter"])
    parser.add_argument("--every", type=int, default=1, help="of the snapshots whose contact counts, each so many")


def rows(given: Namespace) -> Iterator[dict]:
    """Close the smallest asperity of the defaults, then take a half-space away from each of its relaxed tops."""
    material = oxide_glasses(load_materials(ROOT / "config" / "materials").values())["SiO2"]
    potential = load_potential(ROOT / "config" / "potentials" / f"{given.potential}.yaml")
    area = Area()
    asperity = min(HardnessSettings().asperities, key=lambda one: one.tiles)
    closing = ClosingSettings()
    wanted = HardnessSettings(asperities=(asperity,), seeds=given.seeds, energy_scales=given.energy_scales)
    with tempfile.TemporaryDirectory() as folder:
        for run in planned_runs(wanted):
            work = Path(folder) / run.name
            glass = make_glass(material, potential, GlassSettings(), run.seed, work / "glass")
            plan = plan_closing(closing, run, PROTOCOL)
            place = (run.seed, run.asperity.tiles, round(1000 * run.asperity.amplitude_nm))
            base_nm = base_thickness_nm(closing, run.asperity.tiles * float(glass.cell_A[0]) / 10, PROTOCOL)
            cut = cut_body(run, glass, potential, base_nm, place, PROTOCOL)
            aside, bond = Workspace(work / "anneal", {}, "anneal.in"), oxide_bond(glass.elements, material, potential)
            body = prepare_body(run, cut.atoms, cut.formula, potential, closing, PROTOCOL, aside, place)
            workspace = Workspace(work / "closing", {}, "closing.in")

            def readout(cell: PressedCell, plan=plan, workspace=workspace, bond=bond) -> Readout:
                steps = plan.segment_steps, plan.timestep, PROTOCOL.samples
                return Readout(workspace, *steps, area, cell, bond)

            def wide_enough(cell: PressedCell, segments: int, readout=readout) -> bool:
                contact_nm2 = readout(cell).curve(range(1, segments + 1))[-1]["contact_area_nm2"]
                return contact_nm2 > RULES.max_area_fraction * cell.wavelength_A**2 / 100

            cell, reached = press_body(run, body, potential, closing, PROTOCOL, plan, place, workspace, wide_enough)
            run_lammps("relax.in", workspace, {"pairs": "pairs", "segment": range(reached.segments + 1)})
            read = readout(cell)
            read.curve(range(1, reached.segments + 1))
            counted = [n for n in range(1, reached.segments + 1) if attraction_row(read, n, cell)["top_area_nm2"] > 0]
            for n in counted[:: given.every]:
                body = replace(
                    body, positions_A=read.relaxed(n).frame[:, 1:4], types=read.relaxed(n).frame[:, 0].astype(int)
                )
                yield {
                    "potential": potential.name,
                    "run": run.name,
                    "snapshot": n,
                    **top_rows(read, n, cell, body, potential, run.energy_scale),
                    **slab_rows(read, n, cell, glass),
                }


def top_rows(
    read: Readout, segment: int, cell: PressedCell, top: Atoms, potential: Potential, energy_scale: float
) -> dict[str, float]:
    """Contact area and cut-offs of one top: rigid below its contact, rigid as a whole, with free atoms as a whole."""
    below = attraction_row(read, segment, cell)
    area_A2 = 100 * below["top_area_nm2"]
    density = bulk_density_per_A3(read.relaxed(0).frame[:, 1:4], cell.wavelength_A**2)
    heights = top.positions_A[:, 2]
    judged = {
        "below": TopAttraction(area_A2, below["top_force_over_hamaker"] / 10, below["top_work_over_hamaker"]),
        "whole": attract_top(heights, np.ones(len(heights)), area_A2, density),
        "free": pulled(top, area_A2, density, potential, energy_scale),
    }
    found = {"area_nm2": area_A2 / 100}
    for name, attraction in judged.items():
        found[f"{name}_force_D0_nm"], found[f"{name}_work_D0_nm"] = combined_cutoffs_nm([attraction])
    return found


def slab_rows(read: Readout, segment: int, cell: PressedCell, glass: Atoms) -> dict[str, float]:
    """Cut-offs of the rigid top below its contact beside slabs of its glass: mean and scatter over registries."""
    sample, places = read.last_sample(segment), read.relaxed(segment).frame[:, 1:4]
    side, axis = cell.wavelength_A, (cell.axis_A, cell.axis_A)
    shares = shares_in_contact(
        places[:, :2], contact_map(sample.touching_A, (side, side), read.area, axis), (side, side), axis
    )
    density = bulk_density_per_A3(read.relaxed(0).frame[:, 1:4], side**2)
    rng = np.random.default_rng(segment)
    judged = [
        combined_cutoffs_nm([beside(places, shares, slab(glass, side, rng), side, sample.area_A2, density)])
        for _ in range(SLABS)
    ]
    (force, work), (force_scatter, work_scatter) = np.mean(judged, axis=0), np.std(judged, axis=0, ddof=1)
    return {
        "slab_force_D0_nm": force, "slab_force_scatter_nm": force_scatter,
        "slab_work_D0_nm": work, "slab_work_scatter_nm": work_scatter,
    }  # fmt: skip


def slab(glass: Atoms, side: float, rng: np.random.Generator) -> np.ndarray:
    """Atoms above a cut through the glass at a random place, the lowest at height 0, shape (atoms, 3)."""
    cell = np.asarray(glass.cell_A)
    tiles = round(side / cell[0])
    places = (glass.positions_A + rng.random(3) * cell) % cell
    tiled = np.concatenate([places + cell * [i, j, k] for i in range(tiles) for j in range(tiles) for k in range(2)])
    kept = tiled[tiled[:, 2] < SLAB_A]
    return kept - np.array([0.0, 0.0, kept[:, 2].min()])


def beside(
    top: np.ndarray, shares: np.ndarray, body: np.ndarray, side: float, area_A2: float, density: float, grain=1.0
) -> TopAttraction:
    """Largest force and work between rigid atoms of a top, with their shares, and of a body above it; A_H = 1.

    Each atom of the body counts `grain` times.
    """
    strength, repulsion = grain / (np.pi * density) ** 2, 2.5 * contact_distance_A(density) ** 6
    counted = (shares > 0) & (top[:, 2] > top[shares > 0, 2].max() - PAIR_A)
    top, shares = top[counted] - np.array([0.0, 0.0, top[counted, 2].min()]), shares[counted]
    body, box = body + np.array([0.0, 0.0, top[:, 2].max()]), [side, side, 1e4]
    near = KDTree(top % box, boxsize=box).sparse_distance_matrix(
        KDTree(body % box, boxsize=box), PAIR_A, output_type="coo_matrix"
    )
    rise = body[near.col, 2] - top[near.row, 2]
    across, weight = np.maximum(near.data**2 - rise**2, 0.0), strength * shares[near.row]
    gaps = np.arange(-2.0, 8.0, STEP_A)
    energy = np.empty(gaps.size)
    for i, gap in enumerate(gaps):
        inverse = 1.0 / np.maximum(across + (rise + gap) ** 2, 0.5) ** 3
        energy[i] = -float(weight @ (inverse - repulsion * inverse**2))
    rest = int(energy.argmin())
    return TopAttraction(area_A2, float(np.gradient(energy, STEP_A)[rest:].max()), -float(energy[rest]))


def pulled(top: Atoms, area_A2: float, density: float, potential: Potential, energy_scale: float) -> TopAttraction:
    """The attraction of a top whose atoms are at rest at each distance of the half-space."""
    contact = contact_distance_A(density)
    sigma = contact * 2.5 ** (1 / 6)  # the minimum of the 9-3 potential lies at (2/5)^(1/6) sigma
    highest = float(top.positions_A[:, 2].max())
    lifted = top.positions_A - [0.0, 0.0, min(0.0, float(top.positions_A[:, 2].min()))]
    with tempfile.TemporaryDirectory() as folder:
        workspace = Workspace(Path(folder) / "pull", {}, "relax.in")
        box = np.array([top.cell_A[0], top.cell_A[1], highest + 40.0])
        masses = potential.masses_u
        write_data(workspace / "top.data", replace(top, positions_A=lifted, cell_A=box, velocities_A_ps=None), masses)
        write_forcefield(workspace, potential, top.elements, energy_scale)
        variables = {
            "data": "top.data", "pairs": "pairs", "frozen": 10 * PROTOCOL.frozen_nm,
            "first": highest + 0.15 * contact, "step": STEP_A, "last": highest + REACH_A,
            "epsilon": HAMAKER_EV / (6 * np.pi * density) / sigma**3, "sigma": sigma,
        }  # fmt: skip
        run_lammps(str(Path(__file__).with_name("pull.in")), workspace, variables)
        height, force = np.loadtxt(workspace / "pull.txt").T
    pull = np.sign(force[-10:].mean()) * force  # the last forces pull
    apart = int(np.argmax(pull > 0))
    work = float(np.trapezoid(pull[apart:], height[apart:]))
    beyond = area_A2 * HAMAKER_EV / (12 * np.pi * (height[-1] - highest) ** 2)  # of a flat, a few per cent
    return TopAttraction(area_A2, float(pull.max()) / HAMAKER_EV, (work + beyond) / HAMAKER_EV)


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Ratios of D0, averaged over the tops, and the mean D0 of both ways with each potential."""

    by_potential = {
        name: [row for row in rows if row["potential"] == name] for name in sorted({row["potential"] for row in rows})
    }

    def mean(column: str, name: str) -> str:
        return f"{np.mean([float(row[column]) for row in by_potential[name]]):.2f} nm"

    def ratio(first: str, second: str) -> str:
        values = [float(row[first]) / float(row[second]) for row in rows]
        return f"{np.mean(values):.2f} ± {np.std(values):.2f}"

    return {
        "tops": f"{len(rows)}",
        "free_force": ratio("free_force_D0_nm", "whole_force_D0_nm"),
        "free_work": ratio("free_work_D0_nm", "whole_work_D0_nm"),
        "below_force": ratio("below_force_D0_nm", "whole_force_D0_nm"),
        "below_work": ratio("below_work_D0_nm", "whole_work_D0_nm"),
        "slab_force": ratio("slab_force_D0_nm", "below_force_D0_nm"),
        "slab_work": ratio("slab_work_D0_nm", "below_work_D0_nm"),
        **{f"force_D0_{name}": mean("below_force_D0_nm", name) for name in by_potential},
        **{f"work_D0_{name}": mean("below_work_D0_nm", name) for name in by_potential},
    }
