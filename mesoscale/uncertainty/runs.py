"""Runs of the contact model: which inputs and seed each has, computing them, and their eight outputs."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact import ContactInputs, Cycle, run_cycle
from mesoscale.errors import InputError
from mesoscale.law import PARAMETERS, LawFit, contact_separation, fit_branch, row_of
from mesoscale.settings import ContactSettings, LawSettings
from mesoscale.uncertainty.designs import Run

Array = NDArray[np.float64]

OUTPUTS = (*PARAMETERS, *(f"delta_{name}" for name in PARAMETERS))
"""Closing parameters and their change on opening, in the order of the paper's Table 2."""
OUTPUT_UNITS = ("nm", "GPa/nm", "GPa", "nm") * 2


TOUCH = {"closing": "first_contact_nm", "opening": "last_contact_nm"}
"""Attribute of a stored curve with the exact separation of first (last) contact, by branch."""


@dataclass(frozen=True)
class Outcome:
    """What one cycle gave."""

    closing: LawFit
    opening: LawFit
    status: str = "ok"
    """`ok`, `unconverged`, or `failed: why`."""

    @property
    def outputs(self) -> Array:
        """The eight outputs in the order of OUTPUTS; NaN where a fit is missing."""
        closing, opening = self.closing.parameters, self.opening.parameters
        return np.concatenate([closing, opening - closing])


NO_FIT = LawFit(np.nan, np.nan, np.nan, np.nan, status="no_curve")


def contact_of(values: Mapping[str, float], settings: ContactSettings) -> tuple[ContactInputs, ContactSettings]:
    """Contact inputs, and settings with the optional eighth input (the attraction's gap cutoff) put in."""
    named = dict(values)
    cutoff = named.pop("gap_cutoff", None)
    if cutoff is not None:
        settings = settings.model_copy(update={"gap_cutoff_nm": cutoff})
    return ContactInputs(**named), settings


def compute(values: Mapping[str, float], seed: int, settings: ContactSettings) -> Cycle | str:
    """The cycle of these inputs, or one line on why it failed."""
    try:
        inputs, settings = contact_of(values, settings)
        return run_cycle(inputs, settings, seed)
    except (InputError, ArithmeticError, ValueError, MemoryError) as error:
        return f"failed: {type(error).__name__}: {' '.join(str(error).split())}"


def fit_cycle(cycle: Cycle, hamaker: float, cell_area_nm2: float, settings: LawSettings) -> Outcome:
    """The law fitted to both branches of a cycle."""
    fits = []
    for branch, touch in (
        (cycle.closing, cycle.first_contact_nm),
        (cycle.opening, getattr(cycle, "last_contact_nm", None)),
    ):
        fits.append(
            fit_curve(
                branch.separation_nm,
                branch.repulsive_nN,
                branch.attractive_nN,
                cell_area_nm2,
                hamaker,
                touch,
                settings,
            )
        )
    return Outcome(fits[0], fits[1], "ok" if cycle.converged else "unconverged")


def fit_curve(
    separation_nm: Array,
    repulsive_nN: Array,
    attractive_nN: Array,
    cell_area_nm2: float,
    hamaker: float,
    touch_nm: float | None,
    settings: LawSettings,
) -> LawFit:
    """The law fitted to one branch, d_c taken from the curve as the settings define it."""
    d_c = None
    if settings.contact_definition != "free_fit":
        d_c = contact_separation(separation_nm, repulsive_nN, settings, touch_nm)
    return fit_branch(separation_nm, repulsive_nN, attractive_nN, cell_area_nm2, hamaker, d_c, settings)


def compute_all(
    runs: Sequence[Run], settings: ContactSettings, progress: Callable[[float, str], None] | None = None
) -> Iterator[tuple[Run, Cycle | str]]:
    """Compute runs one by one; equal inputs and seed (inputs of zero width) are computed once."""
    known: dict[tuple[object, ...], Cycle | str] = {}
    for done, run in enumerate(runs):
        key = (run.seed, *run.values.values())
        if key not in known:
            known = {k: v for k, v in known.items() if k[0] == run.seed}  # memory stays flat
            known[key] = compute(run.values, run.seed, settings)
        yield run, known[key]
        if progress:
            progress((done + 1) / len(runs), f"{done + 1} of {len(runs)} contact cycles")


def compute_rows(
    runs: Sequence[Run],
    contact: ContactSettings,
    law: LawSettings,
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[dict[str, float | int | str]]:
    """Compute runs and fit the law to each: one row per run with inputs, seed, parameters and cost."""
    before = time.process_time()
    for run, cycle in compute_all(runs, contact, progress):
        touch: float | str = ""
        if isinstance(cycle, str):
            outcome = Outcome(NO_FIT, NO_FIT, cycle)
        else:
            outcome = fit_cycle(cycle, run.values["hamaker"], contact.length_nm**2, law)
            touch = cycle.first_contact_nm
        row: dict[str, float | int | str] = {"run": run.index, "seed": run.seed, **run.values}
        for branch, fit in (("closing", outcome.closing), ("opening", outcome.opening)):
            for name, value in zip(PARAMETERS, fit.parameters.tolist(), strict=True):
                row[f"{branch}_{name}"] = value if np.isfinite(value) else ""
            row[f"{branch}_status"] = fit.status
        after = time.process_time()
        yield {**row, "first_contact_nm": touch, "curve_status": outcome.status, "cpu_s": after - before}
        before = after


def fit_stored(
    curves: Mapping[str, Mapping[str, Array]],
    name: str,
    facts: Mapping[str, Any],
    cell_area_nm2: float,
    settings: LawSettings,
) -> Iterator[dict[str, Any]]:
    """Rows of law/*.csv for both branches of a stored curve.

    Parameters
    ----------
    curves : datasets by group `<name>/closing` and `<name>/opening`; a missing group gives a row without fit.
    facts : the curve's attributes: hamaker, first_contact_nm, last_contact_nm, status.
    """
    for branch, touch in TOUCH.items():
        fit = NO_FIT
        if f"{name}/{branch}" in curves:
            curve = curves[f"{name}/{branch}"]
            fit = fit_curve(
                curve["separation_nm"],
                curve["repulsive_nN"],
                curve["attractive_nN"],
                cell_area_nm2,
                float(facts["hamaker"]),
                facts.get(touch),
                settings,
            )
        yield {"branch": branch, **row_of(fit), "curve_status": facts.get("status", "")}
