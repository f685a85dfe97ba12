"""Stiff and extreme switches for simulators, each judged beside finite elements or its own
curves.
"""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from mesoscale.answer.points import Point, press_pad, surfaces_of
from mesoscale.circuit.lumps import lumps_of
from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.circuit.spice import spice_pad
from mesoscale.circuit.switches import central_switch
from mesoscale.circuit.tables import law_of_tables, tables_of
from mesoscale.circuit.verilog import verilog_pad
from mesoscale.errors import InputError
from mesoscale.pad.memory import PadLaw, attracting, deepened
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.settings.definitions import RMS_SCATTER
from mesoscale.studies.answer_stability import SOLVED, TIP, lifted, made_up_law
from mesoscale.studies.driver import HardCase
from mesoscale.switch.beam import beam_of, lumped_beam
from mesoscale.switch.beam_switch import solve_bent
from mesoscale.switch.electrode import with_pad
from mesoscale.switch.numerics import SWITCH

CELLS = 4
"""Cells of a pad that is pressed for a case."""
PAIRS = 28
"""Of lumps, as usual pads need."""
CHECK_LUMPS = (
    "finite; areas add up to the electrode; stiff at rest; pull-in within 1 % of finite elements,"
    " release within 2 % of the hold voltage; sticks where they stick"
)
CHECK_TABLES = "no number missing, as near to the curves as allowed"
CHECK_REFUSED = "refused in one line that says why"


def hard_cases(point: Point, contact: ContactSettings, law: PadLaw) -> list[HardCase]:
    """Hard beams as lumps, hard pads as tables, and switches that have no circuit.

    Parameters
    ----------
    point, contact, law : of the scene: its central switch, the contact on the grid of its pads, and
        its own pad."""
    scattered = Point({**point.values, RMS_SCATTER.name: 0.6}, point.gap_cutoff_nm, point.device)
    return [*hard_lumps(), *hard_tables(law), _pressed("unequal places", scattered, contact)]


def hard_lumps() -> Iterator[HardCase]:
    """Beams with electrode and pad all along, and such as have no lumps."""
    for name, changes in SOLVED.items():
        settings = DeviceSettings(**changes)
        if not settings.without_lumps:
            yield HardCase(
                name,
                "as a beam of the stage answer",
                CHECK_LUMPS,
                partial(_lumps, settings, made_up_law(2.0)),
            )
    for adhesion_kPa in (0.0, 30.0, 300.0, 1e4):
        law = made_up_law(adhesion_kPa)
        judge = partial(_lumps, DeviceSettings(), law)
        yield HardCase(
            f"adhesion of {adhesion_kPa:g} kPa", "from none to sticking", CHECK_LUMPS, judge
        )
    refused: dict[str, tuple[Callable[[], Any], str]] = {
        "odd number of lumps": (
            lambda: lumps_of(DeviceSettings(), 3),
            "even number of lumps, at least 4, not 3",
        ),
        "cantilever": (
            lambda: lumps_of(DeviceSettings(**TIP), 8),
            "circuits are made of beams clamped at both ends",
        ),
        "plate on a spring": (
            lambda: central_switch(DeviceSettings(spring_N_per_m=10.0), made_up_law()),
            "circuits are made of bending electrodes",
        ),
    }
    for name, (make, words) in refused.items():
        yield HardCase(name, "no circuit", CHECK_REFUSED, partial(_refused, make, words))


def hard_tables(law: PadLaw) -> Iterator[HardCase]:
    """A pad with few depths, other attractions and a deeper closing, and made-up ones."""
    pads: dict[str, tuple[str, Callable[[], PadLaw]]] = {
        "own pad": ("as pressed", lambda: law),
        "one depth": ("no depths to interpolate between", lambda: shallow(law, 1)),
        "two depths": ("few depths to interpolate between", lambda: shallow(law, 2)),
        "no attraction": (
            "pull is nothing, whose logarithm is not finite",
            lambda: attracting(law, 0.0),
        ),
        "one depth, no attraction": (
            "the same, opened once",
            lambda: shallow(attracting(law, 0.0), 1),
        ),
        "attraction x 30": ("deep wells", lambda: attracting(law, 30.0)),
        "continued": ("closed beyond what was pressed", lambda: deepened(law)),
        "adhesion of 1 GPa": ("wells far deeper than the push", lambda: made_up_law(1e6)),
        "six micrometres up": (
            "logarithms far from those of near flats",
            lambda: lifted(made_up_law(2.0), 6e3),
        ),
    }
    for name, (description, pad) in pads.items():
        yield HardCase(f"tables, {name}", description, CHECK_TABLES, lambda of=pad: _tables(of()))


def shallow(law: PadLaw, depths: int) -> PadLaw:
    """The pad with its first depths alone."""
    return PadLaw(
        law.separation_nm, law.closing, law.depth_nm[:depths], law.opening[:depths], law.flats
    )


def _pressed(name: str, point: Point, contact: ContactSettings) -> HardCase:
    def judge() -> tuple[bool, str]:
        return _tables(press_pad(point, contact, CELLS, surfaces_of(0)).law)

    return HardCase(f"tables, {name}", "few rough places carry the pad", CHECK_TABLES, judge)


def _lumps(settings: DeviceSettings, law: PadLaw) -> tuple[bool, str]:
    symmetric = settings.model_copy(update={"tilt_nm": 0.0})
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
    made, exact = (
        with_pad(lambda pad, of=beam: solve_bent(of, symmetric, pad), law)[0]
        for beam in (lumped_beam(symmetric, PAIRS), beam_of(symmetric, SWITCH.coarse_elements))
    )
    if not abs(made.pull_in_V - exact.pull_in_V) <= CIRCUIT.release_error * exact.pull_in_V:
        broken.append(f"finite elements pull in at {exact.pull_in_V:.4g} V")
    sticks = (made.release_V == 0.0) != (exact.release_V == 0.0)
    # as between two meshes of a beam that tears off in jerks
    if sticks or not abs(made.release_V - exact.release_V) <= 0.02 * exact.hold_V:
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


def _tables(law: PadLaw) -> tuple[bool, str]:
    broken = []
    errors = []
    for cubic in (True, False):
        tables = tables_of(law, cubic)
        made = law_of_tables(tables, law, cubic)
        known = np.isfinite(law.opening)
        if not np.isfinite(made.opening[known]).all() or not np.isfinite(made.closing).all():
            broken.append("a number missing")
        for number, opened in enumerate(law.opening):
            way = np.isfinite(opened[0])
            net = opened[:, way].sum(axis=0)
            missed = np.abs(made.opening[number][:, way].sum(axis=0) - net)
            well = max(-float(net.min()), 0.0)
            # closing at the depth and the rise above it may each err by as much
            allowed = 2.0 * (CIRCUIT.of_well * well + CIRCUIT.of_net * np.abs(net)) + 1e-9
            if (missed > allowed).any():
                broken.append(f"opening from {law.depth_nm[number]:.4g} nm beside the curves")
            if well > 0.0:
                errors.append(
                    float(
                        (missed / well).max(
                            initial=0.0, where=np.abs(net) < CIRCUIT.near_wells * well
                        )
                    )
                )
    texts = verilog_pad(law, CELLS) + spice_pad(law, CELLS)
    if "nan" in texts:
        broken.append("a number missing in the text")
    return not broken, "; ".join([*broken, f"within {max(errors, default=0.0):.2%} of the well"])
