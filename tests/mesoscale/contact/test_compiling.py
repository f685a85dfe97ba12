"""A new installation says that it compiles; the next process finds its loops in the cache."""

import os
import subprocess
import sys

PRESS = """
import numba
from mesoscale.contact.compiling import announced

@numba.njit(cache=True)
def twice(x):
    return 2 * x

with announced():
    print(twice(21))
"""


def test_compiling_is_said_once_and_not_again(tmp_path):
    script = tmp_path / "doubles.py"
    script.write_text(PRESS, encoding="utf-8")
    environment = os.environ | {
        "NUMBA_CACHE_DIR": str(tmp_path),
        "PYTHONPATH": os.pathsep.join(sys.path),
    }
    command = [sys.executable, str(script)]
    first, second = (
        subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        for _ in range(2)
    )
    assert first.stdout == second.stdout == "42\n"
    assert first.stderr == "asperity: compiling the contact solver, once on this installation\n"
    assert second.stderr == ""
