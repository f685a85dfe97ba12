"""Stiff and extreme cases of the contact model, each judged by physical invariants."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from mesoscale.contact.accuracy import dissipated_energy
from mesoscale.contact.cycle import ContactInputs, Cycle, run_cycle
from mesoscale.errors import InputError
from mesoscale.settings import ContactSettings
from mesoscale.topography.synthesis import synthesize

COLUMNS = ("stage", "case", "description", "checks", "passed", "detail", "wall_s")
TABLE_1 = {
    "hamaker": (0.18, 0.25),
    "e_star": (80.0, 102.0),
    "h_macro": (0.7, 3.2),
    "h_prime": (1.95, 14.8),
    "q0": (0.015, 0.035),
    "hurst": (0.5, 1.0),
    "rms": (2.0, 15.0),
}
MIDDLE = ContactInputs(hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5)
CHECKS = "finite, ordered, ends meet, no gain of energy, volume kept, nothing above its hardness, flow settled"


@dataclass(frozen=True)
class Case:
    """One extreme case."""

    name: str
    description: str
    inputs: ContactInputs = MIDDLE
    changes: dict[str, Any] = field(default_factory=dict)
    heights: np.ndarray | None = None
    cycles: int = 1
    refused: bool = False
    reaches_force: bool = True


def violations(
    cycle: Cycle, inputs: ContactInputs, settings: ContactSettings, start: np.ndarray | None = None
) -> list[str]:
    """Which physical invariants a cycle breaks; empty if none.

    ``start``: the surface before the cycle, for the check of volume (needs `Cycle.heights`).
    """
    found = []
    closing, opening = cycle.closing, cycle.opening
    if not all(np.isfinite(array).all() for branch in (closing, opening) for array in vars(branch).values()):
        return ["not finite"]
    if (np.diff(closing.separation_nm) > 0).any() or (np.diff(opening.separation_nm) < 0).any():
        found.append("separations not ordered")
    if closing.repulsive_nN.min() < 0 or opening.repulsive_nN.min() < 0:
        found.append("repulsion negative")
    if max(closing.attractive_nN.max(), opening.attractive_nN.max()) > 0:
        found.append("attraction positive")
    if inputs.hamaker == 0 and closing.attractive_nN.any():
        found.append("attraction without A_H")
    if (
        closing.repulsive_nN[-1] != opening.repulsive_nN[0]
        or closing.separation_nm[-1] != opening.separation_nm[0]
        or closing.attractive_nN[-1] != opening.attractive_nN[0]
    ):
        found.append("opening does not start where closing ended")
    spent = -float(np.trapezoid(closing.repulsive_nN, closing.separation_nm))
    if dissipated_energy(cycle) < -1e-9 * spent:
        found.append(f"energy gained: {-dissipated_energy(cycle) / spent:.2g} of the work")
    if cycle.flags["unconverged_steps"]:
        found.append(f"{cycle.flags['unconverged_steps']} steps did not settle")
    limit = 1.0 + (settings.flow_tolerance if settings.flow == "return" else 0.0)
    if settings.model == "plastic" and float(cycle.flags["largest_load"]) > limit * (1 + 1e-12):
        found.append(f"an asperity at {cycle.flags['largest_load']:.4g} of its hardness")
    if start is not None and cycle.heights is not None:
        moved = np.abs(cycle.heights - start).sum()
        if abs(np.sum(cycle.heights - start)) > 1e-12 * (moved + np.abs(start).sum()):
            found.append("volume changed")
    return found


def extreme_cases(settings: ContactSettings) -> list[Case]:
    """The cases at the grid of the settings; surfaces that are not random are made here."""
    n = settings.pixels
    spacing = settings.length_nm / n
    x = (np.arange(n) - n // 2) * spacing
    bowl = (x[:, None] ** 2 + x[None, :] ** 2) / settings.length_nm
    rough = synthesize(n, settings.length_nm, 0.025, 0.75, 8.5, 1)
    share = (settings.length_nm / 1000.0) ** 2  # loads as on 1 um^2
    with_ = lambda **change: replace(MIDDLE, **change)  # noqa: E731
    cases = [
        Case("middle of Table 1", "the paper's mean inputs"),
        Case("E* x 1000", "stiff: yields at once", with_(e_star=91e3)),
        Case("E* / 1000", "soft: never yields", with_(e_star=0.091)),
        Case("hard", "H = 1e9 GPa: elastic", with_(h_macro=1e9)),
        Case(
            "no hardness",
            "H = 1e-6 GPa: flows without carrying",
            with_(h_macro=1e-6, h_prime=0.0),
            {"max_force_nN": 1e-3 * share},
        ),
        Case("rms 0.01 nm", "nearly flat", with_(rms=0.01)),
        Case("rms 200 nm", "spikes", with_(rms=200.0)),
        Case("H 0.01", "nearly white spectrum", with_(hurst=0.01)),
        Case("H 0.99", "smoothest of Table 1", with_(hurst=0.99)),
        Case("areal", "slope -(2H+2)", changes={"convention": "areal"}),
        Case("areal, H 0.01", "slope -2.02", with_(hurst=0.01), {"convention": "areal"}),
        Case("one-pixel asperities", "white noise", heights=np.random.default_rng(1).normal(0, 5, (n, n))),
        Case("flat", "all sites touch at once", heights=np.zeros((n, n))),
        Case("giant asperity", "one paraboloid as wide as the cell", heights=bowl),
        Case("A_H = 0", "no attraction", with_(hamaker=0.0)),
        Case("A_H x 100", "strong attraction", with_(hamaker=21.5)),
        Case("gap cut-off 1e-6 nm", "eq. 1 near its singularity", changes={"gap_cutoff_nm": 1e-6}),
        Case("touching sites left out", "reading of eq. 1", changes={"touching_attracts": False}),
        Case("nm x 1e-6", "heights of picometres and less", heights=1e-6 * rough),
        Case("nm x 100", "heights of micrometres on a grid of nanometres", heights=100 * rough),
        Case("20 cycles", "shakedown: the last cycle is elastic", cycles=20),
        Case("not square", "refused in one line", heights=np.zeros((n, n + 1)), refused=True),
        Case("not finite", "refused in one line", heights=np.full((n, n), np.inf), refused=True),
    ]
    for force in (1e4, 1e5):  # 1e6 nN and more flow for minutes
        cases.append(Case(f"{force:.0e} nN", "load on 1 um^2", changes={"max_force_nN": force * share}))
    for pair in ("paper", "wide"):
        for flow in ("increment", "return"):
            words = f"flow {flow}, pair {pair}"
            cases.append(Case(words, "readings of flow", changes={"flow": flow, "flow_pair": pair}))
    for model in ("elastic", "nonlinear"):
        cases.append(Case(model, "single asperities without flow", changes={"model": model}))
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
            losses.append(dissipated_energy(cycle))
            heights, flags = cycle.heights, cycle.flags
    except InputError as error:
        return ([] if case.refused else [f"refused: {error}"]), str(error)
    if case.refused:
        return ["accepted"], ""
    if case.reaches_force and not flags["force_reached"]:
        broken.append("force not reached")
    if case.cycles > 1 and losses[-1] > 0.05 * losses[0]:
        broken.append("no shakedown")
    detail = (
        f"force miss {flags['force_miss']:.1e}, bounds on R {flags['radius_bound_events']}, "
        f"repeated steps {flags['repeated_steps']}, loss of last to first cycle {losses[-1] / losses[0]:.2g}"
        if losses[0] > 0
        else f"force miss {flags['force_miss']:.1e}, no loss"
    )
    return broken, detail


def draw_inputs(number: int) -> ContactInputs:
    """Random inputs from Table 1 (uniform; E* over its central 99.9 %), the same for the same number."""
    random = np.random.default_rng(np.random.SeedSequence([20130805, number]))
    return ContactInputs(**{name: random.uniform(low, high) for name, (low, high) in TABLE_1.items()})


def campaign_case(number: int, pixels: int, settings: ContactSettings) -> tuple[list[str], int, int]:
    """One draw on three surfaces: broken invariants, bounds on R, steps with flow repeated."""
    inputs = draw_inputs(number)
    chosen = settings.model_copy(update={"pixels": pixels})
    broken, bounds, repeated = [], 0, 0
    for seed in (1, 2, 3):
        cycle = run_cycle(inputs, chosen, seed)
        words = violations(cycle, inputs, chosen)
        if not cycle.flags["force_reached"]:
            words.append("force not reached")
        broken += [f"draw {number} seed {seed} at {pixels}^2: {text}" for text in words]
        bounds += int(cycle.flags["radius_bound_events"])
        repeated += int(cycle.flags["repeated_steps"])
    return broken, bounds, repeated


def stability_rows(
    settings: ContactSettings, progress: Callable[[float, str], None] | None = None
) -> Iterator[dict[str, Any]]:
    """Rows of stability/contact.csv: the extreme cases and `settings.study_draws` random draws."""
    cases = extreme_cases(settings)
    for number, case in enumerate(cases):
        start = time.perf_counter()
        broken, detail = judge(case, settings)
        yield _row(case.name, case.description, broken, detail, start)
        if progress is not None:
            progress(0.7 * (number + 1) / len(cases), case.name)
    grids = [max(settings.pixels // k, 32) for k in (8, 4, 2, 1)]
    start = time.perf_counter()
    broken, bounds, repeated = [], 0, 0
    for number in range(settings.study_draws):
        words, more_bounds, more_repeated = campaign_case(number, grids[number % 4], settings)
        broken += words
        bounds += more_bounds
        repeated += more_repeated
        if progress is not None:
            progress(0.7 + 0.3 * (number + 1) / settings.study_draws, f"draw {number}")
    if settings.study_draws:
        words = f"{settings.study_draws} draws from Table 1 x 3 surfaces, {min(grids)} to {max(grids)} pixels"
        yield _row("random draws", words, broken, f"bounds on R {bounds}, repeated steps {repeated}", start)


def _row(name: str, description: str, broken: list[str], detail: str, start: float) -> dict[str, Any]:
    return {
        "stage": "contact",
        "case": name,
        "description": description,
        "checks": CHECKS,
        "passed": not broken,
        "detail": "; ".join([*broken[:5], detail]),
        "wall_s": round(time.perf_counter() - start, 3),
    }
