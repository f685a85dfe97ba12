"""Markov chains that call the engine: a made-up engine whose posterior is known, the distance."""

import numpy as np
import pytest

from evidence.calibration import direct

DATA = np.array([20.0, 500.0])


def engine(values, seed):
    """First contact and pull-off force, each a line in one input with scatter of its own."""
    noise = np.random.default_rng(seed).standard_normal(2)
    return np.array(
        [3.4 * values["rms"] + 1.5 * noise[0], 500 * np.exp(8 * (values["hamaker"] - 0.21) + 0.3 * noise[1])]
    )


@pytest.fixture(autouse=True)
def made_up_engine(monkeypatch):
    monkeypatch.setattr(direct, "observed", engine)


def test_chain_over_surfaces_has_the_posterior_of_the_inputs():
    """Scatter of the surfaces integrated out: RMS is normal with deviation hypot(2, 1.5) / 3.4, inside its prior."""
    rms = direct.direct_chain(DATA, 0, 6000)[200:, direct.FREE.index("rms")]
    assert rms.mean() == pytest.approx(20 / 3.4, abs=0.15)  # some 300 independent draws: 0.04
    assert rms.std() == pytest.approx(np.hypot(2, 1.5) / 3.4, rel=0.2)


def test_weighed_cycles_have_the_posterior_of_the_inputs():
    """The same made-up engine: cycles over the prior, weighed by the data."""
    rms = direct.weighed_part(DATA, 0, 4000)[:, direct.FREE.index("rms")]
    assert rms.mean() == pytest.approx(20 / 3.4, abs=0.1)  # some 900 independent draws: 0.025
    assert rms.std() == pytest.approx(np.hypot(2, 1.5) / 3.4, rel=0.1)


def test_distance_of_like_and_unlike_distributions():
    rng = np.random.default_rng(1)
    parts = list(rng.standard_normal((8, 500, 2)))

    def distances(shift):
        rows = list(direct.compare("parts", parts, rng.standard_normal((4000, 2)) + shift))
        return [row["difference_in_errors"] for row in rows if row["quantity"] == "distance"]

    assert max(distances(0.0)) < 2
    assert min(distances(0.3)) > 8
