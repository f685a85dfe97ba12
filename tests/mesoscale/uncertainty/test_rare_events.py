"""Probabilities of rare events against exact ones."""

import numpy as np
import openturns as ot
import pytest
from scipy.special import ndtr

from mesoscale.uncertainty.likeliest_process import likeliest
from mesoscale.uncertainty.rare_events import (
    LEAST,
    Corrected,
    Process,
    correct,
    quantiles_of,
    rates_given,
    sample_event,
)

SURE = 1e-9
DIMENSION = 6


def reserve(z, beta):
    """A plane at the distance beta from the origin: the event has the probability Phi(-beta)."""
    return beta - z.sum(axis=1) / np.sqrt(z.shape[1])


@pytest.mark.parametrize("beta", [0.0, 2.326, 4.753])
def test_a_plane_has_the_probability_of_its_distance(beta):
    found = sample_event(lambda z: (reserve(z, beta), np.full(len(z), SURE)), DIMENSION, 0.0, 1)
    assert found.probability == pytest.approx(ndtr(-beta), rel=4.0 * max(found.variation, 0.01))
    assert found.variation < 0.3
    assert (reserve(found.points, beta) <= 0.0).all()
    np.testing.assert_allclose(found.chance, 1.0)


def test_runs_state_their_own_scatter():
    """One in a million, ten times: the 90 % interval holds it at least seven times (p = 0.01)."""
    beta, held, shares, stated = 4.753, 0, [], []
    for seed in range(10):
        found = sample_event(
            lambda z: (reserve(z, beta), np.full(len(z), SURE)), DIMENSION, 0.0, seed
        )
        low, high = found.interval(0.9)
        held += low <= ndtr(-beta) <= high
        shares.append(found.probability)
        stated.append(found.variation)
    assert held >= 7
    # a deviation of ten is known to 24 %
    assert np.std(shares, ddof=1) / np.mean(shares) == pytest.approx(
        np.sqrt(np.mean(np.square(stated))), rel=0.6
    )


def test_an_event_that_always_happens_and_one_that_never_does():
    always = sample_event(lambda z: (reserve(z, -20.0), np.full(len(z), SURE)), DIMENSION, 0.0, 1)
    assert always.probability == pytest.approx(1.0)
    never = sample_event(lambda z: (reserve(z, 20.0), np.full(len(z), SURE)), DIMENSION, 0.0, 1)
    assert (never.probability, len(never.points)) == (0.0, 0)
    found = correct(never, np.empty(0, bool), np.empty(0))
    assert (found.probability, found.high) == (0.0, LEAST)


@pytest.mark.parametrize("shift", [-0.3, 0.3])
def test_runs_correct_a_response_that_is_wrong(shift):
    """A response that is off by its own deviation alone is wrong by a factor of 4; the interval
    holds the truth.
    """
    held = 0
    for seed in range(10):
        found = sample_event(
            lambda z: (reserve(z, 4.0) + shift, np.full(len(z), 0.3)), DIMENSION, 0.0, seed
        )
        chosen = np.random.default_rng(seed).permutation(len(found.points))[:256]
        corrected = correct(found, reserve(found.points[chosen], 4.0) <= 0.0, found.chance[chosen])
        held += corrected.low <= ndtr(-4.0) <= corrected.high
        assert abs(np.log(corrected.probability / ndtr(-4.0))) < 1.0
    assert held >= 8


def test_no_event_in_all_runs_leaves_an_upper_end():
    found = sample_event(lambda z: (reserve(z, 2.0), np.full(len(z), 0.3)), DIMENSION, 0.0, 1)
    none = correct(found, np.zeros(100, bool), found.chance[:100])
    assert isinstance(none, Corrected)
    assert none.low == none.probability == 0.0
    assert none.high == pytest.approx(0.03 * found.probability)


def test_a_process_foretells_a_smooth_function_and_leaves_out_what_does_not_vary():
    rng = np.random.default_rng(0)
    x = np.hstack([rng.uniform(-1, 1, (80, 3)), np.full((80, 1), 7.0)])
    y = x[:, 0] + np.exp(0.5 * x[:, 1]) + 0.2 * x[:, 1] * x[:, 2]
    process = Process(x[:60], y[:60])
    mean, deviation = process(x[60:])
    # largest in a corner, where the fit of the lengths decides and processors differ
    error = mean - y[60:]
    assert np.sqrt((error**2).mean()) < 0.01
    assert (np.abs(error) < 4 * deviation).all()
    assert (deviation < 0.05).all()


SLOPES = np.array([0.6, -0.3, 0.5, 0.55])


def _plane(distance, deviation=1e-9):
    return lambda z: (distance + z @ SLOPES, np.full(len(z), deviation))


def test_the_rate_by_what_is_common_is_that_of_a_plane():
    """Given the first two numbers, the reserve is normal: brute force is a formula, over five
    decades.
    """
    common = np.array([True, True, False, False])
    rates = rates_given(_plane(2.0), common, 0.0, 3)
    z = np.random.default_rng(1).normal(size=(200_000, 2))
    truth = ndtr(-(2.0 + z @ SLOPES[:2]) / np.linalg.norm(SLOPES[2:]))
    held = [
        row["low"] * 0.9 <= np.quantile(truth, float(q)) <= row["high"] * 1.1
        for q, row in quantiles_of(rates).items()
    ]
    assert all(held)
    assert rates.mean() == pytest.approx(truth.mean(), rel=0.3)
    for allowed in (1e-6, 1e-4, 1e-2):
        assert (rates < allowed).mean() == pytest.approx(
            (truth < allowed).mean(), abs=2.5 * 0.5 / np.sqrt(400)
        )


def test_quantiles_of_the_rate_hold_the_truth_in_18_of_20():
    common = np.array([True, True, False, False])
    z = np.random.default_rng(1).normal(size=(200_000, 2))
    truth = np.quantile(
        ndtr(-(2.0 + z @ SLOPES[:2]) / np.linalg.norm(SLOPES[2:])), [0.05, 0.5, 0.95]
    )
    held = np.zeros(3, int)
    for seed in range(20):
        rows = quantiles_of(rates_given(_plane(2.0), common, 0.0, seed)).values()
        held += [row["low"] <= value <= row["high"] for row, value in zip(rows, truth, strict=True)]
    assert held.min() >= 18


def test_all_common_fails_or_not_and_all_of_each_has_one_rate():
    wholly = rates_given(_plane(1.0), np.ones(4, bool), 0.0, 0)
    assert set(wholly) == {0.0, 1.0}
    share = float(ndtr(-1.0 / np.linalg.norm(SLOPES)))
    assert wholly.mean() == pytest.approx(share, abs=3.0 * np.sqrt(share / 400))
    single = rates_given(_plane(1.0), np.zeros(4, bool), 0.0, 0)
    np.testing.assert_allclose(single, share, rtol=0.4)  # 400 draws each
    assert single.mean() == pytest.approx(share, rel=0.02)


def test_the_error_of_the_response_is_common_too():
    """A reserve of 1 +- 1 by an unknown that all devices share."""
    rates = rates_given(_plane(1.0, 1.0), np.zeros(4, bool), 0.0, 0)
    for q, shift in ((0.5, 0.0), (0.95, 1.645)):
        assert np.quantile(rates, q) == pytest.approx(
            ndtr((shift - 1.0) / np.linalg.norm(SLOPES)), rel=0.15
        )


@pytest.mark.parametrize("seed", [4, 11])
def test_a_process_through_a_plane_with_noise_knows_the_noise(seed):
    """With seed 11 OpenTURNS 1.27 ends with the amplitude that was given, and a deviation of 4."""
    rng = np.random.default_rng(seed)
    x = rng.uniform(-1.0, 1.0, (40, 2))
    mean, deviation = Process(x, x.sum(axis=1) + 0.03 * rng.normal(size=40))(np.zeros((1, 2)))
    assert mean[0] == pytest.approx(0.0, abs=0.03)
    assert deviation[0] == pytest.approx(0.03, rel=0.3)


def test_a_process_is_that_of_openturns():
    """Mean and deviation, with a trend, noise, and an input that does not vary."""
    rng = np.random.default_rng(0)
    x = rng.normal(size=(80, 6))
    x[:, 3] = 1.0
    y = 2.0 + x[:, 0] - 0.5 * x[:, 1] + 0.3 * np.sin(2.0 * x[:, 2]) + 0.05 * rng.normal(size=80)
    ours = Process(x, y)
    varied = [0, 1, 2, 4, 5]
    scaled = 2.0 * (x[:, varied] - x[:, varied].min(axis=0)) / np.ptp(x[:, varied], axis=0) - 1.0
    found = likeliest(scaled, y)
    kernel = ot.MaternModel(found.lengths, [found.amplitude], 2.5)
    kernel.activateNuggetFactor(True)
    kernel.setNuggetFactor(found.noise)
    trend = ot.LinearBasisFactory(5).build()
    fitter = ot.GaussianProcessFitter(ot.Sample(scaled), ot.Sample(y[:, None]), kernel, trend)
    fitter.setOptimizeParameters(False)
    fitter.run()
    regression = ot.GaussianProcessRegression(fitter.getResult())
    regression.run()
    z = 1.5 * rng.normal(size=(50, 6))
    places = 2.0 * (z[:, varied] - x[:, varied].min(axis=0)) / np.ptp(x[:, varied], axis=0) - 1.0
    mean, deviation = ours(z)
    covariance = ot.GaussianProcessConditionalCovariance(regression.getResult())
    variance = np.array(covariance.getConditionalMarginalVariance(ot.Sample(places)))[:, 0]
    theirs = np.array(regression.getResult().getMetaModel()(ot.Sample(places)))[:, 0]
    assert mean == pytest.approx(theirs, abs=1e-6)
    assert deviation == pytest.approx(np.sqrt(variance), abs=1e-6)


def test_a_run_that_openturns_stops_by_rounding_is_made_with_other_numbers(monkeypatch):
    seeds = []

    def stopped_once(self):
        seeds.append(1)
        if len(seeds) == 1:
            raise TypeError("InvalidArgumentException : The variance estimate must be >= 0")
        return run(self)

    run = ot.SubsetSampling.run
    monkeypatch.setattr(ot.SubsetSampling, "run", stopped_once)
    found = sample_event(lambda z: (2.0 - z[:, 0], np.full(len(z), 1e-9)), 1, 0.0, 1, repeats=1)
    assert found.probability == pytest.approx(0.0228, rel=0.3)
    assert len(seeds) == 2
