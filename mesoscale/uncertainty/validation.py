"""Responses against direct cycles: bias, errors, Q², and what makes an output doubtful."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.inputs.distributions import InputTable
from mesoscale.law.parameters import FITTED, LAW_OUTPUTS
from mesoscale.settings import UncertaintySettings
from mesoscale.settings.uncertainty import RESAMPLES
from mesoscale.uncertainty.designs import SAMPLE_SEED
from mesoscale.uncertainty.doubts import against_physics, explained
from mesoscale.uncertainty.propagation import (
    Direct,
    Propagation,
    exported_responses,
    to_paper_outputs,
)
from mesoscale.uncertainty.surrogate import evaluate

Array = NDArray[np.float64]


def direct_runs_of_rows(
    rows: Iterable[Mapping[str, str]], names: Sequence[str], count: int
) -> Direct:
    """Inputs (m, n) and parameters (m, len(FITTED)) of the first `count` runs; NaN if missing."""
    rows = list(islice(rows, count))
    inputs = np.array([[float(row[name]) for name in names] for row in rows])
    outputs = np.array([[_number(row[name]) for name in FITTED] for row in rows])
    inputs = inputs.reshape(len(rows), len(names))
    return inputs, outputs.reshape(len(rows), len(FITTED))


def _number(text: str) -> float:
    """A number of a table; NaN where it has none."""
    return float(text) if text else np.nan


def held_out_predictions(direct: Direct, ranges: Array, settings: UncertaintySettings) -> Array:
    """Parameters of every direct run by responses that never saw it, (m, len(FITTED)).

    The responses are fitted anew, terms and coefficients, without each fifth of the runs (five-fold
    cross-validation).
    """
    x, y = direct
    predicted = np.full_like(y, np.nan)
    folds = np.arange(len(x)) % 5
    for fold in range(5):
        seen = folds != fold
        held = folds == fold
        again = exported_responses((x[seen], y[seen]), ranges, settings)
        predicted[held] = evaluate(again, x[held])
    return predicted


def validation_rows(
    direct: Direct,
    table: InputTable,
    result: Propagation,
    settings: UncertaintySettings,
    again: Array,
    largest_GPa: float,
) -> list[dict[str, Any]]:
    """Rows of uncertainty/validation.csv, one per output of Table 2.

    Parameters
    ----------
    direct : inputs (m, n) and closing and opening parameters (m, len(FITTED)) of the direct runs.
    again : parameters at the inputs of the first direct runs on other surfaces, shape (r,
        len(FITTED)).
    largest_GPa : largest pressure of the curves that the law was fitted to.

    Notes
    -----
    Every direct run has its own surface, so `q2` (1 - mean squared error / variance of the runs)
    includes the scatter between surfaces and cannot reach 1; `explained` leaves that part out.
    """
    truth, predicted = map(
        to_paper_outputs, (direct[1], held_out_predictions(direct, table.ranges(), settings))
    )
    repeated = to_paper_outputs(again)
    physics = against_physics(result.responses, table, largest_GPa)
    rng = np.random.default_rng(np.random.SeedSequence([SAMPLE_SEED, 0xB1]))
    rows = []
    for k, output in enumerate(LAW_OUTPUTS):
        usable = np.isfinite(truth[:, k])
        y = truth[usable, k]
        row: dict[str, Any] = {"output": output.name, "unit": output.unit, "runs": len(truth)}
        row["missing"] = int((~usable).sum())
        rows.append(row)
        if len(y) < 3:
            continue
        picks = rng.integers(len(y), size=(RESAMPLES, len(y)))
        errors = predicted[usable, k] - y
        variance = y.var()
        row["rmse"] = np.sqrt((errors**2).mean())
        row["bias"] = errors.mean()
        if variance > 0:
            row["q2"] = 1 - (errors**2).mean() / variance
            spread = np.maximum(y[picks].var(axis=1), 1e-12 * variance)
            q2 = 1 - (errors[picks] ** 2).mean(axis=1) / spread
            row["q2_low"], row["q2_high"] = np.quantile(q2, [0.05, 0.95])
        pairs = len(repeated)
        known = usable[:pairs] & np.isfinite(predicted[:pairs, k])
        paired = np.isfinite(repeated[:, k]) & known
        if paired.sum() > 2:
            first = truth[:pairs, k][paired]
            second = repeated[:, k][paired]
            response = predicted[:pairs, k][paired]
            # a stream of its own, so that the intervals above stay
            own_rng = np.random.default_rng(np.random.SeedSequence([SAMPLE_SEED, 0xEA]))
            row |= explained(first, second, response, own_rng)
            doubts = (row["doubt"], physics.get(output.name, ""))
            row["doubt"] = "; ".join(filter(None, doubts))
    return rows
