"""What does it change that atoms of a top follow the pull of the other body?

The hardness stage takes the cut-off D0 of the attraction from rigid tops (`atomistic.hardness.top_attraction`). Here
the smooth half-space is taken away from the relaxed tops of closing runs in small steps, and all atoms come to rest
after each. The same tops are also judged rigid, with all their atoms and with those below the contact alone.
"""

import tempfile
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from atomistic.hardness.closing import attraction_row
from atomistic.hardness.contact_area import calibrated
from atomistic.hardness.glass import make_glass, write_forcefield
from atomistic.hardness.plateau import RULES
from atomistic.hardness.pressing import base_thickness_nm, plan_closing, prepare_body, press_bodies
from atomistic.hardness.readout import Geometry, Readout
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


def arguments(parser: ArgumentParser) -> None:
    """Glasses, energies and snapshots."""
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--energy-scales", type=float, nargs="+", default=[1.0, 0.5])
    parser.add_argument("--every", type=int, default=1, help="of the snapshots whose contact counts, each so many")


def rows(given: Namespace) -> Iterator[dict]:
    """Close the smallest asperity of the defaults, then take a half-space away from each of its relaxed tops."""
    material = oxide_glasses(load_materials(ROOT / "config" / "materials").values())["SiO2"]
    potential = load_potential(ROOT / "config" / "potentials" / "pmmcs.yaml")
    area, _ = calibrated(potential)
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
            body = prepare_body(
                run, glass, potential, closing, PROTOCOL, Workspace(work / "anneal", {}, "anneal.in"), place,
                run.asperity.amplitude_nm, base_nm,
            )  # fmt: skip
            workspace = Workspace(work / "closing", {}, "closing.in")

            def readout(geometry: Geometry, plan=plan, workspace=workspace) -> Readout:
                steps = plan.segment_steps, plan.timestep, PROTOCOL.samples
                return Readout(workspace, *steps, area, geometry, [1], material.part("oxide_glass").cutoff_A)

            def wide_enough(geometry: Geometry, segments: int, readout=readout) -> bool:
                contact_nm2 = readout(geometry).curve(range(1, segments + 1))[-1]["contact_area_nm2"]
                return contact_nm2 > RULES.max_area_fraction * geometry.wavelength_A**2 / 100

            geometry, reached = press_bodies(
                run, [body], potential, closing, PROTOCOL, plan, place, workspace, wide_enough
            )
            run_lammps("relax.in", workspace, {"pairs": "pairs", "segment": range(reached.segments + 1)})
            read = readout(geometry)
            read.curve(range(1, reached.segments + 1))
            counted = [
                n for n in range(1, reached.segments + 1) if attraction_row(read, n, geometry)["top_area_nm2"] > 0
            ]
            for n in counted[:: given.every]:
                body = replace(
                    body, positions_A=read.relaxed(n).frame[:, 1:4], types=read.relaxed(n).frame[:, 0].astype(int)
                )
                yield {"run": run.name, "snapshot": n, **top_rows(read, n, geometry, body, potential, run.energy_scale)}


def top_rows(
    read: Readout, segment: int, geometry: Geometry, top: Atoms, potential: Potential, energy_scale: float
) -> dict[str, float]:
    """Contact area and cut-offs of one top: rigid below its contact, rigid as a whole, with free atoms as a whole."""
    below = attraction_row(read, segment, geometry)
    area_A2 = 100 * below["top_area_nm2"]
    density = bulk_density_per_A3(read.relaxed(0).frame[:, 1:4], geometry.wavelength_A**2)
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


def pulled(top: Atoms, area_A2: float, density: float, potential: Potential, energy_scale: float) -> TopAttraction:
    """The attraction of a top whose atoms are at rest at each distance of the half-space."""
    contact = contact_distance_A(density)
    sigma = contact * 2.5 ** (1 / 6)  # the minimum of the 9-3 potential lies at (2/5)^(1/6) sigma
    highest = float(top.positions_A[:, 2].max())
    lifted = top.positions_A - [0.0, 0.0, min(0.0, float(top.positions_A[:, 2].min()))]
    with tempfile.TemporaryDirectory() as folder:
        workspace = Workspace(Path(folder) / "pull", {}, "relax.in")
        box = np.array([top.cell_A[0], top.cell_A[1], highest + 40.0])
        masses = {ion: potential.species[ion].mass_u for ion in top.elements}
        write_data(workspace / "top.data", replace(top, positions_A=lifted, cell_A=box, velocities_A_ps=None), masses)
        write_forcefield(workspace, potential, top.elements, energy_scale)
        variables = {
            "data": "top.data", "pairs": "pairs", "frozen": 10 * PROTOCOL.frozen_nm,
            "first": highest + 0.15 * contact, "step": STEP_A, "last": highest + REACH_A,
            "epsilon": HAMAKER_EV / (6 * np.pi * density) / sigma**3, "sigma": sigma,
        }  # fmt: skip
        run_lammps(str(Path(__file__).with_name("pull.in")), workspace, variables)
        height, force = np.loadtxt(workspace / "pull.txt").T
    pull = -np.sign(force[0]) * force  # the first force pushes
    apart = int(np.argmax(pull > 0))
    work = float(np.trapezoid(pull[apart:], height[apart:]))
    beyond = area_A2 * HAMAKER_EV / (12 * np.pi * (height[-1] - highest) ** 2)  # of a flat, a few per cent
    return TopAttraction(area_A2, float(pull.max()) / HAMAKER_EV, (work + beyond) / HAMAKER_EV)


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Ratios of D0, averaged over the tops, and the mean D0 of each way."""

    def mean(column: str) -> float:
        return float(np.mean([float(row[column]) for row in rows]))

    def ratio(first: str, second: str) -> str:
        values = [float(row[first]) / float(row[second]) for row in rows]
        return f"{np.mean(values):.2f} ± {np.std(values):.2f}"

    return {
        "tops": f"{len(rows)}",
        "free_force": ratio("free_force_D0_nm", "whole_force_D0_nm"),
        "free_work": ratio("free_work_D0_nm", "whole_work_D0_nm"),
        "below_force": ratio("below_force_D0_nm", "whole_force_D0_nm"),
        "below_work": ratio("below_work_D0_nm", "whole_work_D0_nm"),
        "force_D0": f"{mean('below_force_D0_nm'):.2f} nm",
        "work_D0": f"{mean('below_work_D0_nm'):.2f} nm",
    }
