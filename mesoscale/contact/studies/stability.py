"""Stiff and extreme cases of the contact model, each judged by physical invariants."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from mesoscale.contact.cycle import Cycle, run_cycle
from mesoscale.contact.energy import dissipated_energy, work
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.topography.synthesis import synthesize

MIDDLE = ContactInputs(hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5)
FINER = 16  # force steps of the path that judges a gain of energy, over those of the cycle
LOST = 1e-8  # coupled, constant hardness: pressures are solved to 1e-9, so repulsion falls by no more than rounding
CHECKS = "finite, ordered, ends meet, no gain of energy, volume kept, nothing above its hardness, flow settled"

Check = tuple[str, str, str, Callable[[], tuple[bool, str]]]
"""Case, description, what is checked, and the check."""


@dataclass(frozen=True)
class Case:
    """One extreme case.

    Attributes
    ----------
    too_much : a load that the hardness of the whole surface does not carry.
    """

    name: str
    description: str
    inputs: ContactInputs = MIDDLE
    changes: dict[str, Any] = field(default_factory=dict)
    heights: np.ndarray | None = None
    cycles: int = 1
    refused: bool = False
    too_much: bool = False


def violations(
    cycle: Cycle, inputs: ContactInputs, settings: ContactSettings, start: np.ndarray | None = None
) -> list[str]:
    """Which physical invariants a cycle breaks; empty if none.

    ``start``: the surface before the cycle, for the check of volume (needs `Cycle.heights`), and to judge a gain of
    energy on a finer path: the error of a sum over few points is unknown where asperities merge and the force jumps.
    """
    broken = []
    closing, opening = cycle.closing, cycle.opening
    if not all(np.isfinite(array).all() for branch in (closing, opening) for array in vars(branch).values()):
        return ["not finite"]
    if (np.diff(closing.separation_nm) > 0).any() or (np.diff(opening.separation_nm) < 0).any():
        broken.append("separations not ordered")
    if closing.repulsive_nN.min() < 0 or opening.repulsive_nN.min() < 0:
        broken.append("repulsion negative")
    if max(closing.attractive_nN.max(), opening.attractive_nN.max()) > 0:
        broken.append("attraction positive")
    if inputs.hamaker == 0 and closing.attractive_nN.any():
        broken.append("attraction without A_H")
    if (
        closing.repulsive_nN[-1] != opening.repulsive_nN[0]
        or closing.separation_nm[-1] != opening.separation_nm[0]
        or closing.attractive_nN[-1] != opening.attractive_nN[0]
    ):
        broken.append("opening does not start where closing ended")
    gain, known = _energy_gain(cycle)
    if gain > known and start is not None:
        finer = settings.model_copy(update={"force_steps": FINER * settings.force_steps})
        gain, known = _energy_gain(run_cycle(inputs, finer, 0, heights=start))
    if gain > known:
        broken.append(f"energy gained: {gain:.2g} of the work, known to {known:.1g}")
    if cycle.flags["unconverged_steps"]:
        broken.append(f"{cycle.flags['unconverged_steps']} steps did not settle")
    limit = 1.0 + (settings.flow_tolerance if settings.flow == "return" else 0.0)
    if settings.model == "plastic" and float(cycle.flags["largest_load"]) > limit * (1 + 1e-12):
        broken.append(f"an asperity at {cycle.flags['largest_load']:.4g} of its hardness")
    coupled = settings.mechanics == "coupled"
    constant = settings.model == "elastic" or inputs.h_prime == 0.0
    if coupled and constant and float(cycle.flags["repulsion_drop"]) > LOST:
        broken.append(f"closing lost {cycle.flags['repulsion_drop']:.2g} of its repulsion")
    if start is not None and cycle.heights is not None and coupled and settings.flow_volume == "dropped":
        if (cycle.heights < start).any():
            broken.append("flow added material")
    elif start is not None and cycle.heights is not None:
        moved = np.abs(cycle.heights - start).sum()
        if abs(np.sum(cycle.heights - start)) > 1e-12 * (moved + np.abs(start).sum()):
            broken.append("volume changed")
    return broken


def _energy_gain(cycle: Cycle) -> tuple[float, float]:
    """Energy gained over a cycle and its uncertainty, as shares of the work of closing."""
    spent, _ = work(cycle.closing)
    lost, uncertainty = dissipated_energy(cycle)
    return (-lost / spent, uncertainty / spent + 1e-9) if spent > 0 else (-lost, uncertainty)


def extreme_cases(settings: ContactSettings) -> list[Case]:
    """The cases at the grid of the settings; surfaces that are not random are made here."""
    n = settings.pixels
    spacing = settings.length_nm / n
    x = (np.arange(n) - n // 2) * spacing
    bowl = (x[:, None] ** 2 + x[None, :] ** 2) / settings.length_nm
    rough = synthesize(n, settings.length_nm, 0.025, 0.75, 8.5, 1)
    share = (settings.length_nm / 1000.0) ** 2  # loads as on 1 um^2
    with_ = lambda **change: replace(MIDDLE, **change)  # noqa: E731
    coupled = settings.mechanics == "coupled"  # then the separation of the mean planes says when contact is full
    cases = [
        Case("middle of Table 1", "the paper's mean inputs"),
        Case("E* x 1000", "stiff: yields at once", with_(e_star=91e3)),
        Case("E* / 1000", "soft: never yields", with_(e_star=0.091)),
        Case("hard", "H = 1e6 GPa: elastic", with_(h_macro=1e6)),
        Case(
            "no hardness",
            "H = 1e-6 GPa: flows without carrying",
            with_(h_macro=1e-6, h_prime=0.0),
            {"max_force_nN": 1e-3 * share},
        ),
        Case("rms 0.01 nm", "nearly flat", with_(rms=0.01)),
        Case("rms 200 nm", "spikes", with_(rms=200.0)),
        Case("H 0.01", "slope -2.02", with_(hurst=0.01)),
        Case("H 0.99", "smoothest of Table 1", with_(hurst=0.99)),
        Case("profile", "slope -(2H+1): rough down to its pixels", changes={"convention": "profile"}),
        Case("profile, H 0.01", "slope -1.02", with_(hurst=0.01), {"convention": "profile"}),
        Case("one-pixel asperities", "white noise", heights=np.random.default_rng(1).normal(0, 5, (n, n))),
        Case("flat", "all sites touch at once", heights=np.zeros((n, n)), too_much=coupled),
        Case("giant asperity", "one paraboloid as wide as the cell", heights=bowl),
        Case("A_H = 0", "no attraction", with_(hamaker=0.0)),
        Case("A_H x 100", "strong attraction", with_(hamaker=21.5)),
        Case("gap cut-off 1e-6 nm", "eq. 1 near its singularity", changes={"gap_cutoff_nm": 1e-6}),
        Case("touching sites attract", "reading of eq. 1", changes={"touching_attracts": True}),
        Case("nm x 1e-6", "heights of picometres and less", heights=1e-6 * rough, too_much=coupled),
        Case("nm x 1e6", "heights of millimetres on a grid of nanometres", heights=1e6 * rough),
        Case("nm x 100", "heights of micrometres on a grid of nanometres", heights=100 * rough),
        Case("20 cycles", "shakedown: the last cycle is elastic", cycles=20),
        Case("not square", "refused in one line", heights=np.zeros((n, n + 1)), refused=True),
        Case("not finite", "refused in one line", heights=np.full((n, n), np.inf), refused=True),
    ]
    for force in (1e4, 1e5, 1e6):
        cases.append(Case(f"{force:.0e} nN", "load on 1 um^2", changes={"max_force_nN": force * share}))
    words = "load on 1 um^2, more than hardness carries: closing ends before, and says so"
    cases.append(Case("1e+07 nN", words, changes={"max_force_nN": 1e7 * share}, too_much=True))
    cases += _coupled_cases(settings, share) if coupled else _asperity_cases()
    for model in ("elastic", "nonlinear"):
        cases.append(Case(model, "single asperities without flow", changes={"model": model}))
    return cases


def _asperity_cases() -> list[Case]:
    """Readings that only asperities on their own have."""
    cases = [Case("p = 2/3", "reading of eq. 3", changes={"prefactor": "paper"})]
    for pair in ("paper", "wide"):
        for flow in ("increment", "return"):
            words = f"flow {flow}, pair {pair}"
            cases.append(Case(words, "readings of flow", changes={"flow": flow, "flow_pair": pair}))
    return cases


def _coupled_cases(settings: ContactSettings, share: float) -> list[Case]:
    """What tries a half-space with all asperities on it."""
    n = settings.pixels
    spike, pair = np.zeros((n, n)), np.zeros((n, n))
    spike[n // 2, n // 2] = -5.0
    pair[n // 2, n // 2 - 2 : n // 2 + 3] = -5.0 + 0.5 * np.array([0.0, 1.0, 2.0, 1.0, 0.0])
    light = {"max_force_nN": 50.0 * share}
    cases = [
        Case("single site", "one site above a plane", heights=spike, changes=light),
        Case("merging pair", "two equal summits with a saddle between", heights=pair, changes=light),
        Case("H' = 0", "constant hardness", replace(MIDDLE, h_prime=0.0)),
        Case("4 neighbours", "reading of a cluster", changes={"neighbours": 4}),
        Case("4 force steps", "large steps", changes={"force_steps": 4}),
        Case(
            "full elastic contact",
            "closing ends where all sites touch, and says so",
            changes={"model": "elastic", "max_force_nN": 1e12},
            too_much=True,
        ),
    ]
    for exponent in range(-3, 7):
        inputs = replace(MIDDLE, e_star=10.0**exponent, h_macro=1.0, h_prime=0.0)
        # softest: the load is beyond full contact
        cases.append(Case(f"E*/H 1e{exponent}", "from never yielding to rigid", inputs, too_much=exponent == -3))
    return cases


def judge(case: Case, settings: ContactSettings) -> tuple[list[str], str]:
    """Run a case; returns broken invariants and what else is worth knowing."""
    share = (settings.length_nm / 1000.0) ** 2
    chosen = settings.model_copy(update={"max_force_nN": 7000.0 * share, **case.changes})
    try:
        heights = case.heights
        if heights is None:
            i = case.inputs
            heights = synthesize(
                chosen.pixels, chosen.length_nm, i.q0, i.hurst, i.rms, 1, chosen.convention, chosen.q1_per_nm
            )
        broken: list[str] = []
        losses: list[float] = []
        flags: dict[str, Any] = {}
        for number in range(case.cycles):
            cycle = run_cycle(case.inputs, chosen, 1, heights=heights, keep_surface=True)
            broken += [f"cycle {number + 1}: {words}" for words in violations(cycle, case.inputs, chosen, heights)]
            losses.append(dissipated_energy(cycle)[0])
            heights, flags = cycle.heights, cycle.flags
    except InputError as error:
        return ([] if case.refused else [f"refused: {error}"]), str(error)
    if case.refused:
        return ["accepted"], ""
    if flags["force_reached"] == case.too_much:
        broken.append("force reached, though hardness cannot carry it" if case.too_much else "force not reached")
    if case.cycles > 1 and losses[-1] > 0.05 * losses[0]:
        broken.append("no shakedown")
    detail = (
        f"force miss {flags['force_miss']:.1e}, bounds on R {flags['radius_bound_events']}, "
        f"repeated steps {flags['repeated_steps']}, loss of last to first cycle {losses[-1] / losses[0]:.2g}"
        if losses[0] > 0
        else f"force miss {flags['force_miss']:.1e}, no loss"
    )
    return broken, detail


def stability_checks(settings: ContactSettings, draws: Sequence[Mapping[str, str]]) -> list[Check]:
    """The extreme cases, and the random draws (rows of `draws.draw_rows`) by grid."""
    chosen = study_grid(settings)
    return [
        *((case.name, case.description, CHECKS, partial(_verdict, case, chosen)) for case in extreme_cases(chosen)),
        *draws_by_grid(draws),
    ]


def _verdict(case: Case, settings: ContactSettings) -> tuple[bool, str]:
    broken, detail = judge(case, settings)
    return not broken, "; ".join([*broken[:5], detail])


def draws_by_grid(draws: Sequence[Mapping[str, str]]) -> Iterator[Check]:
    """A check for each grid on which random draws were made: it counts what their own jobs found."""
    for pixels in sorted({int(row["pixels"]) for row in draws}):
        rows = [row for row in draws if int(row["pixels"]) == pixels]
        words = f"{len({row['draw'] for row in rows})} draws from Table 1, {len(rows)} cycles"
        yield f"random draws, {pixels} pixels", words, CHECKS, partial(_counted, rows)


def _counted(rows: Sequence[Mapping[str, str]]) -> tuple[bool, str]:
    broken = [f"draw {row['draw']} seed {row['seed']}: {row['broken']}" for row in rows if row["broken"]]
    detail = (
        f"{len(broken)} of {len(rows)} cycles break an invariant; {sum(int(row['steps']) for row in rows)} steps, "
        f"at most {max(int(row['most_sweeps']) for row in rows)} sweeps in one; "
        f"bounds on R {sum(int(row['radius_bound_events']) for row in rows)}, "
        f"repeated steps {sum(int(row['repeated_steps']) for row in rows)}, "
        f"largest force miss {max(float(row['force_miss']) for row in rows):.1e}"
    )
    return not broken, "; ".join([*broken[:5], detail])


def study_grid(settings: ContactSettings) -> ContactSettings:
    """At most 256 pixels a side of the same spacing: extreme cases cost more than usual ones."""
    pixels = min(settings.pixels, 256)
    return settings.model_copy(update={"pixels": pixels, "length_nm": settings.length_nm * pixels / settings.pixels})
