"""One closing run: cut, anneal, press against the counterface, relax without it; returns the measured curve."""

import shutil
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from atomistic.errors import InputError
from atomistic.hardness.contact_area import calibrated, contact_map, shares_in_contact
from atomistic.hardness.glass import cations
from atomistic.hardness.plateau import RULES, may_stop
from atomistic.hardness.pressing import (
    Plan,
    base_thickness_nm,
    plan_closing,
    prepare_body,
    press_bodies,
)
from atomistic.hardness.readout import Geometry, Readout, Rows, slice_rows, witness_rows
from atomistic.hardness.runs import PROTOCOL, ClosingRun, Protocol
from atomistic.hardness.top_attraction import attract_top, bulk_density_per_A3
from atomistic.lammps import Atoms, Progress, Workspace, run_lammps
from atomistic.materials import Material
from atomistic.potentials import Potential
from atomistic.settings import ClosingSettings

MAX_STRAIN = 0.01  # of a counterface whose cell differs from the asperity's


@dataclass(frozen=True)
class Closing:
    """Result of a closing run.

    Attributes
    ----------
    curve : one row per average (columns as in docs/hardness.md).
    witness : one row per relaxed snapshot: bond exchanges and lasting lowering against the first, and the attraction of
        its top.
    snapshots : slices through the contact of the relaxed snapshots, for pictures.
    summary : atoms, steps and the side of the cell.
    """

    curve: Rows
    witness: Rows
    snapshots: Rows
    summary: dict[str, float]


def run_closing(
    run: ClosingRun,
    material: Material,
    glass: Atoms,
    potential: Potential,
    closing: ClosingSettings,
    work: Path,
    protocol: Protocol = PROTOCOL,
    progress: Progress | None = None,
    counter_glass: Atoms | None = None,
    counter_potential: Potential | None = None,
) -> Closing:
    """Carry out a run, or go on with it if `work` holds its restart files; `work` is deleted at the end.

    Parameters
    ----------
    material, glass : oxide of the asperity, and a cell of its glass.
    counter_glass, counter_potential : glass and potential of a counterface of oxide; None: those of the asperity.
    """
    area, _ = calibrated(potential, counter_potential)
    plan = plan_closing(closing, run, protocol)
    identity = {
        "potential": [within.model_dump() for within in (potential, counter_potential or potential)],
        "run": [run.model_dump(), material.formula_text, closing.model_dump(), protocol.model_dump(), asdict(area)],
        "glass": [[g.cell_A.tolist(), g.positions_A.sum(axis=0).tolist()] for g in (glass, counter_glass or glass)],
    }
    place = (run.seed, run.asperity.tiles, round(1000 * run.asperity.amplitude_nm))
    aside = Workspace(work / "anneal", identity, "anneal.in")
    base_nm = base_thickness_nm(closing, run.asperity.tiles * float(glass.cell_A[0]) / 10, protocol)
    amplitude = run.asperity.amplitude_nm
    bodies = [prepare_body(run, glass, potential, closing, protocol, aside, place, amplitude, base_nm, progress)]
    if closing.counterface != "flat":
        relief = amplitude if closing.counterface == "asperity" else 0.0
        counter, thickness = commensurate(counter_glass or glass, glass), protocol.counter_base_nm
        aside = Workspace(work / "anneal_counter", identity, "anneal.in")
        within = counter_potential or potential
        upper = prepare_body(run, counter, within, closing, protocol, aside, (*place, 6), relief, thickness, progress)
        bodies.append(upper)
    workspace = Workspace(work / "closing", identity, "closing.in")
    kinds = [glass.elements.index(ion) + 1 for ion in cations(material, potential)]

    @cache
    def readout(geometry: Geometry) -> Readout:
        cutoff = material.part("oxide_glass").cutoff_A
        return Readout(workspace, plan.segment_steps, plan.timestep, protocol.samples, area, geometry, kinds, cutoff)

    def read(geometry: Geometry, reached: Plan) -> Closing:
        relaxed = range(reached.segments + 1)
        if missing := [n for n in relaxed if not (workspace / f"relaxed.{n}").exists()]:
            run_lammps("relax.in", workspace, {"pairs": "pairs", "segment": missing})
        return _read(readout(geometry), reached, 10 * protocol.frozen_nm, geometry)

    def complete(geometry: Geometry, segments: int) -> bool:
        cell_nm2 = (geometry.wavelength_A / 10) ** 2
        curve = readout(geometry).curve(range(1, segments + 1))
        if curve[-1]["contact_area_nm2"] < RULES.stop_area_fraction * cell_nm2:
            return False
        measured = read(geometry, replace(plan, segments=segments))
        return may_stop(measured.curve, measured.witness, cell_nm2, closing.stop, protocol.approach_nm)

    geometry, reached = press_bodies(
        run, bodies, potential, closing, protocol, plan, place, workspace, complete, progress, counter_potential
    )
    result = read(geometry, reached)
    tops = [attraction_row(readout(geometry), n, geometry) for n in range(reached.segments + 1)]
    shutil.rmtree(work)
    return replace(result, witness=[{**row, **top} for row, top in zip(result.witness, tops, strict=True)])


def _read(readout: Readout, plan: Plan, held_A: float, geometry: Geometry) -> Closing:
    segments = range(1, plan.segments + 1)
    curve = readout.curve(segments)

    def displacement_nm(step: int) -> float:
        if plan.dwell_steps:
            return float(np.interp(step, [row["step"] for row in curve], [row["displacement_nm"] for row in curve]))
        return step * plan.timestep * plan.speed / 10

    snapshots = [readout.relaxed(n) for n in (0, *segments)]
    summary: dict[str, float] = {
        "atoms": geometry.atoms,
        "steps": plan.total_steps,
        "restart_steps": plan.segment_steps,
        "wavelength_nm": geometry.wavelength_A / 10,
    }
    return Closing(curve, witness_rows(snapshots, displacement_nm, held_A), slice_rows(snapshots, geometry), summary)


def attraction_row(readout: Readout, segment: int, geometry: Geometry) -> dict[str, float]:
    """What `attract_top` says of the top after a segment, as columns of the witness; NaN while the contact is small."""
    top = None
    if segment and (sample := readout.last_sample(segment)).area_A2 >= (10 * RULES.min_length_nm) ** 2:
        side, axis = (geometry.wavelength_A, geometry.wavelength_A), (geometry.axis_A, geometry.axis_A)
        places = readout.relaxed(segment).frame[:, 1:4]
        in_contact = contact_map(sample.touching_A, side, readout.area, axis)
        shares = shares_in_contact(places[:, :2], in_contact, side, axis)
        density = bulk_density_per_A3(readout.relaxed(0).frame[:, 1:4], side[0] * side[1])
        top = attract_top(places[:, 2], shares, sample.area_A2, density)
    return {
        "top_area_nm2": top.area_A2 / 100 if top else np.nan,
        "top_force_over_hamaker": 10 * top.force_per_A if top else np.nan,
        "top_work_over_hamaker": top.work if top else np.nan,
    }


def commensurate(counter: Atoms, glass: Atoms) -> Atoms:
    """The counterface's glass in a cell as wide as the asperity's.

    Raises
    ------
    InputError : that would strain it by more than `MAX_STRAIN`.
    """
    factor = glass.cell_A[0] / counter.cell_A[0]
    if abs(factor - 1) > MAX_STRAIN:
        raise InputError(
            f"the counterface's glass cell of {counter.cell_A[0]:.2f} A would be strained by {factor - 1:+.1%} beside "
            f"one of {glass.cell_A[0]:.2f} A (gate {MAX_STRAIN:.0%}): quench it with the edge of the asperity's cell"
        )
    return replace(counter, positions_A=factor * counter.positions_A, cell_A=factor * counter.cell_A)
