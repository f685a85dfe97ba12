"""Real LAMMPS runs of some hundred atoms: a glass, a closing, and both resumed after SIGKILL."""

import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import numpy as np
import pytest
from atomistic.hardness.studies import stability
from atomistic.hardness.studies.stability import half_energy_identity

from atomistic.errors import InputError
from atomistic.hardness.closing import run_closing
from atomistic.hardness.glass import glass_properties, make_glass
from atomistic.hardness.runs import planned_runs, settings_of_run
from atomistic.lammps import Atoms, Workspace, load_data, write_data
from atomistic.settings import GlassSettings, HardnessSettings

CONFIG = Path(__file__).parents[3] / "config"
PMMCS, SILICA = CONFIG / "potentials" / "pmmcs.yaml", CONFIG / "materials" / "silicon_dioxide.yaml"
GLASS = GlassSettings(atoms=150, melt_ps=1, quench_rate_K_ps=1000, rest_ps=1, segment_steps=300)
SETTINGS = HardnessSettings.model_validate(
    {
        "seeds": [1],
        "asperities": [{"name": "tiny", "tiles": 2, "amplitude_nm": 0.2}],
        "glass": GLASS.model_dump(),
        "closing": {"base_nm": 1.4, "base_over_contact": 0, "speed_m_s": 200, "anneal_ps": 0.2},
    }
)


@pytest.fixture(scope="module")
def glass(potential, oxides, tmp_path_factory):
    return make_glass(oxides["SiO2"], potential, GLASS, 1, tmp_path_factory.mktemp("glass") / "work")


@pytest.fixture(scope="module")
def closing(glass, potential, oxides, tmp_path_factory):
    [full, _] = planned_runs(SETTINGS)
    return run_closing(full, oxides["SiO2"], glass, potential, SETTINGS, tmp_path_factory.mktemp("closing") / "work")


def test_quenched_melt_is_silica(glass, potential, oxides):
    """Even 150 atoms quenched at 1000 K/ps are a four-fold network with the bond of silica."""
    found = glass_properties(oxides["SiO2"], potential, glass)
    assert found["bond_A"] == pytest.approx(1.61, abs=0.03)
    assert found["cation_coordination"] == pytest.approx(4, abs=0.1)
    assert 2.0 < found["density_g_cm3"] < 2.6
    assert glass.count("O") == 2 * glass.count("Si") == 100


def test_unknown_material(potential, oxides):
    carbide = oxides["SiO2"].model_copy(update={"formula": {"Si": 1, "C": 1}})
    with pytest.raises(InputError, match="SiC is not among SiO2, TiO2"):
        make_glass(carbide, potential, GLASS, 1, Path("unused"))
    bare = oxides["SiO2"].model_copy(update={"oxide_glass": None})
    with pytest.raises(InputError, match="silicon_dioxide: its file has no section oxide_glass"):
        make_glass(bare, potential, GLASS, 1, Path("unused"))


def test_data_files_keep_every_digit(tmp_path, glass):
    path = tmp_path / "glass.data"
    write_data(path, glass, {"Si": 28.085, "O": 15.999})
    again = load_data(path, glass.elements)
    np.testing.assert_array_equal(again.positions_A, glass.positions_A)
    np.testing.assert_array_equal(again.velocities_A_ps, glass.velocities_A_ps)
    np.testing.assert_array_equal(again.types, glass.types)


def test_closing_conserves_energy_and_builds_up_stress(closing):
    column = {name: np.array([row[name] for row in closing.curve]) for name in closing.curve[0]}
    assert np.all(column["force_nN"][:2] == 0)
    assert column["force_nN"][-1] > 1
    assert column["contact_area_nm2"][-1] > column["contact_area_nm2"][len(closing.curve) // 2] > 0
    assert np.abs(column["energy_drift_meV_per_atom"]).max() < 3  # 0.2 meV per atom and ps is the gate
    deeper = column["contact_area_nm2_depth_1.5A"] >= column["contact_area_nm2"]
    assert deeper.all()
    np.testing.assert_allclose(
        column["contact_stress_GPa"][-1] * column["contact_area_nm2"][-1], column["force_nN"][-1], rtol=1e-9
    )


def test_snapshots_without_the_flat(closing):
    assert closing.witness[0]["exchanged_bonds"] == 0
    assert closing.witness[-1]["exchanged_bonds"] >= closing.witness[0]["exchanged_bonds"]
    assert {row["step"] for row in closing.snapshots} == {row["step"] for row in closing.witness}


KILLED = """
    import sys
    from pathlib import Path
    sys.path.insert(0, {tests!r})
    from test_closing import GLASS, PMMCS, SETTINGS, SILICA
    from atomistic.hardness.closing import run_closing
    from atomistic.hardness.glass import make_glass
    from atomistic.lammps import load_data
    from atomistic.materials import load_material
    from atomistic.potentials import load_potential
    from atomistic.hardness.runs import planned_runs
    potential, silica = load_potential(PMMCS), load_material(SILICA)
    if {what!r} == "glass":
        make_glass(silica, potential, GLASS, 1, Path({work!r}))
    else:
        glass = load_data({glass!r}, ("Si", "O"))
        run_closing(planned_runs(SETTINGS)[0], silica, glass, potential, SETTINGS, Path({work!r}))
"""


def kill_after(what, work, mark, glass_file=""):
    """Start a run and kill its Python once `mark` exists; its LAMMPS must die with it."""
    code = textwrap.dedent(KILLED).format(
        tests=str(Path(__file__).parent), what=what, work=str(work), glass=str(glass_file)
    )
    process = subprocess.Popen([sys.executable, "-c", code])
    deadline = time.monotonic() + 60
    while not mark.exists() and time.monotonic() < deadline and process.poll() is None:
        time.sleep(0.005)
    assert process.poll() is None, "the run ended before it could be killed"
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    time.sleep(0.3)
    assert not lammps_in(work), "LAMMPS outlived its workflow"


def lammps_in(work):
    found = []
    for path in Path("/proc").glob("[0-9]*/cwd"):
        try:
            if str(path.resolve()).startswith(str(work)):
                found.append(path)
        except OSError:
            continue
    return found


def test_killed_quench_resumes_bit_for_bit(glass, potential, oxides, tmp_path):
    work = tmp_path / "work"
    kill_after("glass", work, work / "restart.3")
    assert (work / "restart.3").exists()
    resumed = make_glass(oxides["SiO2"], potential, GLASS, 1, work)
    np.testing.assert_array_equal(resumed.positions_A, glass.positions_A)
    np.testing.assert_array_equal(resumed.cell_A, glass.cell_A)
    assert not work.exists()


def test_killed_closing_resumes_bit_for_bit(glass, potential, oxides, closing, tmp_path):
    work, glass_file = tmp_path / "work", tmp_path / "glass.data"
    write_data(glass_file, glass, {"Si": 28.085, "O": 15.999})
    kill_after("closing", work, work / "closing" / "restart.2", glass_file)
    resumed = run_closing(planned_runs(SETTINGS)[0], oxides["SiO2"], glass, potential, SETTINGS, work)
    assert resumed.curve == closing.curve or all(
        np.array_equal(list(a.values()), list(b.values()), equal_nan=True)
        for a, b in zip(resumed.curve, closing.curve, strict=True)
    )
    assert resumed.witness == closing.witness
    assert resumed.snapshots == closing.snapshots


def test_a_changed_setting_does_not_resume_old_work(tmp_path):
    first = Workspace(tmp_path / "w", {"speed": 50}, "glass.in")
    (first / "restart.1").write_text("")
    assert Workspace(tmp_path / "w", {"speed": 50}, "glass.in").segments_done(3) == 1
    assert Workspace(tmp_path / "w", {"speed": 60}, "glass.in").segments_done(3) == 0


def test_half_energies_at_T_move_like_full_ones_at_2T(glass, potential, tmp_path):
    passed, detail = half_energy_identity(glass, potential, tmp_path / "nve")
    assert passed, detail


def test_stability_study_passes(potential, oxides, tmp_path, monkeypatch):
    """All checks of a potential, and of those of a closing the overlapping start and the snap-in."""
    of_closing = stability._of_closing
    monkeypatch.setattr(stability, "_of_closing", lambda *given: of_closing(*given)[:2])
    checks = stability.stability_checks([potential], oxides, tmp_path / "work")
    assert {"overlapping_start", "snap_in", "coulomb_slab_pmmcs"} < {case for case, *_ in checks}
    verdicts = {case: check() for case, _, _, check in checks}
    assert {case: detail for case, (passed, detail) in verdicts.items() if not passed} == {}


def test_settings_of_a_run_plan_just_that_run():
    settings = HardnessSettings()
    runs = planned_runs(settings)
    assert len(runs) == len({run.name for run in runs}) == 12
    for run in runs:
        assert planned_runs(HardnessSettings.model_validate(settings_of_run(run, settings))) == [run]


def test_atoms_take():
    atoms = Atoms(("Si", "O"), np.array([1, 2, 2]), np.eye(3), np.ones(3))
    assert atoms.take(np.array([True, False, True])).count("O") == 1
