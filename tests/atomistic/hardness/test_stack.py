"""A film of oxide on a metal or a nitride: its forces, how it lies, and tiny ones pressed for
real.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial import KDTree

from asperity.guards.errors import InputError
from atomistic.hardness.closing import cut_body, oxide_bond, run_closing
from atomistic.hardness.cost import closing_seconds
from atomistic.hardness.glass import make_glass
from atomistic.hardness.metal import METAL, Metal, MetalNumerics, polycrystal
from atomistic.hardness.motion import free_motion
from atomistic.hardness.network import Network, SlowQuench
from atomistic.hardness.plateau import film_fault, plastic_onset, point
from atomistic.hardness.readout import OxideBond, bonds_of
from atomistic.hardness.runs import PROTOCOL, ClosingRun, planned_runs
from atomistic.hardness.stack import (
    GAP_A,
    Stack,
    base_of,
    check_film,
    cut_base,
    film_properties,
    lay,
)
from atomistic.lammps import Atoms
from atomistic.materials import load_material
from atomistic.settings import AsperitySettings, ClosingSettings, GlassSettings, HardnessSettings

MATERIALS = Path(__file__).parents[3] / "config" / "materials"
TITANIUM, NITRIDE = MATERIALS / "titanium.yaml", MATERIALS / "silicon_nitride.yaml"
GLASS = GlassSettings(atoms=240, melt_ps=0.5, quench_rate_K_ps=2000, rest_ps=0.3)
QUICK = PROTOCOL.model_copy(
    update={
        "base_over_contact": 0.0,
        "frozen_nm": 0.3,
        "thermostat_nm": 0.3,
        "depth_over_amplitude": 1.7,
    }
)
CLOSING = ClosingSettings(base_nm=1.2, speed_m_s=400, anneal_ps=0.1)


@pytest.fixture(scope="module")
def metal():
    return Metal(load_material(TITANIUM))


@pytest.fixture(scope="module")
def glass(potential, oxides, tmp_path_factory):
    return make_glass(
        oxides["SiO2"], potential, GLASS, 1, tmp_path_factory.mktemp("glass") / "work"
    )


@pytest.fixture(scope="module")
def base(metal, glass, tmp_path_factory):
    """A cube as wide as two glass cells, hardly annealed."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            "atomistic.hardness.metal.METAL", MetalNumerics(anneal_ps=0.5, max_strain=0.05)
        )
        return metal, metal.make(
            float(glass.cell_A[0]), 2, 1, tmp_path_factory.mktemp("base") / "work"
        )


@pytest.fixture(scope="module")
def nitride(glass, tmp_path_factory):
    """A cell as wide as one of the glass, melted and quenched in a moment."""
    network = Network(load_material(NITRIDE))
    with pytest.MonkeyPatch.context() as patch:
        quick = SlowQuench(melt_ps=0.3, rate_K_ps=3000.0, rest_ps=0.3)
        patch.setattr("atomistic.hardness.network.QUENCH", quick)
        patch.setattr(Network, "faults", lambda network, glass: [])
        return network, network.make(
            float(glass.cell_A[0]), 2, 1, tmp_path_factory.mktemp("nitride") / "work"
        )


def run_of(film_nm, scale=1.0):
    asperity = AsperitySettings(name="tiny", tiles=2, amplitude_nm=0.25, film_nm=film_nm)
    return ClosingRun(name="tiny", asperity=asperity, seed=1, energy_scale=scale)


def test_grains_fill_the_cell_and_keep_apart(metal):
    body = polycrystal(metal, 40.0, 35.0, 1)
    assert body.positions_A.min() >= 0
    assert not KDTree(body.positions_A, boxsize=body.cell_A).query_pairs(
        METAL.too_near * metal.eam.r_A
    )
    # grain boundaries close in the anneal
    assert 0.88 < len(body) / 40.0**3 * 1e3 / metal.atoms_per_nm3 < 1.0
    neighbours = KDTree(body.positions_A, boxsize=body.cell_A).query_ball_point(
        body.positions_A, 3.5
    )
    assert np.median([len(found) - 1 for found in neighbours]) == 12  # of hexagonal packing


def test_the_cube_has_the_width_asked_for_and_the_density_of_a_metal(glass, base):
    metal, cube = base
    np.testing.assert_allclose(cube.cell_A[:2], 2 * glass.cell_A[0])
    assert 0.93 < len(cube) / np.prod(cube.cell_A) * 1e3 / metal.atoms_per_nm3 < 1.0


def test_the_bond_of_metal_and_oxide_has_its_depth_and_the_force_of_its_energy(metal, potential):
    stack, r = Stack(potential, metal), np.linspace(1.5, 6.0, 2001)
    energy, force = stack.bond("Ti-O", r)
    assert energy.min() == pytest.approx(-0.28, rel=0.01)  # shifted
    at_end = stack.bond("Ti-O", np.array([potential.cutoff_A]))
    np.testing.assert_allclose(at_end, 0, atol=1e-15)
    np.testing.assert_allclose(force[1:-1], -np.gradient(energy, r)[1:-1], atol=2e-4)


def test_each_pair_of_types_has_its_force(metal, potential):
    text = Stack(potential, metal).files(("Ti", "Si", "O"), 1.0)["pairs"]
    commands = [
        line.removeprefix("pair_coeff ")
        for line in text.splitlines()
        if line.startswith("pair_coeff")
    ]
    assert commands == [
        "* * eam/alloy metal.eam Ti NULL NULL",
        "1 2 table cross contact 6.5",
        "1 3 table cross Ti-O 6.5",
        "2 2 table table Si_Si 6.5",
        "2 3 table table Si_O 6.5",
        "3 3 table table O_O 6.5",
    ]


def test_a_nitride_has_its_own_silicon_and_bonds_both_ways(potential):
    stack = Stack(potential, Network(load_material(NITRIDE)))
    lines = stack.files(("Si", "N", "Si", "O"), 1.0)["pairs"].splitlines()
    own = [line.removeprefix("pair_coeff ") for line in lines if line.startswith("pair_coeff")]
    assert lines[0] == "pair_style hybrid/overlay table linear 4000 tersoff harmonic/cut"
    assert own == [
        "* * tersoff base.tersoff Si N NULL NULL",
        "1 1 harmonic/cut 4.0 2.9",
        "2 2 harmonic/cut 4.0 2.75",
        "1 3 table cross contact 6.5",
        "1 4 table cross Si-O 6.5",
        "2 3 table cross N-Si 6.5",
        "2 4 table cross contact 6.5",
        "3 3 table table Si_Si 6.5",
        "3 4 table table Si_O 6.5",
        "4 4 table table O_O 6.5",
    ]


def test_a_film_far_off_leaves_the_energies_of_both_bodies(
    potential, glass, base, nitride, tmp_path
):
    """Each type has its own forces, also where base and film both have silicon."""

    for body, cell in (base, nitride):
        below = len(body.elements)
        body_under_film = lay(cell, glass, 2, 2.5, 6.0, 10.0, 1)
        lift = np.where(body_under_film.types > below, 60.0, 0.0)[:, None] * [0, 0, 1]
        edges = body_under_film.cell_A + np.array([0, 0, 60.0])
        apart = replace(
            body_under_film, positions_A=body_under_film.positions_A + lift, cell_A=edges
        )
        of_base, of_film = apart.types <= below, apart.types > below
        parts = [
            Atoms(body.elements, apart.types[of_base], apart.positions_A[of_base], apart.cell_A),
            Atoms(
                glass.elements,
                apart.types[of_film] - below,
                apart.positions_A[of_film],
                apart.cell_A,
            ),
        ]
        whole, *alone = (
            free_motion(atoms, force, tmp_path / "still", 0.01, 1)[0][0, 1]
            for atoms, force in (
                (apart, Stack(potential, body)),
                (parts[0], body),
                (parts[1], potential),
            )
        )
        assert whole == pytest.approx(sum(alone), rel=1e-9)


def test_a_glass_of_the_base_is_judged_by_its_file(nitride):
    network, cell = nitride
    found = network.properties(cell)
    assert found["density_g_cm3"] == pytest.approx(3.1, abs=0.5)
    assert found["bond_A"] == pytest.approx(1.75, abs=0.05)
    # bonds have two ends
    assert found["coordination_Si"] * 3 == pytest.approx(found["coordination_N"] * 4, rel=1e-9)
    # some bonds are too long now
    thin = Atoms(cell.elements, cell.types, 1.24 * cell.positions_A, 1.24 * cell.cell_A)
    assert any(fault.startswith("density_g_cm3") for fault in network.faults(thin))
    assert network.properties(thin)["coordination_N"] < found["coordination_N"]


def test_halved_energies_leave_the_metal(metal, potential):
    full, half = (Stack(potential, metal).files(("Ti", "Si", "O"), scale) for scale in (1.0, 0.5))
    assert full["metal.eam"] == half["metal.eam"]
    one, other = (np.loadtxt(files["cross"].splitlines()[5:9]) for files in (full, half))
    np.testing.assert_allclose(other[:, 2:], one[:, 2:] / 2)


def test_an_ion_without_cross_terms_is_refused(metal, potential):
    with pytest.raises(
        InputError,
        match="titanium: film_base has no cross terms Ti-N, so that no film with that ion",
    ):
        Stack(potential, metal).files(("Ti", "Si", "N"), 1.0)


def test_a_film_lies_on_its_metal_with_its_thickness(glass, base):
    body = lay(base[1], glass, 2, 2.5, 8.0, 12.0, 1)
    film = body.types > 1
    counts = np.bincount(body.types)[2:]
    assert counts[1] == 2 * counts[0]  # neutral
    x, y, z = body.positions_A[film].T
    assert z.max() < 12.0 + 2.5 + GAP_A + 8.0
    side = float(body.cell_A[0])
    top = np.hypot(x - side / 4, y - side / 4) < 4.0  # about the peak
    assert z[top].min() > 12.0 + 1.0
    volume_A3 = side**2 * 8.0
    # some atoms of so small a film go for its neutrality
    density = len(glass) / np.prod(glass.cell_A)
    assert film.sum() / volume_A3 == pytest.approx(density, rel=0.12)


def test_a_film_that_came_off_or_slid_does_not_count():
    rng = np.random.default_rng(2)
    metal = np.column_stack(
        [np.ones(4000), rng.uniform(0, 40, (4000, 2)), rng.uniform(0, 20, 4000)]
    )
    film = np.column_stack(
        [np.full(4000, 2), rng.uniform(0, 40, (4000, 2)), rng.uniform(21.5, 30, 4000)]
    )
    start = np.concatenate([metal, film])
    assert film_fault(film_properties(start, start, 40.0, 1)) is None
    slid, off, bare = start.copy(), start.copy(), start.copy()
    slid[4000:, 1] += 3.0
    assert film_properties(start, slid, 40.0, 1)["slid_A"] == pytest.approx(3.0)
    assert (
        film_fault(film_properties(start, slid, 40.0, 1))
        == "the film slid by 3.0 A over its base (gate 2.1 A)"
    )
    off[4000:, 3] += 6.0
    assert "a gap of" in str(film_fault(film_properties(off, off, 40.0, 1)))
    bare = bare[(bare[:, 0] == 1) | (bare[:, 1] > 8)]
    assert "the film covers 80% of its base" in str(
        film_fault(film_properties(bare, bare, 40.0, 1))
    )


def test_bonds_join_cation_and_anion_of_the_film_alone(potential, oxides):
    bond = oxide_bond(("Ti", "Si", "O"), oxides["SiO2"], potential)
    assert bond == OxideBond(2, 3, 2.2)
    frame = np.array([[1, 0, 0, 0], [2, 3, 0, 0], [3, 4.6, 0, 0], [3, 1.6, 0, 0], [1, 1.5, 0, 0]])
    assert bonds_of(frame, bond, 1.0, 50.0) == {(1, 2), (1, 3)}
    assert oxide_bond(("Ti",), oxides["SiO2"], potential) is None
    assert bonds_of(frame, None, 1.0, 50.0) == set()


def test_where_a_metal_lies_below_the_lasting_lowering_is_the_witness():
    """Its grain boundaries change bonds at rest, and the film settles before contact: both count
    for nothing.
    """
    lowering = (0.0, 0.12, 0.13, 0.14, 0.2, 0.3)
    rows = [
        {"displacement_nm": 0.1 * k, "new_exchanges": 80, "lowering_nm": low}
        for k, low in enumerate(lowering)
    ]
    onset = plastic_onset(rows, 0.1, by_bonds=False)
    assert onset.displacement_nm == pytest.approx(0.4)
    assert plastic_onset(rows, 0.1).displacement_nm is None


@pytest.fixture(scope="module")
def pressed(potential, oxides, glass, base, tmp_path_factory):
    """A film on titanium, pressed."""
    work = tmp_path_factory.mktemp("pressed") / "work"
    return run_closing(
        run_of(0.4), oxides["SiO2"], glass, potential, CLOSING, work, QUICK, base=base
    )


def test_a_film_that_is_stopped_goes_on_as_if_it_had_not_been(
    pressed, potential, oxides, glass, base, tmp_path
):
    class Stopped(Exception):
        pass

    def stop(share, doing):
        if (tmp_path / "work" / "closing" / "restart.2").exists():
            raise Stopped

    given = (run_of(0.4), oxides["SiO2"], glass, potential, CLOSING, tmp_path / "work", QUICK)
    with pytest.raises(Stopped):
        run_closing(*given, stop, base=base)
    resumed = run_closing(*given, base=base)
    for part in ("curve", "witness", "summary"):
        # bit for bit; NaN where no stress is
        np.testing.assert_equal(getattr(resumed, part), getattr(pressed, part))


def test_a_film_is_pressed_and_keeps_its_energy(pressed):
    column = {name: np.array([row[name] for row in pressed.curve]) for name in pressed.curve[0]}
    assert column["force_nN"].max() > 1
    assert np.abs(column["energy_drift_meV_per_atom"]).max() < 3
    assert all(np.isnan(row["top_force_over_hamaker"]) for row in pressed.witness)
    assert pressed.summary["covered_share"] > 0.9
    assert pressed.summary["slid_A"] < 2.1
    summary = {
        **pressed.summary,
        "run": "tiny",
        "energy_scale": 1.0,
        "asperity": "tiny",
        "amplitude_nm": 0.25,
    }
    summary |= {"film_nm": 0.4, "seed": 1, "lammps_cpu_s": 1.0, "slid_A": 5.0}
    row = point(pressed.curve, pressed.witness, summary, "pmmcs")
    assert row["status"] == "rejected: the film slid by 5.0 A over its base (gate 2.1 A)"


def test_a_film_on_nitride_and_nitride_itself_are_pressed(
    potential, oxides, glass, nitride, tmp_path
):
    quick = CLOSING.model_copy(update={"speed_m_s": 800})
    for film_nm in (0.4, 0.0):
        work = tmp_path / f"{film_nm:g}"
        closing = run_closing(
            run_of(film_nm), oxides["SiO2"], glass, potential, quick, work, QUICK, base=nitride
        )
        assert max(row["force_nN"] for row in closing.curve) > 1
        assert np.abs([row["energy_drift_meV_per_atom"] for row in closing.curve]).max() < 3
    silicon, nitrogen = np.bincount(cut_base(nitride[1], glass, 2, 2.5, 12.0, 1).types)[1:]
    assert 4 * silicon == 3 * nitrogen


def test_the_metal_is_pressed_by_itself(potential, oxides, glass, base, tmp_path):
    closing = run_closing(
        run_of(0.0), oxides["SiO2"], glass, potential, CLOSING, tmp_path / "work", QUICK, base=base
    )
    assert max(row["force_nN"] for row in closing.curve) > 1


def test_a_film_thinner_than_a_layer_or_thicker_than_the_widest_contact_is_refused(
    potential, glass, base
):
    check_film(0.6, 3.5)
    for thickness in (0.1, 4.0):
        with pytest.raises(
            InputError,
            match=r"whose widest judged contact is 3\.5 nm, accepted are 0\.3 \(one layer\)",
        ):
            check_film(thickness, 3.5)
    with pytest.raises(InputError, match="film_nm = 9: on an asperity"):
        cut_body(run_of(9.0), glass, potential, 1.2, (1,), base)
    with pytest.raises(
        InputError, match=r"asperity tiny: film_nm = 0\.4 needs a body below; set hardness\.base"
    ):
        cut_body(run_of(0.4), glass, potential, 1.2, (1,))


def stacked_settings(**changed):
    asperities = [
        {"name": "oxide", "tiles": 2, "amplitude_nm": 0.5},
        {"name": "metal", "tiles": 2, "amplitude_nm": 0.5, "film_nm": 0},
        {"name": "thick", "tiles": 2, "amplitude_nm": 0.5, "film_nm": 2},
        {"name": "thin", "tiles": 2, "amplitude_nm": 0.5, "film_nm": 0.6},
    ]
    return HardnessSettings.model_validate(
        {"base": "titanium", "seeds": [1], "asperities": asperities, **changed}
    )


def test_films_have_one_energy_scale():
    runs = planned_runs(stacked_settings(energy_scales=[1.0, 0.5]))
    assert [run.name for run in runs if run.asperity.name != "oxide"] == [
        f"{name}_seed1_full" for name in ("metal", "thick", "thin")
    ]
    assert len(runs) == 5


def test_the_plan_prices_the_metal_and_refuses_a_film_too_thick(oxides):
    titanium = base_of(load_material(TITANIUM))
    seconds = closing_seconds(stacked_settings(), oxides["SiO2"], titanium)
    assert seconds["thick_seed1_full"] > seconds["thin_seed1_full"] > seconds["metal_seed1_full"]
    thick = stacked_settings(
        asperities=[{"name": "a", "tiles": 2, "amplitude_nm": 0.5, "film_nm": 5}]
    )
    with pytest.raises(
        InputError, match="film_nm = 5: on an asperity whose widest judged contact is 3"
    ):
        closing_seconds(thick, oxides["SiO2"], titanium)


def test_films_and_their_metal_belong_together():
    with pytest.raises(
        ValidationError, match="thin has a film_nm, but there is no base; name what lies below"
    ):
        stacked_settings(
            base=None,
            asperities=[{"name": "thin", "tiles": 2, "amplitude_nm": 0.5, "film_nm": 0.6}],
        )
    with pytest.raises(
        ValidationError, match="no asperity has a film_nm; add it, or leave base out"
    ):
        stacked_settings(asperities=[{"name": "oxide", "tiles": 2, "amplitude_nm": 0.5}])


def test_metals_are_checked_on_loading(tmp_path):
    text = TITANIUM.read_text()
    path = tmp_path / "titanium.yaml"
    path.write_text(text.replace("formula: {Ti: 1}", "formula: {Ti: 1, O: 2}"))
    with pytest.raises(InputError, match="eam: needs a formula of one element, got TiO2"):
        load_material(path)
    path.write_text(text.replace("  grain_nm: 3.0", "  # grain_nm: 3.0"))
    with pytest.raises(InputError, match="grain_nm is of a metal, and every metal needs it"):
        load_material(path)
    path.write_text(text.replace("  eta: 0.558572\n", ""))
    with pytest.raises(InputError, match=r"eam\.eta is missing"):
        load_material(path)
    path.write_text(text.replace("  area_error: 0.05", "  # area_error: 0.05"))
    with pytest.raises(InputError, match=r"film_base\.area_error is missing"):
        load_material(path)
