"""Lengths and noise of a Gaussian process against another code, finite differences and truth."""

import numpy as np
import pytest
from scipy.optimize import minimize

from mesoscale.errors import InputError
from mesoscale.uncertainty import likeliest_process
from mesoscale.uncertainty.likeliest_process import LENGTHS, NOISES, likeliest
from mesoscale.uncertainty.rare_events import Process

RUNS, INPUTS = 60, 4


def made_up(noise=0.05, seed=3, runs=RUNS):
    rng = np.random.default_rng(seed)
    x = rng.uniform(-1, 1, (runs, INPUTS))
    y = np.sin(1.5 * x[:, 0]) + 0.25 * x[:, 1] ** 2 + noise * rng.normal(size=runs)
    return x, y


def by_openturns(x, y):
    """The same search by the library, with another algorithm and slopes by differences."""
    import openturns as ot

    kernel = ot.MaternModel([2.0] * INPUTS, [1.0], 2.5)
    kernel.activateNuggetFactor(True)
    trend = ot.LinearBasisFactory(INPUTS).build()
    fitter = ot.GaussianProcessFitter(ot.Sample(x), ot.Sample(y[:, None]), kernel, trend)
    search = ot.TNC()
    search.setMaximumCallsNumber(100_000)
    for error in ("Absolute", "Relative", "Residual", "Constraint"):
        getattr(search, f"setMaximum{error}Error")(1e-12)
    fitter.setOptimizationAlgorithm(search)
    low, high = np.array([*[LENGTHS] * INPUTS, NOISES]).T
    fitter.setOptimizationBounds(ot.Interval(low.tolist(), high.tolist()))
    fitter.run()
    *lengths, noise, amplitude, _ = fitter.getResult().getCovarianceModel().getFullParameter()
    return lengths, noise, amplitude


def test_the_maximum_is_that_of_another_code():
    x, y = made_up()
    found = likeliest(x, y)
    lengths, noise, amplitude = by_openturns(x, y)
    assert found.lengths == pytest.approx(lengths, rel=1e-3)
    assert found.noise == pytest.approx(noise, rel=1e-3)
    assert found.amplitude == pytest.approx(amplitude, rel=1e-3)


def test_slopes_are_those_of_finite_differences():
    x, y = made_up()
    squares = (x[:, None, :] - x[None, :, :]) ** 2
    trend = np.column_stack([np.ones(RUNS), x])
    point = np.log([0.7, 1.5, 2.0, 3.0, 0.02])

    def cost(place):
        at = likeliest_process._at(place, squares, trend, y)
        return likeliest_process._cost(at, squares)

    step = 1e-6
    by_differences = [
        (cost(point + step * axis)[0] - cost(point - step * axis)[0]) / (2 * step)
        for axis in np.eye(INPUTS + 1)
    ]
    assert cost(point)[1] == pytest.approx(by_differences, rel=1e-6, abs=1e-6)


def test_noise_and_length_of_drawn_processes_are_found():
    """Mean logarithms of 20 are those of the truth within three errors; many lengths lie in the
    range, as few of them have a likelihood that is biased.
    """
    length, noise, runs = 0.1, 0.01, 120
    found = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        x = rng.uniform(-1, 1, (runs, 1))
        apart = np.sqrt(5.0) * np.abs(x - x.T) / length
        correlation = (1 + apart + apart**2 / 3) * np.exp(-apart) + noise * np.eye(runs)
        fitted = likeliest(x, np.linalg.cholesky(correlation) @ rng.normal(size=runs))
        of_noise = fitted.noise * fitted.amplitude**2 / noise
        found.append(np.log([fitted.lengths[0] / length, of_noise, fitted.amplitude]))
    error = np.std(found, axis=0, ddof=1) / np.sqrt(len(found))
    assert (np.abs(np.mean(found, axis=0)) < 3 * error).all()


def test_the_library_foretells_with_what_was_found():
    """Mean and deviation beside the formulas of universal kriging."""
    x, y = made_up()
    low, width = x.min(axis=0), np.ptp(x, axis=0)
    u = 2 * (x - low) / width - 1
    found = likeliest(u, y)
    new = np.random.default_rng(5).uniform(-1, 1, (20, INPUTS))
    v = 2 * (new - low) / width - 1

    def correlation(a, b):
        apart = np.sqrt(5 * ((a[:, None] - b[None]) ** 2 @ found.lengths**-2.0))
        return (1 + apart + apart**2 / 3) * np.exp(-apart)

    inverse = np.linalg.inv(correlation(u, u) + found.noise * np.eye(RUNS))
    trend, new_trend = (np.column_stack([np.ones(len(of)), of]) for of in (u, v))
    slopes = np.linalg.solve(trend.T @ inverse @ trend, trend.T @ inverse @ y)
    across = correlation(v, u)
    mean = new_trend @ slopes + across @ inverse @ (y - trend @ slopes)
    left = new_trend - across @ inverse @ trend
    of_trend = np.einsum("mi,ij,mj->m", left, np.linalg.inv(trend.T @ inverse @ trend), left)
    known = np.einsum("mi,ij,mj->m", across, inverse, across)
    of_library, deviation = Process(x, y)(new)
    assert of_library == pytest.approx(mean, rel=1e-6, abs=1e-8)
    variance = found.amplitude**2 * (1.0 + of_trend - known)
    noisy = variance + found.amplitude**2 * found.noise
    assert np.allclose(deviation**2, variance) or np.allclose(deviation**2, noisy)


@pytest.mark.parametrize("values", ["line", "twice"])
def test_values_without_a_process_have_one(values):
    x, y = made_up(0.0)
    if values == "line":
        y = 2.0 + x @ np.arange(1.0, INPUTS + 1)
    if values == "twice":
        x, y = np.tile(x, (2, 1)), np.tile(y, 2)
    mean, deviation = Process(x, y)(x)
    assert mean == pytest.approx(y, abs=1e-3)
    assert np.isfinite(deviation).all()


def test_a_search_that_does_not_settle_is_refused(monkeypatch):
    monkeypatch.setattr(likeliest_process, "MOST_STEPS", 2)
    with pytest.raises(InputError, match="did not settle in 2 steps"):
        likeliest(*made_up())


def test_a_search_that_ends_by_rounding_goes_on(monkeypatch):
    """The first search is cut short, as L-BFGS-B is where one step gains nothing."""
    sought = []

    def cut_short(*arguments, options, **others):
        sought.append(arguments[1])
        if len(sought) == 1:
            options = options | {"maxiter": 3}
        return minimize(*arguments, options=options, **others)

    whole = likeliest(*made_up())
    monkeypatch.setattr("scipy.optimize.minimize", cut_short)
    again = likeliest(*made_up())
    assert len(sought) == 2
    assert again.log_likelihood == pytest.approx(whole.log_likelihood, abs=1e-4)


def test_random_functions_all_settle():
    for seed in range(40):
        rng = np.random.default_rng([741129, seed])
        runs, inputs = int(rng.integers(32, 160)), int(rng.integers(1, 12))
        x = rng.uniform(-1, 1, (runs, inputs))
        y = np.sin(rng.uniform(0.1, 6) * x @ rng.normal(size=inputs))
        y += 10.0 ** rng.uniform(-8, 0.5) * rng.normal(size=runs)
        y = 10.0 ** rng.uniform(-6, 6) * y + rng.choice([0.0, 1e3])
        found = likeliest(x, y)
        assert np.isfinite([*found.lengths, found.noise, found.amplitude]).all()
