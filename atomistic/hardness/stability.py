"""Stiff and extreme cases of the hardness stage, judged by what must hold (`stability`).

Made-up closings without a hardness must be refused, with the reason. Atoms that are cold, hot,
molten or pressed too fast must keep their energy. What cannot be computed must end in one line.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from atomistic.for_studies import HardCase, Verdict, refused
from atomistic.hardness.closing import ClosedAsperity, run_closing
from atomistic.hardness.contact_area import Area, calibrated, contact_area
from atomistic.hardness.glass import MELT_K, TIMESTEP_FS
from atomistic.hardness.made_up_closings import (
    APPROACH_NM,
    CELL_AREA_NM2,
    HARDNESS_GPA,
    TRAVEL_NM,
    Rows,
    contact_length_nm,
    curve,
    plateau,
    witness,
)
from atomistic.hardness.motion import drift_meV_atom_ps, free_motion, heated
from atomistic.hardness.plateau import RULES, find_hardness
from atomistic.hardness.runs import PROTOCOL, ClosingRun
from atomistic.hardness.top_attraction import attract_top
from atomistic.lammps import Atoms, load_data, load_dump, write_data
from atomistic.materials import Material
from atomistic.potentials import Potential
from atomistic.settings import AsperitySettings, ClosingSettings

FREE_PS = 4.0
"""Time at constant energy: over half of it a heated solid still drifts by 0.25 meV per atom and ps
while it melts.
"""
SIDE_A = 24.0
"""Least width of the asperities that are closed."""
AMPLITUDE_NM = 0.2
BASE_NM = 1.4
SPEED_M_S = 200.0
LARGEST_DRIFT_MEV_ATOM_PS = 1.0
"""Of a closing of less than 1 ps: a cut surface has hardly come to rest, and its energy scatters by
as much at the start. The gate of longer ones is `Rules.max_drift_meV_atom_ps`."""
THIN = PROTOCOL.model_copy(update={"base_over_contact": 0.0})
REFUSED = "no hardness; the status says why"
ONE_LINE = "refused in one line"
DUMP = (
    "ITEM: TIMESTEP\n10\nITEM: NUMBER OF ATOMS\n{count}\nITEM: BOX BOUNDS pp pp ff\n0 1\n0 1\n0"
    " 1\n{atoms}"
)
DUMPED = "ITEM: ATOMS id x\n1 0.5\n2 0.25\n"


def hard_cases(
    material: Material, potential: Potential, glass: Atoms, work: Path
) -> list[HardCase]:
    """All cases.

    Parameters
    ----------
    glass : a periodic cell of the material.
    work : an existing folder for LAMMPS, which the caller removes.
    """
    return [
        *curve_cases(),
        *file_cases(glass, potential, work),
        *top_cases(potential),
        *motion_cases(potential, glass, work),
        *closing_cases(material, potential, glass, work),
    ]


def curve_cases() -> list[HardCase]:
    """Made-up closings: their hardness is 10 GPa where they have one."""
    length = contact_length_nm()
    late = np.maximum(0, 3.2 * (TRAVEL_NM - 0.75))
    molten = curve(plateau, temperature=400.0)
    for row in molten[30:]:
        row["temperature_K"] = 800.0
    recovers = witness()
    recovers[-1]["lowering_nm"] = 0.0
    unknown_energy = curve(plateau)
    unknown_energy[20]["energy_drift_meV_per_atom"] = np.nan
    unknown_temperature = curve(plateau)
    unknown_temperature[20]["temperature_K"] = np.nan
    sparse = [row for k, row in enumerate(witness()) if k % 4 == 0]
    refusals = [
        (
            "no plateau",
            "stress rises with the contact to the end",
            curve(_rising),
            witness(),
            "still rises",
        ),
        (
            "energy drifts",
            "by 1 meV per atom and ps",
            curve(plateau, drift=0.5),
            witness(),
            "energy drifts",
        ),
        ("melts", "temperature rises to 800 K", molten, witness(), "warms"),
        ("energy without a number", "one of 48", unknown_energy, witness(), "energy"),
        ("temperature without a number", "one of 48", unknown_temperature, witness(), "warms"),
        (
            "tiny contact",
            "0.8 nm wide throughout",
            curve(plateau, np.full(len(TRAVEL_NM), 0.8)),
            witness(),
            "too small",
        ),
        (
            "no contact",
            "the flat never touches",
            curve(lambda _: float("nan"), 0 * length),
            witness(),
            "too small",
        ),
        (
            "single average",
            "a curve of one row",
            curve(plateau)[-1:],
            witness(),
            "a curve of 1 averages",
        ),
        (
            "pulled",
            "adhesion throughout: stress is negative",
            curve(lambda _: -1.0),
            witness(),
            "adhesion",
        ),
        (
            "late yield",
            "three averages beyond the onset",
            curve(plateau)[:-2],
            witness(onset=1.1),
            "too few averages",
        ),
        (
            "no snapshot before contact",
            "one every 0.4 nm",
            curve(plateau),
            sparse,
            "no snapshot before contact",
        ),
        (
            "stopped early",
            "on 24 % of the cell",
            curve(plateau),
            witness(),
            "stopped before its rule",
        ),
        ("never yields", "no bond exchanged", curve(plateau), witness(onset=9), "no_yield"),
        ("few bonds", "three exchanged", curve(plateau), witness(after=3), "no_yield"),
        (
            "springs back",
            "the top stays 0.02 nm lower",
            curve(plateau),
            witness(lowering=0.02),
            "no_yield",
        ),
        (
            "recovers",
            "the last snapshot is as high as the first",
            curve(plateau),
            recovers,
            "no_yield",
        ),
        (
            "flickers",
            "20 bonds a snapshot without contact, 25 with",
            curve(plateau),
            witness(0.8, 20, 5),
            "no_yield",
        ),
    ]
    areas = {"stopped early": 9.5 / RULES.stop_area_fraction}
    cases = [
        HardCase(
            name,
            words,
            REFUSED,
            partial(_no_hardness, rows, seen, why, areas.get(name, CELL_AREA_NM2)),
        )
        for name, words, rows, seen, why in refusals
    ]
    rng = np.random.default_rng(5)
    noisy = curve(lambda length_nm: plateau(length_nm) * (1 + 0.3 * rng.normal()))
    jumping = curve(lambda length_nm: plateau(length_nm) * (2 if length_nm > 2.6 else 1))
    return [
        *cases,
        HardCase(
            "noise",
            "30 % on every average of a plateau",
            "hardness within three of its standard errors, and an interval wider than a run may"
            " stop on",
            partial(_noisy_hardness, noisy),
        ),
        HardCase(
            "jump",
            "stress doubles at a contact of 2.6 nm",
            "refused, or a hardness between both levels",
            partial(_between, jumping, HARDNESS_GPA, 2 * HARDNESS_GPA),
        ),
        HardCase(
            "late contact",
            "contact from 0.75 nm on, with 20 exchanges a snapshot before it",
            "they are background, no plastic flow",
            partial(_background, curve(plateau, late), witness(0.9, 20), 20.0),
        ),
    ]


def file_cases(glass: Atoms, potential: Potential, work: Path) -> list[HardCase]:
    """Files cut short."""
    dumps = [
        ("dump cut short", "two of three atoms", 3, DUMPED),
        ("dump without atoms", "it ends after its head", 2, ""),
        ("dump that lies", "a trillion atoms announced", 10**12, DUMPED),
        ("dump of words", "the number of atoms is a word", "two", DUMPED),
    ]
    cases = []
    for k, (name, words, count, atoms) in enumerate(dumps):
        text = DUMP.format(count=count, atoms=atoms)
        judge = partial(
            refused, partial(_load_written, work / f"dump_{k}", text), "not a whole LAMMPS dump"
        )
        cases.append(HardCase(name, words, ONE_LINE, judge))
    cut = partial(
        refused,
        partial(_load_cut, glass, potential, work / "cut.data"),
        "not a whole LAMMPS data file",
    )
    return [
        *cases,
        HardCase("glass cut short", "a data file without its last hundred lines", ONE_LINE, cut),
    ]


def top_cases(potential: Potential) -> list[HardCase]:
    """Contacts and tops of few atoms or none."""
    cell = (60.0, 60.0)
    middle = (30.0, 30.0)
    lattice = np.stack(np.meshgrid(np.arange(0, 60, 3.0), np.arange(0, 60, 3.0)), axis=-1).reshape(
        -1, 2
    )
    no_atom = partial(attract_top, np.zeros(3), np.zeros(3), 100.0, 0.066)
    no_area = partial(attract_top, np.zeros(3), np.ones(3), 0.0, 0.066)
    bare = potential.model_copy(update={"contact_area": None})
    areas = [
        ("nothing touches", "no atom at the flat", np.empty((0, 2)), 0.0),
        ("all touches", "atoms on the whole cell", lattice, 3600.0),
        (
            "one atom touches",
            "its contact is a disc of the rim",
            np.array([middle]),
            np.pi * Area().rim_A ** 2,
        ),
    ]
    return [
        *(
            HardCase(
                name,
                words,
                "the known area, within 15 %",
                partial(_area, places, cell, middle, area_A2),
            )
            for name, words, places, area_A2 in areas
        ),
        HardCase(
            "no atom pulls",
            "a top without atoms",
            ONE_LINE,
            partial(refused, no_atom, "no atoms below"),
        ),
        HardCase(
            "top without area",
            "a contact of 0 Å2",
            ONE_LINE,
            partial(refused, no_area, "no atoms below"),
        ),
        HardCase(
            "area not calibrated",
            "a potential whose contacts were never measured",
            ONE_LINE,
            partial(refused, partial(calibrated, bare), "contact_area"),
        ),
    ]


def motion_cases(potential: Potential, glass: Atoms, work: Path) -> list[HardCase]:
    """Atoms at constant energy."""
    closing_fs = PROTOCOL.timestep_fs
    gate = f"drift below {RULES.max_drift_meV_atom_ps} meV per atom and ps"
    moving = [
        ("cold", 10.0, closing_fs),
        ("room temperature", PROTOCOL.temperature_K, closing_fs),
        ("hot", PROTOCOL.anneal_temperature_K, closing_fs),
        ("molten", MELT_K, TIMESTEP_FS),
    ]
    cases = [
        HardCase(
            name,
            f"{kelvin:g} K, {step_fs:g} fs, {FREE_PS:g} ps at constant energy",
            gate,
            partial(_keeps_energy, glass, potential, kelvin, step_fs, work / "nve"),
        )
        for name, kelvin, step_fs in moving
    ]
    overlapping = replace(
        glass, positions_A=np.vstack([glass.positions_A[1], glass.positions_A[1:]])
    )
    overlap = partial(free_motion, overlapping, potential, work / "nve", closing_fs, 10)
    return [
        *cases,
        HardCase(
            "overlapping atoms",
            "two atoms at one place",
            ONE_LINE,
            partial(refused, overlap, "LAMMPS nve.in"),
        ),
        HardCase(
            "time step too long",
            "30 fs at room temperature",
            "refused, or a drift beyond the gate",
            partial(_explodes, glass, potential, work / "nve"),
        ),
        HardCase(
            "atoms pulled apart",
            "two ions beyond the reach of their potential",
            "no force: they stay where they are",
            partial(_stays_apart, glass, potential, work / "nve"),
        ),
    ]


def closing_cases(
    material: Material, potential: Potential, glass: Atoms, work: Path
) -> list[HardCase]:
    """Small closings that are real."""
    keeps = f"no atom is lost, drift below {LARGEST_DRIFT_MEV_ATOM_PS:g} meV per atom and ps"
    close = partial(_close, material, potential, glass, work / "closing")
    return [
        HardCase(
            "hot closing", "1200 K", keeps, partial(_closes, partial(close, temperature_K=1200.0))
        ),
        HardCase(
            "cold closing", "10 K", keeps, partial(_closes, partial(close, temperature_K=10.0))
        ),
        HardCase(
            "fast closing", "1000 m/s", keeps, partial(_closes, partial(close, speed_m_s=1000.0))
        ),
        HardCase(
            "no asperity",
            "a flat surface, pressed by 0.3 nm",
            "pressed, and no hardness: a contact on all of the cell has no window",
            partial(_flat, partial(close, amplitude_nm=0.001, depth_over_amplitude=300.0)),
        ),
        HardCase(
            "does not touch",
            "travel that ends 0.2 nm above the highest atom",
            "no contact, no force, no hardness",
            partial(_untouched, partial(close, depth_over_amplitude=-1.0, approach_nm=0.4)),
        ),
    ]


def _rising(length_nm: float) -> float:
    return 4 * length_nm


def _no_hardness(rows: Rows, seen: Rows, why: str, cell_area_nm2: float) -> Verdict:
    hardness = find_hardness(rows, seen, cell_area_nm2, APPROACH_NM)
    return hardness.status != "yield" and why in hardness.status, hardness.status


def _noisy_hardness(rows: Rows) -> Verdict:
    hardness = find_hardness(rows, witness(), CELL_AREA_NM2, APPROACH_NM)
    half = 0.5 * (hardness.hardness_hi - hardness.hardness_lo)
    wide = half > RULES.stop_interval * hardness.hardness_GPa
    detail = f"{hardness.status}, {hardness.hardness_GPa:.1f} +- {half:.1f} GPa"
    return (
        hardness.status == "yield"
        and wide
        and abs(hardness.hardness_GPa - HARDNESS_GPA) < 3 * half,
        detail,
    )


def _between(rows: Rows, low_GPa: float, high_GPa: float) -> Verdict:
    hardness = find_hardness(rows, witness(), CELL_AREA_NM2, APPROACH_NM)
    if hardness.status != "yield":
        return True, hardness.status
    return low_GPa <= hardness.hardness_GPa <= high_GPa, f"{hardness.hardness_GPa:.1f} GPa"


def _background(rows: Rows, seen: Rows, exchanges: float) -> Verdict:
    hardness = find_hardness(rows, seen, CELL_AREA_NM2, APPROACH_NM)
    return (
        hardness.exchanges_before == exchanges,
        f"{hardness.exchanges_before:g} exchanges before contact",
    )


def _load_written(path: Path, text: str) -> object:
    path.write_text(text, encoding="utf-8")
    return load_dump(path)


def _load_cut(glass: Atoms, potential: Potential, path: Path) -> object:
    write_data(path, replace(glass, velocities_A_ps=None), potential.masses_u)
    lines = path.read_text(encoding="utf-8").splitlines()
    path.write_text("\n".join(lines[:-100]), encoding="utf-8")
    return load_data(path, glass.elements)


def _area(
    places: np.ndarray, cell: tuple[float, float], middle: tuple[float, float], area_A2: float
) -> Verdict:
    measured_A2 = contact_area(places, cell, Area(), middle)
    return abs(measured_A2 - area_A2) <= 0.15 * area_A2, f"{measured_A2:.1f} of {area_A2:.1f} Å2"


def _drift(glass: Atoms, potential: Potential, kelvin: float, step_fs: float, work: Path) -> float:
    record, _ = free_motion(
        heated(glass, potential, kelvin), potential, work, step_fs, round(1000 * FREE_PS / step_fs)
    )
    return drift_meV_atom_ps(record, len(glass), step_fs)


def _keeps_energy(
    glass: Atoms, potential: Potential, kelvin: float, step_fs: float, work: Path
) -> Verdict:
    drift = _drift(glass, potential, kelvin, step_fs, work)
    return abs(drift) < RULES.max_drift_meV_atom_ps, f"{drift:+.3f} meV per atom and ps"


def _explodes(glass: Atoms, potential: Potential, work: Path) -> Verdict:
    drifts: list[float] = []
    stopped, detail = refused(
        lambda: drifts.append(_drift(glass, potential, PROTOCOL.temperature_K, 30.0, work)),
        "LAMMPS nve.in",
    )
    if not drifts:
        return stopped, detail
    return not abs(drifts[0]) < RULES.max_drift_meV_atom_ps, f"{drifts[0]:+.3g} meV per atom and ps"


def _stays_apart(glass: Atoms, potential: Potential, work: Path) -> Verdict:
    types = np.array([1, 2])
    places = np.array([[50.0, 50.0, 20.0], [50.0, 50.0, 80.0]])
    ions = Atoms(glass.elements, types, places, np.full(3, 100.0), np.zeros((2, 3)))
    record, end = free_motion(ions, potential, work, PROTOCOL.timestep_fs, 100)
    moved = float(np.abs(end.positions_A - places).max())
    return moved < 1e-9 and float(np.ptp(record[:, 2])) == 0.0, f"moved by {moved:.1g} Å"


def _close(
    material: Material,
    potential: Potential,
    glass: Atoms,
    work: Path,
    speed_m_s: float = SPEED_M_S,
    amplitude_nm: float = AMPLITUDE_NM,
    **protocol: float,
) -> ClosedAsperity:
    """A small closing."""
    tiles = max(1, round(SIDE_A / float(glass.cell_A[0])))
    asperity = AsperitySettings(name="tiny", tiles=tiles, amplitude_nm=amplitude_nm)
    run = ClosingRun(name="tiny", asperity=asperity, seed=1, energy_scale=1.0)
    closing = ClosingSettings(base_nm=BASE_NM, speed_m_s=speed_m_s, anneal_ps=0.5)
    varied = THIN.model_copy(update=protocol)
    return run_closing(run, material, glass, potential, closing, work, varied)


def _closes(close: Callable[[], ClosedAsperity]) -> Verdict:
    rows = close().curve
    drift = rows[-1]["energy_drift_meV_per_atom"] - rows[0]["energy_drift_meV_per_atom"]
    rate = drift / max(rows[-1]["time_ps"] - rows[0]["time_ps"], 1.0)
    pressed = rows[-1]["force_nN"] > 0
    detail = f"{rate:+.2f} meV per atom and ps, {rows[-1]['force_nN']:.1f} nN at the end"
    return abs(rate) < LARGEST_DRIFT_MEV_ATOM_PS and pressed, detail


def _flat(close: Callable[[], ClosedAsperity]) -> Verdict:
    closed = close()
    last = closed.curve[-1]
    cell_nm2 = closed.summary["wavelength_nm"] ** 2
    hardness = find_hardness(closed.curve, closed.witness, cell_nm2)
    touches = last["force_nN"] > 0 and last["contact_area_nm2"] > RULES.max_area_fraction * cell_nm2
    detail = f"contact on {last['contact_area_nm2']:.1f} of {cell_nm2:.1f} nm2: {hardness.status}"
    return touches and hardness.status != "yield", detail


def _untouched(close: Callable[[], ClosedAsperity]) -> Verdict:
    closed = close()
    hardness = find_hardness(closed.curve, closed.witness, closed.summary["wavelength_nm"] ** 2)
    force = max(abs(row["force_nN"]) for row in closed.curve)
    area = max(row["contact_area_nm2"] for row in closed.curve)
    return (
        force == 0 and hardness.status != "yield",
        f"{force:g} nN on {area:g} nm2: {hardness.status}",
    )
