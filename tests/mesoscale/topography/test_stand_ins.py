"""What stands in people's files, in the made cases and example files beside this project; skipped
where they lack.
"""

from pathlib import Path

import numpy as np
import pytest

import asperity as asp
from mesoscale.errors import InputError
from mesoscale.settings import InstrumentSettings, TopographySettings
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.measurements.loading import load_measurements

SHARED = Path(__file__).resolve().parents[4] / "shared"
MADE, FORMATS = SHARED / "cases" / "stand_ins", SHARED / "afm" / "formats"
made = pytest.mark.skipif(not MADE.is_dir(), reason="made cases are not shipped")
examples = pytest.mark.skipif(not FORMATS.is_dir(), reason="example files are not shipped")


def load(path, **instrument):
    settings = TopographySettings(instruments=(InstrumentSettings(files="*", **instrument),))
    (measured,) = load_measurements(path, settings=settings)
    return measured.data


def levelled_rms(scan):
    return clean(scan, TopographySettings()).rms_nm


@made
@pytest.mark.parametrize(
    "name",
    [
        "to_pack.gwy",
        "one_scan_zipped.zip",
        "directions_HeightTrace.gwy",
        "directions_Z_forward.gwy",
        "height_sensor_and_deformation.gwy",
        "missing_as_-9999.txt",
        "missing_as_stars.txt",
        "patches_as_-9999.txt",
    ],
)
def test_all_dresses_are_the_same_surface(name):
    """256 x 256 pixels of 500 nm; 1 % of the pixels filled from their neighbours change its RMS
    height by 0.5 %.
    """
    sound, scan = load(MADE / "to_pack.gwy"), load(MADE / name)
    assert isinstance(scan, Scan)
    assert scan.heights_nm.shape == (256, 256)
    assert scan.lengths_nm == pytest.approx((500.0, 500.0))
    assert levelled_rms(scan) == pytest.approx(levelled_rms(sound), rel=0.005)


@made
def test_a_channel_without_unit_is_the_same_surface_once_it_has_one():
    with pytest.raises(InputError, match="--unit nm"):
        load(MADE / "no_unit.gwy")
    rms = levelled_rms(load(MADE / "to_pack.gwy"))
    assert levelled_rms(load(MADE / "no_unit.gwy", unit="nm")) == pytest.approx(rms, rel=0.005)


@made
@pytest.mark.parametrize(
    ("name", "share"),
    [
        ("missing_as_-9999.txt", "1.00% of the points (655), which lie exactly at -9999 nm"),
        ("patches_as_-9999.txt", "0.19% of the points (125), which lie exactly at -9999 nm"),
        ("missing_as_stars.txt", "0.06% of the values (40), which are words such as '***'"),
        ("line_missing_as_9999.csv", "2.05% of the points (21), which lie exactly at 9999 nm"),
    ],
)
def test_missing_points_are_a_doubt_with_share_and_value(name, share):
    film = asp.Film([MADE / name])
    (doubt,) = (doubt for doubt in film.description["doubts"] if doubt["code"] == "missing_points")
    assert share in doubt["text"]


@made
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("only_deformation.gwy", "no channel of heights .* it has Deformation"),
        ("force_curve.txt", r"a table of Z piezo \(nm\), Deflection \(nm\)"),
        ("current_over_z.txt", r"a table of Z \(nm\), Current \(A\)"),
        ("heights_alone.txt", "--size 1 --unit um,nm"),
        ("README.md", "no reader understands this file"),
    ],
)
def test_what_is_no_surface_is_refused_with_its_reason(name, words):
    with pytest.raises(InputError, match=words) as error:
        load(MADE / name)
    assert "\n" not in str(error.value)


@made
def test_lines_have_their_length_and_points_their_holes():
    words = load(MADE / "units_in_words.txt")
    assert len(words.heights_nm) == 1024
    assert words.length_nm == pytest.approx(1000.0, rel=2e-3)
    alone = load(MADE / "heights_alone.txt", size=(1.0,), unit="um", height_unit="nm")
    assert alone.length_nm == pytest.approx(1000.0)
    points = load(MADE / "points_with_holes.xyz")
    assert points.heights_nm.shape == (64, 64)
    assert np.isnan(points.heights_nm).sum() == 109


LINES_AND_MAPS = {  # points, and size of the first axis in nm
    "bcrf-1.bcrf": ((960, 600), 1.777e6),
    "dektak-1.csv": ((9600,), 1.5e6),
    "hfm-1.hfm": ((9600,), 4.8e6),
    "matrix-4.txt": ((75, 305), 2.77e4),
    "metropro-1.dat": ((640, 480), 7.03e5),
    "opdx-3.opdx": ((3001,), 5.0e4),
    "plu-1.plu": ((768, 576), 1.275e6),
    "stp-1.stp": ((256, 256), 600.0),
    "top-1.top": ((256, 256), 600.0),
    "x3p-2.x3p": ((650, 650), 8.3e4),
}


@examples
@pytest.mark.parametrize("name", LINES_AND_MAPS)
def test_example_files_of_instruments_have_their_size(name):
    shape, length_nm = LINES_AND_MAPS[name]
    data = load(FORMATS / name)
    assert data.heights_nm.shape == shape
    along = data.lengths_nm[0] if isinstance(data, Scan) else data.length_nm
    assert along == pytest.approx(length_nm, rel=0.01)
    (film,) = (asp.Film([FORMATS / name]).description,)
    assert "treated" not in [doubt["code"] for doubt in film["doubts"]]
    assert "missing_points" not in [doubt["code"] for doubt in film["doubts"]]


@examples
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("csv-1.csv", "a profile without length unit.*--unit um,nm"),
        ("opdx-3.txt", "a profile without length unit.*--unit um,nm"),
        ("xy-4.txt", "a profile without length unit.*--unit um,nm"),
        ("csv-2.csv", "a line of 8 points"),
        ("di-3.di", "several height channels: ZSensor, Height"),
        ("nid-1.nid", r"several height channels: Scan forward \(Z-Axis\)"),
        ("frt-1.frt", r"21\.0% of the pixels are missing.*--crop"),
        ("mitutoyo_mock.xlsx", "nothing to see"),
        ("nms-1.nms", "its unit may be mistaken"),
    ],
)
def test_example_files_that_leave_something_open_are_refused_with_a_remedy(name, words):
    with pytest.raises(InputError, match=words) as error:
        asp.Film([FORMATS / name])
    assert "\n" not in str(error.value)


@examples
def test_the_round_example_is_described_once_it_is_cut():
    scan = load(FORMATS / "frt-1.frt", crop="largest")
    assert np.isnan(scan.heights_nm).mean() < 0.05
    assert min(scan.heights_nm.shape) > 300


@examples
@pytest.mark.parametrize(
    ("name", "channel"),
    [("di-3.di", "ZSensor"), ("di-3.di", "Height"), ("nid-1.nid", "Scan forward (Z-Axis)")],
)
def test_a_channel_that_is_named_is_taken(name, channel):
    assert f"read channel {channel}" in load(FORMATS / name, channel=channel).steps
