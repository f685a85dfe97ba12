"""Reading AFM files: heights, units, channels, and one clear line for whatever cannot be used."""

import pickle
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from mesoscale.errors import InputError
from mesoscale.settings import InstrumentSettings, TopographySettings
from mesoscale.topography.measurements.channels import height_channel
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.measurements.loading import load_measurements, write_gwy

IN_NM = TopographySettings(instruments=(InstrumentSettings(files="*", unit="nm"),))
AFM = Path(__file__).resolve().parents[5] / "shared" / "afm"


def load_scan(path, channel=None):
    """The only scan of a file."""
    (measured,) = load_measurements(path, settings=TopographySettings(channel=channel))
    return measured.data


def gwy(path, heights, lengths=(1000.0, 750.0)):
    write_gwy(path, Scan(heights, lengths, "test"))
    return path


def test_gwyddion_round_trip_keeps_heights_size_and_holes(tmp_path):
    heights = np.random.default_rng(0).standard_normal((64, 48))
    heights[3, 4] = np.nan
    scan = load_scan(gwy(tmp_path / "a.gwy", heights))
    assert scan.heights_nm == pytest.approx(heights, rel=1e-12, nan_ok=True)
    assert scan.lengths_nm == pytest.approx((1000.0, 750.0))
    assert scan.name == "a"


def test_missing_and_foreign_files_are_named(tmp_path):
    with pytest.raises(InputError, match=r"nothing\.gwy: no such scan"):
        load_scan(tmp_path / "nothing.gwy")
    text = tmp_path / "notes.gwy"
    text.write_text("not a scan")
    with pytest.raises(InputError, match="no reader understands"):
        load_scan(text)


def test_a_suffix_that_lies_does_not_matter(tmp_path):
    heights = np.random.default_rng(0).standard_normal((64, 48))
    path = gwy(tmp_path / "a.gwy", heights).rename(tmp_path / "a.ibw")
    assert load_scan(path).heights_nm == pytest.approx(heights, rel=1e-12)


@pytest.mark.parametrize(
    "suffix", ["gwy", "ibw", "di", "spm", "000", "jpk", "mi", "mdt", "ezd", "nid", "tiff", "tif"]
)
def test_an_empty_file_of_any_suffix_is_refused_in_one_line(tmp_path, suffix):
    path = tmp_path / f"empty.{suffix}"
    path.write_bytes(b"")
    with pytest.raises(InputError, match="empty") as caught:
        load_scan(path)
    assert "\n" not in str(caught.value)


def test_the_page_lists_every_format_that_is_read():
    from SurfaceTopography.IO import readers

    read = {reader.format() for reader in readers} - {"npz"}
    page = (Path(__file__).resolve().parents[4] / "docs/topography.md").read_text(encoding="utf-8")
    listed = page.split("**Formats.**")[1].split("Besides, `sxm`")[0]
    assert {name for name in re.findall(r"`(\w+)`", listed)} == read
    assert len(read) >= 40


def test_truncated_file_is_refused(tmp_path):
    path = gwy(tmp_path / "a.gwy", np.zeros((64, 64)))
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(
        InputError,
        match=r"a\.gwy: no reader .* \(Gwyddion: The file has 2000 bytes, but its header",
    ):
        load_scan(path)


def test_text_without_physical_size_is_refused(tmp_path):
    path = tmp_path / "a.txt"
    np.savetxt(path, np.random.default_rng(0).standard_normal((40, 40)))
    with pytest.raises(InputError, match="no physical size"):
        load_scan(path)


class Bomb:
    """A pickle that leaves a trace when it is loaded."""

    def __init__(self, trace):
        self.trace = str(trace)

    def __reduce__(self):
        return (Path.touch, (Path(self.trace),))


def test_numpy_files_are_refused_and_pickles_never_loaded(tmp_path):
    trace = tmp_path / "executed"
    bomb = np.empty(1, dtype=object)
    bomb[0] = Bomb(trace)
    np.save(tmp_path / "a.npy", bomb, allow_pickle=True)
    np.savez(tmp_path / "b.npz", bomb)
    (tmp_path / "c.pkl").write_bytes(pickle.dumps(Bomb(trace)))
    (tmp_path / "d.gwy").write_bytes(pickle.dumps(Bomb(trace)))
    for name in ("a.npy", "b.npz", "c.pkl", "d.gwy"):
        with pytest.raises(InputError, match=name):
            load_scan(tmp_path / name)
    assert not trace.exists()


def test_several_height_channels_are_asked_for(tmp_path):
    from gwyfile.objects import GwyContainer, GwyDataField

    content = GwyContainer()
    for k, title in enumerate(("Height", "ZSensor")):
        content[f"/{k}/data/title"] = title
        content[f"/{k}/data"] = GwyDataField(
            np.full((40, 40), k * 1e-9), xreal=1e-6, yreal=1e-6, si_unit_xy="m", si_unit_z="m"
        )
    path = tmp_path / "two.gwy"
    content.tofile(str(path))
    with pytest.raises(InputError, match=r"Height, ZSensor; name one in topography\.channel"):
        load_scan(path)
    assert load_scan(path, channel="ZSensor").heights_nm.max() == pytest.approx(1.0)
    with pytest.raises(InputError, match="no height channel 'Phase'"):
        load_scan(path, channel="Phase")


def test_of_hundreds_of_channels_some_are_listed():
    channels = [
        SimpleNamespace(
            is_height_channel=True,
            name=f"Height {k}",
            unit="m",
            dim=2,
            nb_grid_pts=(64, 64),
            physical_sizes=(1.0, 1.0),
        )
        for k in range(300)
    ]
    with pytest.raises(InputError, match=r"Height 9 and 290 more; name one") as error:
        height_channel("a.gwy", channels, "gwy", None, lambda item: "")
    assert len(str(error.value)) < 250
    assert (
        height_channel("a.gwy", channels, "gwy", "Height 299", lambda item: "")[0] is channels[299]
    )


@pytest.mark.parametrize(
    ("unit", "nm"),
    [("\u00b5m", 1e3), ("\u03bcm", 1e3), ("Angstrom", 0.1), ("\u00c5", 0.1), ("nm", 1.0)],
)
def test_units_are_read_in_all_spellings(tmp_path, unit, nm):
    path = unit_gwy(tmp_path / "a.gwy", unit, 1000.0 / nm)
    assert load_scan(path).lengths_nm == pytest.approx((1000.0, 1000.0))
    assert load_scan(path).heights_nm.max() == pytest.approx(nm)


def test_heights_in_volts_are_refused_with_the_reason(tmp_path):
    with pytest.raises(InputError, match="no channel of heights in a unit of length"):
        load_scan(unit_gwy(tmp_path / "a.gwy", "V", 1000.0))


def unit_gwy(path, unit, side):
    from gwyfile.objects import GwyContainer, GwyDataField

    content = GwyContainer()
    content["/0/data/title"] = "Height"
    heights = np.eye(40)
    content["/0/data"] = GwyDataField(
        heights, xreal=side, yreal=side, si_unit_xy=unit, si_unit_z=unit
    )
    content.tofile(str(path))
    return path


def test_cleaning_levels_aligns_fills_and_records(tmp_path):
    rng = np.random.default_rng(0)
    rough = rng.standard_normal((128, 128))
    heights = rough + 0.3 * np.arange(128)[:, None] + 20 * rng.standard_normal(128)[None, :]
    heights[5, 7] = np.nan
    heights[60, 60] += 500.0
    cleaned = clean(Scan(heights, (100.0, 100.0), "a"), TopographySettings())
    assert len(cleaned.steps) == 4
    assert np.all(np.isfinite(cleaned.heights_nm))
    assert cleaned.rms_nm == pytest.approx(1.0, rel=0.03)


def test_cleaning_leaves_a_smooth_creased_scan_alone():
    """Tips leave parabolas that meet in creases; these are no spikes."""
    x = np.linspace(0, 10, 200)
    creased = (
        np.maximum.reduce([-((x - c) ** 2) for c in np.arange(0.5, 10, 0.7)])[:, None]
        + 0 * x[None, :]
    )
    settings = TopographySettings(detrend="none", line_alignment="none")
    cleaned = clean(Scan(creased, (10.0, 10.0), "a"), settings)
    assert cleaned.heights_nm == pytest.approx(creased - creased.mean())


def test_too_many_holes_are_refused():
    heights = np.random.default_rng(0).standard_normal((64, 64))
    heights[:10, :] = np.nan
    with pytest.raises(InputError, match=r"15\.6% of the pixels are missing.* \(--crop;"):
        clean(Scan(heights, (1.0, 1.0), "holes"), TopographySettings())


@pytest.mark.skipif(not AFM.is_dir(), reason="real scans are not shipped")
@pytest.mark.parametrize(
    ("name", "length", "rms"), [("example_ps.tiff", 1000.0, 3.93), ("di-6.di", 10000.0, 16.85)]
)
def test_real_scans_are_read_in_nanometres(name, length, rms):
    scan = load_scan(AFM / name)
    assert scan.lengths_nm == pytest.approx((length, length))
    assert scan.rms_nm == pytest.approx(rms, abs=0.01)


def test_cut_off_scans_are_refused():
    heights = np.clip(np.random.default_rng(0).standard_normal((64, 64)), -1.0, None)
    with pytest.raises(InputError, match="cut off"):
        clean(Scan(heights, (1.0, 1.0), "low"), TopographySettings())


@pytest.mark.parametrize("length_nm", [5.0, 1e9])
def test_a_size_that_no_instrument_has_is_taken_for_a_mistaken_unit(tmp_path, length_nm):
    path = tmp_path / "scan.gwy"
    write_gwy(
        path, Scan(np.random.default_rng(0).standard_normal((64, 64)), (length_nm, length_nm), "a")
    )
    with pytest.raises(
        InputError, match=r"scan\.gwy: a size of .* nm; plausible is 10 \.\. 1e\+08 nm, so its unit"
    ):
        load_scan(path)


def test_a_height_that_no_surface_has_is_refused(tmp_path):
    heights = np.random.default_rng(0).standard_normal((64, 64))
    heights[3, 4] = 1e200  # one bit of an exponent
    write_gwy(tmp_path / "scan.gwy", Scan(heights, (1000.0, 1000.0), "a"))
    with pytest.raises(
        InputError, match=r"scan\.gwy: a height of 1e\+200 nm; plausible is up to 1e\+08 nm about"
    ):
        load_scan(tmp_path / "scan.gwy")


def _no_channels():
    raise KeyError("Miscellaneous")


def _line_of_three():
    line = SimpleNamespace(
        dim=1, unit="um", info={}, positions_and_heights=lambda: ([0.0], [1.0], [2.0])
    )
    return [
        SimpleNamespace(
            is_height_channel=True,
            name="z",
            unit="um",
            dim=1,
            physical_sizes=None,
            topography=lambda: line,
        )
    ]


@pytest.mark.parametrize("read", [_no_channels, _line_of_three])
def test_a_reader_that_fails_after_opening_is_one_line(tmp_path, monkeypatch, read):
    class Reader:
        channels = property(lambda self: read())
        format = staticmethod(lambda: "top")

    path = tmp_path / "cut.top"
    path.write_bytes(b"x" * 100)
    monkeypatch.setattr("SurfaceTopography.IO.open_topography", lambda *given: Reader())
    with pytest.raises(InputError, match=r"cut\.top: heights cannot be read"):
        load_measurements(path)
