"""The cut-off D0 of a top made of atoms, on bodies whose attraction is known."""

import numpy as np
import pytest
from scipy.stats import t

from asperity.guards.errors import InputError
from atomistic.hardness.top_attraction import (
    FOLLOW,
    RIM_ERROR,
    attract_top,
    bulk_density_per_A3,
    combined_cutoffs_nm,
    contact_distance_A,
    gap_cutoff,
    mean_over_glasses,
)

DENSITY = 0.0668  # atoms per Å^3: silica of 2.22 g/cm3
SPACING = DENSITY ** (-1 / 3)
LAYER = 1 / SPACING**2  # atoms an area of one layer of the stack


def test_the_contact_distance_is_that_of_the_literature_for_silica():
    """0.2241 nm was found by an independent script for this density and D = 0.165 nm."""
    assert contact_distance_A(DENSITY) == pytest.approx(2.241, abs=0.002)


def test_a_flat_stack_of_layers_has_the_work_of_dense_solids():
    depths = -SPACING * np.arange(40)
    by_force, by_work = combined_cutoffs_nm([attract_top(depths, np.ones(40), 1 / LAYER, DENSITY)])
    # a stack of 40 layers lacks the share (0.165 / 9.9)^2 of an infinite one
    assert by_work == pytest.approx(0.165, rel=1e-3)
    # its stress rises over a distance, so that it is lower than that of the law at touch: 1.26
    # instead of 2.54 GPa
    assert 0.215 / (6 * np.pi * by_force**3) == pytest.approx(1.26, abs=0.01)


def shapes():
    """Depths below the highest place (Å) and areas (Å^2) of bodies in the shapes of a switch's
    contacts.
    """
    side = np.linspace(0.0, 1.0, 4001)[1:] - 1 / 8000
    for radius in (5.0, 20.0, 100.0):  # nm: spheres, out to three tenths of the radius or 15 nm
        across = 10 * min(0.3 * radius, 15.0) * side
        yield (
            f"sphere of {radius:g} nm",
            across**2 / (20 * radius),
            2 * np.pi * across * across[-1] / 4000,
        )
    # nm: a top that was pressed flat at H = 8 GPa and sprang back, E* = 96 GPa (Hertz)
    for half in (
        2.5,
        5.0,
        10.0,
    ):
        across, radius = 10 * half * side, 4 * half * 96 / (3 * np.pi * 8)
        yield (
            f"top of {2 * half:g} nm",
            across**2 / (20 * radius),
            2 * np.pi * across * across[-1] / 4000,
        )
    for height in (1.0, 5.0):  # nm: a wave in two directions
        wave = 5 * height * (1 - np.cos(np.pi * side[::8]))
        yield f"wave of {height:g} nm", np.add.outer(wave, wave).ravel(), np.full(500**2, 1.0)


@pytest.mark.parametrize(("name", "depths", "areas"), list(shapes()))
def test_the_work_and_not_the_force_decides_the_pull_off_of_what_is_not_flat(name, depths, areas):
    """Each place of a shape is a stack of layers: their exact sum, against the law with either
    cut-off.
    """
    stack = SPACING * np.arange(200)
    gaps = np.linspace(1.5, 200.0, 40_000)
    contact = contact_distance_A(DENSITY)
    distances = np.add.outer(gaps, stack)
    stress = (3 * LAYER / (6 * np.pi * DENSITY)) * (
        distances**-4.0 - contact**6 * distances**-10.0
    ).sum(axis=1)
    exact = max(areas @ np.interp(gap + depths, gaps, stress) for gap in np.arange(1.8, 3.2, 0.02))
    cutoffs = combined_cutoffs_nm([attract_top(-stack, np.ones(200), 1 / LAYER, DENSITY)])
    by_force, by_work = (
        areas @ (1 / (6 * np.pi * (depths + 10 * cutoff) ** 3)) / exact for cutoff in cutoffs
    )
    # terms of the order of D0 over the height of the shape
    assert by_work == pytest.approx(1.0, abs=0.07), name
    assert by_force < 0.7, name


def test_a_top_of_one_atom_pulls_as_its_potential():
    contact = contact_distance_A(DENSITY)
    atom = attract_top(np.zeros(1), np.ones(1), 1 / LAYER, DENSITY)
    strength = 1 / (6 * np.pi * DENSITY)
    assert atom.work == pytest.approx(2 / 3 * strength / contact**3, rel=1e-9)
    assert atom.force_per_A == pytest.approx(1.8 * strength / contact**4 / 2.5 ** (2 / 3), rel=1e-9)


@pytest.mark.parametrize("radius_A", [40.0, 160.0])
def test_a_sphere_of_continuum_pulls_off_with_the_work_of_its_flat(radius_A):
    """DMT: 2 pi R w, but for terms of the order of the gap (some 2 Å) over the radius.

    A continuum of atoms has a work of its own between flats, by the same sum.
    """
    fine = 0.05
    depths = np.arange(fine / 2, 2 * radius_A, fine)
    sections = DENSITY * fine * np.pi * depths * (2 * radius_A - depths)  # atoms in each slice
    scale = sections.max()
    sphere = attract_top(-depths, sections / scale, 1.0, DENSITY)
    flat = attract_top(-depths, np.full(depths.size, fine * DENSITY), 1.0, DENSITY)
    assert sphere.force_per_A * scale == pytest.approx(
        2 * np.pi * radius_A * flat.work, rel=3.0 / radius_A
    )


def test_the_highest_atom_keeps_the_others_away():
    depths = -SPACING * np.arange(40)
    flat = attract_top(np.repeat(depths, 100), np.ones(4000), 100 / LAYER, DENSITY)
    rough = attract_top(np.append(np.repeat(depths, 100), 1.0), np.ones(4001), 100 / LAYER, DENSITY)
    assert rough.force_per_A < 0.8 * flat.force_per_A
    assert combined_cutoffs_nm([rough])[1] > combined_cutoffs_nm([flat])[1]


def test_contacts_side_by_side_count_with_their_areas():
    depths = -SPACING * np.arange(40)
    one = attract_top(depths, np.ones(40), 1 / LAYER, DENSITY)
    four = attract_top(np.repeat(depths, 4), np.ones(160), 4 / LAYER, DENSITY)
    assert combined_cutoffs_nm([one, four]) == pytest.approx(combined_cutoffs_nm([one]))


def test_atoms_that_do_not_count_do_not_matter():
    depths = -SPACING * np.arange(40)
    beside = np.concatenate([depths, [3.0]])
    shares = np.append(np.ones(40), 0.0)
    assert attract_top(beside, shares, 1 / LAYER, DENSITY) == attract_top(
        depths, np.ones(40), 1 / LAYER, DENSITY
    )


def test_a_top_without_contact_is_refused():
    with pytest.raises(InputError, match="no atoms below its contact"):
        attract_top(np.zeros(3), np.zeros(3), 10.0, DENSITY)


def test_the_density_is_counted_in_the_bulk():
    rng = np.random.default_rng(1)
    positions = np.array([20.0, 20.0, 30.0]) * rng.random((40_000, 3))
    assert bulk_density_per_A3(positions, 400.0) == pytest.approx(40_000 / 12_000, rel=0.03)


def rows(*tops):
    return [
        {
            "top_area_nm2": t.area_A2 / 100,
            "top_force_over_hamaker": 10 * t.force_per_A,
            "top_work_over_hamaker": t.work,
        }
        for t in tops
    ]


SEEDS = {name: number // 3 for number, name in enumerate("abcdef")}
"""Two glasses of three runs each."""


def test_the_distribution_spans_free_and_rigid_tops_of_all_runs():
    depths = -SPACING * np.arange(40)
    smooth = attract_top(depths, np.ones(40), 1 / LAYER, DENSITY)
    small = {
        "top_area_nm2": np.nan,
        "top_force_over_hamaker": np.nan,
        "top_work_over_hamaker": np.nan,
    }
    witnesses = {
        "a": [small, *rows(smooth)],
        **{name: rows(smooth, smooth) for name in "bcdef"},
        "none": [small],
    }
    found = gap_cutoff(witnesses, {**SEEDS, "none": 7})
    assert found is not None
    by_force, by_work = combined_cutoffs_nm([smooth])
    # runs of one kind of top do not scatter: what is left are atoms that follow, and the rim of the
    # area
    ratio = np.array(found["values"]) / by_work
    assert ratio.mean() == pytest.approx(FOLLOW[0], rel=5e-3)
    assert ratio.std() == pytest.approx(
        np.hypot(FOLLOW[1], FOLLOW[0] * RIM_ERROR / 3**0.5), rel=0.1
    )
    assert found["runs"][0]["by_force_nm"] == pytest.approx(by_force)
    assert [(run["run"], run["snapshots"]) for run in found["runs"]] == [
        ("a", 1),
        *((name, 2) for name in "bcdef"),
    ]


def test_fewer_runs_than_a_fit_needs_give_no_distribution():
    top = rows(attract_top(-SPACING * np.arange(40), np.ones(40), 1 / LAYER, DENSITY))
    assert gap_cutoff({name: top for name in "abc"}, SEEDS) is None


@pytest.mark.parametrize("runs", [2, 5])  # of each glass; four in all are the fewest that are used
@pytest.mark.parametrize(("of_glasses", "least"), [(0.0, 0.9), (0.5, 0.9), (1.0, 0.86)])
def test_the_mean_over_glasses_is_held_as_often_as_stated(of_glasses, least, runs):
    rng = np.random.default_rng(1)
    held = []
    for _ in range(100):
        values = np.repeat(of_glasses * rng.normal(size=2), runs) + rng.normal(size=2 * runs)
        low, high = np.quantile(
            mean_over_glasses(values, np.repeat([1, 2], runs), 1000, rng), [0.05, 0.95]
        )
        held.append(low < 0 < high)
    assert np.mean(held) >= least


def test_glasses_that_differ_widen_the_mean():
    rng = np.random.default_rng(2)
    of_runs = np.array([0.0, 0.1, -0.1])
    alike, apart = (
        np.ptp(
            np.quantile(
                mean_over_glasses(np.r_[of_runs, of_runs + by], [1] * 3 + [2] * 3, 4000, rng),
                [0.05, 0.95],
            )
        )
        for by in (0.0, 1.0)
    )
    assert apart > 1.3 * alike


def test_runs_of_one_glass_each_are_as_student_has_it():
    rng = np.random.default_rng(3)
    values = rng.normal(size=8)
    drawn = mean_over_glasses(values, range(8), 20_000, rng)
    low, high = t.interval(0.9, 7, values.mean(), values.std(ddof=1) / np.sqrt(8))
    assert np.quantile(drawn, [0.05, 0.95]) == pytest.approx([low, high], abs=0.1 * (high - low))
