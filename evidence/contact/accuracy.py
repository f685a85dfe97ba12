"""What error does each numerical choice of a contact curve leave at the middle of Table 1?

One choice at a time by both engines: single asperities on 1024^2 sites down to the grid, and coupled ones on 512^2 with
the cut-off of the predictive scenes. The attraction is the paper's. Half an hour of one core.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from evidence.contact.draws import MIDDLE
from mesoscale.contact.cycle import Cycle, run_cycle
from mesoscale.contact.energy import dissipated_energy, pull_off
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.inputs.contact import ContactInputs
from mesoscale.law.fit import fit_branch
from mesoscale.settings import ContactSettings
from mesoscale.studies.driver import Knob, StudyRow, compared, rows_of

SETTINGS = {
    "asperity": ContactSettings(mechanics="asperity", attraction="clamped"),
    "coupled": ContactSettings(mechanics="coupled", attraction="clamped", pixels=512, q1_per_nm=0.29),
}
OUTPUTS = (
    "d_c",
    "C_a",
    "C_r",
    "rho_r",
    "separation at full load",
    "attraction at full load",
    "dissipated energy",
    "pull-off",
)
SEEDS = (1, 2, 3)

Setup = tuple[ContactSettings, Numerics]
Study = tuple[str, str, Setup, list[tuple[Any, Setup]]]
"""Knob, its reference in words, the reference, and its values with what each makes of settings and numerics."""


def studies(settings: ContactSettings) -> Iterator[Study]:
    """What is tried; all grids show the surface of the settings: that of its cut-off, or of the Nyquist limit."""

    def numerics(knob: str, best: Any, words: str, values: Sequence[Any], **others: Any) -> Study:
        def changed(value: Any) -> Setup:
            return settings, replace(NUMERICS, **{knob: value}, **others)

        return knob, words, changed(best), [(value, changed(value)) for value in values]

    yield numerics("force_steps", 320, "320 force steps", (5, 10, 20, 40, 80))
    if settings.mechanics == "adhesive":
        yield numerics("unknown_work", 0.001, "unknown work 0.001", (0.1, 0.05, 0.02, 0.01, 0.005))
    if settings.mechanics == "asperity":  # coupled pressures need no flow to settle
        tolerances = (0.1, 0.03, 0.01, 1e-3, 1e-4)
        yield numerics("flow_tolerance", 1e-5, "tolerance 1e-5", tolerances, max_sweeps=5000)
        small = {"flow": "increment", "max_sweeps": 100000}
        increments = (0.3, 0.1, 0.03, 0.01)
        knob, words, best, tries = numerics("flow_increment_nm", 0.003, "increments of 0.003 nm", increments, **small)
        yield knob, words, best, [*tries, ("return mapping", (settings, NUMERICS))]
    yield numerics("gap_bins", 65536, "65536 bins", (16, 64, 256, 1024, 4096))

    cutoff, pixels = settings.q1_per_nm or settings.nyquist_per_nm, settings.pixels
    finest = 2 * pixels
    if settings.mechanics == "asperity":  # coupled cycles cost twenty times as much on twice the sites a side
        finest = max(finest, min(4 * pixels, 4096))
    grids = [n for n in (pixels // 4, pixels // 2, pixels, 2 * pixels) if 32 <= n < finest]

    def grid(pixels: int) -> Setup:
        return settings.model_copy(update={"pixels": pixels, "q1_per_nm": cutoff}), NUMERICS

    resolving = [(n, grid(n)) for n in grids if np.pi * n / settings.length_nm >= cutoff]
    yield "pixels", f"{finest} pixels, cut-off {cutoff:.3g} 1/nm", grid(finest), resolving


def accuracy_points(inputs: ContactInputs, settings: ContactSettings) -> Iterator[StudyRow]:
    """Error and cost of every value of every knob, over the surfaces of `SEEDS`."""

    def error(tried: np.ndarray, wanted: np.ndarray) -> np.ndarray:
        scale = np.abs(wanted)
        scale[:, [OUTPUTS.index("d_c"), OUTPUTS.index("separation at full load")]] = inputs.rms
        return np.nanmean(np.abs(tried - wanted) / scale, axis=0)

    metric, outputs = "mean relative deviation over surfaces (lengths: relative to rms)", partial(_outputs, inputs)
    knobs = []
    for name, words, best, values in studies(settings):
        tries = [(value, partial(outputs, *choice)) for value, choice in values]
        compare = compared(partial(outputs, *best), tries, error, len(SEEDS))
        knobs.append(Knob(name, metric, words, compare, OUTPUTS))
    yield from rows_of(knobs)


def _outputs(inputs: ContactInputs, settings: ContactSettings, numerics: Numerics) -> np.ndarray:
    """OUTPUTS for each surface, shape (seeds, outputs)."""
    cycles = [run_cycle(inputs, settings, seed, numerics=numerics) for seed in SEEDS]
    return np.array([cycle_outputs(cycle, inputs, settings) for cycle in cycles])


def cycle_outputs(cycle: Cycle, inputs: ContactInputs, settings: ContactSettings) -> list[float]:
    """The numbers OUTPUTS of one cycle: law of the closing branch, end of closing, energy.

    d_c is taken at 3 % of the force: first contact does not depend on the path, and would hide its error.
    """
    closing = cycle.closing
    d_c = separation_at_share(closing.separation_nm, closing.repulsive_nN, 0.03)
    forces = closing.repulsive_nN, closing.attractive_nN
    fit = fit_branch(closing.separation_nm, *forces, settings.length_nm**2, inputs.hamaker, d_c)
    return [
        d_c,
        fit.C_a_GPa_nm,
        fit.C_r_GPa,
        fit.rho_r_nm,
        closing.separation_nm[-1],
        closing.attractive_nN[-1],
        dissipated_energy(cycle)[0],
        pull_off(cycle.opening),
    ]


def separation_at_share(separation_nm: np.ndarray, repulsive_nN: np.ndarray, share: float) -> float:
    """The separation where the repulsion reaches a share of its maximum, linear between points; NaN without contact.

    Unlike first contact it depends on how the curve was computed. It is smaller by about rho_r ln(...).
    """
    order = np.argsort(separation_nm)[::-1]
    h, f = np.asarray(separation_nm, float)[order], np.asarray(repulsive_nN, float)[order]
    if not (f > 0).any():
        return np.nan
    target = share * f.max()
    index = int(np.flatnonzero(f >= target)[0])
    if index == 0:
        return float(h[0])
    between = (target - f[index - 1]) / (f[index] - f[index - 1])
    return float(h[index - 1] + between * (h[index] - h[index - 1]))


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Every case of every value of every choice, by both engines."""
    for mechanics, settings in SETTINGS.items():
        for point in accuracy_points(MIDDLE, settings):
            yield {"mechanics": mechanics, **point}


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Errors (per cent) of the choices that scenes have, of outputs that matter."""

    def error(mechanics: str, knob: str, value: str, case: str) -> str:
        found = [
            row
            for row in rows
            if (row["mechanics"], row["knob"], row["value"], row["case"]) == (mechanics, knob, value, case)
        ]
        return f"{100 * float(found[-1]['error']):.2g} %"

    chosen = {"steps": ("force_steps", "40"), "grid": ("pixels", "")}
    own = {"asperity": "1024", "coupled": "512"}
    return {
        f"{mechanics}_{name}_{case.replace('-', '_').lower()}": error(mechanics, knob, value or own[mechanics], case)
        for mechanics in SETTINGS
        for name, (knob, value) in chosen.items()
        for case in ("d_c", "C_a", "C_r", "pull-off")
    }
