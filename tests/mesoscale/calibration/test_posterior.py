"""Responses, likelihood and sampling against exact results and made-up truths."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.calibration.further import next_measurements, next_on_pad
from mesoscale.calibration.learning import (
    check_range,
    information_bits,
    learned,
    outliers,
    predictive_probability,
)
from mesoscale.calibration.likelihood import normal_with_common, posterior_of
from mesoscale.calibration.measurements import Measurements
from mesoscale.calibration.observables import OBSERVABLES, force_levels_nN
from mesoscale.calibration.posterior import Calibration, Cycles, draw, expected_of, responses_of
from mesoscale.calibration.responses import transformed
from mesoscale.calibration.sampling import NormalProposal, autocorrelation, diagnose, sample
from mesoscale.calibration.summary import posterior_json, predictive_rows, sample_rows, summary_rows
from mesoscale.calibration.surfaces import check_points
from mesoscale.calibration.switches import SwitchModel, law_values
from mesoscale.errors import InputError
from mesoscale.law.parameters import PARAMETERS
from mesoscale.settings import DeviceSettings
from tests.mesoscale.calibration.conftest import MAX_FORCE_NN, made_up_observables

AREAS_NM2 = np.array([40.0, 100.0, 400.0, 4000.0])  # one area alone leaves a ridge of H_macro and H', slow to sample
TRUTH = np.array([[0.21, 91.0, 1.5, 8.0, 0.022, 0.8, 5.0]])


@pytest.fixture(scope="module")
def parts(prior, cycles):
    responses, laws = responses_of(prior, cycles)
    switch = SwitchModel.of(DeviceSettings(), 1e6)
    return responses, laws, switch, expected_of(cycles)


def given(prior, parts, *tables):
    responses, laws, switch, expected = parts
    return posterior_of(prior, tables, responses, laws, switch, MAX_FORCE_NN, expected)


def result_of(prior, parts, *tables):
    posterior = given(prior, parts, *tables)
    chain = draw(posterior)
    responses, laws, switch, expected = parts
    return Calibration(posterior, chain, posterior.inputs(chain.z), responses, laws, expected, switch)


def pull_offs(values, share=0.1):
    values = np.asarray(values, float)
    columns = {"pull_off": values, "pull_off_error": share * values}
    return Measurements("pull_off", columns, tuple(f"p{k}" for k in range(len(values))), False, 0.0, "pull_off.csv")


def hardness(values, error=0.1, area=100.0):
    values = np.asarray(values, float)
    columns = {"area": np.full_like(values, area), "hardness": values, "hardness_error": np.full_like(values, error)}
    return Measurements("hardness", columns, tuple(f"h{k}" for k in range(len(values))), False, 0.0, "hardness.csv")


def modulus(value, error):
    columns = {"e_star": np.array([value]), "e_star_error": np.array([error])}
    return Measurements("modulus", columns, ("m",), False, 0.0, "modulus.csv")


def volts(kind, value):
    columns = {kind: np.array([value]), f"{kind}_error": np.array([0.05])}
    return Measurements(kind, columns, ("v",), False, 0.0, f"{kind}.csv")


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
    return Measurements("closing_curves", columns, tuple(names), zero_known, discrepancy, "curves.csv")


def test_responses_find_mean_and_scatter(prior, parts):
    """A fresh set of runs: standardised differences have mean 0 and variance 1 within the noise of 4000 runs."""
    x = prior.sample(4000, 11)
    y = made_up_observables(x, np.random.default_rng(11))[:, : len(OBSERVABLES)]
    prediction = parts[0].every(x)
    off = transformed(OBSERVABLES, y) - prediction.mean
    sd = np.sqrt(np.einsum("mkk->mk", prediction.scatter) * (1 + prediction.error[:, None]))
    assert np.abs((off / sd).mean(axis=0)).max() < 0.12  # 900 runs know the mean to 0.03, a region of them less
    assert np.abs((off / sd).std(axis=0) - 1).max() < 0.08


def test_runs_that_lack_one_observable_still_teach_the_others(prior, cycles):
    """Smooth surfaces without a closing curve: their pull-off forces count where only those are asked for."""
    y = cycles.y.copy()
    y[cycles.x[:, 6] < 4, :6] = np.nan
    fits, _ = responses_of(prior, Cycles(cycles.x, y))
    assert fits.pick(["pull_off_nN"]).runs == len(y)
    assert fits.pick(["closing_begin_nm", "pull_off_nN"]).dropped == (cycles.x[:, 6] < 4).sum()


def test_common_error_is_the_dense_normal_density():
    rng = np.random.default_rng(0)
    r, v, c = rng.standard_normal(6), rng.uniform(0.5, 2, 6), rng.standard_normal(6)
    dense = np.diag(v) + np.outer(c, c)
    exact = -0.5 * (r @ np.linalg.solve(dense, r) + np.linalg.slogdet(2 * np.pi * dense)[1])
    assert normal_with_common(r, v, c) == pytest.approx(exact, rel=1e-12)


def test_surface_likelihood_is_the_dense_normal_density(prior, parts):
    """Pull-off forces of several surfaces: all numbers at once in one dense covariance."""
    data = pull_offs([60.0, 75.0, 90.0])
    data = replace(data, discrepancy=0.2)
    posterior = given(prior, parts, data)
    x = prior.sample(5, 1)
    prediction = parts[0].pick(["pull_off_nN"])(x)
    for k in range(5):
        scatter = prediction.scatter[k, 0, 0]
        shared = 0.2**2 + prediction.error[k] * scatter
        dense = np.eye(3) * (scatter + 0.1**2) + shared
        off = np.log([60.0, 75.0, 90.0]) - prediction.mean[k, 0]
        exact = -0.5 * (off @ np.linalg.solve(dense, off) + np.linalg.slogdet(2 * np.pi * dense)[1])
        assert posterior.log_likelihood(x[k : k + 1])[0] == pytest.approx(exact, rel=1e-8)


def test_an_unknown_zero_changes_nothing(prior, parts):
    data = curves(2, np.random.default_rng(4))
    moved = replace(data, columns={**data.columns, "separation": data.columns["separation"] + 123.0})
    x = prior.sample(20, 2)
    a, b = (given(prior, parts, some).log_likelihood(x) for some in (data, moved))
    assert a - a[0] == pytest.approx(b - b[0], abs=1e-5)


def test_sampler_finds_a_normal_posterior():
    """Mean and variance of a normal likelihood times the standard normal prior, to 5 standard errors of 400 draws."""
    chain = sample(lambda z: -0.5 * ((z[:, 0] - 2) / 0.1) ** 2, 3, 32, 3000, 4000, 1)
    assert chain.converged
    assert chain.z[:, 0].mean() == pytest.approx(2 / 1.01, abs=5 * 0.0995 / 20)
    assert chain.z[:, 1].std() == pytest.approx(1, abs=0.1)


def test_sampler_finds_both_modes_with_their_weights():
    chain = sample(
        lambda z: np.logaddexp(np.log(0.7) - 50 * (z[:, 0] - 1) ** 2, np.log(0.3) - 50 * (z[:, 0] + 1) ** 2),
        2, 32, 4000, 4000, 2,
    )  # fmt: skip
    assert (chain.z[:, 0] > 0).mean() == pytest.approx(0.7, abs=0.1)


def test_draws_that_are_returned_come_from_all_walkers():
    """Weights of two modes over eight seeds: 400 independent draws know each to 0.023, so their scatter is below 0.035.

    Every sixth draw of 32 walkers comes from five of them: it scattered by 0.049.
    """

    def two_modes(z):
        return np.logaddexp(np.log(0.7) - 50 * (z[:, 0] - 1.5) ** 2, np.log(0.3) - 50 * (z[:, 0] + 1.5) ** 2)

    shares = [(sample(two_modes, 2, 32, 4000, 4000, seed).z[:, 0] > 0).mean() for seed in range(2, 10)]
    assert np.std(shares) < 0.035
    assert np.mean(shares) == pytest.approx(0.7, abs=0.03)


def test_autocorrelation_time_of_a_known_process():
    """x' = 0.9 x + noise: (1 + 0.9) / (1 - 0.9) = 19 steps; 8 series of 4000 steps know it to 8 %."""
    rng = np.random.default_rng(1)
    x = np.empty((8, 4000))
    x[:, 0] = rng.standard_normal(8)
    for step in range(1, 4000):
        x[:, step] = 0.9 * x[:, step - 1] + np.sqrt(1 - 0.9**2) * rng.standard_normal(8)
    time, variance = autocorrelation(x)
    assert time == pytest.approx(19, rel=0.25)
    assert variance == pytest.approx(1, rel=0.15)


def test_proposals_keep_the_distribution_that_they_are_reversible_with():
    """Fitted to the wrong normal distribution and accepted by Metropolis' rule: the right one stays."""
    rng = np.random.default_rng(4)
    proposal = NormalProposal(np.array([0.5, -0.5]) + rng.standard_normal((4000, 2)) @ [[1.5, 0.3], [0.0, 0.8]])
    x = rng.standard_normal((20000, 2))
    for _ in range(10):
        new, factor = proposal(x, np.random.RandomState(rng.integers(2**31)))
        log_ratio = factor + 0.5 * ((x**2).sum(axis=1) - (new**2).sum(axis=1))
        x = np.where((np.log(rng.random(len(x))) < log_ratio)[:, None], new, x)
    assert x.mean(axis=0) == pytest.approx([0, 0], abs=4 / np.sqrt(20000))
    assert np.cov(x.T) == pytest.approx(np.eye(2), abs=0.05)


def test_walkers_that_follow_each_other_count_once():
    """Thirty-two copies of four series have no more independent draws than the four."""
    series = np.random.default_rng(2).standard_normal((4, 400, 1, 1))
    _, effective, _ = diagnose(np.repeat(series, 32, axis=2))
    assert effective == pytest.approx(1600, rel=0.5)


RIDGE = np.linalg.qr(np.random.default_rng(0).standard_normal((7, 7)))[0] / np.geomspace(0.01, 100, 7)
"""Of a normal likelihood of all seven inputs, as columns: rotated, deviations 0.01 to 100."""
FIRST_INPUT = {  # logarithms of likelihoods of the first input
    "flat": np.zeros_like,
    "edge": lambda x: np.where(x > 0, -3 * x, -1e3 * x**2),
    "two modes": lambda x: np.logaddexp(np.log(0.7) - 50 * (x - 1) ** 2, np.log(0.3) - 50 * (x + 1) ** 2),
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
        return -0.5 * ((z @ RIDGE) ** 2).sum(axis=1) if case == "ridge" else FIRST_INPUT[case](z[:, 0])

    chains = [sample(log_likelihood, 7, 32, 4000, 10**6, seed) for seed in range(4)]
    assert all(chain.converged for chain in chains)
    off = np.array([(chain.z.mean(axis=0) - mean) / sd for chain in chains])
    assert np.sqrt((off**2).mean()) < 1.25 / np.sqrt(400)  # 28 of them: 13 % is one deviation


def test_a_chain_that_is_too_short_says_so():
    chain = sample(lambda z: -0.5 * ((z[:, 0] - 3) / 1e-4) ** 2, 6, 16, 200, 500, 1)
    assert not chain.converged
    assert "R-hat" in chain.reason or "independent draws" in chain.reason


def test_curves_pull_off_and_hardness_find_the_truth(prior, parts):
    rng = np.random.default_rng(8)
    y = made_up_observables(np.repeat(TRUTH, 10, axis=0), rng)
    result = result_of(
        prior,
        parts,
        curves(10, rng),
        pull_offs(y[:, 13]),
        hardness(1.5 + 8.0 * AREAS_NM2**-0.25 + 0.1 * rng.standard_normal(4), area=AREAS_NM2),
    )
    assert result.chain.converged
    off = (result.x.mean(axis=0) - TRUTH[0]) / result.x.std(axis=0)
    assert np.abs(off).max() < 3
    assert result.x[:, 6].std() < 0.4 * prior.sample(4000, 1)[:, 6].std()
    assert information_bits(result.chain.z) > 3


def test_nothing_learned_gives_the_prior_back(prior, parts):
    result = result_of(prior, parts, modulus(91.0, 500.0))
    assert result.chain.converged
    assert information_bits(result.chain.z) < 0.15
    assert result.x[:, 6].std() == pytest.approx(3.75, rel=0.1)


def test_bits_of_one_modulus_are_those_of_two_normal_distributions(prior, parts):
    """Prior 91 +- 3.8 and a datum 91 +- 3.8: half the variance, 0.5 (ln 2 - 0.5) nats; no more than noise besides."""
    result = result_of(prior, parts, modulus(91.0, 3.8))
    k = list(result.posterior.free).index(prior.names.index("e_star"))
    assert information_bits(result.chain.z[:, [k]]) == pytest.approx(0.5 * (np.log(2) - 0.5) / np.log(2), abs=0.04)


def test_contradictions_and_outliers_are_named(prior, parts):
    rng = np.random.default_rng(5)
    data = [hardness([3.9, 4.0, 4.1]), modulus(130.0, 2.0)]
    rows = learned(result_of(prior, parts, *data), data, MAX_FORCE_NN)
    assert "agrees" in rows[0]["verdict"]
    assert "contradicts" in rows[1]["verdict"]
    assert rows[1]["probability"] < 0.01
    values = made_up_observables(np.repeat(TRUTH, 12, axis=0), rng)[:, 13]
    values[4] *= 40
    named = outliers(result_of(prior, parts, pull_offs(values)))
    assert len(named) == 1
    assert "p4" in named[0]


def test_predictive_probability_is_uniform_under_the_prior(prior, parts):
    """Data drawn from the prior: probabilities below 0.2 come up in about a fifth of 40 cases (4 standard errors)."""
    rng = np.random.default_rng(6)
    template = given(prior, parts, pull_offs([70.0, 80.0]))
    x = prior.sample(40, 5)
    predicted, others = template.predict(x), prior.sample(300, 9)
    shares = [predictive_probability(template.simulated(predicted.at(k), rng), others, rng) for k in range(40)]
    assert abs(np.mean(np.array(shares) < 0.2) - 0.2) < 4 * np.sqrt(0.16 / 40)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (pull_offs([1e9]), "the model gives"),
        (hardness([400.0]), "the model gives"),
        (modulus(5000.0, 10.0), "the model gives"),
        (volts("release", 500.0), "release = 500: the model gives"),
        (volts("pull_in", 0.1), "pull_in = 0.1: the model gives"),
    ],
)
def test_measurements_outside_the_model_are_refused(prior, cycles, parts, table, words):
    with pytest.raises(InputError, match=words) as error:
        check_range([table], prior, cycles, MAX_FORCE_NN, parts[2])
    assert "\n" not in str(error.value)


def test_measurements_inside_the_model_are_taken(prior, cycles, parts):
    release, pull_in = volts("release", 1.5), volts("pull_in", 62.7)
    check_range([modulus(91.0, 3.0), release, pull_in], prior, cycles, MAX_FORCE_NN, parts[2])


def test_curves_outside_the_forces_of_the_responses_and_unknown_pull_offs_are_refused():
    data = curves(1, np.random.default_rng(1))
    far = replace(data, columns={**data.columns, "force": 1e3 * data.columns["force"]})
    with pytest.raises(InputError, match="c0 has 0 points with a net force of 140"):
        check_points(far, MAX_FORCE_NN)
    with pytest.raises(InputError, match="pull_off"):
        check_points(pull_offs([200.0], share=0.7), MAX_FORCE_NN)


def test_without_convergence_nothing_goes_on(prior, parts):
    """Neither samples nor inputs, and the reason in the gate."""
    posterior = given(prior, parts, hardness([4.0], error=1e-5))
    chain = draw(posterior, max_steps=200)
    responses, laws, switch, expected = parts
    result = Calibration(posterior, chain, posterior.inputs(chain.z), responses, laws, expected, switch)
    content = posterior_json(result, [hardness([4.0])], [], [])
    assert not content["gate"]["passed"]
    assert "has not converged" in content["gate"]["reasons"][0]
    assert content["inputs"] == {}
    assert not sample_rows(result)
    assert not summary_rows(result)
    assert not predictive_rows(result, MAX_FORCE_NN)


def test_swapped_columns_of_a_curve_are_refused(prior, cycles, parts):
    data = curves(1, np.random.default_rng(1))
    columns = {**data.columns, "separation": data.columns["force"][::-1], "force": 200 + 10 * np.arange(12.0)}
    with pytest.raises(InputError, match="look at units, columns"):
        check_range([replace(data, columns=columns)], prior, cycles, MAX_FORCE_NN, parts[2])


def test_release_and_pull_in_are_those_of_a_fine_grid(prior, parts):
    """On laws that the responses predict: the lowest and the highest point of the path, within 2e-3."""
    _, laws, switch, _ = parts
    x = prior.sample(50, 4)
    closing, opening = switch.laws(law_values(laws(x)), x[:, prior.names.index("hamaker")])
    volts, pull_in = switch.release_V(opening), switch.pull_in_V(closing)
    for k in range(50):
        one, down = take_one(opening, k), take_one(closing, k)
        s = np.geomspace(one.d_c_nm + 1e-3, switch.switch.gap_nm, 20_000)
        inner = one.d_c_nm - np.linspace(0.0, 3.0 * one.rho_r_nm, 20_000)
        path = switch.path_V2(np.concatenate([inner[::-1], s]), one, switch.last_share)
        barrier = 20_000 + int(np.argmax(switch.path_V2(s, one, switch.last_share)))
        lowest = path[:barrier].min()
        assert volts[k] == pytest.approx(np.sign(lowest) * np.sqrt(abs(lowest)), rel=2e-3, abs=0.05)
        assert pull_in[k] == pytest.approx(np.sqrt(switch.path_V2(s, down, 1.0).max()), rel=1e-3)


def take_one(law, k):
    """One of the samples of a law."""
    return replace(law, **{name: np.asarray(getattr(law, name))[k] for name in (*PARAMETERS, "hamaker")})


def test_a_release_voltage_teaches_most_of_the_release_voltage(prior, parts):
    """What the made-up release depends on is not the modulus, so measuring that again is worth nothing."""
    result = result_of(prior, parts, modulus(91.0, 3.0))
    rows = {row["kind"]: row for row in next_measurements(result, MAX_FORCE_NN)}
    assert rows["release"]["reduction"] > 0.2
    assert abs(rows["modulus"]["reduction"]) < 0.1


def test_next_on_pad_finds_what_its_release_depends_on(prior, parts):
    """Made-up release that falls with the RMS and knows nothing of E*: exact where it is measured itself."""
    x = prior.sample(128, 5)
    volts = 20 - x[:, 6] + 0.3 * np.random.default_rng(2).standard_normal(128)
    responses = parts[0]
    rows = {
        row["kind"]: row
        for row in next_on_pad(lambda tables: given(prior, parts, *tables), responses, x, volts, MAX_FORCE_NN)
    }
    assert set(rows) == {
        "closing_curves",
        "opening_curves",
        "contact_begin",
        "pull_off",
        "hardness",
        "modulus",
        "release",
    }
    assert rows["contact_begin"]["reduction"] > 0.5
    assert rows["release"]["reduction"] > 0.7
    assert abs(rows["modulus"]["reduction"]) < 4 * rows["modulus"]["standard_error"] + 0.02


def test_next_on_pad_has_nothing_to_narrow_where_all_stick(prior, parts):
    x = prior.sample(40, 5)
    rows = next_on_pad(lambda tables: given(prior, parts, *tables), parts[0], x, np.zeros(40), MAX_FORCE_NN)
    assert all(row["reduction"] == 0 and row["width_now_V"] == 0 for row in rows)
