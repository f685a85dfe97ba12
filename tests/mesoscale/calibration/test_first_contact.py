"""A first contact with a normal error in nm, against brute force over its inverse."""

import numpy as np
import pytest

from mesoscale.calibration.first_contact import first_contacts
from mesoscale.calibration.likelihood import posterior_of
from mesoscale.calibration.measurements import Measurements
from mesoscale.calibration.posterior import expected_of, responses_of
from tests.mesoscale.calibration.conftest import MAX_FORCE_NN

PRIOR = (0.04, 0.015**2)


def brute_force(value, error, mean, variance):
    """ln of the integral of N(value; 1/f, error) over f ~ N(mean, variance)."""
    f = np.linspace(1e-4, 0.5, 2_000_001)
    logs = -0.5 * ((value - 1 / f) / error) ** 2 - 0.5 * (f - mean) ** 2 / variance
    density = np.exp(logs) / (2 * np.pi * error * np.sqrt(variance))
    return np.log(density.sum() * (f[1] - f[0]))


@pytest.mark.parametrize("error", [0.01, 0.5, 2.0, 6.0])
@pytest.mark.parametrize("mean", [0.035, 0.05, 0.065])
def test_likelihood_of_one_datum_is_exact(error, mean):
    """Scatter of a tenth; 6 nm of 20 nm is the worst: 0.02 in the logarithm."""
    variance = (0.1 * mean) ** 2
    data = first_contacts(np.array([20.0]), np.array([error]), *PRIOR)
    normal = -0.5 * (mean - data.inverse) ** 2 / (variance + data.variances)
    normal -= 0.5 * np.log(2 * np.pi * (variance + data.variances))
    found = normal[0] + data.correction(np.array([mean]), np.array([variance]))[0]
    assert found == pytest.approx(brute_force(20.0, error, mean, variance), abs=0.02 if error > 5 else 1e-3)


def test_a_precise_datum_is_its_inverse():
    data = first_contacts(np.array([20.0]), np.array([0.01]), *PRIOR)
    assert data.inverse == pytest.approx([1 / 20], rel=1e-5)
    assert np.sqrt(data.variances) == pytest.approx([0.01 / 400], rel=1e-4)


def test_posterior_uses_it(prior, cycles):
    """One first contact known to 3 nm: the likelihood at given inputs by brute force over the surfaces there."""
    responses, laws = responses_of(prior, cycles)
    columns = {"contact_begin": np.array([18.0]), "contact_begin_error": np.array([3.0])}
    data = Measurements("contact_begin", columns, ("a",), False, 0.0, "begin.csv")
    posterior = posterior_of(prior, [data], responses, laws, None, MAX_FORCE_NN, expected_of(cycles))
    x = prior.sample(200, 4)
    x = x[(x[:, 6] > 4) & (x[:, 6] < 8)]
    prediction = responses.pick(["contact_begin_nm"])(x)
    wanted = [
        brute_force(18.0, 3.0, mean, scatter * (1 + error))
        for mean, scatter, error in zip(
            prediction.mean[:, 0], prediction.scatter[:, 0, 0], prediction.error, strict=True
        )
    ]
    assert posterior.log_likelihood(x) == pytest.approx(np.array(wanted), abs=5e-3)
