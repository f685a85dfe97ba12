"""The exported pad with its memory, over two closings of different depth."""

import importlib.util
import shutil
import subprocess

import numpy as np
import pytest

from mesoscale.device.pad_export import START_NM, spice_pad, verilog_pad
from mesoscale.pad.compact import CompactPad, fit_compact
from mesoscale.pad.memory import PadLaw
from tests.mesoscale.closed_form import tabulated

AREA = 1e12
HISTORY_NM = (60.0, 30.0, 26.0, 28.0, 33.0, 60.0, 30.0, 27.0, 23.0, 25.0, 30.0, 60.0)
"""Closed to 26 nm, opened, closed past it to 23 nm, opened again."""


def pad():
    compact = CompactPad(-2.9, 0.25, 0.003, -0.35, 0.04, 0.02, 0.078, 0.97, 0.5, 2.0, 0.215, 0.3)
    s = np.arange(19.0, 80.0, 0.1)
    depths = np.array([20.0, 22.0, 24.0, 26.0, 28.0])
    law = tabulated(compact, PadLaw(s, np.zeros((2, s.size)), depths, np.zeros((5, 2, s.size)), compact.flats))
    return law, fit_compact(law)[0]


def expected():
    """Separation, deepest closing so far and force (nN) of every step of the history, by our own closed form."""
    _, compact = pad()
    deepest = np.minimum.accumulate(HISTORY_NM)
    return np.array(HISTORY_NM), deepest, AREA * np.add(*compact.opening_GPa(HISTORY_NM, deepest))


@pytest.mark.skipif(
    importlib.util.find_spec("openvaf_py") is None,
    reason="no Verilog-A compiler is installed (Python package openvaf-py)",
)
def test_openvaf_follows_a_history_of_two_closings(tmp_path):
    import openvaf_py

    law, compact = pad()
    path = tmp_path / "rough_pad.va"
    path.write_text(verilog_pad(law, 256))
    (module,) = openvaf_py.compile_va(str(path))
    values = {**vars(compact), "area_nm2": AREA, "follow": 1e-9, "mfactor": 1.0}
    for separation, deepest, force in zip(*expected(), strict=True):
        state = START_NM - deepest
        residuals, _ = module.run_init_eval({**values, "V(s,ref)": separation * 1e-9, "V(closed)": state})
        # the state is at rest: it does not want to follow further, and hardly leaks
        assert abs(residuals[2][0]) <= 1e-9
        assert -residuals[0][0] == pytest.approx(force * 1e-9, rel=1e-6)


@pytest.mark.skipif(shutil.which("ngspice") is None, reason="ngspice is not installed (Debian package ngspice)")
def test_ngspice_follows_a_history_of_two_closings(tmp_path):
    law, _ = pad()
    (tmp_path / "pad.sub").write_text(spice_pad(law, 256))
    # a millisecond of motion and one of rest for every step; backward Euler, as what overshoots would be remembered
    points = " ".join(f"{2 * k + at}m {s:g}" for k, s in enumerate(HISTORY_NM) for at in (0.0, 1.0))
    (tmp_path / "deck.cir").write_text(
        f"""* two closings
.include pad.sub
.options reltol=1e-11 vntol=1e-12 abstol=1e-15 method=gear maxord=1
Vs s 0 PWL({points})
X s force rough_pad params: follow=1e-6 area={AREA:g}
.tran 2u {2 * len(HISTORY_NM) - 1}m 0 2u
.control
set wr_singlescale
set numdgt=16
run
wrdata out.txt v(force)
quit
.endc
.end
"""
    )
    done = subprocess.run(["ngspice", "-b", "deck.cir"], cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    time, force = np.loadtxt(tmp_path / "out.txt").T
    at_rest = np.interp((2 * np.arange(len(HISTORY_NM)) + 0.99) * 1e-3, time, force)
    np.testing.assert_allclose(at_rest, expected()[2], rtol=1e-6)


def test_the_exports_name_what_they_were_made_of():
    law, _ = pad()
    for text in (verilog_pad(law, 256), spice_pad(law, 256)):
        assert "from 256 cells, closed to 20 .. 28 nm" in text


def test_curves_without_a_closed_form_say_so():
    law, _ = pad()
    short = PadLaw(law.separation_nm, law.closing, law.depth_nm[:2], law.opening[:2], law.flats)
    assert verilog_pad(short, 8).startswith("// pad: ")
    assert spice_pad(short, 8).startswith("* pad: ")
