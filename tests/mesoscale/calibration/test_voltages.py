"""Voltages of made-up switches on pads over the prior: what they teach is known."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.answer.points import Point, plan_points
from mesoscale.answer.switches import PadModel, Solved
from mesoscale.calibration.measurements import Measurements
from mesoscale.calibration.posterior import Calibration, Model
from mesoscale.calibration.summary import predictive_rows
from mesoscale.calibration.voltages import fit_voltages
from mesoscale.errors import InputError
from mesoscale.settings import ContactSettings
from mesoscale.studies.answer_stability import published_beam
from mesoscale.switch import States
from tests.mesoscale.calibration.conftest import MAX_FORCE_NN

EACH_V, SHARED_V = 0.5, 1.0


def pads(prior, count=200, middle_V=20.0):
    """Releases that fall by 2 V a nanometre of RMS, with scatter by the first property of each
    device and by D0.
    """
    settings = published_beam()
    design = plan_points(prior, ContactSettings(mechanics="asperity"), settings, count)
    each = design.varies.index("each")
    d0 = design.names.index("gap_cutoff_nm")
    scaled = np.sqrt(12) * (design.probability - 0.5)
    points = []
    for k, point in enumerate(design.points):
        release = (
            middle_V
            - 2 * (point.values["rms"] - 8.5)
            + EACH_V * scaled[k, each]
            - SHARED_V * scaled[k, d0]
        )
        states = States(60.0 + 0.1 * release, max(release, 0.0), 8e3)
        points.append(Solved(point, None, states, (release, release)))
    central = Solved(Point(prior.medians(), 0.2, settings), None, None, (0.0, 0.0), "not needed")
    return PadModel(central, design, tuple(points))


def measured(kind, values, error=0.1):
    values = np.asarray(values, float)
    columns = {kind: values, f"{kind}_error": np.full_like(values, error)}
    return Measurements(
        kind, columns, tuple(f"s{k}" for k in range(len(values))), False, 0.0, f"{kind}.csv"
    )


def sticking(stuck, switches):
    columns = {"stuck": np.array([float(stuck)]), "switches": np.array([float(switches)])}
    return Measurements("sticking", columns, ("s",), False, 0.0, "sticking.csv")


@pytest.fixture(scope="module")
def switches(prior, cycles):
    return Model(prior, cycles, fit_voltages(pads(prior), prior), MAX_FORCE_NN)


def test_mean_and_scatter_are_told_apart(prior, switches):
    release = switches.voltages["release"]
    x = prior.sample(500, 3)
    assert release(x) == pytest.approx(20 - 2 * (x[:, 6] - 8.5), abs=0.2)
    assert release.each_V == pytest.approx(EACH_V, rel=0.1)
    assert release.shared_V == pytest.approx(SHARED_V, rel=0.1)
    assert switches.voltages["pull_in"](x) == pytest.approx(62 - 0.2 * (x[:, 6] - 8.5), abs=0.02)


def test_switches_that_stick_count_below_zero(prior):
    """Half of the switches stick: the line of the others goes on below zero, where least squares
    would end at it.
    """
    release = fit_voltages(pads(prior, middle_V=0.0), prior)["release"]
    x = np.array([[0.21, 91.0, 1.5, 8.0, 0.022, 0.8, rms] for rms in (3.0, 8.5, 14.0)])
    assert release(x) == pytest.approx([11.0, 0.0, -11.0], abs=1.2)


@pytest.mark.parametrize("count", [150, 190, 250, 400])
def test_switches_that_stick_do_not_bias_the_others(prior, count):
    """Lines through known and sticking switches are those that made them, whatever their number."""
    release = fit_voltages(pads(prior, count, middle_V=0.0), prior)["release"]
    x = np.array([[0.21, 91.0, 1.5, 8.0, 0.022, 0.8, rms] for rms in (3.0, 8.5, 14.0)])
    # the made-up switches have no other scatter
    assert release(x) == pytest.approx([11.0, 0.0, -11.0], abs=0.05)
    assert release.each_V == pytest.approx(EACH_V, rel=0.1)
    assert release.shared_V == pytest.approx(SHARED_V, rel=0.1)


def test_measured_releases_find_the_roughness(prior, switches):
    """Ten switches on one film: what they share stays, what each has of its own averages out."""
    data = measured("release", 22.0 + EACH_V * np.random.default_rng(1).standard_normal(10))
    posterior = switches.posterior([data])
    chain = posterior.draw()
    x = posterior.inputs(chain.z)
    assert chain.converged
    assert x[:, 6].mean() == pytest.approx(7.5, abs=0.2)
    assert x[:, 6].std() == pytest.approx(0.5 * np.hypot(SHARED_V, EACH_V / np.sqrt(10)), rel=0.15)
    result = Calibration((data,), switches, posterior, chain, x, {})
    (row,) = [row for row in predictive_rows(result) if row["quantity"] == "release"]
    assert row["posterior_q05"] < 22.0 < row["posterior_q95"]
    assert row["posterior_q95"] - row["posterior_q05"] < 0.4 * (row["prior_q95"] - row["prior_q05"])


def test_switches_that_stuck_are_rough_ones(prior, cycles):
    model = Model(prior, cycles, fit_voltages(pads(prior, middle_V=0.0), prior), MAX_FORCE_NN)
    posterior = model.posterior([sticking(20, 20)])
    x = posterior.inputs(posterior.draw().z)
    assert np.quantile(x[:, 6], 0.05) > 7.0
    assert posterior.simulated(x[:1], np.random.default_rng(1)).data[0].stuck[0] > 10


def test_voltages_that_no_switch_has_are_refused(switches):
    switches.check_range(measured("release", [25.0]))
    for kind, volts in (("release", 500.0), ("pull_in", 0.1)):
        with pytest.raises(InputError, match=f"{kind} = {volts:g}: the model gives"):
            switches.check_range(measured(kind, [volts]))


def test_too_few_switches_are_refused(prior):
    model = pads(prior, 30)
    stuck = tuple(
        replace(point, states=replace(point.states, release_V=0.0)) for point in model.points
    )
    with pytest.raises(InputError, match=r"pad\.points: 0 of 30 switches over the prior let go"):
        fit_voltages(replace(model, points=stuck), prior)
