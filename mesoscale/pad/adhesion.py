"""Adhesion of a pad: the energy per area that opening it costs, and its pull-off.

The energy is the work of opening from the first separation at which the net force is zero, on the way out from the
largest load, to infinity. Pads differ in their surfaces; each is closed until its own cells carry the load.

A sphere on the film is Derjaguin's integral. At the distance r from its lowest point a sphere of radius R is r^2 / 2R
higher, so rings of equal steps of separation have equal areas 2 pi R ds. The force is 2 pi R times the integral of the
pressure over separation, each ring with a deepest closing of its own. The sphere keeps its shape: Hertz's flattening is
left out.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.attraction import retardation_rate, wall_offset_nm
from mesoscale.contact.displacement import Displacement
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs, contact_of
from mesoscale.pad.cells import PadGrid, SideBySide, far_nm, sample_cells
from mesoscale.pad.curves import PadCells, assemble
from mesoscale.pad.memory import PadLaw, flats_of, law_of
from mesoscale.settings import AdhesionSettings, ContactSettings

Array = NDArray[np.float64]

STEP_NM = 0.1
"""Step of separation in and near contact."""
FIRST_SEED = 5000
"""Of the surface of the first pad's first cell."""
SPHERE_STEP_RMS = 0.25
"""Distance of the depths of closing for the memory under a sphere, in units of the RMS height: some eight of them."""
RING_NM = 0.05
"""Step of the rings of a sphere."""
LIFT_NM = 60.0
"""The sphere is lifted so far at a time in search of its largest pull."""
MOST_STEPS = 20_000


@dataclass(frozen=True)
class Case:
    """Inputs and settings that all pads of a case share.

    Attributes
    ----------
    varied : which number differs from the central case: none, rms, gap_cutoff, retardation or work.
    """

    varied: str
    inputs: ContactInputs
    contact: ContactSettings


def plan_cases(values: Mapping[str, float], contact: ContactSettings, adhesion: AdhesionSettings) -> list[Case]:
    """The central case and one for each number beside it, in each mechanics; `adhesion.case_count` of them.

    Raises
    ------
    InputError : inputs that the contact does not accept.
    """
    cases = []
    for mechanics in adhesion.mechanics:
        inputs, settings = contact_of(values, contact.model_copy(update={"mechanics": mechanics}))
        cases.append(Case("none", inputs, settings))
        cases += [Case("rms", replace(inputs, rms=rms), settings) for rms in adhesion.rms_nm]
        for varied, key, numbers in (
            ("gap_cutoff", "gap_cutoff_nm", adhesion.gap_cutoffs_nm),
            ("retardation", "retardation_nm", adhesion.retardations_nm),
        ):
            cases += [Case(varied, inputs, settings.model_copy(update={key: number})) for number in numbers]
        cases += [
            Case(
                "work",
                replace(inputs, hamaker=work.hamaker(contact.attraction)),
                settings.model_copy(update={"gap_cutoff_nm": work.gap_cutoff_nm(contact.attraction)}),
            )
            for work in adhesion.works
        ]
    return cases


def flats_energy(hamaker: float, separation_nm: Array | float, rate: float) -> Any:
    """Energy per area (nN/nm = J/m^2) of two flats whose walls are so far apart, retarded at `rate` (1/nm)."""
    s = np.asarray(separation_nm, float)
    return hamaker / (12.0 * np.pi * s**2) / (1.0 + rate * s)


@dataclass(frozen=True)
class Opened:
    """What opening costs.

    Attributes
    ----------
    zero_nm : separation at which the net force is zero, on the way out from the largest load.
    energy_J_m2 : work per area from there to infinity.
    pull_off_GPa : largest net attraction on the way.
    """

    zero_nm: float
    energy_J_m2: float
    pull_off_GPa: float


def open_from(separation_nm: Array, net_GPa: Array, beyond_J_m2: float) -> Opened:
    """Energy and pull-off of an opening curve.

    Parameters
    ----------
    separation_nm, net_GPa : the way out from the largest load, separations rising, shape (n,).
    beyond_J_m2 : energy per area from the last separation to infinity.
    """
    first = int(np.argmax(net_GPa < 0.0))
    s, net = separation_nm[first:], net_GPa[first:]
    if first > 0:
        zero = float(np.interp(0.0, -net_GPa[first - 1 : first + 1], separation_nm[first - 1 : first + 1]))
        s, net = np.insert(s, 0, zero), np.insert(net, 0, 0.0)
    return Opened(float(s[0]), -float(np.trapezoid(net, s)) + beyond_J_m2, -float(net.min()))


def close_to_loads(case: Case, loads_GPa: Sequence[float], count: int, first_seed: int) -> tuple[PadCells, list[int]]:
    """Cells under one plane, closed side by side once, and opened where their mean repulsion reaches each load.

    Returns the cells, and the position among the depths for each load; between the loads and up to first contact they
    are opened from further depths.

    Raises
    ------
    InputError : the cells never carry the largest load.
    """
    cells = sample_cells(case.inputs, count, first_seed)
    film = SideBySide(case.inputs, case.contact, cells)
    top = float(film.first_contact_nm.max()) + STEP_NM
    separations, openings = far_nm(top)[::-1].tolist(), []
    for separation in separations:
        film.close_to(separation)
    repelled, last_opened, loaded = 0.0, np.inf, {}
    for step in range(MOST_STEPS):
        separation = top - STEP_NM * step
        separations.append(separation)
        repelled = film.close_to(separation)
        reached = [load for load in loads_GPa if load <= repelled and load not in loaded]
        if reached or (repelled > 0.0 and last_opened - separation >= SPHERE_STEP_RMS * case.inputs.rms):
            openings.append((len(separations) - 1, [cell.opening() for cell in film.cells]))
            last_opened = separation
            loaded |= dict.fromkeys(reached, len(openings) - 1)
        if len(loaded) == len(set(loads_GPa)):
            break
    else:
        raise InputError(
            f"adhesion.loads_MPa = {max(loads_GPa) * 1e3:g}: cells closed by {top - separations[-1]:.4g} nm carry "
            f"{repelled * 1e3:.3g} MPa; lower it"
        )
    opened = np.full((len(film.cells), len(openings), 2, len(separations)), np.nan)
    for depth, (place, branches) in enumerate(openings):
        for number, branch in enumerate(branches):
            opened[number, depth, :, : place + 1] = branch
    closed = [
        Displacement(contact, cell.closing, branches, cell.settled)
        for contact, cell, branches in zip(film.first_contact_nm.tolist(), film.cells, opened, strict=True)
    ]
    grid = PadGrid(np.array(separations), np.array([place for place, _ in openings]))
    return assemble(grid, cells, closed, case.contact.length_nm**2), [loaded[load] for load in loads_GPa]


def pad_rows(case: Case, adhesion: AdhesionSettings, number: int) -> list[dict[str, Any]]:
    """One row for each load of one pad of a case: columns of adhesion/pads.csv."""
    first = FIRST_SEED + number * adhesion.cells
    cells, loaded = close_to_loads(case, [load * 1e-3 for load in adhesion.loads_MPa], adhesion.cells, first)
    rate, offset = retardation_rate(case.contact.retardation_nm), wall_offset_nm(case.contact)
    outwards = cells.grid.separation_nm[::-1]
    beyond = float(flats_energy(case.inputs.hamaker, outwards[-1] + offset, rate))
    law = law_of(cells, flats_of(case.inputs, case.contact))
    rows = []
    for load, place in zip(adhesion.loads_MPa, loaded, strict=True):
        net = cells.mean(cells.opening[:, place]).sum(axis=0)[::-1]
        way = np.isfinite(net)
        opened = open_from(outwards[way], net[way], beyond)
        sphere = press_sphere(law, float(cells.grid.depth_nm[place]), adhesion.sphere_radius_um * 1e3, beyond)
        rows.append(
            {
                "mechanics": case.contact.mechanics,
                "varied": case.varied,
                "rms_nm": case.inputs.rms,
                "hamaker_aJ": case.inputs.hamaker,
                "gap_cutoff_nm": case.contact.gap_cutoff_nm,
                "retardation_nm": case.contact.retardation_nm,
                "load_MPa": load,
                "pad": number,
                "cells": adhesion.cells,
                "depth_nm": float(cells.grid.depth_nm[place]),
                "zero_force_nm": opened.zero_nm,
                "energy_uJ_m2": opened.energy_J_m2 * 1e6,
                "flats_uJ_m2": float(flats_energy(case.inputs.hamaker, opened.zero_nm + offset, rate)) * 1e6,
                "pull_off_kPa": opened.pull_off_GPa * 1e6,
                "sphere_load_uN": sphere.load_nN * 1e-3,
                "sphere_pull_off_uN": sphere.pull_off_nN * 1e-3,
                "sphere_work_mJ_m2": sphere.work_J_m2 * 1e3,
            }
        )
    return rows


def rows_of_case(
    case: Case, adhesion: AdhesionSettings, progress: Callable[[float, str], None] | None = None
) -> Iterator[dict[str, Any]]:
    """Rows of all pads of a case."""
    for number in range(adhesion.pads):
        yield from pad_rows(case, adhesion, number)
        if progress:
            progress((number + 1) / adhesion.pads, f"{number + 1} of {adhesion.pads} pads")


@dataclass(frozen=True)
class PressedSphere:
    """A sphere that was pressed on a film and pulled off.

    Attributes
    ----------
    load_nN : largest repulsion less attraction while it was pressed.
    pull_off_nN : largest net attraction on the way out.
    work_J_m2 : pull-off over 2 pi R, the work of adhesion that Derjaguin, Muller and Toporov would read from it.
    """

    load_nN: float
    pull_off_nN: float
    work_J_m2: float


def press_sphere(law: PadLaw, deepest_nm: float, radius_nm: float, beyond_J_m2: float) -> PressedSphere:
    """Press a sphere until its lowest point is at a separation of the film, and pull it off.

    Rings farther out than the shallowest computed depth have not touched, and open as they closed.

    Parameters
    ----------
    deepest_nm : that separation, of those from which the pad was opened or between them.
    beyond_J_m2 : energy per area of the attraction from the last separation of the law to infinity.

    Raises
    ------
    InputError : a separation that was not computed.
    """
    ends = float(law.separation_nm[-1])
    rings = np.arange(deepest_nm, ends, RING_NM)
    load = float(np.trapezoid(law.closing_GPa(rings), rings)) - beyond_J_m2
    touched, pull = rings[rings <= law.depth_nm[-1]], 0.0
    for start in np.arange(0.0, ends - deepest_nm, LIFT_NM):
        rises = np.arange(start, min(start + LIFT_NM, ends - deepest_nm), RING_NM)
        held = np.array([law.opening_GPa(ring + rises, ring) for ring in touched])
        inner = np.trapezoid(held, touched, axis=0) if touched.size > 1 else np.zeros(rises.size)
        outer = _integral_to_end(law, touched[-1] + rises)
        per_area = inner + outer - beyond_J_m2
        pull = max(-float(per_area.min()), pull)
        if per_area.argmin() < rises.size - 1:
            break  # it pulls less from here on
    return PressedSphere(2 * np.pi * radius_nm * load, 2 * np.pi * radius_nm * pull, pull)


def _integral_to_end(law: PadLaw, starts_nm: Array) -> Array:
    """Integral of the closing pressure (nN/nm) from each start to the last separation of the law."""
    at = np.arange(starts_nm.min(), law.separation_nm[-1] + RING_NM, RING_NM).clip(max=law.separation_nm[-1])
    pressure = law.closing_GPa(at)
    pieces = 0.5 * (pressure[1:] + pressure[:-1]) * np.diff(at)
    remaining = np.append(np.cumsum(pieces[::-1])[::-1], 0.0)
    return np.interp(starts_nm, at, remaining)


MEASURED = ("zero_force_nm", "energy_uJ_m2", "flats_uJ_m2", "pull_off_kPa")
ON_SPHERE = ("sphere_load_uN", "sphere_pull_off_uN", "sphere_work_mJ_m2")
SHARED = ("mechanics", "varied", "rms_nm", "hamaker_aJ", "gap_cutoff_nm", "retardation_nm", "load_MPa", "cells")


def summary_rows(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Rows of adhesion/summary.csv: mean, standard error and the lowest and highest pad of each case and load."""
    groups: dict[tuple[Any, ...], list[Mapping[str, Any]]] = {}
    for row in rows:
        groups.setdefault(tuple(row[key] for key in SHARED), []).append(row)
    summary = []
    for shared, pads in groups.items():
        line: dict[str, Any] = dict(zip(SHARED, shared, strict=True)) | {"pads": len(pads)}
        for key in (*MEASURED, *ON_SPHERE):
            values = np.array([float(row[key]) for row in pads])
            line[key] = float(values.mean())
            line[f"{key}_error"] = float(values.std(ddof=1) / len(values) ** 0.5) if len(values) > 1 else None
            line[f"{key}_lowest"], line[f"{key}_highest"] = float(values.min()), float(values.max())
        summary.append(line)
    return summary
