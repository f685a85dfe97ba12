"""Stiff and extreme cases of a scene's contact, each judged by physical invariants (target
`stability`).
"""

from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from mesoscale.contact.cycle import Cycle, run_cycle
from mesoscale.contact.energy import dissipated_energy, work
from mesoscale.contact.numerics import NUMERICS
from mesoscale.contact.surface import random_surface
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.settings.contact import NOMINAL_SEED
from mesoscale.settings.definitions import definition
from mesoscale.studies.driver import HardCase

CHECKS = (
    "finite, ordered, ends meet, no gain of energy, volume kept, nothing above its hardness, flow"
    " settled"
)
WITHOUT_FILM = {"h_film": 0.0, "t_film": 0.0, "k_film": 0.0, "m_film": 0.0}
FINER = 16  # force steps of the path that judges a gain of energy, over those of the cycle


@dataclass(frozen=True)
class Case:
    """One extreme case.

    Attributes
    ----------
    changes : of the settings; loads are those on the cell.
    heights : (N, N) in nm; by default a random surface.
    too_much : a load that the hardness of the whole surface does not carry.
    """

    name: str
    description: str
    inputs: ContactInputs
    changes: dict[str, Any] = field(default_factory=dict)
    heights: np.ndarray | None = None
    cycles: int = 1
    too_much: bool = False


def violations(
    cycle: Cycle, inputs: ContactInputs, settings: ContactSettings, start: np.ndarray | None = None
) -> list[str]:
    """Which physical invariants a cycle breaks; empty if none.

    ``start``: the surface before the cycle, for the check of volume (needs `Cycle.heights`), and to
    judge a gain of energy on a finer path: the error of a sum over few points is unknown where
    asperities merge and the force jumps.
    """
    broken = []
    closing, opening = cycle.closing, cycle.opening
    if not all(
        np.isfinite(array).all() for branch in (closing, opening) for array in vars(branch).values()
    ):
        return ["not finite"]
    if (np.diff(closing.separation_nm) > 0).any() or (np.diff(opening.separation_nm) < 0).any():
        broken.append("separations not ordered")
    if closing.repulsive_nN.min() < 0 or opening.repulsive_nN.min() < 0:
        broken.append("repulsion negative")
    if max(closing.attractive_nN.max(), opening.attractive_nN.max()) > 0:
        broken.append("attraction positive")
    if inputs.hamaker == 0 and not settings.air and closing.attractive_nN.any():
        broken.append("attraction without A_H")
    if (
        closing.repulsive_nN[-1] != opening.repulsive_nN[0]
        or closing.separation_nm[-1] != opening.separation_nm[0]
        or closing.attractive_nN[-1] != opening.attractive_nN[0]
    ):
        broken.append("opening does not start where closing ended")
    gain, known = _energy_gain(cycle)
    if gain > known and start is not None:
        finer = replace(NUMERICS, force_steps=FINER * NUMERICS.force_steps)
        gain, known = _energy_gain(
            run_cycle(inputs, settings, 0, heights=start, contact_at="lowest", numerics=finer)
        )
    if gain > known:
        broken.append(f"energy gained: {gain:.2g} of the work, known to {known:.1g}")
    if cycle.flags["unconverged_steps"]:
        broken.append(f"{cycle.flags['unconverged_steps']} steps did not settle")
    limit = 1.0 + NUMERICS.flow_tolerance
    if settings.model == "plastic" and float(cycle.flags["largest_load"]) > limit * (1 + 1e-12):
        broken.append(f"an asperity at {cycle.flags['largest_load']:.4g} of its hardness")
    coupled = settings.mechanics != "asperity"
    constant = settings.model == "elastic" or inputs.hardness.constant
    # pressures are solved to 1e-9, so that repulsion falls by no more than rounding
    if settings.mechanics == "coupled" and constant and float(cycle.flags["repulsion_drop"]) > 1e-8:
        broken.append(f"closing lost {cycle.flags['repulsion_drop']:.2g} of its repulsion")
    if start is not None and cycle.heights is not None:
        moved = cycle.heights - start
        if coupled and (moved < 0).any():
            broken.append("flow added material")
        if not coupled and abs(moved.sum()) > 1e-12 * (np.abs(moved).sum() + np.abs(start).sum()):
            broken.append("volume changed")
    return broken


def _energy_gain(cycle: Cycle) -> tuple[float, float]:
    """Energy gained over a cycle and its uncertainty, as shares of the work of closing."""
    spent, _ = work(cycle.closing)
    lost, uncertainty = dissipated_energy(cycle)
    return (-lost / spent, uncertainty / spent + 1e-9) if spent > 0 else (-lost, uncertainty)


def extreme_cases(inputs: ContactInputs, settings: ContactSettings) -> list[Case]:
    """The cases around the inputs and settings of a scene."""
    n = settings.pixels
    area = settings.length_nm**2
    carried = inputs.hardness.pressure(area) * area
    x = (np.arange(n) - n // 2) * settings.length_nm / n
    with_ = partial(replace, inputs)
    # then the separation of the mean planes says when contact is full
    coupled = settings.mechanics != "asperity"
    reading = settings.reading.model_copy
    cases = [
        Case("central inputs", "medians of the scene's inputs", inputs),
        Case("stiffest", "E* = 2000 GPa: yields at once", with_(e_star=definition("e_star").high)),
        Case("E* / 1000", "soft: never yields", with_(e_star=1e-3 * inputs.e_star)),
        Case("hard", "H = 1e6 GPa: elastic", with_(h_macro=1e6, **WITHOUT_FILM)),
        Case("H' = 0", "constant hardness", with_(h_prime=0.0, **WITHOUT_FILM)),
        Case(
            "no hardness",
            "H = 1e-6 GPa: flows without carrying",
            with_(h_macro=1e-6, h_prime=0.0, **WITHOUT_FILM),
            {"max_force_nN": 1e-9 * area},
        ),
        Case("rms 0.01 nm", "nearly flat", with_(rms=0.01)),
        Case("rms 200 nm", "spikes", with_(rms=200.0)),
        Case("H 0.01", "slope -2.02", with_(hurst=0.01)),
        Case("H 0.99", "smoothest of Table 1", with_(hurst=0.99)),
        Case("A_H = 0", "no attraction", with_(hamaker=0.0)),
        Case("A_H x 100", "strong attraction", with_(hamaker=100.0 * inputs.hamaker)),
        Case("gap cut-off 1e-6 nm", "eq. 1 near its singularity", inputs, {"gap_cutoff_nm": 1e-6}),
        Case(
            "touching sites attract",
            "reading of eq. 1",
            inputs,
            {"reading": reading(update={"touching_attracts": True})},
        ),
        Case(
            "profile",
            "slope -(2H+1): rough down to its pixels",
            inputs,
            {"reading": reading(update={"convention": "profile"})},
        ),
        Case(
            "one-pixel asperities",
            "white noise",
            inputs,
            heights=np.random.default_rng(1).normal(0, 5, (n, n)),
        ),
        Case("flat", "all sites touch at once", inputs, heights=np.zeros((n, n)), too_much=coupled),
        Case(
            "giant asperity",
            "one paraboloid as wide as the cell",
            inputs,
            heights=(x[:, None] ** 2 + x[None, :] ** 2) / settings.length_nm,
        ),
        Case("20 cycles", "shakedown: the last cycle is elastic", inputs, cycles=20),
        *(
            Case(
                f"load {share:g}",
                "of what the hardness of the whole cell carries",
                inputs,
                _loaded(share * carried),
            )
            for share in (0.01, 0.1, 0.5)
        ),
        Case(
            "load 5",
            "more than the hardness of the whole cell carries: closing ends before, and says so",
            inputs,
            _loaded(5.0 * carried),
            too_much=True,
        ),
    ]
    other_models = [
        model for model in ("elastic", "nonlinear", "plastic") if model != settings.model
    ]
    return cases + [
        Case(model, "another model", inputs, {"model": model}) for model in other_models
    ]


def _loaded(force_nN: float) -> dict[str, Any]:
    """Changes of the settings for a load on a plastic surface."""
    return {"model": "plastic", "max_force_nN": force_nN}


def judge(case: Case, settings: ContactSettings) -> tuple[list[str], str]:
    """Run a case, at 7 MPa unless it states a load; returns broken invariants and what else is
    worth knowing.
    """
    chosen = settings.model_copy(
        update={"max_force_nN": 7e-3 * settings.length_nm**2, **case.changes}
    )
    heights = (
        random_surface(case.inputs, chosen, NOMINAL_SEED) if case.heights is None else case.heights
    )
    broken: list[str] = []
    losses: list[float] = []
    flags: dict[str, Any] = {}
    for number in range(case.cycles):
        cycle = run_cycle(
            case.inputs, chosen, 1, heights=heights, contact_at="lowest", keep_surface=True
        )
        broken += [
            f"cycle {number + 1}: {words}"
            for words in violations(cycle, case.inputs, chosen, heights)
        ]
        losses.append(dissipated_energy(cycle)[0])
        heights, flags = cycle.heights, cycle.flags
    if flags["force_reached"] == case.too_much:
        broken.append(
            "force reached, though hardness cannot carry it"
            if case.too_much
            else "force not reached"
        )
    if case.cycles > 1 and losses[-1] > 0.05 * losses[0]:
        broken.append("no shakedown")
    detail = f"force miss {flags['force_miss']:.1e}, no loss"
    if losses[0] > 0:
        detail = (
            f"force miss {flags['force_miss']:.1e}, bounds on R {flags['radius_bound_events']},"
            f" repeated steps {flags['repeated_steps']}, loss of last to first cycle"
            f" {losses[-1] / losses[0]:.2g}"
        )
    return broken, detail


def hard_cases(inputs: ContactInputs, settings: ContactSettings) -> list[HardCase]:
    """The cases of a scene, with their judges.

    They have at most 256 pixels a side of the scene's spacing: they cost more than usual contacts.
    """
    pixels = min(settings.pixels, 256)
    length = settings.length_nm * pixels / settings.pixels
    chosen = settings.model_copy(update={"pixels": pixels, "length_nm": length})
    return [
        HardCase(case.name, case.description, CHECKS, partial(_verdict, case, chosen))
        for case in extreme_cases(inputs, chosen)
    ]


def _verdict(case: Case, settings: ContactSettings) -> tuple[bool, str]:
    broken, detail = judge(case, settings)
    return not broken, "; ".join([*broken[:5], detail])
