"""Runs of the contact model: inputs and seed of each, computing them, and the law of each."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.checks import check_seed
from mesoscale.contact import Cycle, run_cycle
from mesoscale.errors import InputError
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.distributions import InputTable
from mesoscale.law.branches import NO_FIT, Outcome, fit_cycle
from mesoscale.law.compact import Law
from mesoscale.law.parameters import PARAMETERS
from mesoscale.settings import ContactSettings
from mesoscale.uncertainty.designs import Run, random_runs

Array = NDArray[np.float64]


def compute(values: Mapping[str, float], seed: int, settings: ContactSettings) -> Cycle | str:
    """The cycle of these inputs, or one line on why it failed."""
    try:
        inputs, settings = contact_of(values, settings)
        return run_cycle(inputs, settings, seed)
    except (InputError, ArithmeticError, ValueError, MemoryError) as error:
        return f"failed: {type(error).__name__}: {' '.join(str(error).split())}"


def compute_all(
    runs: Sequence[Run],
    settings: ContactSettings,
    progress: Callable[[float, str], None] | None = None,
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
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[dict[str, float | int | str]]:
    """Compute runs and fit the law to each: one row per run with inputs, seed and parameters."""
    for run, cycle in compute_all(runs, contact, progress):
        touch: float | str = ""
        if isinstance(cycle, str):
            outcome = Outcome(NO_FIT, NO_FIT, cycle)
        else:
            outcome = fit_cycle(cycle)
            touch = cycle.first_contact_nm
        row: dict[str, float | int | str] = {"run": run.index, "seed": run.seed}
        row |= run.values
        for branch, fit in (("closing", outcome.closing), ("opening", outcome.opening)):
            for name, value in zip(PARAMETERS, fit.parameters.tolist(), strict=True):
                row[f"{branch}_{name}"] = value if np.isfinite(value) else ""
            row[f"{branch}_status"] = fit.status
        yield {**row, "first_contact_nm": touch, "curve_status": outcome.status}


@dataclass(frozen=True)
class MonteCarlo:
    """Laws of surfaces and inputs drawn at random; arrays of one entry per sample kept, shape (m,).

    Attributes
    ----------
    inputs : inputs by name, in the units of the table.
    closing : laws of closing; each parameter has shape (m,).
    opening : laws of opening.
    failed : why the other samples are left out, one entry each.
    """

    inputs: dict[str, Array]
    closing: Law
    opening: Law
    failed: tuple[str, ...]

    def __repr__(self) -> str:
        return (
            f"MonteCarlo: laws of {np.size(self.closing.d_c_nm)} samples, {len(self.failed)}"
            " left out"
        )


def monte_carlo(
    table: InputTable,
    contact: ContactSettings,
    samples: int,
    seed: int = 1,
    progress: Callable[[float, str], None] | None = None,
) -> MonteCarlo:
    """Close and open `samples` random surfaces, each with a draw of the inputs; fit the law.

    Samples whose cycle or fit failed are left out and counted. More samples extend fewer ones of
    the same seed.

    Raises
    ------
    InputError : `samples` or `seed` is no whole number, or no sample gave a law.
    """
    check_seed(seed)
    if isinstance(samples, bool) or not isinstance(samples, int) or samples < 1:
        raise InputError(f"samples = {samples!r}: accepted is a whole number >= 1")
    runs = random_runs(table, 0, samples, seed)
    drawn = []
    parameters = []
    failed = []
    for run, cycle in compute_all(runs, contact, progress):
        outcome = Outcome(NO_FIT, NO_FIT, cycle) if isinstance(cycle, str) else fit_cycle(cycle)
        pair = np.stack([outcome.closing.parameters, outcome.opening.parameters])
        if outcome.status == "ok" and np.isfinite(pair).all():
            drawn.append(list(run.values.values()))
            parameters.append(pair)
        else:
            reasons = [outcome.status, outcome.closing.status, outcome.opening.status]
            failed.append(next(reason for reason in reasons if reason != "ok"))
    if not drawn:
        raise InputError(
            f"none of {samples} samples gave a law: {'; '.join(dict.fromkeys(failed))}"
        )
    inputs = dict(zip(table.names, np.array(drawn).T, strict=True))
    laws = []
    for columns in np.stack(parameters).transpose(1, 2, 0):
        by_name = dict(zip(PARAMETERS, columns, strict=True))
        laws.append(Law(**by_name, hamaker=inputs["hamaker"]))
    closing, opening = laws
    return MonteCarlo(inputs, closing, opening, tuple(failed))
