"""A device of which something was measured: what remains unknown of it."""

import numpy as np
import pytest

from mesoscale.answer.departures import departed_properties, with_properties
from mesoscale.answer.measured import (
    Solved,
    _posterior,
    narrowed,
    observed,
    over_prior,
    what_remains,
)
from mesoscale.answer.spread import departures, properties_at, typical
from mesoscale.errors import InputError
from mesoscale.studies.answer_stability import published_beam
from mesoscale.switch.beam import beam_of
from mesoscale.switch.resonance import lowest_kHz

FEW = {"bow_nm": None, "tilt_nm": None, "permittivity": None, "dielectric_nm": None}
"""Four properties vary: a posterior of few beams."""


def device(**changes):
    return published_beam(spread=FEW, density_g_cm3=8.9, **changes)


def properties(found, settings, count=1000):
    rng = np.random.default_rng(0)
    moved = found.table.transform(rng.random((count, len(settings.varied))))
    return departed_properties(settings, moved)


@pytest.mark.parametrize(("ends", "number"), [("clamped", 1.027911), ("cantilever", 0.161540)])
def test_the_resonance_is_that_of_euler_and_bernoulli(ends, number):
    """f = 1.027911 sqrt(E / rho) t / L^2 clamped at both ends, 0.161540 at one."""
    settings = published_beam(ends=ends, bends_as="beam")
    exact = number * np.sqrt(89.3e9 / 8900.0) * 4e-6 / 510e-6**2 / 1e3
    assert lowest_kHz(beam_of(settings, 32), settings) == pytest.approx(exact, rel=1e-5)


def test_a_tense_beam_sounds_like_a_string_and_one_about_to_buckle_hardly():
    tense = published_beam(residual_stress_MPa=2000.0, thickness_um=0.1)
    string = np.sqrt(0.7 * 2000e6 / 8900.0) / (2.0 * 510e-6) / 1e3
    assert lowest_kHz(beam_of(tense, 32), tense) == pytest.approx(string, rel=0.01)
    near = published_beam(residual_stress_MPa=-28.4)
    assert lowest_kHz(beam_of(near, 32), near) < 10.0


def test_a_measured_pull_in_is_that_of_the_devices_that_remain():
    settings = device(measured={"pull_in_V": "72 +- 1"})
    found = narrowed(settings)
    volts = [
        observed(with_properties(settings, row))["pull_in_V"]
        for row in properties(found, settings, 40)
    ]
    before_V = found.stated["pull_in_V"][1]
    assert before_V > 5.0
    assert np.mean(volts) == pytest.approx(72.0, abs=0.6)
    assert np.std(volts) < 1.6
    assert observed(typical(settings))["pull_in_V"] == pytest.approx(72.0, abs=0.6)
    assert typical(settings).measured is None
    assert found.doubt == ""


def test_pull_in_alone_does_not_tell_the_stiffness_from_the_gap():
    """V^2 is as E t^3 g^3: what remains lies on a ridge, where none of them is known."""
    settings = device(measured={"pull_in_V": "75.6 +- 0.3"})
    found = narrowed(settings)
    remains = dict(zip(settings.varied, found.after / found.before, strict=True))
    assert min(remains[name] for name in ("thickness_um", "gap_um", "youngs_modulus_GPa")) > 0.9
    thickness, gap, _, stress = properties(found, settings).T
    assert np.corrcoef(thickness, stress)[0, 1] < -0.1
    assert np.corrcoef(gap, stress)[0, 1] < -0.1
    with_capacitance = device(measured={"pull_in_V": "75.6 +- 0.3", "capacitance_fF": "171.6 +- 1"})
    place = settings.varied.index("gap_um")
    assert narrowed(with_capacitance).after[place] < 0.5 * found.after[place]


def test_made_up_devices_lie_in_their_own_posteriors():
    """Eight devices, four properties each: of 90 % intervals at least 24 of 32 hold the truth."""
    rng = np.random.default_rng(5)
    settings, held = device(), []
    truths = properties_at(settings, rng.random((8, len(settings.varied))))
    for truth in truths:
        value = observed(with_properties(settings, truth))["pull_in_V"] + rng.normal()
        measured = device(measured={"pull_in_V": (value, 1.0)})
        low, high = np.quantile(properties(narrowed(measured), measured), (0.05, 0.95), axis=0)
        held.append((low < truth) & (truth < high))
    assert np.sum(held) >= 24


@pytest.mark.parametrize(
    ("measured", "words"),
    [
        (
            {"pull_in_V": "30 +- 1"},
            r"measured.pull_in_V = 30 \+- 1 contradicts the stated device, which has 75.* \+- ",
        ),
        ({"capacitance_fF": "90 +- 1"}, "measured.capacitance_fF = 90"),
        (
            {"pull_in_V": "84 +- 0.5", "resonance_kHz": "49 +- 0.2"},
            "pull_in_V and resonance_kHz contradict each other",
        ),
    ],
)
def test_what_contradicts_what_is_said_in_one_line(measured, words):
    with pytest.raises(InputError, match=words) as caught:
        departures(device(measured=measured))
    assert "\n" not in str(caught.value)


def test_a_doubtful_measurement_is_said_and_kept():
    over = over_prior(device().model_copy(update={"hold_voltage_V": None}))
    volts = np.exp(over.logarithms[:, 0])
    far_V = volts.mean() + 3.4 * volts.std()
    said = what_remains(device(measured={"pull_in_V": (far_V, 1.0)}))
    assert "contradicts the stated device" in said["doubt"]
    assert [row["name"] for row in said["properties"]] == device().varied


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"measured": {"pull_in_V": "72"}}, "value and its standard error, as in 72"),
        ({"measured": {"pull_in_V": "72 +- 0"}}, "accepted is above 0"),
        ({"measured": {"resonance_kHz": "52 +- 1"}}, "needs the density of the beam"),
        (
            {"measured": {"capacitance_fF": "52 +- 1"}, "spring_N_per_m": 5.0},
            "measured narrows a beam",
        ),
    ],
)
def test_a_measurement_that_is_none_is_refused_in_one_line(changes, words):
    with pytest.raises(InputError, match=words) as caught:
        published_beam(**changes)
    assert "\n" not in str(caught.value)


def test_a_beam_that_touches_first_is_not_measured_by_its_pull_in():
    dimple = {"electrode": (0.2, 0.8), "contact": (0.4, 0.6), "dimple_nm": 3200.0}
    with pytest.raises(InputError, match="touches before it snaps"):
        departures(device(**dimple, measured={"pull_in_V": "45 +- 1"}))


def test_a_wide_prior_is_narrowed_step_by_step():
    """A normal number of deviation 1, measured with 0.001: no draw of the prior is near enough."""
    rng = np.random.default_rng(1)
    z = rng.standard_normal((300, 2))
    logarithms = np.column_stack([5.0 + 0.3 * z[:, 0], 2.0 + 0.1 * z[:, 1], 1.0 + 0.0 * z[:, 0]])
    value = np.exp(5.0 + 0.3 * 1.7)
    draws = _posterior(Solved(z, logarithms), [0], np.array([value]), np.array([1e-3 * value]), rng)
    assert draws[:, 0].mean() == pytest.approx(1.7, abs=0.001)
    assert draws[:, 0].std() == pytest.approx(1e-3 / 0.3, rel=0.1)
    assert draws[:, 1].std() == pytest.approx(1.0, rel=0.1)
