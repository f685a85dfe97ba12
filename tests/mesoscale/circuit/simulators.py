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
    done = subprocess.run(
        ["ngspice", "-b", "deck.cir"], cwd=folder, capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return np.loadtxt(folder / "out.txt").T


def compile_for_ngspice(path):
    """The shared library (.osdi) of a Verilog-A file, beside it; skips the test where a tool for it
    is missing.
    """
    if shutil.which("openvaf") is None:
        pytest.skip(
            "no openvaf is installed: no package has it (openvaf-py evaluates modules, but writes"
            " no .osdi)"
        )
    (path.parent / "osdi.cir").write_text(
        "* osdi\nV1 1 0 1\nR1 1 0 1\n.control\nosdi\nquit\n.endc\n.end\n"
    )
    done = subprocess.run(
        ["ngspice", "-b", "osdi.cir"], cwd=path.parent, capture_output=True, text=True, timeout=60
    )
    if "no such command" in done.stdout + done.stderr:
        pytest.skip("ngspice is built without OSDI, as Debian's is")
    subprocess.run(["openvaf", path.name], cwd=path.parent, check=True, timeout=600)
