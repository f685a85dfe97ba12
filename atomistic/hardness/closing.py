"""One closing run: cut, anneal, press against the counterface, relax without it; returns the measured curve."""

import shutil
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from atomistic.errors import InputError
from atomistic.hardness.contact_area import require_calibration
from atomistic.hardness.glass import cations
from atomistic.hardness.plateau import may_stop
from atomistic.hardness.pressing import (
    Plan,
    base_thickness_nm,
    plan_closing,
    prepare_body,
    press_bodies,
    script_of,
)
from atomistic.hardness.readout import Geometry, Readout, Rows, slice_rows, witness_rows
from atomistic.hardness.runs import ClosingRun
from atomistic.lammps import Atoms, Progress, Workspace, run_lammps
from atomistic.materials import Material
from atomistic.potentials import Potential
from atomistic.settings import HardnessSettings

MAX_STRAIN = 0.01  # of a counterface whose cell differs from the asperity's


@dataclass(frozen=True)
class Closing:
    """Result of a closing run.

    curve : one row per average (columns as in docs/hardness.md).
    witness : one row per relaxed snapshot: bond exchanges and lasting lowering against the first.
    snapshots : slices through the contact of the relaxed snapshots, for pictures.
    unloading : rows like those of `curve` while the counterface goes back.
    """

    curve: Rows
    witness: Rows
    snapshots: Rows
    unloading: Rows
    summary: dict[str, float]


def run_closing(
    run: ClosingRun,
    material: Material,
    glass: Atoms,
    potential: Potential,
    settings: HardnessSettings,
    work: Path,
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
    require_calibration(potential, settings.area, counter_potential)
    closing, plan = settings.closing, plan_closing(settings, run)
    identity = {
        "potential": [within.model_dump() for within in (potential, counter_potential or potential)],
        "run": [run.asperity.model_dump(), run.seed, run.energy_scale],
        "settings": settings.model_dump(include={"closing": True, "area": True, "material": True, "plasticity": True}),
        "glass": [[g.cell_A.tolist(), g.positions_A.sum(axis=0).tolist()] for g in (glass, counter_glass or glass)],
    }
    place = (run.seed, run.asperity.tiles, round(1000 * run.asperity.amplitude_nm))
    aside = Workspace(work / "anneal", identity, "anneal.in")
    base_nm = base_thickness_nm(settings, run.asperity.tiles * float(glass.cell_A[0]) / 10)
    bodies = [prepare_body(run, glass, potential, settings, aside, place, run.asperity.amplitude_nm, base_nm, progress)]
    if closing.counterface in ("oxide", "asperity"):
        amplitude = run.asperity.amplitude_nm if closing.counterface == "asperity" else 0.0
        counter, thickness = commensurate(counter_glass or glass, glass), closing.counter_base_nm
        aside = Workspace(work / "anneal_counter", identity, "anneal.in")
        within = counter_potential or potential
        bodies.append(prepare_body(run, counter, within, settings, aside, (*place, 6), amplitude, thickness, progress))
    workspace = Workspace(work / "closing", identity, script_of(settings))
    kinds = [glass.elements.index(ion) + 1 for ion in cations(material, potential)]

    @cache
    def readout(geometry: Geometry) -> Readout:
        cutoff = material.part("oxide_glass").cutoff_A
        return Readout(workspace, plan.segment_steps, plan.timestep, settings.area, geometry, kinds, cutoff)

    def read(geometry: Geometry, reached: Plan) -> Closing:
        relaxed = range(reached.segments + reached.back + 1)
        if missing := [n for n in relaxed if not (workspace / f"relaxed.{n}").exists()]:
            run_lammps("relax.in", workspace, {"pairs": "pairs", "segment": missing})
        return _read(readout(geometry), reached, 10 * closing.frozen_nm, geometry)

    def complete(geometry: Geometry, segments: int) -> bool:
        cell_nm2 = (geometry.wavelength_A / 10) ** 2
        curve = readout(geometry).curve(range(1, segments + 1))
        if curve[-1]["contact_area_nm2"] < settings.plasticity.stop_area_fraction * cell_nm2:
            return False
        measured = read(geometry, replace(plan, segments=segments, back=0))
        return may_stop(measured.curve, measured.witness, cell_nm2, closing, settings.plasticity)

    geometry, reached = press_bodies(
        run, bodies, potential, settings, plan, place, workspace, progress, complete, counter_potential
    )
    result = read(geometry, reached)
    shutil.rmtree(work)
    return result


def _read(readout: Readout, plan: Plan, held_A: float, geometry: Geometry) -> Closing:
    closing_segments = range(1, plan.segments + 1)
    curve = readout.curve(closing_segments)
    unloading = readout.curve(range(plan.segments + 1, plan.segments + plan.back + 1)) if plan.back else []

    def displacement_nm(step: int) -> float:
        if plan.step:
            return step * plan.step / 10
        if plan.dwell_steps:
            return float(np.interp(step, [row["step"] for row in curve], [row["displacement_nm"] for row in curve]))
        return step * plan.timestep * plan.speed / 10

    snapshots = [readout.relaxed(n) for n in (0, *closing_segments)]
    witness = witness_rows(snapshots, displacement_nm, held_A, geometry)
    summary: dict[str, float] = {
        "atoms": geometry.atoms,
        "steps": plan.total_steps,
        "restart_steps": plan.segment_steps,
        "wavelength_nm": geometry.wavelength_A / 10,
    }
    if plan.back:
        last = readout.relaxed(plan.segments + plan.back)
        unloaded = witness_rows([snapshots[0], last], displacement_nm, held_A, geometry)[-1]
        summary |= {
            "snapshot_exchanged_bonds": witness[-1]["exchanged_bonds"],
            "unloaded_exchanged_bonds": unloaded["exchanged_bonds"],
            "snapshot_lowering_nm": witness[-1]["lowering_nm"],
            "unloaded_lowering_nm": unloaded["lowering_nm"],
            "unloaded_force_nN": unloading[-1]["force_nN"],
        }
    return Closing(curve, witness, slice_rows(snapshots, geometry), unloading, summary)


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
