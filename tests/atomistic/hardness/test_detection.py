"""The error rates are those of the detector, and within their bounds at the noise of the runs of scene reduced."""

import numpy as np
import pytest
from atomistic.hardness.studies import detection
from atomistic.hardness.studies.detection import detection_points, noise_of

from atomistic.settings import HardnessSettings

SETTINGS = HardnessSettings()


def run(noise, correlation=0.4, background=4, seed=0):
    """Curve and witness of a run with that relative noise about a smooth curve."""
    rng = np.random.default_rng(seed)
    length = np.linspace(0.2, 5.0, 60)
    shocks = rng.normal(0, noise * np.sqrt(1 - correlation**2), len(length))
    values = np.zeros(len(length))
    for k in range(1, len(length)):
        values[k] = correlation * values[k - 1] + shocks[k]
    curve = [
        {
            "time_ps": 10 * x,
            "displacement_nm": 0.2 + 0.2 * x,
            "contact_length_nm": x,
            "contact_area_nm2": x**2,
            "contact_stress_GPa": 10 * (0.7 + x / 10) * (1 + e),
            "temperature_K": 300.0,
            "energy_drift_meV_per_atom": 0.0,
        }
        for x, e in zip(length.tolist(), values.tolist(), strict=True)
    ]
    witness = [
        {"displacement_nm": 0.1 * k, "new_exchanges": background if k else 0, "lowering_nm": 0.0} for k in range(7)
    ]
    return curve, witness


@pytest.mark.parametrize("noise", [0.02, 0.06])
def test_noise_is_measured(noise):
    measured = (noise_of(run(noise, seed=k)[0], SETTINGS, 64.0) for k in range(20))
    found = np.array([each for each in measured if each is not None])
    deviation, correlation = np.mean(found, axis=0)
    assert deviation == pytest.approx(noise, rel=0.15)
    assert 0.1 < correlation < 0.5  # taking out a smooth curve takes some of the correlation with it


def test_a_curve_too_short_has_no_noise():
    assert noise_of(run(0.05)[0][:25], SETTINGS, 64.0) is None


@pytest.mark.parametrize(("noise", "background"), [(0.01, 2), (0.057, 36)])
def test_rates_keep_their_bounds(noise, background, monkeypatch):
    monkeypatch.setattr(detection, "TRIALS", 100)
    curve, witness = run(noise, background=background, seed=2)
    rows = detection_points([curve], [witness], [64.0], SETTINGS)
    assert {row["knob"] for row in rows} == {"noise, median of the runs", "noise, largest of the runs"}
    assert [row["case"] for row in rows if not row["passed"]] == []
