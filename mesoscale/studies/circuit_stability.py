"""Stiff and extreme switches for simulators, each judged beside finite elements or its own
curves.
"""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from mesoscale.answer.points import Point
from mesoscale.answer.switches import press_pad, surfaces_of
from mesoscale.circuit.lumps import lumps_of
from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.circuit.spice import spice_pad
from mesoscale.circuit.switches import central_switch
from mesoscale.circuit.tables import curves_of_tables, tables_of
from mesoscale.circuit.verilog import verilog_pad
from mesoscale.errors import InputError
from mesoscale.pad.curves import PadCurves, attracting, deepened, on_deep_enough
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.settings.definitions import RMS_SCATTER
from mesoscale.studies.answer_stability import SOLVED, TIP, lifted, made_up_pad, published_beam
from mesoscale.studies.driver import HardCase
from mesoscale.switch.beam import COARSE_ELEMENTS, beam_of, lumped_beam
from mesoscale.switch.beam_switch import BeamSwitch

CELLS = 4
"""Cells of a pad that is pressed for a case."""
PAIRS = 28
"""Of lumps, as usual pads need."""
ROUNDING_GPa = 1e-9
"""Of curves, 1 Pa: no switch feels less."""
RELEASE_APART = 0.02
"""Of the hold voltage, between releases of lumps and of finite elements: as between two meshes of a
beam that tears off in jerks."""
CHECK_LUMPS = (
    "finite; areas add up to the electrode; stiff at rest; pull-in within 1 % of finite elements,"
    " release within 2 % of the hold voltage; sticks where they stick"
)
CHECK_TABLES = "no number missing, as near to the curves as allowed"
CHECK_REFUSED = "refused in one line that says why"


def hard_cases(point: Point, contact: ContactSettings, pad: PadCurves) -> list[HardCase]:
    """Hard beams as lumps, hard pads as tables, and switches that have no circuit.

    Parameters
    ----------
    point, contact, pad : of the scene: its central switch, the contact on the grid of its pads, and
        its own pad.
    """
    scattered = Point({**point.values, RMS_SCATTER.name: 0.6}, point.gap_cutoff_nm, point.device)
    return [*hard_lumps(), *hard_tables(pad), _pressed("unequal places", scattered, contact)]


def hard_lumps() -> Iterator[HardCase]:
    """Beams with electrode and pad all along, and such as have no lumps."""
    for name, changes in SOLVED.items():
        settings = published_beam(**changes)
        if not settings.without_circuit:
            yield HardCase(
                name,
                "as a beam of the stage answer",
                CHECK_LUMPS,
                partial(_lumps, settings, made_up_pad(2.0)),
            )
    for adhesion_kPa in (0.0, 30.0, 300.0, 1e4):
        judge = partial(_lumps, published_beam(), made_up_pad(adhesion_kPa))
        yield HardCase(
            f"adhesion of {adhesion_kPa:g} kPa", "from none to sticking", CHECK_LUMPS, judge
        )
    refused: dict[str, tuple[Callable[[], Any], str]] = {
        "odd number of lumps": (
            lambda: lumps_of(published_beam(), 3),
            "even number of lumps, at least 4, not 3",
        ),
        "cantilever": (
            lambda: lumps_of(published_beam(**TIP), 8),
            "circuits are made of beams clamped at both ends",
        ),
        "plate on a spring": (
            lambda: central_switch(published_beam(spring_N_per_m=10.0), made_up_pad()),
            "circuits are made of bending electrodes",
        ),
    }
    for name, (make, words) in refused.items():
        yield HardCase(name, "no circuit", CHECK_REFUSED, partial(_refused, make, words))


def hard_tables(pad: PadCurves) -> Iterator[HardCase]:
    """A pad with few depths, other attractions and a deeper closing, and made-up ones."""
    pads: dict[str, tuple[str, Callable[[], PadCurves]]] = {
        "own pad": ("as pressed", lambda: pad),
        "one depth": ("no depths to interpolate between", lambda: shallow(pad, 1)),
        "two depths": ("few depths to interpolate between", lambda: shallow(pad, 2)),
        "no attraction": (
            "pull is nothing, whose logarithm is not finite",
            lambda: attracting(pad, 0.0),
        ),
        "one depth, no attraction": (
            "the same, opened once",
            lambda: shallow(attracting(pad, 0.0), 1),
        ),
        "attraction x 30": ("deep wells", lambda: attracting(pad, 30.0)),
        "continued": ("closed beyond what was pressed", lambda: deepened(pad)),
        "adhesion of 1 GPa": ("wells far deeper than the push", lambda: made_up_pad(1e6)),
        "six micrometres up": (
            "logarithms far from those of near flats",
            lambda: lifted(made_up_pad(2.0), 6e3),
        ),
    }
    for name, (description, made) in pads.items():
        judge = partial(_tables_of_made, made)
        yield HardCase(f"tables, {name}", description, CHECK_TABLES, judge)


def shallow(pad: PadCurves, depths: int) -> PadCurves:
    """The pad with its first depths alone."""
    return PadCurves(
        pad.separation_nm, pad.closing, pad.depth_nm[:depths], pad.opening[:depths], pad.flats
    )


def _pressed(name: str, point: Point, contact: ContactSettings) -> HardCase:
    def judge() -> tuple[bool, str]:
        return _tables(press_pad(point, contact, CELLS, surfaces_of(0)).curves)

    return HardCase(f"tables, {name}", "few rough places carry the pad", CHECK_TABLES, judge)


def _lumps(settings: DeviceSettings, pad: PadCurves) -> tuple[bool, str]:
    symmetric = settings.level
    lumps = lumps_of(settings, PAIRS)
    broken = []
    if not all(np.isfinite(value).all() for value in vars(lumps).values()):
        broken.append("not finite")
    area_m2 = settings.length_um * settings.width_um * 1e-12
    if not abs(lumps.area_m2.sum() - area_m2) <= 1e-9 * area_m2:
        broken.append(f"lumps have {lumps.area_m2.sum() / area_m2:.4g} of the electrode's area")
    pulled = lumps.drawn_m @ lumps.height_nm * 1e-9
    at_rest = lumps.stiffness_N_m + lumps.stretching_N_m * np.outer(pulled, pulled)
    if not np.linalg.eigvalsh(at_rest)[0] > 0.0:
        broken.append("not stable at rest")
    lumped = BeamSwitch(symmetric, lumped_beam(symmetric, PAIRS))
    made, _ = on_deep_enough(pad, lumped.states_on)
    elements = BeamSwitch(symmetric, beam_of(symmetric, COARSE_ELEMENTS))
    exact, _ = on_deep_enough(pad, elements.states_on)
    if not abs(made.pull_in_V - exact.pull_in_V) <= CIRCUIT.release_error * exact.pull_in_V:
        broken.append(f"finite elements pull in at {exact.pull_in_V:.4g} V")
    one_sticks = (made.release_V == 0.0) != (exact.release_V == 0.0)
    apart_V = abs(made.release_V - exact.release_V)
    if one_sticks or not apart_V <= RELEASE_APART * exact.hold_V:
        broken.append(f"finite elements release at {exact.release_V:.4g} V")
    detail = f"{PAIRS} pairs: pull-in {made.pull_in_V:.4g} V, release {made.release_V:.4g} V"
    return not broken, "; ".join([*broken, detail])


def _refused(make: Callable[[], Any], words: str) -> tuple[bool, str]:
    try:
        make()
    except InputError as error:
        line = str(error)
        return words in line and "\n" not in line, line
    return False, "not refused"


def _tables_of_made(make: Callable[[], PadCurves]) -> tuple[bool, str]:
    return _tables(make())


def _tables(pad: PadCurves) -> tuple[bool, str]:
    """Whether both kinds of tables tell the curves of a pad, and by how much they miss them."""
    broken = []
    largest_error = 0.0
    for cubic in (True, False):
        tabled = curves_of_tables(tables_of(pad, cubic), pad, cubic)
        if _has_missing_numbers(tabled, pad):
            broken.append("a number missing")
        for number, depth_nm in enumerate(pad.depth_nm.tolist()):
            as_near_as_allowed, error = _near(tabled.opening[number], pad.opening[number])
            if not as_near_as_allowed:
                broken.append(f"opening from {depth_nm:.4g} nm beside the curves")
            largest_error = max(largest_error, error)
    if "nan" in verilog_pad(pad, CELLS) + spice_pad(pad, CELLS):
        broken.append("a number missing in the text")
    return not broken, "; ".join([*broken, f"within {largest_error:.2%} of the well"])


def _has_missing_numbers(tabled: PadCurves, pad: PadCurves) -> bool:
    """Whether tables lack a number where the pad has one."""
    computed = np.isfinite(pad.opening)
    complete = np.isfinite(tabled.opening[computed]).all() and np.isfinite(tabled.closing).all()
    return not complete


def _near(tabled: np.ndarray, opening: np.ndarray) -> tuple[bool, float]:
    """Whether an opening by tables is as near to that of the pad as allowed, and the largest error
    in and about its well, over the depth of the well.

    Both are repulsive and attractive pressures (GPa), shape (2, n).
    """
    computed = np.isfinite(opening[0])
    net = opening[:, computed].sum(axis=0)
    missed = np.abs(tabled[:, computed].sum(axis=0) - net)
    well = max(-float(net.min()), 0.0)
    # closing at the depth and the rise above it may each err by as much
    allowed = 2.0 * (CIRCUIT.of_well * well + CIRCUIT.of_net * np.abs(net)) + ROUNDING_GPa
    near_enough = bool((missed <= allowed).all())
    if well == 0.0:
        return near_enough, 0.0
    about_the_well = np.abs(net) < CIRCUIT.near_wells * well
    error = (missed / well).max(initial=0.0, where=about_the_well)
    return near_enough, float(error)
