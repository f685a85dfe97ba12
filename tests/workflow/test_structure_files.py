"""What one job of the elastic stage hands to the next."""

import numpy as np
from ase.calculators.emt import EMT

from atomistic.elastic.dft import PyscfGamma, Solution
from workflow.structure_files import start_from, write_start


def test_orbitals_pass_from_job_to_job(tmp_path):
    ended, starting = PyscfGamma(), PyscfGamma()
    ended.history = [Solution(np.eye(4), np.eye(4, 1)), Solution(2 * np.eye(4), np.eye(4, 2))]
    write_start(tmp_path / "a01.h5", ended, {})
    start_from(starting, tmp_path / "a01.h5")
    (kept,) = starting.history
    assert np.array_equal(kept.overlap, 2 * np.eye(4))
    assert np.array_equal(kept.orbitals, np.eye(4, 2))


def test_engines_without_orbitals_and_rejected_glasses_keep_none(tmp_path):
    for calculator in (EMT(), None):
        write_start(tmp_path / "a01.h5", calculator, {})
        starting = PyscfGamma()
        start_from(starting, tmp_path / "a01.h5")
        assert starting.history == []
