"""Tables of measurements: units, and what is refused in one line."""

import numpy as np
import pytest

from mesoscale.calibration.measurements import load_measurements
from mesoscale.errors import InputError
from mesoscale.settings import MeasurementTable

CURVE = "specimen,separation_nm,force_nN,separation_error_nm\n"
DRIFT = "hold_V,time_s,shift_V,shift_error_V\n60,1,0.2,0.05\n60,10,0.4,0.05\n70,10,1.1,0.05\n"
WEATHER = (
    "hold_V,time_min,shift_mV,shift_error_V,rest_h,temperature_C,humidity_percent\n"
    "60,1,200,0.05,9,20,50\n70,1,400,0.05,0,40,10\n"
)
POINTS = "".join(f"a,{40 - k},{200 * 1.5**k},0.1\n" for k in range(6))


def load(tmp_path, kind, text, **more):
    file = tmp_path / "data.csv"
    file.write_text(text, encoding="utf-8")
    return load_measurements(MeasurementTable(kind=kind, file=str(file), **more))


def test_units_are_converted(tmp_path):
    data = load(tmp_path, "pull_off", "pull_off_uN,pull_off_error_nN\n0.2,20\n")
    assert data.columns["pull_off"] == pytest.approx([200.0])
    assert data.columns["pull_off_error"] == pytest.approx([20.0])
    curve = load(tmp_path, "closing_curves", "# by hand\n" + CURVE + POINTS)
    assert len(curve) == 6
    assert curve.columns["separation"][0] == 40


def test_a_drift_is_read_with_its_conditions(tmp_path):
    data = load(tmp_path, "drift", WEATHER)
    assert data.columns["time"] == pytest.approx([60.0, 60.0])
    assert data.columns["shift"] == pytest.approx([0.2, 0.4])
    assert data.columns["rest"] == pytest.approx([32400.0, 0.0])
    assert data.columns["humidity"] == pytest.approx([0.5, 0.1])
    assert set(load(tmp_path, "drift", DRIFT).columns) == {"hold", "time", "shift", "shift_error"}


def test_rows_without_specimen_are_surfaces_of_their_own(tmp_path):
    data = load(tmp_path, "pull_off", "pull_off_nN,pull_off_error_nN\n200,20\n210,20\n")
    assert len(set(data.specimens)) == 2


@pytest.mark.parametrize(
    ("kind", "text", "words"),
    [
        ("pull_off", "pull_off,pull_off_error_nN\n200,20\n", "no unit"),
        ("pull_off", "pull_off_kg,pull_off_error_nN\n200,20\n", "unknown unit"),
        ("pull_off", "pull_off_nN,pull_off_error_nN\n200,-20\n", "an error is positive"),
        ("pull_off", "pull_off_nN,pull_off_error_nN\n200,0\n", "an error is positive"),
        ("pull_off", "pull_off_nN,pull_off_error_nN\n20,200\n5,90\n", "swapped"),
        ("pull_off", "pull_off_nN,pull_off_error_nN\n-200,20\n", "positive"),
        ("pull_off", "pull_off_nN,pull_off_error_nN\n", "no rows"),
        ("pull_off", "pull_off_nN,pull_off_error_nN\nabc,3\n", "finite number"),
        ("pull_off", "pull_off_nN,pull_off_uN,pull_off_error_nN\n1,1,3\n", "twice"),
        ("closing_curves", "specimen,separation_nm,force_nN\na,1,2\n", "no errors"),
        ("closing_curves", "separation_nm,force_nN,force_error_nN\n1,2,1\n", "specimen"),
        ("closing_curves", CURVE + POINTS.replace(",0.1", ",-0.1"), "an error is positive"),
        ("closing_curves", CURVE + POINTS.replace(",0.1", ",0"), "both errors are zero"),
        (
            "closing_curves",
            "specimen,separation,force_nN,separation_error_nm\n" + POINTS,
            "no unit",
        ),
        ("pull_in", "pull_in_V,pull_in_error_V\n0.1,60\n", "swapped"),
        ("modulus", "e_star_error_GPa,e_star_GPa\n91,3\n", "swapped"),
        ("drift", DRIFT.replace("60,1", "70,1"), "one voltage does not tell"),
        ("drift", DRIFT.replace("70,10,", "70,-10,"), "a time is not below zero"),
        ("drift", DRIFT.replace("70,10,", "-70,10,"), "a hold is above 0 V"),
        ("drift", DRIFT.replace(",0.05", ",0"), "an error is positive"),
        ("drift", DRIFT.replace("time_s", "time"), "no unit"),
        ("drift", DRIFT.replace("time_s", "time_years"), "unknown unit"),
        ("drift", "hold_V,shift_V,shift_error_V\n60,1,0.1\n70,1,0.1\n", "no column time"),
        ("drift", WEATHER.replace("20,50", "-300,50"), "above -273.15"),
        ("drift", WEATHER.replace("20,50", "20,150"), "0 to 100 percent"),
        ("drift", WEATHER.replace("9,20", "-9,20"), "a time is not below zero"),
        ("closing_curves", CURVE + "a,30,200,0.1\na,29,400,0.1\n", "2 points"),
        (
            "closing_curves",
            CURVE + "".join(f"a,{k},{200 * 1.5**k},0.1\n" for k in range(6)),
            "rises with separation",
        ),
        ("sticking", "stuck,switches\n20,3\n", "swapped"),
        ("release", "release_V,release_error_V\n0,1\n", "sticking"),
        ("hardness", "hardness_GPa,hardness_error_GPa\n4,0.2\n", "no column area"),
    ],
)
def test_one_line_says_what_is_wrong(tmp_path, kind, text, words):
    with pytest.raises(InputError, match=words) as error:
        load(tmp_path, kind, text)
    assert "\n" not in str(error.value)
    assert "data.csv" in str(error.value)


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        load_measurements(MeasurementTable(kind="pull_off", file=str(tmp_path / "none.csv")))


def test_one_table_of_a_kind():
    from mesoscale.settings import MeasurementsSettings

    table = MeasurementTable(kind="pull_off", file="a.csv")
    with pytest.raises(InputError, match="given twice"):
        MeasurementsSettings(tables=(table, table))


def test_errors_of_one_coordinate_are_enough(tmp_path):
    text = "specimen,separation_nm,force_nN,force_error_nN\n" + POINTS
    data = load(tmp_path, "opening_curves", text, zero="known")
    assert data.zero_known
    assert np.allclose(data.columns["force_error"], 0.1)
