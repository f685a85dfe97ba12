"""Responses, likelihood and sampling against exact results and made-up truths."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.calibration import surfaces
from mesoscale.calibration.measurements import Measurements
from mesoscale.calibration.observables import NAMES, Cycles, force_levels_nN
from mesoscale.calibration.posterior import Calibration
from mesoscale.calibration.responses import fit_responses
from mesoscale.calibration.sampling import Sampling, diagnose, sample
from mesoscale.calibration.summary import (
    checks,
    posterior_json,
    predictive_probability,
    predictive_rows,
    sample_rows,
    summary_rows,
)
from mesoscale.calibration.surfaces import check_points
from mesoscale.calibration.values import normal_with_common
from mesoscale.errors import InputError
from tests.mesoscale.calibration.conftest import MAX_FORCE_NN, made_up_observables

# one area alone leaves a ridge of H_macro and H', slow to sample
AREAS_NM2 = np.array([40.0, 100.0, 400.0, 4000.0])
TRUTH = np.array([[0.21, 91.0, 1.5, 8.0, 0.022, 0.8, 5.0]])


def result_of(model, *tables, settings=None):
    posterior = model.posterior(tables)
    chain = posterior.draw(settings)
    return Calibration(tables, model, posterior, chain, posterior.inputs(chain.z), {})


def pull_offs(values, share=0.1):
    values = np.asarray(values, float)
    columns = {"pull_off": values, "pull_off_error": share * values}
    return Measurements(
        "pull_off", columns, tuple(f"p{k}" for k in range(len(values))), False, 0.0, "pull_off.csv"
    )


def hardness(values, error=0.1, area=100.0):
    values = np.asarray(values, float)
    columns = {
        "area": np.full_like(values, area),
        "hardness": values,
        "hardness_error": np.full_like(values, error),
    }
    return Measurements(
        "hardness", columns, tuple(f"h{k}" for k in range(len(values))), False, 0.0, "hardness.csv"
    )


def modulus(value, error):
    columns = {"e_star": np.array([value]), "e_star_error": np.array([error])}
    return Measurements("modulus", columns, ("m",), False, 0.0, "modulus.csv")


def curves(count, rng, zero_known=False, error=0.1, x=TRUTH, discrepancy=0.0):
    y = made_up_observables(np.repeat(x, count, axis=0), rng)
    forces = np.geomspace(*force_levels_nN(MAX_FORCE_NN)[[0, -1]], 12)
    rows, names = [], []
    for k, row in enumerate(y):
        levels = row[0] - np.concatenate([[0], np.cumsum(row[1:6])])
        points = np.interp(np.log(forces), np.log(force_levels_nN(MAX_FORCE_NN)), levels)
        zero = 0.0 if zero_known else rng.uniform(-50, 50)
        rows.append(points + zero + error * rng.standard_normal(12))
        names += [f"c{k}"] * 12
    columns = {
        "separation": np.concatenate(rows),
        "force": np.tile(forces, count),
        "separation_error": np.full(12 * count, error),
    }
    return Measurements(
        "closing_curves", columns, tuple(names), zero_known, discrepancy, "curves.csv"
    )


def test_responses_find_mean_and_scatter(prior, cycles):
    """A fresh set of runs: standardised differences have mean 0 and variance 1 within the noise of
    4000 runs.
    """
    x = prior.sample(4000, 11)
    y = Cycles(x, made_up_observables(x, np.random.default_rng(11))).of(NAMES)
    prediction = fit_responses(NAMES, cycles, prior)(x)
    sd = np.sqrt(np.einsum("mkk->mk", prediction.scatter) * (1 + prediction.error[:, None]))
    off = (y - prediction.mean) / sd
    # 900 runs know the mean to 0.03, a region of them less
    assert np.abs(off.mean(axis=0)).max() < 0.12
    assert np.abs(off.std(axis=0) - 1).max() < 0.08


def test_scatter_that_changes_over_the_inputs_is_found(prior):
    """Scatter of a pull-off force that grows fourfold from the smallest to the largest q0."""
    x, rng = prior.sample(3000, 12), np.random.default_rng(12)
    y = made_up_observables(x, rng)
    sd = 0.2 * 4 ** ((x[:, 4] - 0.015) / 0.02)
    y[:, -1] = np.exp(4 + sd * rng.standard_normal(len(x)))
    ends = np.array([[0.21, 91, 1.5, 8, q0, 0.8, 6] for q0 in (0.015, 0.035)])
    found = np.sqrt(fit_responses(["pull_off_nN"], Cycles(x, y), prior)(ends).scatter[:, 0, 0])
    assert found == pytest.approx([0.2, 0.8], rel=0.15)


def test_runs_that_lack_one_observable_still_teach_the_others(prior, cycles):
    """Smooth surfaces without a closing curve: their pull-off forces count where only those are
    asked for.
    """
    y = cycles.y.copy()
    y[cycles.x[:, 6] < 4, :6] = np.nan
    some = Cycles(cycles.x, y)
    assert fit_responses(["pull_off_nN"], some, prior).cycles == len(y)
    both = fit_responses(["closing_begin_nm", "pull_off_nN"], some, prior)
    assert both.cycles == (cycles.x[:, 6] >= 4).sum()


def test_common_error_is_the_dense_normal_density():
    rng = np.random.default_rng(0)
    r, v, c = rng.standard_normal(6), rng.uniform(0.5, 2, 6), rng.standard_normal(6)
    dense = np.diag(v) + np.outer(c, c)
    exact = -0.5 * (r @ np.linalg.solve(dense, r) + np.linalg.slogdet(2 * np.pi * dense)[1])
    assert normal_with_common(r, v, c) == pytest.approx(exact, rel=1e-12)


def test_surface_likelihood_is_the_dense_normal_density(model, prior):
    """Pull-off forces of several surfaces: all numbers at once in one dense covariance, up to one
    constant.

    Data are linearised where they and the prior put them, which moves the error of a tenth by a
    hundredth of itself.
    """
    posterior = model.posterior([replace(pull_offs([60.0, 75.0, 90.0]), discrepancy=0.2)])
    x = prior.sample(5, 1)
    prediction = posterior.surfaces.responses(x)
    exact = []
    for k in range(5):
        scatter = prediction.scatter[k, 0, 0]
        shared = 0.2**2 + prediction.error[k] * scatter
        dense = np.eye(3) * (scatter + 0.1**2) + shared
        off = np.log([60.0, 75.0, 90.0]) - prediction.mean[k, 0]
        exact.append(
            -0.5 * (off @ np.linalg.solve(dense, off) + np.linalg.slogdet(2 * np.pi * dense)[1])
        )
    found = posterior.log_likelihood(x)
    assert found - found[0] == pytest.approx(np.array(exact) - exact[0], abs=1e-6)


def test_likelihood_of_curves_is_the_dense_normal_density(model, prior):
    """Curves and pull-off forces of the same surfaces: covariance of all observables of all
    surfaces at once.
    """
    rng = np.random.default_rng(3)
    tables = (
        curves(3, rng, zero_known=True, discrepancy=0.5),
        replace(pull_offs([60.0, 75.0]), specimens=("c0", "c2")),
    )
    part = model.posterior(tables).surfaces
    x = prior.sample(4, 7)
    prediction, common = part.responses(x), part._common(part.responses(x))
    exact = []
    for k in range(4):
        size = len(part.specimens)
        spread = np.kron(np.eye(size), prediction.scatter[k]) + np.kron(
            np.ones((size, size)), common[k]
        )
        precision = np.zeros_like(spread)
        for s, block in enumerate(part.precision):
            place = slice(7 * s, 7 * s + 7)
            precision[place, place] = block
        mean, information = np.tile(prediction.mean[k], size), part.information.ravel()
        off = information - precision @ mean
        inner = np.linalg.solve(np.linalg.inv(spread) + precision, off)
        log = mean @ information - 0.5 * mean @ precision @ mean + 0.5 * off @ inner
        exact.append(log - 0.5 * np.linalg.slogdet(np.eye(len(spread)) + precision @ spread)[1])
    found = part.log_likelihood(x)
    assert found - found[0] == pytest.approx(np.array(exact) - exact[0], rel=1e-6, abs=1e-6)


def test_observables_that_are_still_moving_are_refused(model, monkeypatch):
    """One step does not reach where curves are linearised; thirty do."""
    table = curves(2, np.random.default_rng(3))
    model.posterior([table])
    monkeypatch.setattr(surfaces, "MOST_STEPS", 1)
    with pytest.raises(InputError, match=r"curves\.csv: specimen c0: .* do not settle in 1 steps"):
        model.posterior([table])


def test_an_unknown_zero_changes_nothing(model, prior):
    data = curves(2, np.random.default_rng(4))
    moved = replace(
        data, columns={**data.columns, "separation": data.columns["separation"] + 123.0}
    )
    x = prior.sample(20, 2)
    a, b = (model.posterior([some]).log_likelihood(x) for some in (data, moved))
    assert a - a[0] == pytest.approx(b - b[0], abs=1e-5)


def test_sampler_finds_a_normal_posterior():
    """Mean and variance of a normal likelihood times the standard normal prior, to 5 standard
    errors of 400 draws.
    """
    chain = sample(lambda z: -0.5 * ((z[:, 0] - 2) / 0.1) ** 2, 3)
    assert chain.converged
    assert chain.z[:, 0].mean() == pytest.approx(2 / 1.01, abs=5 * 0.0995 / 20)
    assert chain.z[:, 1].std() == pytest.approx(1, abs=0.1)


def test_draws_that_are_returned_come_from_all_walkers():
    """Weights of two modes over eight seeds: 400 independent draws know each to 0.023, so their
    scatter is below 0.035.

    Every sixth draw of 32 walkers comes from five of them: it scattered by 0.049.
    """

    def two_modes(z):
        return np.logaddexp(
            np.log(0.7) - 50 * (z[:, 0] - 1.5) ** 2, np.log(0.3) - 50 * (z[:, 0] + 1.5) ** 2
        )

    shares = [
        (sample(two_modes, 2, Sampling(seed=seed)).z[:, 0] > 0).mean() for seed in range(2, 10)
    ]
    assert np.std(shares) < 0.035
    assert np.mean(shares) == pytest.approx(0.7, abs=0.03)


def test_walkers_that_follow_each_other_count_once():
    """Thirty-two copies of four series have no more independent draws than the four."""
    series = np.random.default_rng(2).standard_normal((4, 400, 1, 1))
    _, effective = diagnose(np.repeat(series, 32, axis=2))
    assert effective == pytest.approx(1600, rel=0.5)


RIDGE = np.linalg.qr(np.random.default_rng(0).standard_normal((7, 7)))[0] / np.geomspace(
    0.01, 100, 7
)
"""Of a normal likelihood of all seven inputs, as columns: rotated, deviations 0.01 to 100."""
FIRST_INPUT = {  # logarithms of likelihoods of the first input
    "flat": np.zeros_like,
    "edge": lambda x: np.where(x > 0, -3 * x, -1e3 * x**2),
    "two modes": lambda x: np.logaddexp(
        np.log(0.7) - 50 * (x - 1) ** 2, np.log(0.3) - 50 * (x + 1) ** 2
    ),
}


@pytest.mark.parametrize("case", ["flat", "edge", "two modes", "ridge"])
def test_a_converged_chain_knows_means_as_well_as_it_says(case):
    """Seven inputs: the error of means over four seeds is that of 400 draws or smaller."""
    mean, sd = np.zeros(7), np.ones(7)
    if case == "ridge":
        sd = np.sqrt(np.diag(np.linalg.inv(np.eye(7) + RIDGE @ RIDGE.T)))
    else:
        x = np.linspace(-6, 6, 100_001)
        weights = np.exp(FIRST_INPUT[case](x) - x**2 / 2)
        weights /= weights.sum()
        mean[0] = weights @ x
        sd[0] = np.sqrt(weights @ (x - mean[0]) ** 2)

    def log_likelihood(z):
        return (
            -0.5 * ((z @ RIDGE) ** 2).sum(axis=1) if case == "ridge" else FIRST_INPUT[case](z[:, 0])
        )

    chains = [sample(log_likelihood, 7, Sampling(samples=10**6, seed=seed)) for seed in range(4)]
    assert all(chain.converged for chain in chains)
    off = np.array([(chain.z.mean(axis=0) - mean) / sd for chain in chains])
    assert np.sqrt((off**2).mean()) < 1.25 / np.sqrt(400)  # 28 of them: 13 % is one deviation


def test_a_chain_that_is_too_short_says_so():
    chain = sample(
        lambda z: -0.5 * ((z[:, 0] - 3) / 1e-4) ** 2,
        6,
        Sampling(walkers=16, block=100, max_steps=100),
    )
    assert not chain.converged
    assert "R-hat" in chain.reason or "independent draws" in chain.reason


def test_curves_pull_off_and_hardness_find_the_truth(model, prior):
    rng = np.random.default_rng(8)
    y = made_up_observables(np.repeat(TRUTH, 10, axis=0), rng)
    result = result_of(
        model,
        curves(10, rng),
        pull_offs(y[:, 13]),
        hardness(1.5 + 8.0 * AREAS_NM2**-0.25 + 0.1 * rng.standard_normal(4), area=AREAS_NM2),
    )
    assert result.chain.converged
    off = (result.x.mean(axis=0) - TRUTH[0]) / result.x.std(axis=0)
    assert np.abs(off).max() < 3
    assert result.x[:, 6].std() < 0.4 * prior.sample(4000, 1)[:, 6].std()


def test_nothing_learned_gives_the_prior_back(model):
    result = result_of(model, modulus(91.0, 500.0))
    assert result.chain.converged
    assert result.chain.z.std(axis=0) == pytest.approx(1, abs=0.1)
    assert result.x[:, 6].std() == pytest.approx(3.75, rel=0.1)


def test_contradictions_and_outliers_are_named(model):
    rng = np.random.default_rng(5)
    rows = checks(result_of(model, hardness([3.9, 4.0, 4.1]), modulus(130.0, 2.0)))
    assert "agrees" in rows["hardness"]["verdict"]
    assert "contradicts" in rows["modulus"]["verdict"]
    assert rows["modulus"]["probability"] < 0.01
    values = made_up_observables(np.repeat(TRUTH, 12, axis=0), rng)[:, 13]
    values[4] *= 40
    result = result_of(model, pull_offs(values))
    named = result.posterior.surfaces.outliers(result.x[:50])
    assert len(named) == 1
    assert "p4" in named[0]


def test_predictive_probability_is_uniform_under_the_prior(model, prior):
    """Data drawn from the prior: probabilities below 0.2 come up in about a fifth of 40 cases (4
    standard errors).
    """
    rng = np.random.default_rng(6)
    template = model.posterior([pull_offs([70.0, 80.0])])
    x, others = prior.sample(40, 5), prior.sample(300, 9)
    shares = [
        predictive_probability(template.simulated(x[k : k + 1], rng), others, rng)
        for k in range(40)
    ]
    assert abs(np.mean(np.array(shares) < 0.2) - 0.2) < 4 * np.sqrt(0.16 / 40)


@pytest.mark.parametrize("table", [pull_offs([1e9]), hardness([400.0]), modulus(5000.0, 10.0)])
def test_measurements_outside_the_model_are_refused(model, table):
    with pytest.raises(InputError, match="the model gives") as error:
        model.check_range(table)
    assert "\n" not in str(error.value)


def test_measurements_inside_the_model_are_taken(model):
    for table in (
        modulus(91.0, 3.0),
        hardness([4.0]),
        pull_offs([60.0, 90.0]),
        curves(3, np.random.default_rng(2)),
    ):
        model.check_range(table)


def test_curves_outside_the_forces_of_the_responses_and_unknown_pull_offs_are_refused():
    data = curves(1, np.random.default_rng(1))
    far = replace(data, columns={**data.columns, "force": 1e3 * data.columns["force"]})
    with pytest.raises(InputError, match="c0 has 0 points with a net force of 140"):
        check_points(far, MAX_FORCE_NN)
    with pytest.raises(InputError, match="pull_off"):
        check_points(pull_offs([200.0], share=0.7), MAX_FORCE_NN)


def test_without_convergence_nothing_goes_on(model):
    """Neither samples nor inputs, and the reason in the gate."""
    result = result_of(
        model, hardness([4.0], error=1e-5), settings=Sampling(block=50, max_steps=50)
    )
    content = posterior_json(result, {})
    assert not content["gate"]["passed"]
    assert "has not converged" in content["gate"]["reasons"][0]
    assert content["inputs"] == {}
    assert not sample_rows(result)
    assert not summary_rows(result)
    assert not predictive_rows(result)


def test_swapped_columns_and_wrong_units_of_a_curve_are_refused(model):
    data = curves(1, np.random.default_rng(1))
    swapped = {
        **data.columns,
        "separation": data.columns["force"][::-1],
        "force": 200 + 10 * np.arange(12.0),
    }
    micrometres = {**data.columns, "separation": 1e3 * data.columns["separation"]}
    for columns in (swapped, micrometres):
        with pytest.raises(InputError, match="look at units, columns"):
            model.check_range(replace(data, columns=columns))
