"""A given map under a flat: Hertz, Boussinesq's punch, the cycle of a scene, and what must hold for
any map.
"""

import numpy as np
import pytest

import asperity as asp
from asperity import pressed_map
from mesoscale.contact.surface import random_surface

PIXELS, SIDE, RADIUS, E_STAR = 128, 200.0, 1000.0, 100.0
X = (np.arange(PIXELS) + 0.5) * SIDE / PIXELS - SIDE / 2
R = np.hypot(X[:, None], X)
SPHERE = -(R**2) / (2 * RADIUS)
INPUTS = asp.ContactInputs(0.215, 91.0, 1.95, 8.375, q0=0.06, hurst=0.75, rms=3.0)
GRID = asp.ContactSettings(mechanics="coupled", pixels=64, length_nm=250.0, q1_per_nm=0.3)


def test_a_sphere_alone_is_hertzs():
    """To the width of a site over the contact radius, which has 12 to 21 sites."""
    loads = np.array([1000.0, 5000.0])
    pressed = asp.press(SPHERE, SIDE, loads, E_STAR, periodic=False)
    radius = (0.75 * loads * RADIUS / E_STAR) ** (1 / 3)
    assert pressed.converged
    np.testing.assert_allclose(pressed.loads_nN, loads, rtol=1e-5)
    np.testing.assert_allclose(
        pressed.pressure_GPa.sum((1, 2)) * (SIDE / PIXELS) ** 2, loads, rtol=1e-5
    )
    np.testing.assert_allclose(SIDE * np.sqrt(pressed.area_share / np.pi), radius, rtol=0.02)
    np.testing.assert_allclose(pressed.approach_nm, radius**2 / RADIUS, rtol=0.003)
    np.testing.assert_allclose(
        pressed.pressure_GPa.max((1, 2)), 1.5 * loads / (np.pi * radius**2), rtol=0.003
    )
    # the gap beside the contact (Johnson 1985, eq. 3.42a)
    beside = 1.2 * radius[1] < R
    a, r = radius[1], R[beside]
    lowered = (
        radius[1]
        / (np.pi * RADIUS)
        * ((2 - (r / a) ** 2) * np.arcsin(a / r) + np.sqrt((r / a) ** 2 - 1))
        * a
    )
    wanted = r**2 / (2 * RADIUS) - a**2 / RADIUS + lowered
    np.testing.assert_allclose(pressed.gap_nm[1][beside], wanted, atol=0.002 * wanted.max())


@pytest.mark.parametrize("yields", [{}, {"h_macro": 20.0}])
def test_an_approach_gives_the_load_that_gives_it(yields):
    """To the width of steps where it yields, which come by another way."""
    by_load = asp.press(SPHERE, SIDE, [1000.0, 5000.0], E_STAR, periodic=False, **yields)
    pressed = asp.press(
        SPHERE, SIDE, None, E_STAR, periodic=False, approach_nm=by_load.approach_nm, **yields
    )
    np.testing.assert_allclose(pressed.approach_nm, by_load.approach_nm, rtol=1e-9)
    np.testing.assert_allclose(pressed.loads_nN, by_load.loads_nN, rtol=2e-3 if yields else 1e-6)
    assert pressed.converged


def test_a_flat_punch_alone_is_boussinesqs():
    """Stiffness 2 E* a, pressure F / (2 pi a^2) in the middle; its radius has 32 sites."""
    radius, load = 50.0, 1e4
    pressed = asp.press(np.where(radius > R, 0.0, -500.0), SIDE, load, E_STAR, periodic=False)
    assert pressed.area_share[0] == np.mean(radius > R)
    assert load / pressed.approach_nm[0] == pytest.approx(2 * E_STAR * radius, rel=0.005)
    middle = pressed.pressure_GPa[0, PIXELS // 2, PIXELS // 2]
    assert middle == pytest.approx(load / (2 * np.pi * radius**2), rel=0.005)


def test_a_rectangle_is_the_part_of_a_square_that_touches():
    part = asp.press(SPHERE[:, 32:96], (SIDE, SIDE / 2), 1000.0, E_STAR, periodic=False)
    whole = asp.press(SPHERE, SIDE, 1000.0, E_STAR, periodic=False)
    np.testing.assert_allclose(part.pressure_GPa, whole.pressure_GPa[:, :, 32:96], atol=1e-6)
    assert part.lengths_nm == (SIDE, SIDE / 2)


@pytest.mark.parametrize("model", ["elastic", "plastic"])
def test_a_periodic_map_is_pressed_as_in_a_cycle(model):
    settings = GRID.model_copy(update={"model": model, "max_force_nN": 2000.0})
    surface = asp.random_surface(INPUTS, settings, 3)
    cycle = asp.run_cycle(INPUTS, settings, 3)
    yields = {"h_macro": 1.95, "h_prime": 8.375} if model == "plastic" else {}

    def law(gap):
        return INPUTS.hamaker / (6 * np.pi * (gap + settings.gap_cutoff_nm) ** 3)

    pressed = asp.press(
        surface, 250.0, [500.0, 2000.0], 91.0, contact_at="lowest", attraction=law, **yields
    )
    assert pressed.separation_nm[-1] == pytest.approx(cycle.closing.separation_nm[-1], abs=2e-3)
    assert pressed.attraction_nN[-1] == pytest.approx(cycle.closing.attractive_nN[-1], rel=0.01)
    np.testing.assert_array_equal(pressed.gap_nm[pressed.pressure_GPa > 0], 0)


def test_of_two_maps_only_the_sum_counts():
    first, second = (asp.random_surface(INPUTS, GRID, seed) for seed in (1, 2))
    both = asp.press(first, 250.0, 500.0, 91.0, counterface=second)
    one = asp.press(first + second[::-1], 250.0, 500.0, 91.0)
    np.testing.assert_array_equal(both.pressure_GPa, one.pressure_GPa)


def test_neighbours_lower_a_periodic_sphere():
    """By 3.900 F / (pi E* L), a lattice of point forces less its mean, on a cell 20 times as wide
    as the contact.
    """
    free, repeated = (
        asp.press(SPHERE, SIDE, 100.0, E_STAR, periodic=each) for each in (False, True)
    )
    lowered = free.approach_nm[0] - repeated.approach_nm[0]
    assert lowered == pytest.approx(3.90026 * 100.0 / (np.pi * E_STAR * SIDE), rel=0.03)
    assert free.pressure_GPa.max() == pytest.approx(repeated.pressure_GPa.max(), rel=0.003)


def test_a_pressed_map_is_drawn_and_says_what_it_is():
    pressed = asp.press(SPHERE, SIDE, [100.0, 1000.0], E_STAR)
    assert [axes.get_xlabel() for axes in pressed.plot().axes[:2]] == ["x (µm)"] * 2
    lines = pressed.plot_pressures().axes[0].patches
    shown_nm2 = [line.get_data().values.sum() for line in lines]
    assert shown_nm2 == pytest.approx(pressed.area_share * SIDE**2)
    assert repr(pressed) == "Map of 128 x 128 sites; loads: 2"
    assert list(pressed.lines())[2].startswith("1000 nN: ")


@pytest.mark.parametrize(
    ("periodic", "hardness", "needed"),
    [
        (True, {"h_macro": 5.0, "h_prime": 1.0}, "0.00256"),
        (False, {"h_macro": 5.0, "h_prime": 1.0}, "0.00944"),
        (True, {"h_macro": 5.0}, "0.000819"),
        (True, {}, "0.000819"),
        (False, {}, "0.00147"),
    ],
)
def test_a_map_beyond_memory_is_refused(monkeypatch, periodic, hardness, needed):
    monkeypatch.setattr("mesoscale.checks.machine_MB", lambda: 0.5)
    with pytest.raises(
        asp.InputError, match=f"needs {needed} GB of memory, this machine has 0.0005; take a part"
    ):
        asp.press(SPHERE, SIDE, 100.0, E_STAR, periodic=periodic, **hardness)


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize("h_macro", [None, 3.0])
def test_loads_one_by_one_are_those_of_the_way(monkeypatch, periodic, h_macro):
    heights = random_surface(INPUTS, GRID, 3)
    loads = np.linspace(500.0, 4000.0, 5)

    def pressed() -> asp.PressedMap:
        return asp.press(heights, 250.0, loads, E_STAR, h_macro=h_macro, periodic=periodic)

    monkeypatch.setattr(pressed_map, "_one_by_one", lambda *_: True)
    alone = pressed()
    monkeypatch.setattr(pressed_map, "_one_by_one", lambda *_: False)
    way = pressed()
    assert alone.converged
    assert way.converged
    np.testing.assert_array_equal(alone.pressure_GPa > 0.0, way.pressure_GPa > 0.0)
    np.testing.assert_allclose(alone.separation_nm, way.separation_nm, atol=1e-5)
    np.testing.assert_allclose(alone.loads_nN, way.loads_nN, rtol=1e-5)


@pytest.mark.parametrize("periodic", [True, False])
def test_maps_of_many_loads_are_counted_in_memory(monkeypatch, periodic):
    """Pressure and gap: 16 bytes a site and load. Seen as the space that the result takes."""
    loads = np.linspace(10.0, 100.0, 50)
    pressed = asp.press(SPHERE, SIDE, loads, E_STAR, periodic=periodic)
    kept = 16 * 50 * PIXELS**2
    assert pressed.pressure_GPa.base is None  # no larger array is kept for it
    assert pressed.pressure_GPa.nbytes + pressed.gap_nm.nbytes == kept
    contact = 140 * PIXELS**2 * (1 if periodic else 4)
    monkeypatch.setattr("mesoscale.checks.machine_MB", lambda: 1e-6 * (contact + 0.9 * kept))
    with pytest.raises(asp.InputError, match=r"with 0\.0131 GB of maps, needs .* or fewer loads"):
        asp.press(SPHERE, SIDE, loads, E_STAR, periodic=periodic)
    assert asp.press(SPHERE, SIDE, loads[:10], E_STAR, periodic=periodic).converged


@pytest.mark.parametrize(
    "side", [np.float32(SIDE), np.int64(SIDE), np.array(SIDE), [SIDE, SIDE], np.full(2, SIDE)]
)
def test_a_side_is_a_number_or_two_of_any_kind(side):
    np.testing.assert_array_equal(
        asp.press(SPHERE, side, 100.0, E_STAR).pressure_GPa,
        asp.press(SPHERE, SIDE, 100.0, E_STAR).pressure_GPa,
    )


def test_an_attraction_that_writes_into_its_gaps_changes_no_result():
    def spoiling(gap):
        pull = 0.01 / (6 * np.pi * (gap + 0.3) ** 3)
        gap[:] = 7.0
        return pull

    spoiled = asp.press(SPHERE, SIDE, 100.0, E_STAR, attraction=spoiling)
    clean = asp.press(
        SPHERE, SIDE, 100.0, E_STAR, attraction=lambda gap: 0.01 / (6 * np.pi * (gap + 0.3) ** 3)
    )
    np.testing.assert_array_equal(spoiled.gap_nm, clean.gap_nm)
    assert spoiled.attraction_nN.tolist() == clean.attraction_nN.tolist()


def test_only_maps_that_repeat_have_no_tilt():
    """A wave as long as the map seems tilted, a levelled map is not, and one that stands alone may
    be.
    """
    wave = 3.0 * np.sin(2 * np.pi * X / SIDE)[:, None] + 0.0 * X
    rough = np.random.default_rng(1).normal(0.0, 3.0, SPHERE.shape)
    for levelled in (wave, rough, SPHERE):
        assert asp.press(levelled, SIDE, 100.0, E_STAR).converged
    tilted = rough + np.linspace(0.0, 500.0, PIXELS)
    assert asp.press(tilted, SIDE, 100.0, E_STAR, periodic=False).converged
    for heights, axis in ((tilted, "y"), (tilted.T, "x")):
        with pytest.raises(
            asp.InputError, match=f"tilted by 5.. nm along {axis}, the roughness is [23]"
        ):
            asp.press(heights, SIDE, 100.0, E_STAR)
        with pytest.raises(asp.InputError, match=f"tilted by 5.. nm along {axis}"):
            asp.run_cycle(
                INPUTS, GRID, 1, 100.0, heights=heights, length_nm=SIDE, contact_at="highest"
            )


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"side_nm": None}, "side_nm"),
        ({"side_nm": "200"}, "side_nm"),
        ({"side_nm": (None, 200.0)}, "side_nm"),
        ({"side_nm": (200.0, 200.0, 200.0)}, "one length in nm, or the lengths"),
        ({"side_nm": np.ma.masked}, "side_nm"),
        ({"side_nm": 1j}, "side_nm"),
        ({"heights": None}, "heights"),
        ({"heights": SPHERE[:3, :3]}, "at least 4 x 4 sites"),
        ({"loads_nN": np.ones((2, 2))}, "loads_nN: accepted are rising"),
        ({"loads_nN": [[1.0], [2.0, 3.0]]}, "loads_nN: rows of different length"),
        (
            {"loads_nN": np.ma.array([1.0, 2.0], mask=[False, True])},
            "loads_nN: 1 values are masked",
        ),
        ({"loads_nN": None, "approach_nm": np.ones((2, 2))}, "approach_nm: accepted are rising"),
        (
            {"loads_nN": None, "approach_nm": np.ma.array([1.0, 2.0], mask=[0, 1])},
            "approach_nm: 1 values are masked",
        ),
        ({"periodic": "False"}, "periodic = 'False': accepted are True and False"),
        ({"periodic": 0}, "periodic = 0"),
        ({"attraction": 0.2}, "attraction = 0.2: accepted is a function"),
        ({"attraction": lambda: 1.0}, "takes 0 positional arguments"),
        ({"attraction": lambda gap: None}, "attraction"),
        ({"attraction": lambda gap: -np.ones_like(gap)}, r"-1 \.\. 0 GPa where sites do not touch"),
        (
            {"attraction": lambda gap: np.full_like(gap, 1e6)},
            r"0 \.\. 1e\+06 GPa where sites do not touch",
        ),
        ({"attraction": lambda gap: np.ones((2, 2))}, "shape"),
        ({"h_prime": 8.0}, "without h_macro"),
        ({"h_macro": 0.0}, "h_macro = 0 GPa: the surface would carry nothing"),
        ({"counterface": "map"}, "counterface: values of type"),
        ({"heights": SPHERE[:, :64]}, "periodic=False"),
        ({"heights": SPHERE[0]}, "a map of at least 3 x 3"),
        ({"heights": np.where(R < 5, np.nan, SPHERE)}, "not finite"),
        ({"heights": 1e-9 * SPHERE}, "give both in nm"),
        ({"side_nm": (200.0, 100.0)}, "must be squares"),
        ({"loads_nN": [10.0, 5.0]}, "loads_nN: accepted are rising"),
        ({"loads_nN": []}, "loads_nN: accepted are rising"),
        ({"loads_nN": None}, "either loads_nN or approach_nm"),
        ({"approach_nm": 1.0}, "either loads_nN or approach_nm"),
        ({"loads_nN": None, "approach_nm": -1.0}, "approach_nm"),
        ({"loads_nN": None, "approach_nm": 50.0}, "full contact"),
        ({"loads_nN": 1e9}, "full contact"),
        ({"loads_nN": 1e9, "h_macro": 2.0}, "hardness"),
        ({"e_star": -1.0}, "e_star"),
        ({"counterface": SPHERE[1:, 1:]}, "one shape"),
        ({"contact_at": "top"}, "highest"),
        ({"attraction": lambda gap: 1.0}, "a function of an array"),
        ({"attraction": lambda gap: gap / 0}, "finite"),
    ],
)
@pytest.mark.filterwarnings("ignore:divide by zero", "ignore:invalid value")
def test_what_is_no_map_is_refused_in_one_line(changes, words):
    call = {"heights": SPHERE, "side_nm": SIDE, "loads_nN": 100.0, "e_star": E_STAR} | changes
    with pytest.raises(asp.InputError, match=words) as refusal:
        asp.press(**call)
    assert "\n" not in str(refusal.value)


def test_maps_are_a_dataset_and_loads_a_table():
    pressed = asp.press(two_bumps(), (64.0, 32.0), [1.0, 20.0], 50.0, periodic=False)
    maps = pressed.to_xarray()
    assert maps.pressure.dims == ("load", "x", "y")
    assert maps.pressure.attrs["units"] == "GPa"
    site_nm2 = 64.0 * 32.0 / pressed.gap_nm[0].size
    assert maps.pressure.sum(("x", "y")).to_numpy() * site_nm2 == pytest.approx([1.0, 20.0])
    assert maps.x.to_numpy()[[0, -1]] == pytest.approx([0.5, 63.5])
    table = pressed.to_frame()
    assert list(table.area_share) == list(pressed.area_share)


def test_spots_of_two_bumps_are_two_and_share_the_area():
    pressed = asp.press(two_bumps(), (64.0, 32.0), 20.0, 50.0, periodic=False)
    areas = pressed.spot_areas_nm2()
    assert areas.size == 2
    assert areas.sum() == pytest.approx(pressed.area_share[0] * 64.0 * 32.0)
    assert areas[0] > areas[1], "the higher bump carries more"


def two_bumps():
    """Two caps of radius 20 nm, 32 nm apart along x, one 0.1 nm higher; 64 x 32 sites of 1 nm2."""
    x, y = np.meshgrid(np.arange(64) + 0.5, np.arange(32) + 0.5, indexing="ij")
    centres = {16.0: 0.0, 48.0: -0.1}
    caps = [top - ((x - place) ** 2 + (y - 16.0) ** 2) / 40.0 for place, top in centres.items()]
    return np.maximum(*caps)
