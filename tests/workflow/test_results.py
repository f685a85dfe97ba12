"""Result files appear whole or not at all, and give back what was written."""

import csv
import errno
import os
import stat

import numpy as np
import pytest

from workflow.files.results import (
    Dataset,
    atomic_path,
    load_csv,
    load_h5,
    load_json,
    write_csv,
    write_h5,
    write_json,
)


def test_a_writer_that_fails_leaves_the_old_file_and_nothing_else(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("old")

    def fail_half_way():
        with atomic_path(path) as temporary:
            temporary.write_text("half of the n")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail_half_way()
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["points.csv"]


def test_a_full_disk_names_the_file(tmp_path):
    def fill_the_disk():
        with atomic_path(tmp_path / "curves.h5"):
            raise OSError(errno.ENOSPC, "No space left on device")

    with pytest.raises(OSError, match=r"No space left on device: .*curves\.h5"):
        fill_the_disk()
    assert not os.listdir(tmp_path)


def test_results_follow_the_umask(tmp_path):
    old = os.umask(0o022)
    try:
        write_csv(tmp_path / "a.csv", [{"x": 1}])
    finally:
        os.umask(old)
    assert stat.S_IMODE((tmp_path / "a.csv").stat().st_mode) == 0o644


def test_csv_gives_back_every_digit(tmp_path):
    value = np.float64(0.1) + 0.2
    write_csv(tmp_path / "a.csv", [{"force_nN": value, "status": None}])
    (row,) = load_csv(tmp_path / "a.csv")
    assert float(row["force_nN"]) == value
    assert row["status"] == ""


def test_csv_refuses_a_column_that_the_first_row_has_not(tmp_path):
    with pytest.raises(ValueError, match="fields not in fieldnames"):
        write_csv(tmp_path / "a.csv", [{"a": 1}, {"a": 1, "b": 2}])
    assert not os.listdir(tmp_path)


def test_csv_quotes_what_needs_it(tmp_path):
    write_csv(tmp_path / "a.csv", [{"status": "rejected: few points, noisy"}])
    with (tmp_path / "a.csv").open() as stream:
        assert list(csv.reader(stream))[1] == ["rejected: few points, noisy"]


def test_json_has_no_nan(tmp_path):
    write_json(
        tmp_path / "a.json", {"H": np.nan, "interval": np.array([1.0, np.inf])}, {"rule": "fit"}
    )
    content = load_json(tmp_path / "a.json")
    assert content["H"] is None
    assert content["interval"] == [1.0, None]
    assert content["provenance"]["rule"] == "fit"


def test_h5_is_documented_and_reproducible(tmp_path):
    import h5py

    force = Dataset(np.arange(3.0), "nN", "repulsive force", ("step",))
    for name in ("a.h5", "b.h5"):
        write_h5(
            tmp_path / name,
            {"plastic/closing": {"force": force}},
            {"seed": 1},
            {},
            {"plastic": {"model": "plastic"}},
        )
    groups, attributes, group_attributes = load_h5(tmp_path / "a.h5")
    np.testing.assert_array_equal(groups["plastic/closing"]["force"], [0, 1, 2])
    assert attributes["complete"]
    assert group_attributes == {"plastic": {"model": "plastic"}}
    with h5py.File(tmp_path / "a.h5") as file:
        stored = file["plastic/closing/force"]
        assert (stored.attrs["units"], stored.dims[0].label) == ("nN", "step")
    assert (tmp_path / "a.h5").read_bytes() == (tmp_path / "b.h5").read_bytes()


def test_an_incomplete_h5_is_refused(tmp_path):
    import h5py

    with h5py.File(tmp_path / "half.h5", "w") as file:
        file["force"] = [1.0]
    with pytest.raises(ValueError, match="not a complete result file"):
        load_h5(tmp_path / "half.h5")


def test_a_dataset_named_like_its_dimension_is_its_coordinate(tmp_path):
    """As netCDF has it: the separation is the dimension scale of its curve, and of nothing else."""
    import h5py

    curve = {
        "separation_nm": Dataset([3.0, 2.0], "nm", "mean separation", ("separation_nm",)),
        "repulsive_nN": Dataset([0.0, 5.0], "nN", "repulsive force", ("separation_nm",)),
        "heights": Dataset([[0.0]], "nm", "heights", ("x", "y")),
    }
    path = tmp_path / "curves.h5"
    write_h5(path, {"plastic/closing": curve}, {}, {})
    with h5py.File(path) as file:
        group = file["plastic/closing"]
        assert group["separation_nm"].is_scale
        assert list(group["repulsive_nN"].dims[0].keys()) == ["separation_nm"]
        assert group["repulsive_nN"].dims[0]["separation_nm"][:].tolist() == [3.0, 2.0]
        assert next(iter(group["heights"].dims[0].values())).shape == (1,)
    assert set(load_h5(path)[0]["plastic/closing"]) == set(curve), "lengths alone are no results"


def test_results_open_in_xarray(tmp_path):
    """Dimensions with and without coordinates in one dataset, as cells and separations of a pad."""
    import xarray

    pressed = {
        "separation_nm": Dataset([3.0, 2.0], "nm", "mean separation", ("separation_nm",)),
        "closing_GPa": Dataset(np.zeros((4, 2)), "GPa", "pressure", ("cell", "separation_nm")),
    }
    write_h5(tmp_path / "pad.h5", {"point_0000": pressed}, {}, {})
    opened = xarray.open_dataset(tmp_path / "pad.h5", group="point_0000", engine="h5netcdf")
    assert opened.closing_GPa.sizes == {"cell": 4, "separation_nm": 2}
    assert opened.closing_GPa.sel(separation_nm=2.0).shape == (4,)
    assert opened.closing_GPa.attrs["units"] == "GPa"
