"""Common formats are read without loading the whole of SurfaceTopography, and give the same."""

import subprocess
import sys

import numpy as np
import pytest

from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.light_readers import SUFFIXES
from mesoscale.topography.measurements.loading import load_scan, write_gwy

ALONE = """
import sys
from pathlib import Path
from mesoscale.topography.measurements.light_readers import SUFFIXES, light_reader
from mesoscale.topography.measurements.loading import load_scan

light = {}
for suffixes in SUFFIXES.values():
    for suffix in suffixes:
        with light_reader(Path("a." + suffix)) as reader:
            light[suffix] = reader
            assert reader is not None, suffix
before = load_scan(sys.argv[1])
assert "pandas" not in sys.modules and "scipy.stats" not in sys.modules
foreign = load_scan(sys.argv[2])  # its suffix lies, so all readers are tried

import SurfaceTopography
from SurfaceTopography.IO import readers

assert "pandas" in sys.modules
every = {reader.__name__ for reader in readers}
assert every >= {reader.__name__ for reader in light.values()}
full = SurfaceTopography.read_topography(sys.argv[1]).to_unit("nm")
assert full.detrend("height").rms_height_from_area() > 0  # the library works as ever
for scan in (before, foreign, load_scan(sys.argv[1])):
    assert (scan.heights_nm == full.heights()).all()
"""


def test_light_readers_give_what_the_whole_library_gives(tmp_path):
    path = tmp_path / "a.gwy"
    write_gwy(path, Scan(np.random.default_rng(0).standard_normal((64, 48)), (1000.0, 750.0), "a"))
    liar = tmp_path / "a.ibw"
    liar.write_bytes(path.read_bytes())
    done = subprocess.run([sys.executable, "-c", ALONE, path, liar], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("suffix", sorted({suffix for suffixes in SUFFIXES.values() for suffix in suffixes}))
def test_an_empty_file_of_any_suffix_is_refused_in_one_line(tmp_path, suffix):
    from mesoscale.errors import InputError

    path = tmp_path / f"empty.{suffix}"
    path.write_bytes(b"")
    with pytest.raises(InputError, match="empty") as caught:
        load_scan(path)
    assert "\n" not in str(caught.value)
