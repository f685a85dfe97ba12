"""Hard cases of the calibration: each must give the known answer, name what is wrong, or refuse in
one line.

Behind all of them are the engine's own cycles on 128 x 128 points.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

from mesoscale.calibration.measurements import Measurements
from mesoscale.calibration.observables import (
    CURVES,
    LEVELS,
    NAMES,
    Cycles,
    curve_names,
    cycles_of_rows,
    force_levels_nN,
    observe_runs,
)
from mesoscale.calibration.posterior import Calibration, Model, Posterior
from mesoscale.calibration.responses import fit_responses
from mesoscale.calibration.sampling import Sampling
from mesoscale.calibration.summary import checks
from mesoscale.calibration.voltages import Voltage
from mesoscale.errors import InputError
from mesoscale.inputs.distributions import Distribution, InputTable
from mesoscale.inputs.table import input_table
from mesoscale.settings import ContactSettings
from mesoscale.uncertainty.designs import Run, random_runs
from mesoscale.uncertainty.surrogate import Surrogate

Array = NDArray[np.float64]

CONTACT = ContactSettings(mechanics="asperity", pixels=128)
TRUTH = {
    "hamaker": 0.21,
    "e_star": 91.0,
    "h_macro": 1.5,
    "h_prime": 8.0,
    "q0": 0.022,
    "hurst": 0.8,
    "rms": 6.0,
}
RUNS, SURFACES = 400, 12
FIRST_SURFACE = 2_100_000_000


@dataclass(frozen=True)
class Bench:
    """What the cases share.

    Attributes
    ----------
    table, cycles : the prior, and cycles over it.
    seen : observables of surfaces at TRUTH, shape (SURFACES, k).
    """

    table: InputTable
    cycles: Cycles
    seen: Array

    @classmethod
    def computed(cls) -> "Bench":
        """With the engine's cycles."""
        table = input_table()
        over = random_runs(table, 0, RUNS, seed=7, first_surface=FIRST_SURFACE)
        at_truth = [Run(k, -1, FIRST_SURFACE - 1 - k, TRUTH) for k in range(SURFACES)]
        rows = [observe_runs(runs, CONTACT) for runs in (over, at_truth)]
        cycles, seen = (cycles_of_rows(part, table.names) for part in rows)
        return cls(table, cycles, seen.y)

    def of(self, name: str) -> Array:
        """One observable of the surfaces at TRUTH, where they have it."""
        values = self.seen[:, NAMES.index(name)]
        return values[np.isfinite(values)]

    def calibrated(
        self, *tables: Measurements, prior: InputTable | None = None, steps: int = 10_000
    ) -> Calibration:
        """The posterior without further cycles."""
        model = self.model(prior)
        posterior = model.posterior(tables)
        chain = posterior.draw(Sampling(max_steps=steps, block=min(steps, 400)))
        return Calibration(tables, model, posterior, chain, posterior.inputs(chain.z), {})

    def posterior(self, *tables: Measurements, prior: InputTable | None = None) -> Posterior:
        """Density of the inputs given some tables."""
        return self.model(prior).posterior(tables)

    def model(self, prior: InputTable | None = None) -> Model:
        """What tables are compared with, over the prior or another one; releases fall from 14 V at
        2 nm to -12 V.
        """
        prior = prior or self.table
        degrees = np.vstack([np.zeros(7, int), np.eye(7, dtype=int)[prior.names.index("rms")]])
        release = Voltage(Surrogate(self.table.ranges(), degrees, np.array([1.0, -13.0])), 0.5, 0.5)
        return Model(prior, self.cycles, {"release": release}, CONTACT.max_force_nN)

    def column(self, result: Calibration, name: str) -> Array:
        """Samples of one input."""
        return result.x[:, self.table.names.index(name)]

    def prior_with(self, **rows: Distribution) -> InputTable:
        """The prior with some distributions exchanged."""
        changed = tuple(
            replace(row, distribution=rows.get(row.name, row.distribution))
            for row in self.table.rows
        )
        return InputTable(changed, self.table.correlation)


def values_of(
    kind: str, values: Sequence[float] | Array, error: float, discrepancy: float = 0.0
) -> Measurements:
    """Values of one kind (modulus, pull_off, release, ...) with one error."""
    name = "e_star" if kind == "modulus" else kind
    given = np.asarray(values, float)
    columns = {name: given, f"{name}_error": np.full_like(given, error)}
    if kind == "hardness":
        columns["area"] = np.full_like(given, 100.0)
    return Measurements(
        kind, columns, tuple(f"{kind} {k}" for k in range(len(given))), False, discrepancy, kind
    )


def pull_offs(values: Array, discrepancy: float = 0.0) -> Measurements:
    """Pull-off forces with an error of a tenth."""
    data = values_of("pull_off", values, 1.0, discrepancy)
    return replace(data, columns={"pull_off": values, "pull_off_error": 0.1 * values})


def _sticking(stuck: float, total: float) -> Measurements:
    columns = {"stuck": np.array([stuck]), "switches": np.array([total])}
    return Measurements("sticking", columns, ("all",), False, 0.0, "sticking")


def _curves(bench: Bench, zero_nm: float = 0.0) -> Measurements:
    """Closing curves of the surfaces at TRUTH without noise, each error 0.2 nm."""
    first = NAMES.index(curve_names(CURVES["closing_curves"])[0])
    part = bench.seen[:, first : first + LEVELS]
    part = part[np.isfinite(part).all(axis=1)]
    separations = part[:, :1] - np.column_stack(
        [np.zeros(len(part)), np.cumsum(part[:, 1:], axis=1)]
    )
    size = separations.size
    columns = {
        "separation": separations.ravel() + zero_nm,
        "force": np.tile(force_levels_nN(CONTACT.max_force_nN), len(part)),
        "separation_error": np.full(size, 0.2),
    }
    names = tuple(np.repeat([f"c{k}" for k in range(len(part))], LEVELS).tolist())
    return Measurements("closing_curves", columns, names, False, 0.0, "curves")


def _verdicts(result: Calibration) -> list[str]:
    """What is said of each table."""
    return [row["verdict"] for row in checks(result).values()]


def _nothing_learned(result: Calibration) -> bool:
    """Whether all inputs have mean and width of the prior."""
    z = result.chain.z
    return bool(np.abs(z.mean(axis=0)).max() < 0.15 and np.abs(z.std(axis=0) - 1).max() < 0.1)


def _unless(**statements: object) -> list[str]:
    """Names of the statements that do not hold."""
    return [name.replace("_", " ") for name, holds in statements.items() if not holds]


def _refused(action: Callable[[], object], words: str) -> list[str]:
    try:
        action()
    except InputError as error:
        return _unless(names_what_is_wrong=words in str(error), one_line="\n" not in str(error))
    return ["refused"]


def _flat(bench: Bench) -> list[str]:
    result = bench.calibrated(values_of("modulus", [91.0], 500.0))
    width = bench.column(result, "rms").std()
    return _unless(
        converged=result.chain.converged,
        nothing_learned=_nothing_learned(result),
        prior_width_of_the_rms=abs(width / 3.75 - 1) < 0.1,
    )


def _contradicting(bench: Bench) -> list[str]:
    tables = (values_of("hardness", [3.9, 4.0, 4.1], 0.1), values_of("modulus", [130.0], 2.0))
    first, second = _verdicts(bench.calibrated(*tables))
    return _unless(the_other_agrees="agrees" in first, named="contradicts" in second)


def _one_datum(bench: Bench) -> list[str]:
    result = bench.calibrated(pull_offs(bench.of("pull_off_nN")[:1]))
    rms = bench.column(result, "rms")
    low, high = np.quantile(rms, [0.005, 0.995])
    return _unless(
        converged=result.chain.converged,
        something_learned=rms.std() < 0.95 * 3.75,
        truth_inside=low < TRUTH["rms"] < high,
    )


def _outlier(bench: Bench) -> list[str]:
    values = bench.of("pull_off_nN").copy()
    values[4] *= 40
    result = bench.calibrated(pull_offs(values))
    named = result.posterior.surfaces.outliers(result.x[:50]) if result.posterior.surfaces else []
    return _unless(one_named=len(named) == 1, the_right_one="pull_off 4 " in "".join(named))


def _excluded_truth(bench: Bench) -> list[str]:
    prior = bench.prior_with(
        h_macro=Distribution("uniform", 3.0, 3.2), h_prime=Distribution("uniform", 8.0, 14.8)
    )
    data = values_of("hardness", [1.5 + 8 * 100**-0.25] * 4, 0.1)
    result = bench.calibrated(data, prior=prior)
    (verdict,) = _verdicts(result)
    return _unless(
        at_the_edge_of_h_prime=np.quantile(bench.column(result, "h_prime"), 0.05) < 8.2,
        said="contradicts the prior" in verdict,
    )


def _edge(bench: Bench) -> list[str]:
    result = bench.calibrated(values_of("hardness", [0.7 + 1.95 * 100**-0.25] * 5, 0.05))
    low = np.quantile(bench.column(result, "h_macro"), 0.05)
    return _unless(
        converged=result.chain.converged,
        inside=bench.column(result, "h_macro").min() >= 0.7,
        reaches_it=low < 0.75,
    )


def _tiny_error(bench: Bench) -> list[str]:
    result = bench.calibrated(values_of("modulus", [93.0], 1e-3))
    e_star = bench.column(result, "e_star")
    if not result.chain.converged:
        return _unless(says_so=result.chain.reasons)
    return _unless(at_the_datum=abs(e_star.mean() - 93.0) < 1e-3, as_narrow=e_star.std() < 2e-3)


def _many(bench: Bench) -> list[str]:
    values = np.tile(bench.of("pull_off_nN"), 50)
    result = bench.calibrated(pull_offs(values))
    width = bench.column(result, "rms").std()
    return _unless(
        finite=np.isfinite(result.chain.log_likelihood).all(), not_of_no_width=width > 0.05
    )


def _fixed(bench: Bench) -> list[str]:
    prior = bench.prior_with(rms=Distribution("fixed", 6.0))
    result = bench.calibrated(values_of("modulus", [93.0], 3.0), prior=prior)
    return _unless(converged=result.chain.converged, stays=np.ptp(bench.column(result, "rms")) == 0)


def _one_unknown(bench: Bench) -> list[str]:
    known = {
        name: Distribution("fixed", value) for name, value in TRUTH.items() if name != "e_star"
    }
    result = bench.calibrated(values_of("modulus", [91.0], 3.8), prior=bench.prior_with(**known))
    # two equal normal distributions
    return _unless(
        converged=result.chain.converged,
        width=abs(bench.column(result, "e_star").std() / (3.8 / np.sqrt(2)) - 1) < 0.1,
    )


def _ridge(bench: Bench) -> list[str]:
    result = bench.calibrated(values_of("hardness", [4.0], 0.02))
    both = bench.column(result, "h_macro") + bench.column(result, "h_prime") * 100**-0.25
    correlation = np.corrcoef(bench.column(result, "h_macro"), bench.column(result, "h_prime"))[
        0, 1
    ]
    return _unless(
        converged=result.chain.converged,
        along_the_line=correlation < -0.99,
        the_sum_is_the_datum=abs(both.mean() - 4.0) < 0.01 and abs(both.std() / 0.02 - 1) < 0.15,
    )


def _all_or_none(bench: Bench, stuck: float) -> list[str]:
    result = bench.calibrated(_sticking(stuck, 20.0))
    return _unless(
        converged=result.chain.converged, finite=np.isfinite(result.chain.log_likelihood).all()
    )


def _doubtful_model(bench: Bench) -> list[str]:
    """One force teaches nothing; of twelve, what they share is in doubt, and their scatter still
    teaches.
    """
    values = bench.of("pull_off_nN")
    one, twelve = (
        bench.calibrated(pull_offs(some, discrepancy=100.0)) for some in (values[:1], values)
    )
    z = np.random.default_rng(9).standard_normal((20000, len(one.posterior.free)))
    logs = [
        twelve.posterior.log_likelihood(twelve.posterior.inputs(part))
        for part in np.array_split(z, 40)
    ]
    weights = np.exp(np.concatenate(logs) - max(part.max() for part in logs))
    known = z[np.random.default_rng(10).choice(len(z), len(z), p=weights / weights.sum())]
    off = (twelve.chain.z.mean(axis=0) - known.mean(axis=0)) / known.std(axis=0)
    return _unless(
        converged=one.chain.converged and twelve.chain.converged,
        nothing_learned_of_one=_nothing_learned(one),
        widths_as_by_weighing_the_prior=np.abs(
            twelve.chain.z.std(axis=0) / known.std(axis=0) - 1
        ).max()
        < 0.15,
        means_as_by_weighing_the_prior=np.abs(off).max() < 0.15,
    )


def _short(bench: Bench) -> list[str]:
    result = bench.calibrated(values_of("hardness", [4.0, 4.0], 1e-5), steps=50)
    return _unless(no_posterior=not result.chain.converged, says_why=result.chain.reasons)


def _correlated(bench: Bench) -> list[str]:
    correlation = np.eye(len(bench.table.rows))
    i, j = (bench.table.names.index(name) for name in ("h_macro", "h_prime"))
    correlation[i, j] = correlation[j, i] = -0.8
    prior = InputTable(bench.table.rows, correlation)
    result = bench.calibrated(values_of("modulus", [91.0], 500.0), prior=prior)
    # Spearman's rank correlation of uniform inputs is their correlation
    kept = np.corrcoef(result.x[:, i], result.x[:, j])[0, 1]
    return _unless(converged=result.chain.converged, kept=abs(kept + 0.8) < 0.06)


def _far_zero(bench: Bench) -> list[str]:
    near, far = (bench.posterior(_curves(bench, zero)) for zero in (0.0, 1e5))
    x = bench.table.sample(30, 2)
    a, b = near.log_likelihood(x), far.log_likelihood(x)
    return _unless(same_likelihood=np.abs((a - a[0]) - (b - b[0])).max() < 1e-3)


def _outside(bench: Bench) -> list[str]:
    return [
        fault
        for data in (
            pull_offs(np.array([1e9])),
            values_of("hardness", [400.0], 1.0),
            values_of("release", [500.0], 1.0),
            _micrometres(bench),
        )
        for fault in _refused(lambda data=data: bench.model().check_range(data), "the model gives")
    ]


def _micrometres(bench: Bench) -> Measurements:
    data = _curves(bench)
    return replace(data, columns={**data.columns, "separation": 1e3 * data.columns["separation"]})


def _failing_cycles(bench: Bench) -> list[str]:
    y = bench.cycles.y.copy()
    y[np.random.default_rng(1).random(len(y)) < 0.2] = np.nan
    used = fit_responses(NAMES, Cycles(bench.cycles.x, y), bench.table).cycles
    nothing = Cycles(bench.cycles.x, np.full_like(y, np.nan))
    return [
        *_unless(left_out=used < 0.85 * len(y)),
        *_refused(lambda: fit_responses(NAMES, nothing, bench.table), "measurements.runs"),
    ]


def _twice(bench: Bench) -> list[str]:
    x = bench.table.sample(20, 3)
    twice, once = (
        bench.posterior(data).log_likelihood(x)
        for data in (
            values_of("modulus", [92.0, 92.0], 3.0),
            values_of("modulus", [92.0], 3.0 / np.sqrt(2)),
        )
    )
    return _unless(
        as_one_of_half_the_variance=np.allclose(twice - twice[0], once - once[0], atol=1e-9)
    )


def _no_tables(bench: Bench) -> list[str]:
    result = bench.calibrated()
    return _unless(converged=result.chain.converged, the_prior=_nothing_learned(result))


Case = tuple[str, str, Callable[[Bench], list[str]]]
CASES: tuple[Case, ...] = (
    ("flat likelihood", "a modulus known to 500 GPa", _flat),
    ("no data", "no table at all: the prior", _no_tables),
    (
        "contradicting data",
        "a modulus ten deviations above the prior beside fitting hardness points",
        _contradicting,
    ),
    ("one datum", "one pull-off force", _one_datum),
    ("outlier", "one of twelve pull-off forces is forty times too large", _outlier),
    (
        "prior excludes the truth",
        "hardness 4.0 GPa where the prior gives 5.5 and more",
        _excluded_truth,
    ),
    ("truth at the edge", "hardness of the lowest H_macro and H' of the prior", _edge),
    ("tiny error", "a modulus known to 1 MPa", _tiny_error),
    ("many data", "600 pull-off forces", _many),
    ("fixed input", "RMS without width", _fixed),
    ("one unknown", "all inputs known but E*", _one_unknown),
    ("ridge", "hardness at one area: only a sum is known", _ridge),
    ("all stick", "20 of 20 switches", partial(_all_or_none, stuck=20.0)),
    ("none sticks", "0 of 20 switches", partial(_all_or_none, stuck=0.0)),
    ("model in doubt", "discrepancy of a hundred times the value", _doubtful_model),
    ("chain too short", "50 steps for a ridge of 1e-5", _short),
    ("correlated prior", "rank correlation -0.8 of H_macro and H'", _correlated),
    ("far zero", "the zero of all curves 0.1 mm away", _far_zero),
    (
        "outside the model",
        "pull-off of 1 N, hardness of 400 GPa, release at 500 V, separations in the wrong unit",
        _outside,
    ),
    ("failing cycles", "20 % and 100 % without numbers", _failing_cycles),
    ("same datum twice", "counts as one of half the variance", _twice),
)


@pytest.fixture(scope="module")
def bench():
    return Bench.computed()


@pytest.mark.parametrize(("name", "description", "case"), CASES, ids=[case[0] for case in CASES])
def test_known_answer_or_refused(bench, name, description, case):
    assert case(bench) == []
