"""One load without the way there: the same contact as the engine's, which knows another way."""

import math
from dataclasses import replace

import numpy as np
import pytest

import asperity as asp
from mesoscale.contact.coupled import one_load
from mesoscale.contact.coupled.base import Alone, Base, Repeated
from mesoscale.contact.coupled.engine import CoupledContact
from mesoscale.contact.coupled.free import FreeContact
from mesoscale.contact.coupled.grid import Grid
from mesoscale.contact.coupled.stiffness import Stiffness
from mesoscale.contact.path import trace
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.settings.contact import MaterialSettings

E_STAR = 100.0
SIDE = 200.0
INPUTS = ContactInputs(
    hamaker=0.0, e_star=E_STAR, h_macro=0.0, h_prime=0.0, q0=1.0, hurst=0.5, rms=0.0
)
FILM = (
    MaterialSettings(young_GPa=200.0, poisson=0.2, thickness_nm=5.0),
    MaterialSettings(young_GPa=70.0, poisson=0.2),
)
X = np.arange(128) * SIDE / 128
WAVE = np.cos(2 * np.pi * X / SIDE)


def rough(seed: int, pixels: int = 128) -> np.ndarray:
    """A surface with a random law of its spectrum, 0.5 nm high."""
    random = np.random.default_rng(seed)
    hurst, cut = random.uniform(0.1, 1.0), random.uniform(8, pixels / 2)
    waves = np.hypot(np.fft.fftfreq(pixels)[:, None], np.fft.rfftfreq(pixels)) * pixels
    waves[0, 0] = np.inf
    size = np.where(waves <= cut, waves ** (-1.0 - hurst), 0.0)
    heights = np.fft.irfft2(size * np.exp(2j * np.pi * random.random(size.shape)), s=(pixels,) * 2)
    return 0.5 * heights / heights.std()


def by_the_engine(
    heights: np.ndarray, base: Base, separation: float
) -> tuple[np.ndarray, np.ndarray]:
    """Pressure and gap at a separation."""
    bodies = base.bodies if isinstance(base, Repeated) else ()
    settings = ContactSettings(model="elastic", mechanics="coupled").model_copy(
        update={
            "pixels": len(heights),
            "length_nm": base.spacing * len(heights),
            "bodies": (*bodies,),
        }
    )
    kind = CoupledContact if base.repeats else FreeContact
    contact = kind(heights.copy(), INPUTS, settings)
    assert contact.move_to(separation, False).settled
    return contact.fields()


def check(heights: np.ndarray, load: float, base: Base) -> one_load.Pressed:
    """Compare a load with the engine at its separation, which finds the same sites."""
    pressed = one_load.press(heights, load, base)
    assert pressed.settled
    assert pressed.pressure.sum() * base.site_area == pytest.approx(load, rel=1e-9)
    pressure, gap = by_the_engine(heights, base, pressed.separation)
    np.testing.assert_array_equal(pressed.pressure > 0.0, pressure > 0.0)
    largest = pressure.max()
    np.testing.assert_allclose(pressed.pressure, pressure, atol=2e-5 * largest)
    np.testing.assert_allclose(pressed.gap, gap, atol=2e-5 * largest * base.spring)
    return pressed


@pytest.mark.parametrize("seed", range(6))
def test_a_load_has_the_contact_of_the_engine(seed):
    heights = rough(seed)
    load = float(10 ** np.random.default_rng(seed).uniform(1.0, 4.7))
    check(heights, load, Repeated(heights.shape, SIDE / 128, E_STAR))


@pytest.mark.parametrize("kind", [Repeated, Alone])
@pytest.mark.parametrize("load", [20.0, 3e3, 3e4])
def test_a_separation_gives_the_load_that_gives_it(kind, load):
    heights = rough(8)
    base = kind(heights.shape, SIDE / 128, E_STAR)
    pressed = one_load.press(heights, load, base)
    again = one_load.press_to(heights, pressed.separation, base)
    assert again.settled
    assert again.pressure.sum() * base.site_area == pytest.approx(load, rel=1e-4)
    np.testing.assert_array_equal(again.pressure > 0.0, pressed.pressure > 0.0)


@pytest.mark.parametrize("shape", [(128, 128), (128, 100), (97, 128)])
def test_a_map_alone_has_the_contact_of_the_engine(shape):
    heights = rough(1)[: shape[0], : shape[1]] + np.linspace(0.0, 1.0, shape[1])
    base = Alone(shape, SIDE / 128, E_STAR)
    pressed = one_load.press(heights, 500.0, base)
    settings = ContactSettings(model="elastic", mechanics="coupled").model_copy(
        update={"pixels": shape[0], "length_nm": base.spacing * shape[0]}
    )
    contact = FreeContact(heights.copy(), INPUTS, settings)
    contact.move_to(pressed.separation, False)
    assert pressed.settled
    np.testing.assert_array_equal(pressed.pressure > 0.0, contact.fields()[0] > 0.0)


def test_layers_carry_as_in_the_engine():
    heights = rough(2)
    soft = check(heights, 3000.0, Repeated(heights.shape, SIDE / 128, E_STAR))
    hard = check(heights, 3000.0, Repeated(heights.shape, SIDE / 128, E_STAR, (FILM,)))
    assert (hard.pressure > 0.0).sum() < (soft.pressure > 0.0).sum()


def test_a_wave_is_westergaards():
    """A line contact of width 2a: p = p* sin^2(pi a / L) (Westergaard 1939)."""
    heights = np.broadcast_to(-WAVE[:, None], (128, 128)).copy()
    full = math.pi * E_STAR / SIDE  # mean pressure that flattens a height of 1 nm
    for share in (0.05, 0.3, 0.7):
        pressed = check(heights, share * full * SIDE**2, Repeated((128, 128), SIDE / 128, E_STAR))
        half = np.count_nonzero(pressed.pressure[:, 0]) / 256
        assert half == pytest.approx(math.asin(math.sqrt(share)) / math.pi, abs=1 / 128)


@pytest.mark.parametrize("share", [0.9, 0.999, 0.99999])
def test_near_full_contact_the_last_sites_are_found(share):
    heights = rough(3)
    base = Repeated(heights.shape, SIDE / 128, E_STAR)
    grid = Grid(128, SIDE, E_STAR)
    grid.compliance[0, 0] = np.inf
    spectrum = np.fft.rfft2(heights) / grid.compliance
    full = float(np.fft.irfft2(spectrum, s=heights.shape).max())
    pressed = one_load.press(heights, share * full * SIDE**2, base)
    # near full contact the load hangs on the last digits of the separation, the sites do not
    pressure, _ = by_the_engine(heights, base, pressed.separation)
    assert pressed.settled
    np.testing.assert_array_equal(pressed.pressure > 0.0, pressure > 0.0)
    missed = pressed.pressure - pressure
    np.testing.assert_allclose(missed[pressure > 0.0], missed.max(), atol=1e-4 * pressure.max())


def test_one_site_carries_a_load_that_presses_no_second():
    heights = rough(4)
    heights[17, 90] = heights.min() - 1.0
    pressed = check(heights, 1e-3, Repeated(heights.shape, SIDE / 128, E_STAR))
    assert np.argwhere(pressed.pressure).tolist() == [[17, 90]]


def test_a_peak_that_coarse_grids_miss_is_pressed():
    """It stands on sites of odd row and column, which no coarser grid has."""
    heights = 0.1 * rough(5)
    heights[33, 71] -= 3.0
    heights[99, 5] -= 2.5
    pressed = check(heights, 200.0, Repeated(heights.shape, SIDE / 128, E_STAR))
    assert pressed.pressure[33, 71] > 0.0


STEPS = np.where(np.arange(128)[:, None] < 64, 0.0, 3.0) + np.zeros(128)
PUNCH = np.where(np.hypot(X[:, None] - 100, X - 100) < 40.0, -50.0, 0.0)
RIDGES = 2.0 * np.abs((X[:, None] / 25.0) % 1.0 - 0.5) + 0.01 * WAVE
TWO_SCALES = 5.0 * WAVE[:, None] + 5e-3 * rough(6)


@pytest.mark.parametrize("load", [10.0, 1000.0, 30000.0])
@pytest.mark.parametrize("heights", [STEPS, PUNCH, RIDGES, TWO_SCALES, 1e3 * rough(7)])
def test_hard_maps_have_the_contact_of_the_engine(heights, load):
    check(np.ascontiguousarray(heights), load, Repeated(heights.shape, SIDE / 128, E_STAR))


def test_an_oversampled_map_needs_few_transforms():
    """The same smooth map on finer and finer grids; without the long waves' own stiffness the
    number grows.
    """
    counts = []
    for finer in (1, 2, 4):
        x = np.arange(128 * finer) * SIDE / (128 * finer)
        waves = [np.cos(2 * np.pi * k * x / SIDE + k) / k**2 for k in (1, 2, 3, 5)]
        heights = np.sum([wave[:, None] * np.roll(wave, 7 * finer) for wave in waves], axis=0)
        base = Repeated(heights.shape, SIDE / len(x), E_STAR)
        counts.append(one_load.press(heights, 2000.0, base).transforms)
    assert max(counts) <= 30
    assert counts[2] <= counts[0] + 5


def test_a_heavy_load_on_a_map_alone_needs_few_transforms():
    """Its edge carries most. Grids whose edges do not lie on it tilt the first pressures."""
    heights = rough(9, 256)
    base = Alone(heights.shape, SIDE / 256, E_STAR)
    pressed = one_load.press(heights, 1e5, base)
    assert pressed.settled
    assert (pressed.pressure > 0.0).mean() > 0.3
    assert pressed.transforms <= 30


@pytest.mark.parametrize("repeats", [True, False])
def test_few_sites_near_each_other_are_closed_at_once(repeats):
    """The factor holds all of them, also across the seam of a map that repeats."""
    corner = [0, 1] if repeats else [7, 8]
    base = (Repeated if repeats else Alone)((24, 24), 2.0, E_STAR)
    stiffness = Stiffness(base)
    stiffness.excess[:] = 0.0
    touching = np.zeros((24, 24), bool)
    touching[np.ix_([10, 11, 12], [23, *corner] if repeats else [6, *corner])] = True
    touching[11, 0 if repeats else 7] = False
    sites = np.flatnonzero(touching).astype(np.int32)
    gap = np.zeros(touching.size, np.float32)
    gap[sites] = np.arange(sites.size) - 3.0
    pressure = np.zeros(touching.shape)
    pressure.flat[sites] = stiffness.close(sites, gap)
    moved = base.displacement(pressure)
    np.testing.assert_allclose(moved.flat[sites], gap[sites], atol=1e-5)


@pytest.mark.parametrize("shape", [(4, 4), (4, 9), (5, 3)])
def test_maps_of_a_few_sites_carry_their_load(shape):
    """Their coarser grid had one site, which has no wave."""
    heights = np.random.default_rng(5).normal(size=shape)
    repeated = shape[0] == shape[1]
    pressed = asp.press(heights, 10.0, 20.0, 5.0, periodic=repeated)
    area = np.prod(pressed.lengths_nm)
    assert pressed.converged
    assert pressed.pressure_GPa.mean() * area == pytest.approx(20.0, rel=1e-6)


def check_yielding(heights: np.ndarray, load: float, hardness: float) -> one_load.Pressed:
    """Compare a load on a surface that yields with the end of a closing."""
    base = Repeated(heights.shape, SIDE / 128, E_STAR)
    pressed = one_load.press_yielding(heights, load, hardness, base)
    assert pressed.settled
    settings = ContactSettings(model="plastic", mechanics="coupled").model_copy(
        update={"pixels": 128, "length_nm": SIDE}
    )
    contact = CoupledContact(heights.copy(), replace(INPUTS, h_macro=hardness), settings)
    assert trace(contact, 40, True, stop_force=load).reached
    pressure, gap = contact.fields()
    np.testing.assert_array_equal(pressed.pressure > 0.0, pressure > 0.0)
    np.testing.assert_array_equal(pressed.pressure == hardness, pressure == hardness)
    np.testing.assert_allclose(pressed.pressure.mean(), pressure.mean(), rtol=3e-6)
    missed = np.abs(pressed.pressure - pressure).mean() / pressure.mean()
    assert missed < 1e-5
    np.testing.assert_allclose(pressed.gap, gap, atol=1e-5 * pressure.max() * base.spring + 1e-5)
    return pressed


@pytest.mark.parametrize("seed", range(8))
def test_a_load_that_yields_has_the_contact_of_a_closing(seed):
    random = np.random.default_rng(100 + seed)
    hardness = 10 ** random.uniform(-0.5, 1.5)
    load = random.uniform(0.01, 0.5) * hardness * SIDE**2
    pressed = check_yielding(rough(seed), min(load, 4e4), hardness)
    assert pressed.pressure.max() <= hardness


def test_a_hard_surface_does_not_yield():
    heights = rough(2)
    base = Repeated(heights.shape, SIDE / 128, E_STAR)
    elastic = one_load.press(heights, 2000.0, base)
    pressed = one_load.press_yielding(heights, 2000.0, 1e3, base)
    np.testing.assert_array_equal(pressed.pressure > 0.0, elastic.pressure > 0.0)
    np.testing.assert_allclose(pressed.pressure, elastic.pressure, atol=1e-5 * 1e3)


def test_a_surface_far_too_soft_to_bend_touches_by_its_heights():
    """Its lowest sites carry the hardness, as many as the load needs."""
    heights = rough(4)
    hardness = 1e-6
    base = Repeated(heights.shape, SIDE / 128, E_STAR)
    load = 1000.5 * hardness * base.site_area
    pressed = one_load.press_yielding(heights, load, hardness, base)
    lowest = np.argsort(heights.ravel())[:1001]
    assert pressed.settled
    assert set(np.flatnonzero(pressed.pressure)) == set(lowest)


@pytest.mark.parametrize("kind", [Repeated, Alone])
def test_a_separation_of_a_surface_that_yields_gives_the_load_that_gives_it(kind):
    heights = rough(8)
    base = kind(heights.shape, SIDE / 128, E_STAR)
    pressed = one_load.press_yielding(heights, 3e3, 2.0, base)
    again = one_load.press_to(heights, pressed.separation, base, 2.0)
    assert pressed.settled
    assert again.settled
    assert again.pressure.sum() * base.site_area == pytest.approx(3e3, rel=1e-5)
    np.testing.assert_array_equal(again.pressure > 0.0, pressed.pressure > 0.0)


@pytest.mark.parametrize("heights", [STEPS, RIDGES, TWO_SCALES, 1e3 * rough(7)])
def test_hard_maps_that_yield_have_the_contact_of_a_closing(heights):
    check_yielding(np.ascontiguousarray(heights), 500.0, 1.0)


@pytest.mark.parametrize("load", [2000.0, 4500.0])
def test_a_punch_that_one_load_does_not_find_is_closed(load):
    """Most of what a flat top carries comes at one separation."""
    pressed = asp.press(PUNCH, SIDE, load, E_STAR, h_macro=1.0, contact_at="lowest")
    assert pressed.converged
    assert pressed.loads_nN[0] == pytest.approx(load, rel=1e-5)
    top = np.count_nonzero(PUNCH) / PUNCH.size
    assert pressed.area_share[0] == pytest.approx(top, rel=1e-9)
