"""Responses of made-up observables with known coefficients and scatter: no contact cycle is
needed.
"""

import numpy as np
import pytest

from mesoscale.calibration.observables import NAMES, Cycles
from mesoscale.calibration.posterior import Model
from mesoscale.inputs.table import input_table

MAX_FORCE_NN = 7000.0


def made_up_observables(x, rng):
    """Observables of one surface per row of inputs (m, 7); shaped like those of the engine."""
    hamaker, e_star, _, h_prime, q0, hurst, rms = x.T
    begin = rms * (3.0 + 0.4 * hurst + 0.3 * rng.standard_normal(len(x)))
    steps = [
        rms
        * np.exp(
            -3.2
            + 0.01 * (e_star - 91)
            + 0.02 * h_prime
            + 10 * (q0 - 0.025)
            + 0.3 * rng.standard_normal(len(x))
        )
        for _ in range(5)
    ]
    pull_off = np.exp(4.5 + 8 * (hamaker - 0.21) - 0.08 * rms + 0.3 * rng.standard_normal(len(x)))
    touch = rms * np.exp(1.2 + 0.1 * rng.standard_normal(len(x)))
    return np.column_stack([begin, *steps, begin - 1, *steps, touch, pull_off])


@pytest.fixture(scope="session")
def prior():
    return input_table()


@pytest.fixture(scope="session")
def cycles(prior):
    x = prior.sample(900, 3)
    y = made_up_observables(x, np.random.default_rng(3))
    assert y.shape[1] == len(NAMES)
    return Cycles(x, y)


@pytest.fixture(scope="session")
def model(prior, cycles):
    return Model(prior, cycles, {}, MAX_FORCE_NN)
