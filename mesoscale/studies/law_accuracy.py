"""Error of the regression against the direct runs behind it, from the scene's own runs."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from mesoscale.inputs.distributions import InputTable
from mesoscale.law.parameters import OUTPUTS
from mesoscale.settings import ContactSettings, UncertaintySettings
from mesoscale.studies.driver import Array, Knob, Row, Try, rows_of, timed
from mesoscale.uncertainty.designs import random_runs
from mesoscale.uncertainty.propagation import Direct, exported_responses, to_paper_outputs
from mesoscale.uncertainty.runs import compute_rows
from mesoscale.uncertainty.surrogate import evaluate


def accuracy_points(
    direct: Direct, table: InputTable, contact: ContactSettings, settings: UncertaintySettings
) -> Iterator[Row]:
    """Error of the mean of each output, in standard deviations of the direct runs.

    Each regression sees a block of the runs; its mean is compared with that of all of them, over their own inputs. The
    error is the root mean square over up to eight blocks. Five cycles are computed again to know what one costs.
    """
    metric, count = "of the mean, in standard deviations of single cells", len(direct[0])
    tries = _tries(direct, table, contact, settings)
    yield from rows_of([Knob("uncertainty.direct_runs", metric, f"mean of {count} direct runs", tries, OUTPUTS)])


def _tries(direct: Direct, table: InputTable, contact: ContactSettings, settings: UncertaintySettings) -> Iterator[Try]:
    truth, ranges = to_paper_outputs(direct[1]), table.ranges()
    mean, deviation = np.nanmean(truth, axis=0), np.nanstd(truth, axis=0)
    runs = random_runs(table, 0, 6)
    list(compute_rows(runs[:1], contact))  # loads the engine
    _, of_cycle = timed(partial(list, compute_rows(runs[1:], contact)), 5)
    used = 25
    while used <= len(truth) // 2:
        starts = range(0, min(len(truth) // used, 8) * used, used)
        blocks = [(direct[0][first : first + used], direct[1][first : first + used]) for first in starts]
        of_block = partial(_mean, x=direct[0], ranges=ranges, settings=settings)
        means, of_fit = timed(partial(list, map(of_block, blocks)), len(blocks))
        error = np.sqrt(np.mean(np.square((np.array(means) - mean) / deviation), axis=0))
        yield Try(used, error, used * of_cycle + of_fit)
        used *= 2


def _mean(block: Direct, x: Array, ranges: Array, settings: UncertaintySettings) -> Array:
    """Means of the outputs over inputs x by the regression on a block of the runs."""
    return np.nanmean(to_paper_outputs(evaluate(exported_responses(block, ranges, settings), x)), axis=0)
