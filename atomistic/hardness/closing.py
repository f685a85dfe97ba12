"""One closing run: cut, anneal, press by the flat, relax without it; returns the measured curve."""

import shutil
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from asperity.guards.errors import InputError
from atomistic.hardness.asperity import cut_asperity, formula_of
from atomistic.hardness.contact_area import Area, calibrated, contact_map, shares_in_contact
from atomistic.hardness.film_base import Base
from atomistic.hardness.glass import cations
from atomistic.hardness.plateau import RULES, may_stop
from atomistic.hardness.pressing import (
    Plan,
    base_thickness_nm,
    lammps_seed,
    plan_closing,
    prepare_body,
    press_body,
)
from atomistic.hardness.readout import (
    Frame,
    OxideBond,
    PressedCell,
    Readout,
    Rows,
    Sample,
    witness_rows,
)
from atomistic.hardness.runs import PROTOCOL, ClosingRun, Protocol, slowed
from atomistic.hardness.stack import Stack, check_film, cut_base, film_properties, lay
from atomistic.hardness.top_attraction import TopAttraction, attract_top, bulk_density_per_A3
from atomistic.lammps import Atoms, LammpsFolder, Progress, run_lammps
from atomistic.materials import Material
from atomistic.potentials import ForceField, Potential
from atomistic.settings import ClosingSettings

NO_TOP: dict[str, float] = dict.fromkeys(
    ("top_area_nm2", "top_force_over_hamaker", "top_work_over_hamaker"), np.nan
)


@dataclass(frozen=True)
class ClosedAsperity:
    """Result of a closing run.

    Attributes
    ----------
    curve : one row per average (columns as in docs/results.md).
    witness : one row per relaxed snapshot: bond exchanges and lasting lowering against the first,
        and the attraction of its top.
    summary : atoms, steps and the side of the cell.
    """

    curve: Rows
    witness: Rows
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
    base: tuple[Base, Atoms] | None = None,
) -> ClosedAsperity:
    """Carry out a run, or go on from `work`'s restart files; `work` is deleted at the end.

    Parameters
    ----------
    material, glass : oxide of the asperity, and a cell of its glass.
    base : what lies below a film, and a cell of it (`Base.make`).

    Raises
    ------
    InputError : a film that its asperity does not allow, a base that is not given, or no
        calibration of the area.
    """
    wavelength_nm = run.asperity.tiles * float(glass.cell_A[0]) / 10
    calibrated(potential)  # raises where it is not
    area = Area()
    on_base = run.asperity.film_nm is not None
    if on_base and base is not None:
        protocol = slowed(protocol, base[0].below_films.timestep_factor)
    plan = plan_closing(closing, run, protocol)
    choices = [
        run.model_dump(),
        material.formula_text,
        closing.model_dump(),
        protocol.model_dump(),
        asdict(area),
    ]
    identity = {
        "potential": potential.model_dump(),
        "run": choices,
        "glass": [glass.cell_A.tolist(), glass.positions_A.sum(axis=0).tolist()],
    }
    if base is not None:
        metal, cell = base
        identity["base"] = [metal.material.model_dump(), cell.positions_A.sum(axis=0).tolist()]
    place = (run.seed, run.asperity.tiles, round(1000 * run.asperity.amplitude_nm))
    aside = LammpsFolder(work / "anneal", identity, "anneal.in")
    cut = cut_body(
        run, glass, potential, base_thickness_nm(closing, wavelength_nm, protocol), place, base
    )
    body = prepare_body(
        run, cut.atoms, cut.formula, cut.force, closing, protocol, aside, place, progress
    )
    workspace = LammpsFolder(work / "closing", identity, "closing.in")
    bond = oxide_bond(body.elements, material, potential)

    @cache
    def readout(cell: PressedCell) -> Readout:
        return Readout(
            workspace, plan.segment_steps, plan.timestep, protocol.samples, area, cell, bond
        )

    def read(cell: PressedCell, reached: Plan) -> ClosedAsperity:
        snapshots = protocol.snapshots(reached.segments)
        if missing := [n for n in snapshots if not (workspace / f"relaxed.{n}").exists()]:
            run_lammps("relax.in", workspace, {"pairs": "pairs", "segment": missing})
        return _read(readout(cell), reached, snapshots, 10 * protocol.frozen_nm, cell)

    def complete(cell: PressedCell, segments: int) -> bool:
        cell_nm2 = (cell.wavelength_A / 10) ** 2
        curve = readout(cell).curve(range(1, segments + 1))
        if curve[-1]["contact_area_nm2"] < RULES.stop_area_fraction * cell_nm2:
            return False
        measured = read(cell, replace(plan, segments=segments))
        curve, witness = measured.curve, measured.witness
        return may_stop(
            curve, witness, cell_nm2, closing.stop, protocol.approach_nm, on_base=on_base
        )

    cell, reached = press_body(
        run, body, cut.force, closing, protocol, plan, place, workspace, complete, progress
    )
    result = read(cell, reached)
    snapshots = protocol.snapshots(reached.segments)
    # atoms of a base pull otherwise: their tops say nothing of the oxide's
    tops = [NO_TOP] * len(snapshots)
    if not on_base:
        tops = [attraction_row(readout(cell), number, cell) for number in snapshots]
    if run.asperity.film_nm and base is not None:
        start, end = (readout(cell).relaxed(n).frame for n in (0, snapshots[-1]))
        result.summary.update(film_properties(start, end, cell.wavelength_A, len(base[0].elements)))
    shutil.rmtree(work)
    rows = zip(result.witness, tops, strict=True)
    return replace(result, witness=[{**row, **top} for row, top in rows])


@dataclass(frozen=True)
class CutBody:
    """What is annealed and pressed: atoms, those of each type in a formula unit, forces."""

    atoms: Atoms
    formula: np.ndarray
    force: ForceField


def cut_body(
    run: ClosingRun,
    glass: Atoms,
    potential: Potential,
    base_nm: float,
    place: tuple[int, ...],
    base: tuple[Base, Atoms] | None = None,
) -> CutBody:
    """The asperity of a run: of oxide, of the base, or of the base under a film.

    Parameters
    ----------
    base_nm : thickness below the mean height.
    place : numbers that tell the run's random numbers from those of others.
    base : of `run_closing`.

    Raises
    ------
    InputError : of `check_film`, or of a film without a base.
    """
    asperity = run.asperity
    seed = lammps_seed(*place, 3)
    amplitude_A = 10 * asperity.amplitude_nm
    base_A = 10 * base_nm
    film_nm = asperity.film_nm
    if film_nm is None:
        cut = cut_asperity(glass, asperity.tiles, amplitude_A, base_A, seed)
        return CutBody(cut, formula_of(glass), potential)
    if base is None:
        raise InputError(
            f"asperity {asperity.name}: film_nm = {film_nm:g} needs a body below; set hardness.base"
        )
    below, cell = base
    if film_nm == 0:
        return CutBody(
            cut_base(cell, glass, asperity.tiles, amplitude_A, base_A, seed),
            formula_of(cell),
            below,
        )
    check_film(film_nm, RULES.max_area_fraction**0.5 * asperity.tiles * float(glass.cell_A[0]) / 10)
    cut = lay(cell, glass, asperity.tiles, amplitude_A, 10 * film_nm, base_A, seed)
    formula = np.array([*(0 for _ in below.elements), *formula_of(glass)])
    return CutBody(cut, formula, Stack(potential, below))


def oxide_bond(
    elements: tuple[str, ...], material: Material, potential: Potential
) -> OxideBond | None:
    """What counts as a bond in a body with these elements of its types; None: it has no oxide."""
    ions = tuple(potential.materials[material.formula_text])
    if not set(ions) <= set(elements):
        return None
    cation, anion = sorted(ions, key=cations(material, potential).__contains__, reverse=True)
    # the last of an element is the film's
    types = {element: kind for kind, element in enumerate(elements, 1)}
    return OxideBond(types[cation], types[anion], material.part("oxide_glass").cutoff_A)


def _read(
    readout: Readout, plan: Plan, snapshots: list[int], held_A: float, cell: PressedCell
) -> ClosedAsperity:
    summary: dict[str, float] = {"atoms": cell.atoms, "steps": plan.total_steps}
    summary["wavelength_nm"] = cell.wavelength_A / 10
    witness = witness_rows(
        [readout.relaxed(n) for n in snapshots], plan.timestep, plan.speed, held_A
    )
    return ClosedAsperity(readout.curve(range(1, plan.segments + 1)), witness, summary)


def attraction_row(readout: Readout, segment: int, cell: PressedCell) -> dict[str, float]:
    """What `attract_top` says of the top after a segment; NaN while the contact is small."""
    if (
        segment
        and (sample := readout.last_sample(segment)).area_A2 >= (10 * RULES.min_length_nm) ** 2
    ):
        unpressed = readout.relaxed(0).frame
        top = top_below(sample, readout.relaxed(segment).frame, unpressed, readout.area, cell)
        values = (top.area_A2 / 100, 10 * top.force_per_A, top.work)
        return dict(zip(NO_TOP, values, strict=True))
    return NO_TOP


def top_below(
    sample: Sample, relaxed: Frame, unpressed: Frame, area: Area, cell: PressedCell
) -> TopAttraction:
    """Attraction of what lies below a contact once the flat is away.

    Parameters
    ----------
    sample : the contact.
    relaxed, unpressed : atoms without the flat, after this contact and of the body at rest.
    """
    side = (cell.wavelength_A, cell.wavelength_A)
    axis = (cell.axis_A, cell.axis_A)
    places = relaxed[:, 1:4]
    in_contact = contact_map(sample.touching_A, side, area, axis)
    shares = shares_in_contact(places[:, :2], in_contact, side, axis)
    density = bulk_density_per_A3(unpressed[:, 1:4], side[0] * side[1])
    return attract_top(places[:, 2], shares, sample.area_A2, density)
