"""Real LAMMPS runs of some hundred atoms: a glass, a closing, and both resumed after SIGKILL."""

import os
import signal
import subprocess
import sys
import textwrap
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from asperity.guards.errors import InputError
from atomistic.hardness.closing import run_closing
from atomistic.hardness.glass import glass_properties, make_glass
from atomistic.hardness.motion import free_motion, heated
from atomistic.hardness.runs import PROTOCOL, planned_runs
from atomistic.lammps import Atoms, LammpsFolder, load_data, write_data
from atomistic.settings import GlassSettings, HardnessSettings

CONFIG = Path(__file__).parents[3] / "config"
PMMCS, SILICA = CONFIG / "potentials" / "pmmcs.yaml", CONFIG / "materials" / "silicon_dioxide.yaml"
GLASS, SEGMENT_STEPS = GlassSettings(atoms=150, melt_ps=1, quench_rate_K_ps=1000, rest_ps=1), 300
THIN = PROTOCOL.model_copy(update={"base_over_contact": 0.0})
SETTINGS = HardnessSettings.model_validate(
    {
        "seeds": [1],
        "asperities": [{"name": "tiny", "tiles": 2, "amplitude_nm": 0.2}],
        "glass": GLASS.model_dump(),
        "closing": {"base_nm": 1.4, "speed_m_s": 200, "anneal_ps": 0.2},
    }
)


@pytest.fixture(scope="module")
def glass(potential, oxides, tmp_path_factory):
    work = tmp_path_factory.mktemp("glass") / "work"
    return make_glass(oxides["SiO2"], potential, GLASS, 1, work, segment_steps=SEGMENT_STEPS)


@pytest.fixture(scope="module")
def closing(glass, potential, oxides, tmp_path_factory):
    [full] = planned_runs(SETTINGS)
    work = tmp_path_factory.mktemp("closing") / "work"
    return run_closing(full, oxides["SiO2"], glass, potential, SETTINGS.closing, work, THIN)


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
    # 0.2 meV per atom and ps is the gate
    assert np.abs(column["energy_drift_meV_per_atom"]).max() < 3
    np.testing.assert_allclose(
        column["contact_stress_GPa"][-1] * column["contact_area_nm2"][-1],
        column["force_nN"][-1],
        rtol=1e-9,
    )


def test_snapshots_without_the_flat(closing):
    assert closing.witness[0]["exchanged_bonds"] == 0
    assert closing.witness[-1]["exchanged_bonds"] >= closing.witness[0]["exchanged_bonds"]


KILLED = """
    import sys
    from pathlib import Path
    sys.path.insert(0, {tests!r})
    from test_closing import GLASS, PMMCS, SEGMENT_STEPS, SETTINGS, SILICA, THIN
    from atomistic.hardness.closing import run_closing
    from atomistic.hardness.glass import make_glass
    from atomistic.lammps import load_data
    from atomistic.materials import load_material
    from atomistic.potentials import load_potential
    from atomistic.hardness.runs import planned_runs
    potential, silica = load_potential(PMMCS), load_material(SILICA)
    if {what!r} == "glass":
        make_glass(silica, potential, GLASS, 1, Path({work!r}), segment_steps=SEGMENT_STEPS)
    else:
        glass = load_data({glass!r}, ("Si", "O"))
        run_closing(planned_runs(SETTINGS)[0], silica, glass, potential, SETTINGS.closing,
        Path({work!r}), THIN)
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
    resumed = make_glass(oxides["SiO2"], potential, GLASS, 1, work, segment_steps=SEGMENT_STEPS)
    np.testing.assert_array_equal(resumed.positions_A, glass.positions_A)
    np.testing.assert_array_equal(resumed.cell_A, glass.cell_A)
    assert not work.exists()


def test_killed_closing_resumes_bit_for_bit(glass, potential, oxides, closing, tmp_path):
    work, glass_file = tmp_path / "work", tmp_path / "glass.data"
    write_data(glass_file, glass, {"Si": 28.085, "O": 15.999})
    kill_after("closing", work, work / "closing" / "restart.2", glass_file)
    resumed = run_closing(
        planned_runs(SETTINGS)[0], oxides["SiO2"], glass, potential, SETTINGS.closing, work, THIN
    )
    assert resumed.curve == closing.curve or all(
        np.array_equal(list(a.values()), list(b.values()), equal_nan=True)
        for a, b in zip(resumed.curve, closing.curve, strict=True)
    )
    assert resumed.witness == closing.witness


def test_a_changed_setting_does_not_resume_old_work(tmp_path):
    first = LammpsFolder(tmp_path / "w", {"speed": 50}, "glass.in")
    (first / "restart.1").write_text("")
    assert LammpsFolder(tmp_path / "w", {"speed": 50}, "glass.in").segments_done(3) == 1
    assert LammpsFolder(tmp_path / "w", {"speed": 60}, "glass.in").segments_done(3) == 0


def plant_commands(folder, outside):
    (folder / "pairs").write_text(
        f"shell touch {outside / 'executed'}\n" + (folder / "pairs").read_text()
    )


def plant_links(folder, outside):
    for name in ("table", "restart.partial", "log.lammps", "glass.data"):
        (folder / name).unlink(missing_ok=True)
        (folder / name).symlink_to(outside / "precious")


@pytest.fixture
def outside(tmp_path):
    """A folder that nothing may reach."""
    folder = tmp_path / "outside"
    folder.mkdir()
    (folder / "precious").write_text("mine")
    yield folder
    assert [(path.name, path.read_text()) for path in folder.iterdir()] == [("precious", "mine")]


@pytest.mark.parametrize("plant", [plant_commands, plant_links])
def test_a_received_quench_cannot_run_commands_nor_write_elsewhere(
    plant, glass, potential, oxides, outside, tmp_path
):
    work = tmp_path / "work"
    kill_after("glass", work, work / "restart.2")
    plant(work, outside)
    resumed = make_glass(oxides["SiO2"], potential, GLASS, 1, work, segment_steps=SEGMENT_STEPS)
    np.testing.assert_array_equal(resumed.positions_A, glass.positions_A)


def test_a_received_closing_cannot_run_commands(
    glass, potential, oxides, closing, outside, tmp_path
):
    """Neither the anneal, nor the closing, nor the relaxed snapshots execute what was planted
    beside their restarts.
    """
    work, glass_file = tmp_path / "work", tmp_path / "glass.data"
    write_data(glass_file, glass, {"Si": 28.085, "O": 15.999})
    kill_after("closing", work, work / "closing" / "restart.2", glass_file)
    for folder in ("anneal", "closing"):
        plant_commands(work / folder, outside)
    (work / "anneal" / "restart.2").unlink()
    run = planned_runs(SETTINGS)[0]
    resumed = run_closing(run, oxides["SiO2"], glass, potential, SETTINGS.closing, work, THIN)
    assert resumed.witness == closing.witness


def test_halved_energies_move_as_full_ones_at_twice_the_temperature_in_longer_time(
    glass, potential, tmp_path
):
    """E/2 at T moves like E at 2T with time x sqrt 2: checks table, masses, units and time step at
    once.
    """
    hot = heated(glass, potential, 600)
    slow = replace(hot, velocities_A_ps=hot.velocities_A_ps / np.sqrt(2))
    _, full = free_motion(hot, potential, tmp_path / "full", 1.0, 100)
    _, halved = free_motion(slow, potential, tmp_path / "halved", float(np.sqrt(2)), 100, 0.5)
    apart = full.positions_A - halved.positions_A
    apart -= full.cell_A * np.round(apart / full.cell_A)
    assert np.abs(apart).max() < 1e-5  # Å, after 0.1 ps


def test_names_of_runs_differ():
    runs = planned_runs(HardnessSettings())
    assert len(runs) == len({run.name for run in runs}) == 8  # twins of the two small ones


def test_atoms_take():
    atoms = Atoms(("Si", "O"), np.array([1, 2, 2]), np.eye(3), np.ones(3))
    assert atoms.take(np.array([True, False, True])).count("O") == 1
