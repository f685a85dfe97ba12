"""Persson's theory: closed forms against the diffusion equation, limits, scaling, and a half-space beside it."""

import numpy as np
import pytest
from scipy import integrate

from evidence.contact.half_space import by_tamaas
from mesoscale.contact import persson
from mesoscale.contact.surface import random_surface, shortest_wave, surface_spectrum
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.topography.roughness_spectrum import RoughSpectrum

E_STAR = 91.0
ROUGH = RoughSpectrum.from_rms(8.5, 0.025, 3.5, 3.2)
WAVES = (ROUGH.psd, 2 * np.pi / 1000, 3.2)
GRADIENT = persson.rms_gradient(*WAVES)
PRESSURES = np.array([1e-4, 7e-3, 0.1, 0.5, 0.9])


def constant(hardness: float):
    return lambda q: np.full_like(q, hardness)


def by_size(q):
    return persson.hardness_at(q, 1.95, 8.375)


def test_the_gradient_of_a_spectrum():
    """The waves longer than the cell, left out here, hold less than 1e-4 of the gradient."""
    assert pytest.approx(ROUGH.rms_slope, rel=1e-4) == GRADIENT


def test_small_loads_and_full_contact():
    share = persson.elastic_area(1e-6, E_STAR, GRADIENT)
    assert share / (1e-6 / (E_STAR * GRADIENT)) == pytest.approx(persson.SMALL_LOAD_SLOPE, rel=1e-9)
    assert pytest.approx(1.5958, rel=1e-4) == persson.SMALL_LOAD_SLOPE
    assert persson.elastic_area(10 * E_STAR * GRADIENT, E_STAR, GRADIENT) == pytest.approx(1.0)
    assert persson.elastic_area(0.0, E_STAR, GRADIENT) == 0.0


@pytest.mark.parametrize("hardness", [1.0, 10.0, 30.0, 50.0, 300.0])
def test_the_diffusion_equation_agrees_with_the_closed_forms(hardness):
    """Spread of the pressure E* h'/2 = 41 GPa: from 40 hardnesses to a seventh of one."""
    elastic, plastic = persson.plastic_area(PRESSURES, E_STAR, GRADIENT, hardness)
    found = persson.contact_with_hardness(PRESSURES, E_STAR, *WAVES, constant(hardness))
    # the ends of the axis are resolved to 1e-5 of its length, the time steps to 1e-7 and to 1e-10 absolute
    np.testing.assert_allclose(found.elastic, elastic, rtol=1e-4, atol=1e-10)
    np.testing.assert_allclose(found.plastic, plastic, rtol=1e-5, atol=1e-9)
    np.testing.assert_allclose(found.area, found.kept, rtol=1e-4)


def test_images_and_sines_meet():
    """One sum for a spread below the hardness, the other above."""
    hardness = 0.5 * E_STAR * GRADIENT
    below = persson.plastic_area(PRESSURES, E_STAR, GRADIENT, hardness * (1 - 1e-12))
    above = persson.plastic_area(PRESSURES, E_STAR, GRADIENT, hardness * (1 + 1e-12))
    np.testing.assert_allclose(below, above, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("hardness", [5.0, 60.0])
def test_shares_are_those_of_the_distribution(hardness):
    """The sum of images of the density itself, integrated over the axis; its slope at H is what yields."""
    p, spread = 0.3, 0.5 * E_STAR * GRADIENT
    k = np.arange(-400, 401)

    def density(s):
        near, mirrored = (s - p - 2 * k * hardness) / spread, (s + p - 2 * k * hardness) / spread
        return (np.exp(-0.5 * near**2) - np.exp(-0.5 * mirrored**2)).sum() / (spread * np.sqrt(2 * np.pi))

    elastic, plastic = persson.plastic_area(p, E_STAR, GRADIENT, hardness)
    assert integrate.quad(density, 0, hardness)[0] == pytest.approx(elastic, rel=1e-6, abs=1e-12)
    load = integrate.quad(lambda s: s * density(s), 0, hardness)[0] + hardness * plastic
    assert load == pytest.approx(p, rel=1e-9)


def test_soft_and_hard_limits():
    soft = persson.plastic_area(PRESSURES, E_STAR, GRADIENT, 2.0)
    np.testing.assert_allclose(soft[1], PRESSURES / 2.0, rtol=1e-9)
    np.testing.assert_allclose(soft[0], 0.0, atol=1e-12)
    hard = persson.plastic_area(PRESSURES, E_STAR, GRADIENT, 1e4)
    np.testing.assert_allclose(hard[0], persson.elastic_area(PRESSURES, E_STAR, GRADIENT), rtol=1e-12)
    np.testing.assert_allclose(hard[1], 0.0, atol=1e-15)
    beyond = persson.plastic_area(np.array([2.0, 5.0]), E_STAR, GRADIENT, 2.0)
    np.testing.assert_allclose(beyond, [[0, 0], [1, 1]], atol=1e-12)


@pytest.mark.parametrize("scale", [0.1, 1.0, 10.0])
def test_a_hardness_by_size_lies_between_those_of_its_ends(scale):
    """A path of pressures that comes to 0 before it meets a hardness does so before it meets a larger one."""
    found = persson.contact_with_hardness(PRESSURES, scale * E_STAR, *WAVES, by_size)
    assert np.all(np.diff(found.area) > 0)
    assert np.all(np.diff(found.kept) > 0)
    assert np.all(found.elastic >= 0)
    assert np.all(found.area <= found.kept * (1 + 1e-6))
    softest, hardest = (
        np.sum(persson.plastic_area(PRESSURES, scale * E_STAR, GRADIENT, one), axis=0)
        for one in by_size(np.array(WAVES[1:]))
    )
    assert np.all(hardest * (1 - 1e-4) <= found.kept)
    assert np.all(found.kept <= softest * (1 + 1e-4))


def test_with_much_roughness_all_of_the_load_is_at_the_finest_hardness():
    found = persson.contact_with_hardness(PRESSURES, 100 * E_STAR, *WAVES, by_size)
    carried = found.plastic * by_size(WAVES[2])
    assert np.all(carried <= PRESSURES * (1 + 1e-6))
    np.testing.assert_allclose(carried, PRESSURES, rtol=0.02)


def test_a_walk_of_pressures_ends_as_the_equation_says():
    """Random walks between 0 and H(q): those at H(q) stay on it, or fall back so that the mean pressure is kept.

    All moves keep the mean, so that the walks end exactly on 0 and on H(q).
    """
    e_star, paths, steps, p = 30.0, 50_000, 500, 1.0
    random = np.random.default_rng(7)
    q = np.geomspace(*WAVES[1:], 4000)
    variance = 0.5 * np.pi * e_star**2 * integrate.cumulative_trapezoid(q**3 * ROUGH.psd(q), q, initial=0.0)
    knots = np.linspace(0.0, variance[-1], steps + 1)
    strength = by_size(np.interp(knots, variance, q))
    step = np.sqrt(knots[1])
    pressure, alive, stuck = np.full(paths, p), np.ones(paths, bool), np.zeros(paths, bool)
    for k in range(steps):
        back = stuck & (random.random(paths) < (strength[k + 1] - strength[k]) / step)
        stuck &= ~back
        free = alive & ~stuck & ~back
        up = np.minimum(strength[k + 1] - pressure[free], step)
        down = np.minimum(pressure[free], step)
        pressure[free] += np.where(random.random(up.size) < down / (up + down), up, -down)
        pressure[back] = strength[k + 1] - step
        alive &= pressure > 1e-12
        stuck |= alive & (pressure > strength[k + 1] - 1e-12)
        pressure[stuck] = strength[k + 1]
    assert pressure[alive].sum() / paths == pytest.approx(p, rel=0.03)
    found = persson.contact_with_hardness(p, e_star, *WAVES, by_size)
    # three standard deviations of counts of 1,900 and 3,600 walks
    assert (alive & ~stuck).mean() == pytest.approx(found.elastic, rel=0.07)
    assert stuck.mean() == pytest.approx(found.plastic, rel=0.05)


def test_everything_yields_at_the_hardness_of_the_longest_waves():
    found = persson.contact_with_hardness(3.0, E_STAR, *WAVES, by_size)
    assert found.kept == pytest.approx(1.0)


def test_areas_depend_on_pressure_over_modulus_and_gradient():
    """Twice the heights, half the modulus: the same areas. Separations scale with the heights."""
    double = RoughSpectrum(4 * ROUGH.plateau, ROUGH.q0, ROUGH.slope, ROUGH.q1).psd
    assert persson.rms_gradient(double, *WAVES[1:]) == pytest.approx(2 * GRADIENT)
    np.testing.assert_allclose(
        persson.elastic_area(PRESSURES, E_STAR / 2, 2 * GRADIENT), persson.elastic_area(PRESSURES, E_STAR, GRADIENT)
    )
    np.testing.assert_allclose(
        persson.mean_separation(2 * PRESSURES, E_STAR, double, *WAVES[1:]),
        2 * persson.mean_separation(PRESSURES, E_STAR, *WAVES),
    )


def test_separation_falls_with_pressure_to_zero():
    p = np.geomspace(1e-4, 1e3, 40)
    separation = persson.mean_separation(p, E_STAR, *WAVES)
    assert np.all(np.diff(separation) <= 0)
    assert separation[-1] == pytest.approx(0.0, abs=1e-6)


def test_pressing_to_full_contact_costs_its_elastic_energy():
    """int separation dp at full contact = energy of full contact, E*/4 int q psd(q) d^2q = pi E*/2 int q^2 psd dq."""
    p = np.geomspace(1e-9, 1e3, 4001)
    separation = persson.mean_separation(p, E_STAR, *WAVES)
    work = np.trapezoid(separation * p, np.log(p))
    q = np.geomspace(*WAVES[1:], 20001)
    energy = 0.5 * np.pi * E_STAR * np.trapezoid(q**3 * ROUGH.psd(q), np.log(q))
    assert work == pytest.approx(energy, rel=1e-3)


def test_elastic_contact_beside_the_half_space():
    """Mean of three computed surfaces: half as much area again at small loads, less than that above; separations agree.

    Single surfaces scatter by 10 % in both. The longest wave is 4 roll-off waves, the shortest 16 sites.
    """
    pytest.importorskip("tamaas", reason="optional extra peers is not installed")
    inputs = ContactInputs(hamaker=0.0, e_star=E_STAR, h_macro=1.95, h_prime=8.375, q0=0.05, hurst=0.75, rms=2.0)
    length = 512.0
    settings = ContactSettings(pixels=256, length_nm=length, q1_per_nm=np.pi / 16)
    waves = (surface_spectrum(inputs, settings), 2 * np.pi / length, shortest_wave(settings))
    gradient = persson.rms_gradient(*waves)
    ratios = {}
    for load in (0.02, 0.2):
        pressure = load * E_STAR * gradient
        heights = [random_surface(inputs, settings, seed) for seed in (1, 2, 3)]
        found = [by_tamaas(surface, length, pressure * length**2, E_STAR, tolerance=1e-8) for surface in heights]
        area = np.mean([one.pressure > 0 for one in found])
        separation = np.mean([one.separation_nm for one in found])
        ratios[load] = area / persson.elastic_area(pressure, E_STAR, gradient)
        assert separation == pytest.approx(persson.mean_separation(pressure, E_STAR, *waves), rel=0.1)
    assert 1.3 < ratios[0.02] < 1.65
    assert 1.1 < ratios[0.2] < 1.4


def test_bad_input_is_one_line():
    with pytest.raises(InputError, match="0 < q_low < q_high"):
        persson.rms_gradient(ROUGH.psd, 1.0, 0.5)
    with pytest.raises(InputError, match="pressure"):
        persson.elastic_area(-1.0, E_STAR, GRADIENT)
    with pytest.raises(InputError, match="hardness"):
        persson.contact_with_hardness(0.1, E_STAR, *WAVES, constant(0.0))
    with pytest.raises(InputError, match="do not fall"):
        persson.contact_with_hardness(0.1, E_STAR, *WAVES, lambda q: 1.0 / q)
