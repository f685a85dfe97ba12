"""Stiff and extreme pads around a scene's inputs, each judged by physical invariants (target
`stability`).
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from mesoscale.contact.displacement import Displacement, close_by_separation
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs, FilmInputs
from mesoscale.pad.cells import FIRST_SEED, Cell, sample_cells, surface_of
from mesoscale.pad.closing import close_cells, press_cells
from mesoscale.pad.curves import PadCurves
from mesoscale.pad.grid import PadGrid
from mesoscale.pad.pilots import plan_grid
from mesoscale.pad.pressed import Pad, assemble
from mesoscale.settings import ContactSettings
from mesoscale.settings.definitions import definition
from mesoscale.studies.driver import Array, HardCase

ATTRACTIONS = ((0.215, 0.05), (0.215, 2.0), (0.0, 0.165), (1e-6, 30.0), (2.0, 0.3))
"""Hamaker constant (aJ) and D0 (nm)."""
MOST_PIXELS = 64
"""Sites a side: hard cells cost more than usual ones."""
CELLS = 4
FINER = 16
"""Steps for one of a pad, to judge energy: a step of 0.2 nm passes over wells."""
MOST_STEPS = 4000
"""No more of these are taken, however far a pad closes."""
CARRIED_GPa = 5e-3
"""Pressure of a usual switch on its pad."""
CELL = Cell(FIRST_SEED, 0.0, 0.0, 1.0)
CHECK_CYCLE = (
    "in contact; plastic: energy lost, elastic: all given back; two flats beyond the curves"
)
CHECK_PAD = (
    "finite, pushes and pulls of the right sign, opening starts where closing ended and never"
    " pushes harder, no gain of energy, flow settled; or refused in one line"
)
WITHOUT_FILM = {"h_film": 0.0, "t_film": 0.0, "k_film": 0.0, "m_film": 0.0}

SMOOTH = ContactInputs(
    hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.018, hurst=0.75, rms=2.2
)
SOFT_FILM = "soft film"
SOFT = FilmInputs(
    hamaker=0.23430521548187047,
    e_star=87.33645149865933,
    h_macro=1.3514625286680215,
    h_prime=0.0,
    q0=0.024611629023254433,
    hurst=0.414520185165477,
    rms=5.611248889630058,
    h_film=12.005406156058228,
    t_film=4.981708320199124,
    k_film=0.012690575388624947,
    m_film=2.8674830766657347,
    rms_scatter=0.41774411004146894,
)
SOFT_CONTACT = ContactSettings(
    mechanics="coupled",
    attraction="offset",
    pixels=128,
    q1_per_nm=0.3394476182237757,
    gap_cutoff_nm=0.27372814778958604,
)
"""Cells whose touching sites change by one in a step that has settled: the matrix at hand was once
of other sites.
"""


def hard_cases(inputs: ContactInputs, contact: ContactSettings) -> list[HardCase]:
    """The cases around central inputs.

    Parameters
    ----------
    contact : on the grid of the pads. Adhesive cells take minutes: coupled ones stand for them.
    """
    pixels = min(contact.pixels, MOST_PIXELS)
    changes = {"pixels": pixels, "length_nm": contact.length_nm * pixels / contact.pixels}
    if contact.mechanics == "adhesive":
        changes["mechanics"] = "coupled"
    settings = contact.model_copy(update=changes)
    return [*_cycles(inputs, settings), *_pads(inputs, settings), *_planned()]


def _cycles(inputs: ContactInputs, contact: ContactSettings) -> Iterator[HardCase]:
    """One cell under extreme attractions, whose energy is known."""
    for hamaker, cutoff_nm in ATTRACTIONS:
        for model in ("plastic", "elastic"):
            settings = contact.model_copy(update={"model": model, "gap_cutoff_nm": cutoff_nm})
            name = f"A_H {hamaker:g} aJ, D0 {cutoff_nm:g} nm, {model}"
            judge = partial(_cycle, replace(inputs, hamaker=hamaker), settings)
            yield HardCase(name, "extreme attraction, steps of 0.05 nm", CHECK_CYCLE, judge)


def _pads(inputs: ContactInputs, contact: ContactSettings) -> Iterator[HardCase]:
    """Pads of a few cells under a usual load."""
    scattered = dict(vars(inputs)) | {"rms_scatter": 0.6}
    extreme = replace(inputs, rms=10.0 * inputs.rms)
    cases: dict[str, tuple[str, ContactInputs, dict[str, Any]]] = {
        "central inputs": ("medians of the scene's inputs", inputs, {}),
        "stiffest": (
            "E* = 2000 GPa: yields at once",
            replace(inputs, e_star=definition("e_star").high),
            {},
        ),
        "E* / 1000": ("soft: never yields", replace(inputs, e_star=1e-3 * inputs.e_star), {}),
        "hard": ("H = 1e6 GPa: elastic", replace(inputs, h_macro=1e6, **WITHOUT_FILM), {}),
        "H' = 0": ("constant hardness", replace(inputs, h_prime=0.0, **WITHOUT_FILM), {}),
        "rms / 10": ("nearly flat", replace(inputs, rms=0.1 * inputs.rms), {}),
        "rms x 10": ("spikes", extreme, {}),
        "H 0.01": ("slope -2.02", replace(inputs, hurst=0.01), {}),
        "H 0.99": ("smoothest of Table 1", replace(inputs, hurst=0.99), {}),
        "A_H x 100": ("strong attraction", replace(inputs, hamaker=100.0 * inputs.hamaker), {}),
        "gap cut-off 1e-3 nm": ("attraction near its singularity", inputs, {"gap_cutoff_nm": 1e-3}),
        "unequal places": (
            "places differ as much as those of measured films",
            FilmInputs(**scattered),
            {},
        ),
    }
    for name, (description, changed, changes) in cases.items():
        judge = partial(_pad, changed, contact.model_copy(update=changes))
        yield HardCase(name, description, CHECK_PAD, judge)
    other = "coupled" if contact.mechanics == "asperity" else "asperity"
    settings = contact.model_copy(update={"mechanics": other})
    yield HardCase(
        f"{other} cells", "another mechanics", CHECK_PAD, partial(_pad, inputs, settings)
    )


def _planned() -> Iterator[HardCase]:
    """Pads of inputs of their own, whose separations are hard to find."""
    words = "smooth film at 200 MPa, whose asperities merge"
    refused = partial(_refused, SMOOTH, ContactSettings(mechanics="asperity", pixels=64))
    yield HardCase(
        "merging asperities", words, "refused in one line that names coupled mechanics", refused
    )
    coupled = ContactSettings(mechanics="coupled", pixels=64)
    pressed = partial(_carries, SMOOTH, coupled, 4, FIRST_SEED, 0.2)
    yield HardCase("merging asperities, coupled", words, "carries what is asked for", pressed)
    soft = partial(_carries, SOFT, SOFT_CONTACT, 64, 5_000_017_001_000, 0.04)
    yield HardCase(
        SOFT_FILM,
        "touching sites change by one in a settled step",
        "carries what is asked for",
        soft,
    )


def own_separations(inputs: ContactInputs, contact: ContactSettings) -> PadGrid:
    """From where a cell is two flats to deep contact, in steps finer than any well."""
    first = -float(surface_of(inputs, contact, CELL).min())
    farthest = max(1000.0, 120.0 * inputs.rms)
    start = first + 20.0
    near = np.arange(start, first - min(0.7 * inputs.rms, 6.0), -0.05)
    separation = np.concatenate([np.geomspace(farthest, start, 40)[:-1], near])
    return PadGrid(separation, np.array([separation.size - 1]))


def work_J_m2(separation_nm: Array, curve: Array, contact: ContactSettings) -> float:
    """Work that a cell does from its deepest closing outwards (forces in nN, shape (2, n));
    positive: pushed.
    """
    return float(-np.trapezoid(curve.sum(axis=0), separation_nm)) / contact.length_nm**2


def _cycle(inputs: ContactInputs, contact: ContactSettings) -> tuple[bool, str]:
    grid = own_separations(inputs, contact)
    (cell,) = close_cells(inputs, contact, grid, [CELL])
    spent, returned = (
        work_J_m2(grid.separation_nm, curve, contact) for curve in (cell.closing, cell.opening[0])
    )
    broken = []
    if not cell.closing[0, -1] > 0.0:
        broken.append("not in contact")
    if contact.model == "elastic" and not abs(returned - spent) <= 1e-9 * abs(spent):
        broken.append("elastic, but not all of its work came back")
    if contact.model != "elastic" and not returned < spent:
        broken.append("plastic, but no work was lost")
    broken += _flats(inputs, contact, _curves(inputs, contact, grid, cell))
    return not broken, "; ".join(
        [*broken, f"spent {1e3 * spent:.4g} mJ/m^2, returned {1e3 * returned:.4g} mJ/m^2"]
    )


def _curves(
    inputs: ContactInputs, contact: ContactSettings, grid: PadGrid, cell: Displacement
) -> PadCurves:
    return assemble(inputs, contact, grid, [CELL], [cell]).curves


def _flats(inputs: ContactInputs, contact: ContactSettings, pad: PadCurves) -> list[str]:
    """Whether a pad goes over into two flats where its curves end."""
    last_nm = float(pad.separation_nm[-1])
    inside, outside = pad.closing_GPa(np.array([last_nm, last_nm * (1.0 + 1e-9)])).tolist()
    broken = []
    # 1 + 6 (rms / separation)^2 is 4e-4
    if not abs(inside - outside) <= 1e-3 * abs(outside):
        broken.append("the curves do not end as two flats")
    flats = -inputs.hamaker / (6.0 * np.pi * (last_nm + pad.flats.offset_nm) ** 3)
    if not abs(outside - flats) <= 1e-6 * abs(flats):
        broken.append("beyond the curves it is not two flats")
    return broken


def _pad(inputs: ContactInputs, contact: ContactSettings) -> tuple[bool, str]:
    cells = sample_cells(inputs, CELLS)
    try:
        grid = plan_grid(inputs, contact, cells, CARRIED_GPa)
    except InputError as error:
        line = str(error)
        return "\n" not in line, f"refused: {line}"
    pad = press_cells(inputs, contact, grid, cells)
    broken = violations(pad)
    gaining = sum(gains_energy(inputs, contact, cell, grid) for cell in cells[:2])
    if gaining:
        broken.append(f"{gaining} of 2 cells gain energy")
    carried = 1e3 * float(pad.mean(pad.closing)[0, -1])
    return not broken, "; ".join(
        [*broken, f"{carried:.4g} MPa, {pad.grid.separation_nm.size} separations"]
    )


def violations(pad: Pad) -> list[str]:
    """Which physical invariants the cells of a pad break; empty if none."""
    broken = []
    if not np.isfinite(pad.closing).all():
        return ["not finite"]
    if not pad.settled.all():
        broken.append(f"{(~pad.settled).sum()} cells did not settle")
    largest = pad.closing[:, 0].max(axis=1)
    for number, depth in enumerate(pad.grid.depths):
        opened = slice(0, depth + 1)
        closing = pad.closing[:, :, opened]
        opening = pad.opening[:, number, :, opened]
        where = f"from {pad.grid.separation_nm[depth]:.4g} nm"
        if not np.isfinite(opening).all():
            broken.append(f"opening {where} not finite")
            continue
        if opening[:, 0].min() < 0.0 or opening[:, 1].max() > 0.0:
            broken.append(f"opening {where}: a push or pull of the wrong sign")
        apart = np.abs(opening[..., -1] - closing[..., -1]).max(axis=1)
        if (apart > 1e-9 * largest).any():
            broken.append(f"opening {where} does not start where closing ended")
        if (opening[:, 0] > closing[:, 0] + 1e-9 * largest[:, None]).any():
            broken.append(f"opening {where} pushes harder than closing did")
    return broken


def gains_energy(
    inputs: ContactInputs, contact: ContactSettings, cell: Cell, grid: PadGrid
) -> bool:
    """Whether a cell gives back more work than it took, beyond what the sums of both leave open.

    Between two separations the force may have jumped anywhere, as sites touch, flow or let go. So
    each step leaves open half of its length times the change of the force.
    """
    heights = surface_of(inputs, contact, cell)
    last = grid.separation_nm.size - 1
    finer = max(min(FINER, MOST_STEPS // last), 1)
    fine = np.interp(np.arange(finer * last + 1) / finer, np.arange(last + 1), grid.separation_nm)
    depths = finer * grid.depths
    closed = close_by_separation(inputs, contact, heights, fine + float(heights.mean()), depths)
    for depth, opening in zip(depths.tolist(), closed.opening, strict=True):
        opened = slice(0, depth + 1)
        gain = work_J_m2(fine[opened], opening[:, opened], contact) - work_J_m2(
            fine[opened], closed.closing[:, opened], contact
        )
        changes = [
            np.abs(np.diff(curve[:, opened].sum(axis=0))) for curve in (opening, closed.closing)
        ]
        unknown = 0.5 * float(-np.diff(fine[opened]) @ np.add(*changes)) / contact.length_nm**2
        if gain > unknown:
            return True
    return False


def _refused(inputs: ContactInputs, contact: ContactSettings) -> tuple[bool, str]:
    try:
        plan_grid(inputs, contact, sample_cells(inputs, 4), 0.2)
    except InputError as error:
        line = str(error)
        return (
            "asperities merge" in line
            and line.endswith("take mechanics: coupled")
            and "\n" not in line,
            line,
        )
    return False, "planned"


def _carries(
    inputs: ContactInputs,
    contact: ContactSettings,
    count: int,
    first_seed: int,
    pressure_GPa: float,
) -> tuple[bool, str]:
    cells = sample_cells(inputs, count, first_seed, 6e4)
    deep_nm = plan_grid(inputs, contact, cells, pressure_GPa).depth_nm
    return (
        deep_nm.size > 0,
        f"opened from {deep_nm.size} depths, {deep_nm[-1]:.4g} .. {deep_nm[0]:.4g} nm",
    )
