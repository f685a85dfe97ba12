"""Error of the regression against the direct runs behind it, from the scene's own runs."""

import time
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.inputs.distributions import InputTable
from mesoscale.law.parameters import LAW_OUTPUTS
from mesoscale.settings import ContactSettings, LawSettings, UncertaintySettings
from mesoscale.uncertainty.designs import random_runs
from mesoscale.uncertainty.propagation import NodeOutputs, exported_responses, to_paper_outputs
from mesoscale.uncertainty.runs import compute_rows
from mesoscale.uncertainty.surrogate import evaluate

Array = NDArray[np.float64]

FEWEST = 25
"""Direct runs behind the first regression; then twice as many, and so on."""
MOST_BLOCKS = 8
"""Regressions of one size, each on other runs."""
TIMED = 5
"""Cycles that are computed again to know what one costs."""


def accuracy_points(
    direct: tuple[Array, Array],
    table: InputTable,
    contact: ContactSettings,
    law: LawSettings,
    settings: UncertaintySettings,
) -> Iterator[dict[str, Any]]:
    """Points of accuracy/uncertainty.csv: error of the mean of each output, in standard deviations of the direct runs.

    Each regression sees a block of the runs; its mean is compared with that of all of them, over their own inputs. The
    error is the root mean square over blocks.
    """
    x, y = direct
    settings = settings.model_copy(update={"response": "regression"})
    truth = to_paper_outputs(y)
    mean, deviation = np.nanmean(truth, axis=0), np.nanstd(truth, axis=0)
    seconds = _cycle_s(table, contact, law)
    for used in _sizes(len(x) // 2):
        started, errors = time.process_time(), []
        for first in range(0, min(len(x) // used, MOST_BLOCKS) * used, used):
            block = slice(first, first + used)
            nothing = NodeOutputs([], np.empty((0, 0, y.shape[1])))
            responses = exported_responses(nothing, (x[block], y[block]), table.ranges(), settings)
            errors.append((np.nanmean(to_paper_outputs(evaluate(responses, x)), axis=0) - mean) / deviation)
        spent = used * seconds + (time.process_time() - started) / len(errors)
        for output, error in zip(LAW_OUTPUTS, np.sqrt(np.mean(np.square(errors), axis=0)).tolist(), strict=True):
            yield {
                "case": output.name,
                "knob": "uncertainty.direct_runs",
                "value": used,
                "error": error,
                "error_metric": "of the mean, in standard deviations of single cells",
                "reference": f"mean of {len(x)} direct runs",
                "wall_s": spent,
                "cpu_s": spent,
            }


def _sizes(most: int) -> Sequence[int]:
    return [FEWEST * 2**k for k in range(max(most // FEWEST, 1).bit_length()) if FEWEST * 2**k <= most]


def _cycle_s(table: InputTable, contact: ContactSettings, law: LawSettings) -> float:
    """Processor time of one direct run."""
    runs = random_runs(table, 0, TIMED + 1)
    list(compute_rows(runs[:1], contact, law))  # loads the engine
    started = time.process_time()
    list(compute_rows(runs[1:], contact, law))
    return (time.process_time() - started) / TIMED
