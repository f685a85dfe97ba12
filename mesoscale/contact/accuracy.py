"""Error of the curve against the run time of a cycle, one numerical choice at a time (target `accuracy`)."""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from mesoscale.contact.cycle import Cycle, run_cycle
from mesoscale.contact.energy import dissipated_energy, pull_off
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.inputs.contact import ContactInputs
from mesoscale.law.fit import contact_separation, fit_branch
from mesoscale.settings import ContactSettings, LawSettings

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
LARGEST_GRID = 4096  # sites a side of a reference grid, besides twice those of the settings
SEEDS = (1, 2, 3)

METRIC = "mean relative deviation over surfaces (lengths: relative to rms)"

Choice = tuple[ContactSettings, Numerics]
Case = tuple[str, Any, Choice]  # knob, value, and what it makes of settings and numerics


def studies(settings: ContactSettings) -> Iterator[tuple[str, Choice, list[Case]]]:
    """Yield for each study its reference in words, the reference and the cases.

    The grids all show the surface of the settings: that of its cut-off, or of the Nyquist limit where none is set.
    """

    def numerics(**changes: Any) -> Choice:
        return settings, replace(NUMERICS, **changes)

    steps = (5, 10, 20, 40, 80)
    yield "320 force steps", numerics(force_steps=320), [("force_steps", n, numerics(force_steps=n)) for n in steps]

    if settings.mechanics == "adhesive":
        works = (0.1, 0.05, 0.02, 0.01, 0.005)
        yield (
            "unknown work 0.001",
            numerics(unknown_work=0.001),
            [("unknown_work", w, numerics(unknown_work=w)) for w in works],
        )

    if settings.mechanics == "asperity":  # coupled pressures need no flow to settle
        tolerances = (0.1, 0.03, 0.01, 1e-3, 1e-4)
        yield (
            "tolerance 1e-5",
            numerics(flow_tolerance=1e-5, max_sweeps=5000),
            [("flow_tolerance", t, numerics(flow_tolerance=t, max_sweeps=5000)) for t in tolerances],
        )

        increments = (0.3, 0.1, 0.03, 0.01)
        small = partial(numerics, flow="increment", max_sweeps=100000)
        yield (
            "increments of 0.003 nm",
            small(flow_increment_nm=0.003),
            [
                *(("flow_increment_nm", a, small(flow_increment_nm=a)) for a in increments),
                ("return mapping", NUMERICS.flow_tolerance, numerics()),
            ],
        )

    bins = (16, 64, 256, 1024, 4096)
    yield "65536 bins", numerics(gap_bins=65536), [("gap_bins", b, numerics(gap_bins=b)) for b in bins]

    cutoff = settings.q1_per_nm or settings.nyquist_per_nm
    pixels = settings.pixels
    finest = 2 * pixels
    if settings.mechanics == "asperity":  # coupled cycles cost twenty times as much on twice the sites a side
        finest = max(finest, min(4 * pixels, LARGEST_GRID))
    grids = [n for n in (pixels // 4, pixels // 2, pixels, 2 * pixels) if 32 <= n < finest]

    def grid(pixels: int) -> Choice:
        return settings.model_copy(update={"pixels": pixels, "q1_per_nm": cutoff}), NUMERICS

    yield (
        f"{finest} pixels, cut-off {cutoff:.3g} 1/nm",
        grid(finest),
        [("pixels", n, grid(n)) for n in grids if np.pi * n / settings.length_nm >= cutoff],
    )


def accuracy_points(
    inputs: ContactInputs,
    settings: ContactSettings,
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[dict[str, Any]]:
    """Error and cost of every value of every knob, over the surfaces of `SEEDS`."""
    plan = list(studies(settings))
    total = sum(len(cases) + 1 for _, _, cases in plan)
    done = 0
    for words, finest, cases in plan:
        reference, _, _ = _outputs(inputs, *finest)
        done += 1
        for knob, value, choice in cases:
            outputs, wall, cpu = _outputs(inputs, *choice)
            done += 1
            if progress is not None:
                progress(done / total, f"{knob} {value}")
            scale = np.abs(reference)
            scale[:, [OUTPUTS.index("d_c"), OUTPUTS.index("separation at full load")]] = inputs.rms
            errors = np.nanmean(np.abs(outputs - reference) / scale, axis=0)
            for output, error in zip(OUTPUTS, errors, strict=True):
                yield {
                    "case": output,
                    "knob": knob,
                    "value": value,
                    "error": float(error),
                    "error_metric": METRIC,
                    "reference": words,
                    "wall_s": wall,
                    "cpu_s": cpu,
                }


def _outputs(inputs: ContactInputs, settings: ContactSettings, numerics: Numerics) -> tuple[np.ndarray, float, float]:
    """OUTPUTS for each surface, shape (seeds, outputs), and mean wall and processor time of a cycle (s)."""
    wall, cpu = time.perf_counter(), time.process_time()
    cycles = [run_cycle(inputs, settings, seed, numerics=numerics) for seed in SEEDS]
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    values = np.array([cycle_outputs(cycle, inputs, settings) for cycle in cycles])
    return values, wall / len(cycles), cpu / len(cycles)


def cycle_outputs(cycle: Cycle, inputs: ContactInputs, settings: ContactSettings) -> list[float]:
    """The numbers OUTPUTS of one cycle: law of the closing branch, end of closing, energy.

    d_c is taken at 3 % of the force: first contact does not depend on the path, and would hide its error.
    """
    closing = cycle.closing
    law = LawSettings(contact_definition="force_fraction")
    d_c = contact_separation(closing.separation_nm, closing.repulsive_nN, law)
    fit = fit_branch(
        closing.separation_nm,
        closing.repulsive_nN,
        closing.attractive_nN,
        settings.length_nm**2,
        inputs.hamaker,
        d_c,
        law,
    )
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
