"""Runs of the contact model: which inputs and seed each has, computing them, and their eight outputs."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact import Cycle, run_cycle
from mesoscale.errors import InputError
from mesoscale.inputs.contact import contact_of
from mesoscale.law.branches import NO_FIT, Outcome, fit_cycle
from mesoscale.law.compact import PARAMETERS
from mesoscale.settings import ContactSettings, LawSettings
from mesoscale.uncertainty.designs import Run

Array = NDArray[np.float64]

OUTPUTS = (*PARAMETERS, *(f"delta_{name}" for name in PARAMETERS))
"""Closing parameters and their change on opening, in the order of the paper's Table 2."""
OUTPUT_UNITS = ("nm", "GPa/nm", "GPa", "nm") * 2


def short_name(output: str) -> str:
    """`delta_C_a_GPa_nm` to `delta_C_a`, the name in the paper's tables."""
    for suffix in ("_GPa_nm", "_GPa", "_nm"):
        if output.endswith(suffix):
            return output.removesuffix(suffix)
    return output


def compute(values: Mapping[str, float], seed: int, settings: ContactSettings) -> Cycle | str:
    """The cycle of these inputs, or one line on why it failed."""
    try:
        inputs, settings = contact_of(values, settings)
        return run_cycle(inputs, settings, seed)
    except (InputError, ArithmeticError, ValueError, MemoryError) as error:
        return f"failed: {type(error).__name__}: {' '.join(str(error).split())}"


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
