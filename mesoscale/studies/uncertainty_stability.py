"""Unusual inputs and outputs of the propagation: each gives the known answer or says that there is
none.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.errors import InputError
from mesoscale.inputs.distributions import (
    Distribution,
    InputTable,
    UncertainInput,
    correlation_matrix,
)
from mesoscale.law.fit import fit_branch
from mesoscale.law.parameters import FITTED, OUTPUTS
from mesoscale.settings import ContactSettings, UncertaintySettings
from mesoscale.studies.driver import HardCase
from mesoscale.uncertainty.collocation import nodes, to_values
from mesoscale.uncertainty.designs import Run
from mesoscale.uncertainty.propagation import NodeOutputs, output_rows, propagate
from mesoscale.uncertainty.runs import compute_rows
from mesoscale.uncertainty.sensitivity import sensitivity_rows
from mesoscale.uncertainty.validation import direct_runs_of_rows, validation_rows

LARGEST_GPA = 0.007
"""Largest pressure of the made-up curves."""
CHECKS = "the known answer, or none and counted as missing"
Array = NDArray[np.float64]
Function = Callable[[Array], Array]

SETTINGS = UncertaintySettings(direct_runs=200)
UNIFORM = Distribution("uniform", 0.0, 1.0)
MIDDLE = {
    "hamaker": 0.215, "e_star": 91.0, "h_macro": 1.95, "h_prime": 8.375, "q0": 0.025,
    "hurst": 0.75, "rms": 8.5
}  # fmt: skip


@dataclass(frozen=True)
class Answer:
    """Rows of the three result tables for one output in the places of all.

    Attributes
    ----------
    responses : outputs that have a response.
    """

    output: dict[str, Any]
    sensitivity: list[dict[str, Any]]
    validation: dict[str, Any]
    responses: int


def _table(*distributions: Distribution, correlation: Array | None = None) -> InputTable:
    rows = tuple(
        UncertainInput(f"x{k}", "1", distribution, "literature", "")
        for k, distribution in enumerate(distributions)
    )
    if correlation is None:
        correlation = np.eye(len(rows))
    return InputTable(rows, correlation)


def _answer(
    function: Function,
    table: InputTable,
    runs: int = 200,
    missing: float = 0.0,
    seeds: int = 3,
    place: int = 0,
    **changes: Any,
) -> Answer:
    """Propagate an engine that is a plain function of the inputs; a share `missing` of its runs
    fails.

    `place` 0 is an output whose response is fitted as it is, 1 one fitted in logarithm.
    """
    settings = SETTINGS.model_copy(update=changes)
    inputs = len(table.rows)
    rng = np.random.default_rng(5)
    # the same function in the places of all outputs, at the nodes and at random
    x_nodes = to_values(nodes(inputs), table.ranges())
    of_every_seed = np.tile(function(x_nodes), (seeds, 1))
    at_nodes = np.repeat(of_every_seed[..., None], len(FITTED), axis=2)
    at_nodes[rng.random(at_nodes.shape[:2]) < missing] = np.nan
    distribution = NodeOutputs(list(range(seeds)), at_nodes)
    x = table.sample(runs, 11)
    y = np.repeat(function(x)[:, None], len(FITTED), axis=1)
    y[rng.random(runs) < missing] = np.nan
    result = propagate(distribution, table, settings, (x, y))
    outputs = output_rows(distribution, result, (x, y), {}, {})
    with np.errstate(all="ignore"):
        sensitivity = sensitivity_rows(
            distribution, table, settings, np.zeros(len(OUTPUTS)), {}, {}, (x, y)
        )
    validation = validation_rows(
        (x, y), table, result, settings, np.empty((0, len(FITTED))), LARGEST_GPA
    )
    return Answer(
        output=outputs[place],
        sensitivity=sensitivity[place * inputs : (place + 1) * inputs],
        validation=validation[place],
        responses=sum(response is not None for response in result.responses),
    )


def _unless(**statements: bool) -> list[str]:
    """Names of the statements that do not hold."""
    return [name.replace("_", " ") for name, holds in statements.items() if not holds]


def _close(value: float, exact_value: float, relative: float = 0.05) -> bool:
    return bool(abs(value - exact_value) <= relative * abs(exact_value) + 1e-9)


def _zero_width() -> list[str]:
    table = _table(UNIFORM, Distribution("fixed", 2.0), Distribution("normal", 5.0, 0.0))
    answer = _answer(lambda x: 10 + x @ np.array([1.0, 3.0, 2.0]), table)
    return _unless(
        deviation_of_the_one_that_varies=_close(answer.output["dev"], 1 / np.sqrt(12)),
        no_effect_of_the_fixed=all(row["mu_star"] < 1e-9 for row in answer.sensitivity[1:]),
        index_one_of_the_other=_close(answer.sensitivity[0]["sobol_total"], 1.0),
    )


def _count_of_inputs(inputs: int) -> list[str]:
    answer = _answer(lambda x: 10 + x.sum(axis=1), _table(*[UNIFORM] * inputs))
    firsts = np.array([row["sobol_first"] for row in answer.sensitivity])
    return _unless(
        deviation=_close(answer.output["response_dev"], np.sqrt(inputs / 12)),
        equal_indices=bool(np.abs(firsts - 1 / inputs).max() < 0.05),
        q2_is_one=_close(answer.validation["q2"], 1.0, 1e-6),
    )


def _heavy_input() -> list[str]:
    values = np.sort(np.exp(1.5 * np.random.default_rng(3).normal(size=2000)))
    answer = _answer(
        lambda x: 10 + x[:, 0] + x[:, 1],
        _table(Distribution("samples", values=values), UNIFORM),
        runs=400,
    )
    return _unless(
        mean=_close(answer.output["response_mean"], 10.5 + values.mean(), 0.1),
        finite=bool(np.isfinite(answer.output["response_dev"])),
        index_of_the_tail=answer.sensitivity[0]["sobol_total_high"] > 0.95,
    )


def _heavy_output() -> list[str]:
    def function(x: Array) -> Array:
        return np.exp(6 * x[:, 0] + x[:, 1])

    answer = _answer(function, _table(UNIFORM, UNIFORM), place=1)
    exact = (np.exp(6) - 1) / 6 * (np.e - 1)
    return _unless(
        response_has_the_mean=_close(answer.output["response_mean"], exact),
        paper_mean_is_off_and_shown=not _close(answer.output["mean"], exact, 0.1),
    )


def _failing_runs(share: float) -> list[str]:
    answer = _answer(
        lambda x: 10 + x @ np.array([1.0, 2.0]), _table(UNIFORM, UNIFORM), missing=share, seeds=8
    )
    counted = answer.validation["missing"]
    if share == 1.0:
        return _unless(
            all_counted=counted == 200,
            no_seed_used=answer.output["seeds_used"] == 0,
            no_response=answer.responses == 0,
            no_number=all(
                np.isnan(answer.output[key])
                for key in ("mean", "dev", "response_mean", "response_dev")
            ),
        )
    return _unless(
        counted=bool(0 < counted < 200) and answer.output["missing"] > 0,
        incomplete_seeds_left_out=answer.output["seeds_used"] < answer.output["seeds"],
        mean_not_shifted=_close(answer.output["response_mean"], 11.5, 0.01),
    )


def _failing_engine() -> list[str]:
    e_stars = (91.0, -1.0, 91.0)
    runs = [Run(k, -1, k, {**MIDDLE, "e_star": e_star}) for k, e_star in enumerate(e_stars)]
    rows = list(compute_rows(runs, ContactSettings(mechanics="asperity", pixels=128)))
    text = [{key: str(value) for key, value in row.items()} for row in rows]
    _, y = direct_runs_of_rows(text, list(MIDDLE), 3)
    return _unless(
        reported=str(rows[1]["curve_status"]).startswith("failed: "),
        without_numbers=bool(np.isnan(y[1]).all()),
        others_computed=bool(np.isfinite(y[[0, 2]]).all()),
    )


def _not_smooth() -> list[str]:
    answer = _answer(
        lambda x: 10 + np.where(x[:, 0] > 0.37, 5.0, 0.0), _table(UNIFORM, UNIFORM), runs=400
    )
    return _unless(
        validation_says_so=answer.validation["q2"] < 0.9,
        quantiles_of_cells=(answer.output["cell_q05"], answer.output["cell_q50"]) == (10.0, 15.0),
    )


def _tiny_sample() -> list[str]:
    answer = _answer(lambda x: 10 + x[:, 0], _table(UNIFORM, UNIFORM), runs=3, seeds=1)
    return _unless(
        no_response_from_three_runs=answer.responses == 0
        and np.isnan(answer.output["response_mean"]),
        paper_method_still_there=_close(answer.output["mean"], 10.5, 0.1),
        no_scatter_from_one_seed=np.isnan(answer.output["mean_seed_sd"]),
    )


def _all_equal() -> list[str]:
    answer = _answer(lambda x: np.full(len(x), 7.0), _table(UNIFORM, UNIFORM))
    return _unless(
        no_deviation=abs(answer.output["dev"]) < 1e-9 and abs(answer.output["response_dev"]) < 1e-6,
        no_indices=all(np.isnan(row["sobol_first"]) for row in answer.sensitivity),
        no_q2="q2" not in answer.validation or answer.output["cell_dev"] == 0,
    )


def _not_identifiable() -> list[str]:
    h = np.linspace(10.0, 40.0, 60)
    repulsion = 200.0 * np.maximum(30.0 - h, 0.0)
    fit = fit_branch(h, repulsion, -np.ones_like(h), 1e6, 0.215, 30.0)
    row = {"x0": "0"}
    for name, value in zip(FITTED, [*fit.parameters] * 2, strict=True):
        row[name] = ""
        if not np.isnan(value):
            row[name] = str(value)
    _, y = direct_runs_of_rows([row], ["x0"], 1)
    repulsion = [name for name in FITTED if name.endswith(("_C_r_GPa", "_rho_r_nm"))]
    return _unless(
        status_says_so=fit.status.startswith("not_identifiable"),
        d_c_stands=bool(np.isfinite(y[0, 0])),
        C_r_and_rho_r_missing=all(np.isnan(y[0, FITTED.index(name)]) for name in repulsion),
    )


def _correlated() -> list[str]:
    rank = -0.8
    table = _table(
        UNIFORM, UNIFORM, correlation=correlation_matrix(["x0", "x1"], {("x0", "x1"): rank})
    )
    answer = _answer(lambda x: 10 + x.sum(axis=1), table)
    # Spearman's rank correlation of uniform inputs is their correlation
    return _unless(
        deviation_of_the_sum=_close(answer.output["response_dev"], np.sqrt((2 + 2 * rank) / 12))
    )


def _contradiction() -> list[str]:
    try:
        correlation_matrix(["a", "b", "c"], {("a", "b"): 0.95, ("b", "c"): 0.95, ("a", "c"): -0.95})
    except InputError:
        return []
    return ["refused"]


def _eighth_input() -> list[str]:
    runs = [
        Run(k, -1, 0, {**MIDDLE, "gap_cutoff": cutoff}) for k, cutoff in enumerate((0.165, 0.3))
    ]
    near, far = compute_rows(runs, ContactSettings(mechanics="asperity", pixels=128))
    return _unless(
        attraction_falls=float(near["closing_C_a_GPa_nm"]) > 1.5 * float(far["closing_C_a_GPa_nm"]),
        repulsion_stays=near["closing_d_c_nm"] == far["closing_d_c_nm"],
    )


CASES: Sequence[tuple[str, str, Callable[[], list[str]]]] = (
    ("zero width", "one fixed input, one of zero deviation", _zero_width),
    ("one input", "n = 1", lambda: _count_of_inputs(1)),
    ("twelve inputs", "n = 12", lambda: _count_of_inputs(12)),
    ("heavy-tailed input", "lognormal samples, deviation of the logarithm 1.5", _heavy_input),
    ("heavy-tailed output", "over three decades", _heavy_output),
    ("some calls fail", "20 % of nodes and runs without numbers", lambda: _failing_runs(0.2)),
    ("all calls fail", "no number at all", lambda: _failing_runs(1.0)),
    ("engine refuses", "E* < 0 in one run of the contact model", _failing_engine),
    ("not smooth", "a step", _not_smooth),
    ("tiny sample", "three runs, one seed", _tiny_sample),
    ("all equal", "a constant output", _all_equal),
    (
        "not identifiable",
        "a straight repulsion: C_r and rho_r are not determined",
        _not_identifiable,
    ),
    ("correlated inputs", "rank correlation -0.8", _correlated),
    ("contradicting correlations", "0.95, 0.95, -0.95", _contradiction),
    ("eighth input", "D0 0.165 and 0.3 nm through the contact model", _eighth_input),
)


def hard_cases() -> list[HardCase]:
    """The cases with their judges; they are the same in all scenes."""
    return [
        HardCase(name, description, CHECKS, partial(_verdict, case))
        for name, description, case in CASES
    ]


def _verdict(case: Callable[[], list[str]]) -> tuple[bool, str]:
    broken = case()
    return not broken, "; ".join(f"not so: {words}" for words in broken)
