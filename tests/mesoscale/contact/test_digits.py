"""The digits of a cycle do not depend on whether its loops were just compiled or come from the
cache.
"""

import os
import subprocess
import sys

CYCLE = """
import asperity as asp
inputs = asp.ContactInputs(hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025,
hurst=0.75, rms=8.5)
settings = asp.ContactSettings(mechanics="coupled", pixels=64, length_nm=128.0, max_force_nN=100.0)
cycle = asp.run_cycle(inputs, settings, seed=1)
print(cycle.opening.repulsive_nN.tobytes().hex(), cycle.opening.attractive_nN.tobytes().hex())
"""


def test_compiled_and_loaded_loops_give_the_same_bits(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    compiled, loaded = (
        subprocess.run(
            [sys.executable, "-c", CYCLE], env=environment, capture_output=True, check=True
        ).stdout
        for _ in range(2)
    )
    assert len(compiled) > 100
    assert compiled == loaded
