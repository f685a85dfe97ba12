"""Markov chains that call the engine: a made-up engine whose posterior is known, an interrupted chain, the distance."""

import numpy as np
import pytest

from mesoscale.calibration.studies import direct

DATA = np.array([20.0, 500.0])


def engine(values, seed):
    """First contact and pull-off force, each a line in one input with scatter of its own."""
    noise = np.random.default_rng(seed).standard_normal(2)
    return np.array(
        [3.4 * values["rms"] + 1.5 * noise[0], 500 * np.exp(8 * (values["hamaker"] - 0.21) + 0.3 * noise[1])]
    )


@pytest.fixture
def chain(monkeypatch, tmp_path):
    monkeypatch.setattr(direct, "observed", engine)

    def run(steps, name="chain.txt"):
        monkeypatch.setattr(direct, "STEPS", steps)
        return direct.direct_chain(direct.prior(), DATA, 0, tmp_path / name)

    return run


def test_chain_over_surfaces_has_the_posterior_of_the_inputs(chain):
    """Scatter of the surfaces integrated out: RMS is normal with deviation hypot(2, 1.5) / 3.4, inside its prior."""
    rms = chain(6000)[200:, direct.FREE.index("rms")]
    assert rms.mean() == pytest.approx(20 / 3.4, abs=0.15)  # some 300 independent draws: 0.04
    assert rms.std() == pytest.approx(np.hypot(2, 1.5) / 3.4, rel=0.2)


def test_an_interrupted_chain_goes_on_as_if_it_had_not_been(chain, tmp_path):
    whole = chain(300)
    part = tmp_path / "part.txt"
    text = (tmp_path / "chain.txt").read_text()
    part.write_text(text[: len(text) // 2])  # cut within a line
    assert np.array_equal(chain(300, "part.txt"), whole)
    assert part.read_text() == text


def test_weighed_cycles_have_the_posterior_of_the_inputs(monkeypatch, tmp_path):
    """The same made-up engine: cycles over the prior, weighed by the data."""

    def observe(runs, *_):
        names = ("contact_begin_nm", "pull_off_nN")
        return [{**run.values, **dict(zip(names, engine(run.values, run.seed), strict=True))} for run in runs]

    monkeypatch.setattr(direct, "observe_runs", observe)
    monkeypatch.setattr(direct, "PART_RUNS", 4000)
    rms = direct.weighed_part(direct.prior(), DATA, 0, tmp_path / "part.csv")[:, direct.FREE.index("rms")]
    assert rms.mean() == pytest.approx(20 / 3.4, abs=0.1)  # some 900 independent draws: 0.025
    assert rms.std() == pytest.approx(np.hypot(2, 1.5) / 3.4, rel=0.1)
    again = direct.weighed_part(direct.prior(), DATA, 0, tmp_path / "part.csv")
    assert np.array_equal(again[:, direct.FREE.index("rms")], rms)


def test_distance_of_like_and_unlike_distributions():
    rng = np.random.default_rng(1)
    parts = list(rng.standard_normal((8, 500, 2)))

    def distances(shift):
        rows = direct.compare("parts", parts, rng.standard_normal((4000, 2)) + shift)
        return [row["difference_in_errors"] for row in rows if row["quantity"] == "distance"]

    assert max(distances(0.0)) < 2
    assert min(distances(0.3)) > 8
