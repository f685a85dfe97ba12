"""Containers of contact.engineering: read whole, and harmless whatever is inside."""

import json
import zipfile
from pathlib import Path

import numpy as np
import pytest

from mesoscale.errors import InputError
from mesoscale.settings import InstrumentSettings, TopographySettings
from mesoscale.topography.measurements import guarded
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.loading import load_measurements, write_gwy
from mesoscale.topography.measurements.profiles import Profile

DIAMOND = Path(__file__).resolve().parents[4] / "config/measurements/uncd_diamond.zip"
LINE = "\n".join(f"{0.002 * k:.4f} {0.001 * np.sin(k / 9):.7f}" for k in range(300))
ENTRY = "  - {name: line, unit: um, datafile: {original: line.txt}, size: !!python/tuple [0.6]}\n"
META = "surfaces:\n- topographies:\n" + ENTRY


def container(path, meta=META, name="meta.yml", **files):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, meta)
        for file, content in ({"line.txt": LINE} | files).items():
            archive.writestr(file, content)
    return path


def refused(path, words):
    with pytest.raises(InputError, match=words) as caught:
        load_measurements(path)
    assert "\n" not in str(caught.value)
    assert path.name in str(caught.value)


def test_the_diamond_film_is_read_with_each_instrument():
    instruments = (
        InstrumentSettings(files="*stylus*", tip_radius_nm=5000),
        InstrumentSettings(files="80_*", tip_radius_nm=0),
    )
    tem, afm, stylus = load_measurements(
        DIAMOND, settings=TopographySettings(instruments=instruments)
    )
    assert isinstance(afm.data, Scan)
    assert afm.data.lengths_nm == pytest.approx((100.0, 100.0))
    assert isinstance(stylus.data, Profile)
    assert stylus.data.length_nm == pytest.approx(298783.6, rel=1e-3)
    assert stylus.data.bow  # the container says that curvature is the instrument's
    assert (tem.tip_radius_nm, stylus.tip_radius_nm) == (0, 5000)
    assert tem.data.resampled


def test_a_tip_radius_of_the_list_is_taken_as_stated(tmp_path):
    tip = "instrument: {parameters: {tip_radius: {value: 0.012, unit: um}}}"
    stated = ENTRY.replace("size:", f"{tip}, size:")
    (measured,) = load_measurements(container(tmp_path / "stated.zip", META.replace(ENTRY, stated)))
    assert (measured.tip_radius_nm, measured.radius_stated) == (pytest.approx(12.0), True)


def test_both_kinds_of_lists_are_read(tmp_path):
    (old,) = load_measurements(container(tmp_path / "old.zip"))
    listed = {
        "surfaces": [
            {
                "name": "film",
                "topographies": [
                    {
                        "name": "line",
                        "unit": "um",
                        "size": [0.6],
                        "datafile": {"original": "line.txt"},
                    }
                ],
            }
        ]
    }
    (new,) = load_measurements(container(tmp_path / "new.zip", json.dumps(listed), "index.json"))
    assert old.data.heights_nm == pytest.approx(new.data.heights_nm)
    assert old.data.rms_nm == pytest.approx(1 / np.sqrt(2), rel=0.02)


def test_a_map_in_a_container_is_a_scan(tmp_path):
    write_gwy(
        tmp_path / "a.gwy",
        Scan(np.random.default_rng(0).standard_normal((64, 64)), (500.0, 500.0), "a"),
    )
    meta = "surfaces:\n- topographies:\n  - {name: map, datafile: {original: a.gwy}}\n"
    files = {"a.gwy": (tmp_path / "a.gwy").read_bytes()}
    (result,) = load_measurements(container(tmp_path / "map.zip", meta, **files))
    assert result.data.lengths_nm == pytest.approx((500.0, 500.0))


@pytest.mark.parametrize(
    "tag", ["object/apply:os.system", "object/new:pathlib.Path", "name:os.system", "module:os"]
)
def test_code_in_the_list_is_never_run(tmp_path, tag):
    trace = tmp_path / "executed"
    meta = META + f"evil: !!python/{tag} ['touch {trace}']\n"
    refused(container(tmp_path / "evil.zip", meta), "more than plain values")
    assert not trace.exists()


def test_a_bomb_is_refused_by_the_limits_of_the_process(tmp_path, monkeypatch):
    """Of memory or of time: which comes first hangs on the machine, if it has a second or two."""
    monkeypatch.setattr(guarded, "MEMORY_MB", 300.0)
    monkeypatch.setattr(guarded, "CPU_S", 1.0)
    refused(
        container(tmp_path / "bomb.zip", **{"line.txt": b"0" * 400 * 2**20}),
        "reading it (needs|takes) more than",
    )


@pytest.mark.parametrize(
    ("meta", "words"),
    [
        (META.replace("line.txt", "other.txt"), "no item named 'other.txt'"),
        (META.replace("unit: um, ", ""), "without length unit"),
        (META.replace("{original: line.txt}", "{other: line.nc}"), "data file"),
        (META + META.removeprefix("surfaces:\n"), "holds 2 surfaces"),
        ("surfaces: 3\n", "cannot be read"),
        ("surfaces:\n- topographies: []\n", "empty"),
        ("a: [" * 3000, "plain values"),
        (f"{META}a: &a [x, x]\nb: [*a, *a]\n", "alias"),
        (f'{META}a: !!int ""\n', "tag"),
    ],
)
def test_strange_lists_are_refused_in_one_line(tmp_path, meta, words):
    refused(container(tmp_path / "strange.zip", meta), words)


def test_a_name_cannot_leave_the_folder(tmp_path):
    outside = META.replace("line.txt", "../../line.txt")
    (result,) = load_measurements(
        container(tmp_path / "a.zip", outside, **{"../../line.txt": LINE})
    )
    assert result.data.rms_nm > 0
    assert not (tmp_path.parent / "line.txt").exists()


def test_what_is_no_archive_is_refused(tmp_path):
    path = tmp_path / "a.zip"
    path.write_bytes(b"PK\x03\x04 not really")
    refused(path, "cannot be read")
    with zipfile.ZipFile(tmp_path / "b.zip", "w") as archive:
        archive.writestr("notes.txt", "hello")
    refused(tmp_path / "b.zip", "no reader understands this file")  # notes.txt, the only file in it
    with zipfile.ZipFile(tmp_path / "c.zip", "w") as archive:
        archive.writestr("notes.txt", "hello")
        archive.writestr("more.txt", "hello")
    refused(
        tmp_path / "c.zip",
        r"neither a container of contact\.engineering nor one file alone, it holds notes\.txt",
    )
