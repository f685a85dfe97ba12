"""The device stage from sample rows to its results."""

import warnings

import numpy as np
import pytest

from mesoscale.device.behaviour import (
    drive_switch,
    samples_json,
    samples_of_rows,
    state_rows,
)
from mesoscale.device.statistics import stiction_rows
from mesoscale.errors import InputError
from mesoscale.settings import DeviceSettings


def sample_rows(count, seed=0, C_r=6.4e-4):
    rng = np.random.default_rng(seed)
    rms = rng.uniform(2, 15, count)
    rows = []
    for each in rms:
        row = {"hamaker": rng.uniform(0.18, 0.25), "rms": each}
        for branch, shift in (("closing", 0.0), ("opening", -3.0)):
            row |= {
                f"{branch}_d_c_nm": 3.74 * each + shift,
                f"{branch}_C_a_GPa_nm": 15e-5,
                f"{branch}_C_r_GPa": C_r,
                f"{branch}_rho_r_nm": 0.389 * each,
            }
        rows.append({name: str(value) for name, value in row.items()})
    return rows


def test_study_meets_its_analytic_limits_and_counts_what_it_drops():
    rows = sample_rows(300)
    rows[7]["opening_C_r_GPa"] = "-1e-5"
    rows[9]["closing_rho_r_nm"] = ""
    settings = DeviceSettings()
    samples = samples_of_rows(rows, [], settings, 2.0, 2.0)
    results, states = drive_switch(samples, settings, law_pressure_MPa=7.0)
    assert results["samples"] == {"used": 298, "dropped": 2}
    assert results["checks"]["pull_in_relative_error"] < 1e-6
    assert results["checks"]["release_relative_error"] < 1e-6
    free, stuck = results["without_adhesion"], results["with_adhesion"]
    assert free["stiction_probability"]["value"] == 0
    assert stuck["release_V"]["mean"] < free["release_V"]["mean"]
    # the share of samples stuck is the distribution of the critical share, read at what comes off last
    critical = states["with_adhesion"].critical_fraction
    assert stuck["stiction_probability"]["value"] == pytest.approx(np.mean(critical < results["switch"]["last_share"]))
    assert len(state_rows(states)) == 2 * 298
    curve = [row["stiction_probability"] for row in stiction_rows(critical)]
    assert np.all(np.diff(curve) >= 0)


def test_adhesion_scale_reaches_the_samples():
    half = samples_of_rows(sample_rows(20), [], DeviceSettings(adhesion_scale=0.5), 2.0, 2.0)
    full = samples_of_rows(sample_rows(20), [], DeviceSettings(), 2.0, 2.0)
    np.testing.assert_allclose(half.laws["opening"].C_a_GPa_nm, 0.5 * full.laws["opening"].C_a_GPa_nm)


def test_no_usable_sample_is_one_clear_line():
    with pytest.raises(InputError, match=r"none of 10 samples has positive C_r.*uncertainty\.response: regression"):
        samples_of_rows(sample_rows(10, C_r=-1e-4), [], DeviceSettings(), 2.0, 2.0)


def test_nominal_law_is_the_mean_over_seeds_of_the_runs_at_central_inputs():
    fitted = [
        {
            "node": node,
            "branch": branch,
            "hamaker": "0.215",
            "d_c_nm": contact,
            "C_a_GPa_nm": "15e-5",
            "C_r_GPa": "6e-4",
            "rho_r_nm": "3",
        }
        for node, contact in (("0", "30"), ("0", "34"), ("5", "80"))
        for branch in ("closing", "opening")
    ]
    samples = samples_of_rows(sample_rows(20), fitted, DeviceSettings(), 2.0, 2.0)
    assert samples.nominal["closing"].d_c_nm == 32.0
    assert samples.nominal_from == "mean of 2 run(s) at central inputs"
    stored = samples_json(samples, DeviceSettings())
    assert stored["nominal"]["opening"]["d_c_nm"] == 32.0
    assert len(stored["samples"]["opening_rho_r_nm"]) == 20
    # without a fit at central inputs the samples themselves give it
    fitted[0]["C_r_GPa"] = fitted[2]["C_r_GPa"] = ""
    fallback = samples_of_rows(sample_rows(20), fitted, DeviceSettings(), 2.0, 2.0)
    assert "medians" in fallback.nominal_from


def test_a_switch_that_closes_without_snapping_has_no_pull_in_and_gives_no_warning():
    """Contact at 37 nm of a gap of 60 nm: the fold, at (2 g - t / eps) / 3 = 32 nm, is never reached."""
    rows = [{**row, "closing_d_c_nm": "37.4", "opening_d_c_nm": "34.4"} for row in sample_rows(50)]
    settings = DeviceSettings(gap_um=0.06, adhesion_scale=0.0)
    samples = samples_of_rows(rows, [], settings, 2.0, 2.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        results, states = drive_switch(samples, settings, law_pressure_MPa=7.0)
    assert np.isnan(states["with_adhesion"].pull_in_V).all()
    assert results["with_adhesion"]["pull_in_V"]["samples"] == 0
    assert np.isnan(results["checks"]["pull_in_relative_error"])
