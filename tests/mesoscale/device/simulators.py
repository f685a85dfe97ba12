"""Circuit simulators and compilers that tests run where they are installed."""

import importlib.util
import shutil
import subprocess

import numpy as np
import pytest

needs_ngspice = pytest.mark.skipif(
    shutil.which("ngspice") is None, reason="ngspice is not installed (Debian package ngspice)"
)
needs_openvaf = pytest.mark.skipif(
    importlib.util.find_spec("openvaf_py") is None,
    reason="no Verilog-A compiler is installed (Python package openvaf-py)",
)


def by_ngspice(folder, deck):
    """Columns of the file out.txt that a deck writes, run in a folder."""
    (folder / "deck.cir").write_text(deck)
    done = subprocess.run(["ngspice", "-b", "deck.cir"], cwd=folder, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    return np.loadtxt(folder / "out.txt").T
