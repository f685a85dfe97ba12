from dataclasses import replace

import numpy as np
import pytest

from mesoscale.contact import attraction, run_cycle
from mesoscale.contact.asperity import engine
from mesoscale.contact.energy import pull_off
from mesoscale.contact.numerics import Numerics
from mesoscale.contact.surface import random_surface
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.topography.synthesis import synthesize

INPUTS = ContactInputs(
    hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5
)
MODELS = ["elastic", "nonlinear", "plastic"]


def settings_for(**changes) -> ContactSettings:
    return ContactSettings(
        **{
            "mechanics": "asperity",
            "pixels": 256,
            "length_nm": 250.0,
            "max_force_nN": 500.0,
            **changes,
        }
    )


def work(branch) -> float:
    """Work against the repulsion, nN nm; negative on closing."""
    return float(np.trapezoid(branch.repulsive_nN, branch.separation_nm))


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("seed", [1, 2])
def test_a_cycle_is_physical(model, seed):
    cycle = run_cycle(INPUTS, settings_for(model=model), seed)
    closing, opening = cycle.closing, cycle.opening
    assert cycle.converged
    for branch in (closing, opening):
        assert all(np.isfinite(array).all() for array in vars(branch).values())
        assert (branch.repulsive_nN >= 0).all()
        assert (branch.attractive_nN < 0).all()
    assert (np.diff(closing.separation_nm) < 0).all()
    assert (np.diff(opening.separation_nm) > 0).all()
    # the flag is the distance itself, to rounding
    assert abs(closing.repulsive_nN[-1] / 500.0 - 1) == pytest.approx(
        cycle.flags["force_miss"], abs=1e-12
    )
    assert cycle.flags["force_miss"] < 0.02  # one site more or less in contact
    for name in ("separation_nm", "repulsive_nN", "attractive_nN", "contact_area_nm2"):
        assert getattr(opening, name)[0] == getattr(closing, name)[-1]
    dissipated = -work(closing) - work(opening)
    if model == "plastic":
        assert dissipated > 0.2 * -work(closing)
        assert cycle.last_contact_nm < cycle.first_contact_nm
    else:
        assert dissipated == pytest.approx(0.0, abs=1e-9 * -work(closing))
        assert cycle.last_contact_nm == cycle.first_contact_nm
    touching = closing.repulsive_nN > 0
    assert (closing.separation_nm[touching] < cycle.first_contact_nm).all()
    assert closing.separation_nm[~touching].min() == cycle.first_contact_nm


def test_plasticity_softens_and_yield_limits_the_pressure():
    """Elastic > capped; the mean pressure of a yielded contact lies below the hardness of one
    site.
    """
    ends = {model: run_cycle(INPUTS, settings_for(model=model), 1).closing for model in MODELS}
    assert ends["elastic"].separation_nm[-1] > ends["nonlinear"].separation_nm[-1]
    assert ends["elastic"].separation_nm[-1] > ends["plastic"].separation_nm[-1]
    pressure = 500.0 / ends["plastic"].contact_area_nm2[-1]
    one_site = 1.95 + 8.375 * (250 / 256) ** -0.5
    assert 1.95 < pressure < one_site


def test_a_harder_surface_is_the_elastic_one():
    hard = ContactInputs(**{**vars(INPUTS), "h_macro": 1e6})
    plastic = run_cycle(hard, settings_for(), 1)
    elastic = run_cycle(hard, settings_for(model="elastic"), 1)
    assert plastic.flags["changed_sites"] == 0
    np.testing.assert_allclose(
        plastic.closing.repulsive_nN, elastic.closing.repulsive_nN, rtol=1e-12
    )


def test_forces_scale_with_the_materials():
    """Stiffness, hardness and Hamaker constant times three: the same curve with three times the
    force.
    """
    one = run_cycle(INPUTS, settings_for(), 1, 500.0)
    scaled = {
        name: 3 * getattr(INPUTS, name) for name in ("hamaker", "e_star", "h_macro", "h_prime")
    }
    three = run_cycle(ContactInputs(**{**vars(INPUTS), **scaled}), settings_for(), 1, 1500.0)
    np.testing.assert_allclose(three.closing.separation_nm, one.closing.separation_nm, rtol=1e-9)
    np.testing.assert_allclose(
        three.opening.repulsive_nN, 3 * one.opening.repulsive_nN, rtol=1e-6, atol=1e-6
    )
    np.testing.assert_allclose(
        three.opening.attractive_nN, 3 * one.opening.attractive_nN, rtol=1e-6
    )


def test_the_same_seed_gives_the_same_bits():
    one, two = (run_cycle(INPUTS, settings_for(), 3) for _ in range(2))
    for branch in ("closing", "opening"):
        for name, values in vars(getattr(one, branch)).items():
            np.testing.assert_array_equal(values, getattr(getattr(two, branch), name))


def test_cycles_on_the_changed_surface_shake_down():
    """The second closing to the same force follows the first opening, and hardly anything flows any
    more.
    """
    settings = settings_for()
    first = run_cycle(INPUTS, settings, 1, keep_surface=True)
    second = run_cycle(
        INPUTS, settings, 1, heights=first.heights, contact_at="lowest", keep_surface=True
    )
    assert second.first_contact_nm == pytest.approx(first.last_contact_nm, abs=1e-12)
    assert second.first_contact_nm < first.first_contact_nm
    loss = [-work(c.closing) - work(c.opening) for c in (first, second)]
    assert loss[1] < 0.3 * loss[0]
    assert abs(second.heights.mean() - first.heights.mean()) < 1e-13


def test_a_larger_load_continues_a_smaller_one():
    """A closing interrupted by opening reaches the same end as one without, but for the path's
    steps.
    """
    settings, fine = settings_for(), Numerics(force_steps=100)
    half = run_cycle(INPUTS, settings, 1, 250.0, keep_surface=True, numerics=fine)
    continued = run_cycle(
        INPUTS, settings, 1, 500.0, heights=half.heights, contact_at="lowest", numerics=fine
    ).closing
    direct = run_cycle(INPUTS, settings, 1, 500.0, numerics=fine).closing
    assert continued.separation_nm[-1] == pytest.approx(direct.separation_nm[-1], abs=0.1)


def test_given_heights_are_not_changed_and_their_mean_plane_counts():
    heights = synthesize(256, 250.0, 0.025, 0.75, 8.5, 1)
    kept = heights.copy()
    own = run_cycle(INPUTS, settings_for(), 1)
    given = run_cycle(INPUTS, settings_for(), 99, heights=heights, contact_at="lowest")
    np.testing.assert_array_equal(heights, kept)
    np.testing.assert_allclose(given.closing.separation_nm, own.closing.separation_nm, rtol=1e-12)
    lifted = run_cycle(
        INPUTS, settings_for(model="elastic"), 99, heights=heights + 4.0, contact_at="lowest"
    )
    assert lifted.first_contact_nm == pytest.approx(own.first_contact_nm, rel=1e-12)


def test_nothing_is_spent_on_an_attraction_that_is_absent(monkeypatch):
    calls = []

    def counted(name, function):
        return lambda *arguments: calls.append(name) or function(*arguments)

    for name in ("bin_heights", "inverse_cubes", "take_out"):
        monkeypatch.setattr(attraction, name, counted(name, getattr(attraction, name)))
    without = ContactInputs(**{**vars(INPUTS), "hamaker": 0.0})
    cycle = run_cycle(without, settings_for(), 1)
    assert not calls
    assert not cycle.closing.attractive_nN.any()
    run_cycle(INPUTS, settings_for(), 1)
    assert calls.count("bin_heights") == 2  # the surface, and what flow changed before opening


def test_elastic_models_copy_no_surface_and_never_flow(monkeypatch):
    heights = synthesize(256, 250.0, 0.025, 0.75, 8.5, 1)
    held = []
    start = engine.AsperityContact.__init__

    def remember(self, surface, *rest):
        held.append(surface)
        start(self, surface, *rest)

    monkeypatch.setattr(engine.AsperityContact, "__init__", remember)
    monkeypatch.setattr(
        engine.kernels, "settle", lambda *a: pytest.fail("an elastic surface flowed")
    )
    for model in ("elastic", "nonlinear"):
        run_cycle(INPUTS, settings_for(model=model), 1, heights=heights, contact_at="lowest")
    assert all(np.shares_memory(surface, heights) for surface in held)


def test_a_flat_surface_touches_everywhere():
    cycle = run_cycle(
        INPUTS,
        settings_for(model="elastic"),
        1,
        heights=np.zeros((64, 64)),
        contact_at="lowest",
        length_nm=250.0,
    )
    assert cycle.converged
    assert cycle.first_contact_nm == 0.0
    assert cycle.closing.contact_area_nm2[-1] == pytest.approx(250.0**2)


ROUGH = synthesize(256, 250.0, 0.025, 0.75, 8.5, 1)  # nm


@pytest.mark.parametrize(
    ("heights", "words"),
    [
        (np.zeros((4, 5)), "square"),
        (np.zeros(9), "square"),
        (np.zeros((2, 2)), "4 x 4"),
        (np.full((8, 8), np.nan), "finite"),
        (np.where(np.eye(256), np.inf, 0), "finite"),
        (np.ma.masked_greater(ROUGH, 10.0), "masked"),
        (ROUGH + 0j, "complex128"),
        (ROUGH > 0, "bool"),
        (ROUGH.astype(str), "real numbers"),
        ([[0.0, 1.0], [2.0]], "rectangular"),
        (ROUGH[::2, ::2], "128 x 128 sites, but settings.pixels = 256"),
        (1e-9 * ROUGH, "both in nm"),
        (1e9 * ROUGH, "both in nm"),
    ],
)
def test_bad_surfaces_are_refused_in_one_line(heights, words):
    with pytest.raises(InputError, match=words) as refusal:
        run_cycle(INPUTS, settings_for(), 1, heights=heights, contact_at="lowest")
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("length_nm", [0.0, -250.0, 250e-9, np.nan, "250", True])
def test_a_side_that_is_no_length_in_nm_is_refused(length_nm):
    with pytest.raises(InputError, match=r"length_nm = .* nm"):
        run_cycle(
            INPUTS, settings_for(), 1, heights=ROUGH, contact_at="lowest", length_nm=length_nm
        )


def test_measured_heights_touch_at_their_peaks_and_heights_of_no_stated_side_are_refused():
    own = run_cycle(INPUTS, settings_for(), 1, heights=ROUGH, contact_at="lowest")
    measured = run_cycle(INPUTS, settings_for(), 1, heights=-ROUGH, contact_at="highest")
    np.testing.assert_array_equal(measured.opening.repulsive_nN, own.opening.repulsive_nN)
    with pytest.raises(
        InputError, match="say where heights touch the flat: highest, as an instrument"
    ):
        run_cycle(INPUTS, settings_for(), 1, heights=ROUGH)


def test_a_surface_beyond_memory_is_refused_before_it_is_made(monkeypatch):
    monkeypatch.setattr("mesoscale.checks.machine_MB", lambda: 16_000)
    monkeypatch.setattr("mesoscale.contact.cycle.random_surface", None)
    settings = ContactSettings(mechanics="coupled").model_copy(update={"pixels": 16384})
    with pytest.raises(
        InputError, match=r"needs 37\.6 GB of memory, this machine has 16; take a part"
    ) as refusal:
        run_cycle(INPUTS, settings, 1)
    assert "\n" not in str(refusal.value)


def test_a_side_without_heights_is_refused():
    with pytest.raises(InputError, match="give both"):
        run_cycle(INPUTS, settings_for(), 1, length_nm=250.0)


def test_given_heights_bring_their_own_grid_and_side():
    """A quarter of the settings' sites on half their side: the same contact as with settings of
    that size.
    """
    small = synthesize(128, 125.0, 0.1, 0.75, 2.0, 1)
    given = run_cycle(
        INPUTS, settings_for(), 1, heights=small, contact_at="lowest", length_nm=125.0
    )
    stated = run_cycle(
        INPUTS, settings_for(pixels=128, length_nm=125.0), 1, heights=small, contact_at="lowest"
    )
    np.testing.assert_array_equal(given.opening.repulsive_nN, stated.opening.repulsive_nN)
    assert given.cell_area_nm2 == stated.cell_area_nm2 == 125.0**2


@pytest.mark.parametrize(("sites", "miss"), [(2.5, 0.2), (20.5, 1 / 41), (200.5, 1 / 401)])
def test_a_force_missed_by_more_than_one_per_cent_is_not_converged(sites, miss):
    """Where hardness caps every site, the force jumps by one site's: half of that is missed between
    two.
    """
    soft = ContactInputs(**{**vars(INPUTS), "h_macro": 0.01, "h_prime": 0.0})
    force = sites * 0.01 * (250.0 / 64) ** 2
    cycle = run_cycle(soft, settings_for(model="nonlinear", pixels=64), 1, force)
    assert cycle.flags["force_miss"] == pytest.approx(miss, rel=1e-6)
    assert cycle.converged == (miss <= 0.01)


@pytest.mark.parametrize("seed", [1.5, 1.0, -1, True, "1", None, np.nan])
def test_a_seed_is_a_whole_number(seed):
    with pytest.raises(InputError, match=r"seed = .*whole number"):
        run_cycle(INPUTS, settings_for(), seed)


@pytest.mark.parametrize("force", [0.0, -1.0, np.inf, np.nan, "500", 1e15, 1 + 0j])
def test_an_impossible_force_is_refused(force):
    with pytest.raises(InputError, match="max_force_nN = "):
        run_cycle(INPUTS, settings_for(), 1, force)


@pytest.mark.parametrize(
    "change",
    [
        {"e_star": 0.0},
        {"rms": -1.0},
        {"h_macro": float("nan")},
        {"q0": 0.0},
        {"hurst": 50},
        {"rms": 8.5e-9},  # metres
        {"e_star": 91e9},  # pascals
        {"e_star": 75000.0},  # megapascals
        {"hamaker": 2.1e-19},  # joules
        {"q0": 0.025e9},  # 1/m
        {"h_macro": "hard"},
        {"h_prime": None},
        {"rms": np.array([1.0, 2.0])},
        {"hurst": True},
        {"e_star": 1 + 1j},
    ],
)
def test_impossible_inputs_are_refused(change):
    with pytest.raises(InputError, match=f"^{next(iter(change))} = ") as refusal:
        ContactInputs(**{**vars(INPUTS), **change})
    assert "\n" not in str(refusal.value)


def test_the_flag_is_the_largest_fall_below_an_earlier_value():
    cycle = run_cycle(
        ContactInputs(**{**vars(INPUTS), "hamaker": 0.0}),
        ContactSettings(mechanics="asperity", pixels=128),
        2,
    )
    force = cycle.closing.repulsive_nN
    worst = max(force[:k].max() - force[k] for k in range(1, len(force))) / force.max()
    assert worst > 0.01  # this surface loses repulsion
    assert cycle.flags["repulsion_drop"] == pytest.approx(worst)


@pytest.mark.parametrize("q0", [1e-6, 0.0025, 3.3, 900.0])
@pytest.mark.parametrize("pressed", [True, False])
def test_a_roll_off_outside_cell_or_grid_is_refused(q0, pressed):
    inputs = replace(INPUTS, q0=q0)
    made = run_cycle if pressed else random_surface
    with pytest.raises(
        InputError, match=rf"q0 = {q0:.4g} 1/nm: a cell of 250 nm .* 0\.02513 \.\. 3\.217 1/nm"
    ):
        made(inputs, settings_for(), 1)


@pytest.mark.parametrize("q0", [0.2 * np.pi / 250.0, 256 * np.pi / 250.0])
def test_a_roll_off_at_the_ends_of_the_cell_is_taken(q0):
    assert random_surface(replace(INPUTS, q0=q0), settings_for(), 1).std() == pytest.approx(
        INPUTS.rms
    )


@pytest.mark.parametrize("mechanics", ["asperity", "coupled", "adhesive"])
def test_a_surface_without_hardness_is_refused(mechanics):
    soft = replace(INPUTS, h_macro=0.0, h_prime=0.0, hamaker=0.0)
    with pytest.raises(InputError, match="h_macro = 0 GPa: the surface would carry nothing"):
        run_cycle(soft, settings_for(mechanics=mechanics), 1)
    assert run_cycle(
        soft, settings_for(mechanics=mechanics, model="elastic", pixels=64), 1
    ).converged


@pytest.mark.parametrize("mechanics", ["asperity", "coupled"])
@pytest.mark.parametrize("sites", [3, 4])
def test_the_smallest_map_that_repeats_has_four_sites_a_side(mechanics, sites):
    heights = np.random.default_rng(1).normal(0.0, 1.0, (sites, sites))
    call = {"heights": heights, "length_nm": 20.0, "contact_at": "highest", "max_force_nN": 10.0}
    if sites == 4:
        assert run_cycle(INPUTS, settings_for(mechanics=mechanics), 1, **call).converged
        return
    with pytest.raises(InputError, match="a square array of at least 4 x 4 sites"):
        run_cycle(INPUTS, settings_for(mechanics=mechanics), 1, **call)


@pytest.mark.parametrize(
    ("mechanics", "model"),
    [("asperity", "plastic"), ("coupled", "plastic"), ("adhesive", "elastic")],
)
@pytest.mark.parametrize("times", [0.25, 3.0, 16.0])
def test_a_contact_that_is_larger_in_all_lengths_has_the_same_pressures(mechanics, model, times):
    """No length is in the code: forces go with the square, to rounding; adhesive ones to where
    their iteration ends.
    """
    inputs = replace(INPUTS, rms=5.0)
    settings = settings_for(mechanics=mechanics, model=model, pixels=64, gap_cutoff_nm=0.5)
    heights = random_surface(inputs, settings, 3)

    def cycle(times):
        larger = replace(
            inputs,
            hamaker=inputs.hamaker * times**3,
            h_prime=inputs.h_prime * times**0.5,
            rms=inputs.rms * times,
        )
        force = settings.max_force_nN * times**2
        grid = settings.model_copy(
            update={"max_force_nN": force, "gap_cutoff_nm": settings.gap_cutoff_nm * times}
        )
        side = settings.length_nm * times
        return run_cycle(
            larger, grid, 3, heights=heights * times, length_nm=side, contact_at="lowest"
        )

    whole, scaled = cycle(1.0), cycle(times)
    within = 1e-6 if mechanics == "adhesive" else 1e-9
    forces = ("repulsive_nN", "attractive_nN")
    for branch, place in (("closing", -1), ("opening", 0)):
        one, other = getattr(whole, branch), getattr(scaled, branch)
        assert other.separation_nm[place] / times == pytest.approx(
            one.separation_nm[place], rel=within
        )
        for name in forces:
            wanted = getattr(one, name)[place]
            assert getattr(other, name)[place] / times**2 == pytest.approx(wanted, rel=within)
    pulls = (pull_off(whole.opening), pull_off(scaled.opening) / times**2)
    assert pulls[1] == pytest.approx(pulls[0], rel=within)
