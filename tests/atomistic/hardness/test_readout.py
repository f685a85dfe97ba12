import numpy as np
import pytest

from atomistic.hardness.readout import Sample, energy_drift
from atomistic.lammps import Workspace


def samples(position, drive):
    """Samples every 10 steps; position of what moves (Å) and driving force (eV/Å)."""
    return {
        10 * (k + 1): Sample(np.array([x, force, 300.0, force]), {0.5: 0.0}, 0)
        for k, (x, force) in enumerate(zip(position, drive, strict=True))
    }


def write_energy(workspace, segment, position, energy, heat):
    (workspace / f"energy.{segment}").write_text(f"{position} {energy} {heat}\n", encoding="utf-8")


def test_energy_that_work_and_heat_explain_is_no_drift(tmp_path):
    """A spring of 2 eV/Å² pressed from 10 to 8 Å stores 4 eV; 1 eV of them leaves as heat, 0.5 appear from nowhere."""
    workspace = Workspace(tmp_path / "work", {}, "closing.in")
    middles = 10 - 0.2 * (np.arange(10) + 0.5)
    write_energy(workspace, 0, 10.0, -100.0, 0.0)
    write_energy(workspace, 1, 9.0, -100.0 + 1.0 - 0.4, 0.4)
    write_energy(workspace, 2, 8.0, -100.0 + 4.0 - 1.0 + 0.5, 0.6)
    drift = energy_drift(workspace, range(1, 3), 50, samples(middles, 2 * (10 - middles)))
    assert list(drift) == [0, 50, 100]
    assert drift[50] == pytest.approx(0, abs=1e-12)
    assert drift[100] == pytest.approx(0.5)


def test_a_quasi_static_run_has_no_balance(tmp_path):
    assert energy_drift(Workspace(tmp_path / "work", {}, "quasistatic.in"), range(1, 3), 50, {}) == {}
