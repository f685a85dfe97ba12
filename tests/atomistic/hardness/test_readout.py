import numpy as np
import pytest

from atomistic.hardness.readout import Sample, energy_drift
from atomistic.lammps import load_dump


def samples(position, drive):
    """Samples every 10 steps; position of what moves (Å) and driving force (eV/Å)."""
    return {
        10 * (k + 1): Sample(np.array([x, force, 300.0]), 0.0, 0)
        for k, (x, force) in enumerate(zip(position, drive, strict=True))
    }


def test_energy_that_work_and_heat_explain_is_no_drift():
    """A spring of 2 eV/Å² pressed from 10 to 8 Å stores 4 eV; 1 eV of them leaves as heat, 0.5
    appear from nowhere.
    """
    middles = 10 - 0.2 * (np.arange(10) + 0.5)
    ends = {
        0: np.array([10.0, -100.0, 0.0]),
        1: np.array([9.0, -100.0 + 1.0 - 0.4, 0.4]),
        2: np.array([8.0, -100.0 + 4.0 - 1.0 + 0.5, 0.6]),
    }
    drift = energy_drift(ends, 50, samples(middles, 2 * (10 - middles)))
    assert list(drift) == [0, 50, 100]
    assert drift[50] == pytest.approx(0, abs=1e-12)
    assert drift[100] == pytest.approx(0.5)


def test_work_by_samples_at_the_end_of_their_interval_gains_nothing():
    """As in fast closings, where an average is one value; the spring is met at 9 Å."""
    positions = 10 - 0.2 * np.arange(1, 11)
    places = {0: 10.0} | {n: positions[2 * n - 1] for n in range(1, 6)}
    ends = {n: np.array([x, max(0, 9 - x) ** 2, 0.0]) for n, x in places.items()}
    drift = energy_drift(ends, 20, samples(positions, 2 * np.maximum(0, 9 - positions)))
    assert list(drift.values()) == pytest.approx([0] * 6, abs=1e-12)


FRAME = (
    "ITEM: TIMESTEP\n10\nITEM: NUMBER OF ATOMS\n{count}\nITEM: BOX BOUNDS pp pp ff\n0 1\n0 1\n0"
    " 1\n{atoms}"
)
ATOMS = "ITEM: ATOMS id x\n1 0.5\n2 0.25\n"


def test_a_dump_is_read_whole(tmp_path):
    path = tmp_path / "dump"
    path.write_text(2 * FRAME.format(count=2, atoms=ATOMS))
    frames = load_dump(path)
    assert [step for step, _ in frames] == [10, 10]
    np.testing.assert_array_equal(frames[1][1], [[1, 0.5], [2, 0.25]])
