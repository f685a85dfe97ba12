"""Error of the law's mean and of its responses against run time: direct runs, surfaces at the
nodes, degree.

The scene's own runs are used. Errors are in per cent of the standard deviation of single cells.
"""

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mesoscale.inputs.distributions import InputTable
from mesoscale.law.parameters import BRANCHES, LAW, LAW_OUTPUTS
from mesoscale.settings import ContactSettings, UncertaintySettings
from mesoscale.studies.driver import (
    Array,
    Choice,
    Cost,
    Errors,
    Knob,
    Progress,
    Quantity,
    StudyRow,
    root_mean_square,
    rows_of,
    timed,
)
from mesoscale.uncertainty.collocation import nodes as collocation_nodes
from mesoscale.uncertainty.designs import SAMPLE_SEED, random_runs
from mesoscale.uncertainty.propagation import (
    Direct,
    NodeOutputs,
    exported_responses,
    linear_outputs,
    to_paper_outputs,
)
from mesoscale.uncertainty.regression import sparse_chaos
from mesoscale.uncertainty.runs import compute_rows
from mesoscale.uncertainty.surrogate import evaluate

FEWEST = 50
"""Direct runs of the smallest choice: each half still determines the linear terms of a dozen
inputs.
"""
SPLITS = 4
"""Random halvings of the runs of a choice."""
DEGREES = (1, 2, 3)
DEGREE = 3
"""In use (`sparse_chaos`)."""
FOLDS = 5
TIMED_CYCLES = 4
MEAN_SAMPLES = 1000
"""Samples of the inputs that tell the mean of a linear response."""


def accuracy_points(
    direct: Direct,
    again: Array,
    nodes: NodeOutputs,
    table: InputTable,
    contact: ContactSettings,
    settings: UncertaintySettings,
    progress: Progress | None = None,
) -> Iterator[StudyRow]:
    """Rows of accuracy/uncertainty.csv without the stage.

    Parameters
    ----------
    direct : inputs and parameters of the direct runs.
    again : parameters at the inputs of the first of them on other surfaces, shape (r, len(FITTED)).
    nodes : the law at the nodes of the paper's method.
    contact : to time a few cycles.
    """
    cycle = cost_of_cycle(table, contact)
    deviation = np.nanstd(to_paper_outputs(direct[1]), axis=0)
    deviation[deviation == 0] = np.nan  # nothing varies: no error is told
    knobs = []
    if len(direct[0]) >= FEWEST:
        knobs += [_runs(direct, table, settings, deviation, cycle), _degree(direct, again, table)]
    if len(nodes.seeds) > 1:
        knobs.append(_seeds(nodes, table, deviation, cycle))
    yield from rows_of(knobs, progress)


def cost_of_cycle(table: InputTable, contact: ContactSettings) -> Cost:
    """Mean cost of a cycle with its fit at random inputs."""
    first, *timed_runs = random_runs(table, 0, TIMED_CYCLES + 1)
    list(compute_rows([first], contact))  # loads the engine
    _, cost = timed(lambda: list(compute_rows(timed_runs, contact)))
    return cost.times(1 / TIMED_CYCLES)


MEANS = [f"mean {row.short}" for row in LAW_OUTPUTS]


def _percent_of_deviation(names: Sequence[str]) -> list[Quantity]:
    return [Quantity(name, "% of deviation") for name in names]


def _runs(
    direct: Direct, table: InputTable, settings: UncertaintySettings, deviation: Array, cycle: Cost
) -> Knob:
    """The mean by the responses, by the number of direct runs.

    The runs of a choice are halved at random. Half the difference of the means by the halves is an
    estimate of the error of the mean by all of them.
    """
    x, y = direct
    ranges = table.ranges()

    def mean(picked: NDArray[np.int_]) -> Array:
        responses = exported_responses((x[picked], y[picked]), ranges, settings)
        return np.nanmean(to_paper_outputs(evaluate(responses, x)), axis=0)

    def errors(count: int) -> Errors:
        rng = np.random.default_rng(SAMPLE_SEED)
        deviations = []
        for _ in range(SPLITS):
            picked = rng.permutation(len(x))[:count]
            first = picked[: count // 2]
            second = picked[count // 2 :]
            deviations.append(100 * 0.5 * (mean(first) - mean(second)) / deviation)
        _, fit = timed(partial(mean, np.arange(count)))
        return Errors(*root_mean_square(deviations), cycle.times(count) + fit)

    counts = [FEWEST]
    while 2 * counts[-1] <= len(x):
        counts.append(2 * counts[-1])
    if counts[-1] != len(x):
        counts.append(len(x))
    choices = [Choice(count, partial(errors, count)) for count in counts]
    quantities = _percent_of_deviation(MEANS)
    return Knob(
        "direct runs",
        quantities,
        choices,
        len(x),
        "half the difference of two halves",
        None,
        f"{SPLITS} splits",
    )


def _degree(direct: Direct, again: Array, table: InputTable) -> Knob:
    """Responses of each degree against runs that they have not seen.

    The mean square deviation includes the scatter between surfaces. Pairs of surfaces at equal
    inputs tell this scatter, and it is subtracted.
    """
    x, y = direct
    ranges = table.ranges()
    deviation = np.nanstd(y, axis=0)
    deviation[deviation == 0] = np.nan
    folds = np.arange(len(x)) % FOLDS
    signs = [row.any_sign for row in LAW] * 2
    transforms = ["identity" if any_sign else "log" for any_sign in signs]
    scatter, error_of_scatter = _mean_and_error(0.5 * ((again - y[: len(again)]) / deviation) ** 2)

    def held_out(degree: int) -> Array:
        predicted = np.full_like(y, np.nan)
        for fold in range(FOLDS):
            held = folds == fold
            for column, transform in enumerate(transforms):
                usable = ~held & np.isfinite(y[:, column])
                if usable.sum() >= 2 * x.shape[1]:
                    response = sparse_chaos(x[usable], y[usable, column], ranges, transform, degree)
                    predicted[held, column] = response(x[held])
        return predicted

    def errors(degree: int) -> Errors:
        predicted, cost = timed(partial(held_out, degree))
        square, error_of_square = _mean_and_error(((predicted - y) / deviation) ** 2)
        excess = np.maximum(square - scatter, 0.0)
        error_of_excess = np.hypot(error_of_square, error_of_scatter)
        error = np.sqrt(excess)
        # of a root: near zero the root of the error itself
        own_error = error_of_excess / (2 * np.maximum(error, np.sqrt(error_of_excess) / 2))
        return Errors(100 * error, 100 * own_error, cost.times(1 / FOLDS))

    choices = [Choice(degree, partial(errors, degree)) for degree in DEGREES]
    reference = (
        f"{len(x)} direct runs that the response has not seen, less the scatter of {len(again)}"
        " pairs of surfaces"
    )
    names = [f"{row.short} on {branch}" for branch in BRANCHES for row in LAW]
    return Knob("degree of the responses", _percent_of_deviation(names), choices, DEGREE, reference)


def _mean_and_error(values: Array) -> tuple[Array, Array]:
    """Mean of each column and its standard error, without what is missing."""
    count = np.maximum(np.isfinite(values).sum(axis=0), 1)
    return np.nanmean(values, axis=0), np.nanstd(values, axis=0) / np.sqrt(count)


def _seeds(nodes: NodeOutputs, table: InputTable, deviation: Array, cycle: Cost) -> Knob:
    """The mean by the paper's linear responses, by the number of surfaces: standard errors by their
    scatter.
    """
    samples = table.sample(MEAN_SAMPLES, SAMPLE_SEED)
    ranges = table.ranges()
    means = np.array(
        [
            to_paper_outputs(linear_outputs(values, ranges, samples)).mean(axis=0)
            for values in nodes.values
        ]
    )
    known = np.isfinite(means).sum(axis=0)
    scatter = 100 * np.nanstd(means, axis=0, ddof=1) / deviation
    share_unknown = 1 / np.sqrt(2 * np.maximum(known - 1, 1))
    nodes_of_surface = len(collocation_nodes(len(table.rows)))

    def errors(count: int) -> Errors:
        error = scatter / np.sqrt(count)
        return Errors(error, error * share_unknown, cycle.times(count * nodes_of_surface))

    in_use = len(nodes.seeds)
    counts = [1]
    while 2 * counts[-1] <= in_use:
        counts.append(2 * counts[-1])
    if counts[-1] != in_use:
        counts.append(in_use)
    choices = [Choice(count, partial(errors, count)) for count in counts]
    quantities = _percent_of_deviation(MEANS)
    return Knob(
        "surfaces at the nodes",
        quantities,
        choices,
        in_use,
        "scatter between surfaces",
        None,
        f"{in_use} surfaces",
    )
