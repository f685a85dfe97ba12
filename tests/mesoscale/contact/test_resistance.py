"""Resistance of ohmic contacts: Holm's spot, the electrostatic problem solved directly, and
Barber's bounds.
"""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.contact import ContactInputs, run_cycle
from mesoscale.contact.coupled.engine import CoupledContact
from mesoscale.contact.resistance import resistance_Ohm, stiffness_of
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings

GOLD = ((22.0, 22.0), (37.7, 37.7))
INPUTS = ContactInputs(
    hamaker=0.0, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.06, hurst=0.75, rms=3.0
)
# of a square lattice of charges in their neutralising background: sum 1/r - integral
LATTICE = 3.900264920001956


def settings(pixels, length_nm, model="elastic"):
    return ContactSettings(mechanics="coupled", pixels=pixels, length_nm=length_nm, model=model)


def bowl(pixels, length_nm, radius_nm):
    # its summit between the sites
    x = (np.arange(pixels) - pixels // 2 + 0.37) * length_nm / pixels
    return (x[:, None] ** 2 + x[None, :] ** 2) / (2.0 * radius_nm)


def conducted(touching, length_nm):
    """Conductance (S) times the sum of resistivities (Ohm nm) of spots at one potential, periodic;
    spots (N, N).

    On each side a current density j of wave vector q makes a potential rho j / q; the mean of the
    potential is that of the planes far away.
    """
    n = len(touching)
    number = np.hypot(*np.meshgrid(np.fft.fftfreq(n, 1 / n), np.fft.fftfreq(n, 1 / n)))
    number[0, 0] = np.inf
    kernel = np.fft.ifft2(length_nm / (2.0 * np.pi * number)).real  # of a site of unit density
    x, y = np.nonzero(touching)
    potential = kernel[x[:, None] - x, y[:, None] - y]
    return float(np.linalg.solve(potential, np.ones(x.size)).sum()) * (length_nm / n) ** 2


def ohms(way, *material):
    return resistance_Ohm(way.slope, way.area_nm2, INPUTS.e_star, *(material or GOLD))


@pytest.mark.parametrize("resistivities", [(22.0, 22.0), (1e-3, 1e9)])
def test_one_round_spot_is_holms(resistivities):
    """R = (rho_1 + rho_2) / 4a."""
    pixels, length, radius, force = 512, 400.0, 1e3, 260.0
    cycle = run_cycle(
        INPUTS,
        settings(pixels, length),
        1,
        force,
        bowl(pixels, length, radius),
        contact_at="lowest",
    )
    way = stiffness_of(cycle.closing)
    known = way.force_nN > 0.3 * force
    spot_nm = (0.75 * way.force_nN * radius / INPUTS.e_star) ** (1 / 3)  # Hertz
    ohm = ohms(way, resistivities, (0.0, 0.0))
    # the neighbouring cells conduct, too
    alone = ohm + sum(resistivities) * LATTICE / (2.0 * np.pi * length)
    # scatters as sites come in one by one
    error = (alone * 4.0 * spot_nm / sum(resistivities) - 1.0)[known]
    assert known.sum() > 20
    assert abs(error.mean()) < 0.01


def test_many_spots_conduct_as_the_potential_says():
    """Between the chords in all of 100 random contacts; the slope is off where sites come in on
    both sides.
    """
    errors = []
    for seed in range(100):
        rng = np.random.default_rng(seed)
        chosen = settings(64, 200.0, ("elastic", "plastic")[seed % 2])
        inputs = replace(INPUTS, rms=rng.uniform(0.5, 5.0), hurst=rng.uniform(0.4, 0.95))
        cycle = run_cycle(
            inputs, chosen, seed, float(rng.uniform(100.0, 2000.0)), keep_surface=True
        )
        way, branch = stiffness_of(cycle.opening), cycle.opening
        chords = np.diff(way.force_nN) / np.diff(way.approach_nm)
        least, most = np.concatenate([[0.0], chords]), np.concatenate([chords, [np.inf]])
        contact = CoupledContact(cycle.heights.copy(), inputs, chosen)
        for place in (-1, *rng.choice(np.arange(2, way.force_nN.size - 1), 2, replace=False)):
            at = branch.separation_nm[branch.repulsive_nN == way.force_nN[place]][0]
            contact.move_to(float(at - random_surface(inputs, chosen, seed).mean()), False)
            assert contact.force == pytest.approx(way.force_nN[place], rel=1e-3)
            direct = 0.5 * inputs.e_star * conducted(contact.fields()[0] > 0.0, 200.0)
            assert least[place] * 0.9999 <= direct <= most[place] * 1.0001
            errors.append(way.slope[place] / direct - 1.0)
    assert np.median(np.abs(errors)) < 0.005
    assert np.quantile(np.abs(errors), 0.95) < 0.05
    assert abs(np.mean(errors)) < 0.01


def test_rough_contacts_lie_within_barbers_bounds():
    """Two smooth bowls, apart by the roughness' height, bound the force; tangents to the nearer
    bound the slope.
    """
    chosen, smooth, force = settings(64, 200.0), bowl(64, 200.0, 400.0), 1500.0

    def curve(heights, most):
        branch = run_cycle(INPUTS, chosen, 1, most, heights, contact_at="lowest").closing
        return stiffness_of(branch), heights.mean() - branch.separation_nm[branch.repulsive_nN > 0]

    near, approach = curve(smooth, 12.0 * force)
    for seed in range(100):
        rough = random_surface(
            replace(INPUTS, rms=np.random.default_rng(seed).uniform(0.05, 0.3)), chosen, seed
        )
        rough -= rough.min()
        way, sunk = curve(smooth + rough, force)
        high = np.interp(sunk, approach, near.force_nN)
        low = np.interp(sunk - rough.max(), approach, near.force_nN, left=0.0)
        assert (way.force_nN <= high * 1.001 + 1e-6).all()
        assert (way.force_nN >= low * 0.999).all()
        for k in np.arange(2, sunk.size - 1, 7):
            rise, run = near.force_nN - way.force_nN[k], approach - sunk[k]
            ahead, behind = run > 0.1, run < -0.1
            first = way.force_nN[k] / sunk[k]  # the smooth bowl touches at 0
            assert way.slope[k] <= (rise[ahead] / run[ahead]).min() * 1.001
            assert way.slope[k] >= max((rise[behind] / run[behind]).max(initial=0.0), first) * 0.999


def test_a_pressed_contact_conducts_better_and_keeps_it():
    """Medians over surfaces: of a single one, sites come and go."""
    chosen, loads = settings(64, 200.0, "plastic"), np.array([375.0, 750.0, 1500.0])
    shares = []
    for seed in range(8):
        ways = [stiffness_of(run_cycle(INPUTS, chosen, seed, load).opening) for load in loads]
        closing = [ohms(way)[-1] for way in ways]
        opened = np.interp(loads, ways[-1].force_nN, ohms(ways[-1]))
        shares.append([*closing, *(opened / closing)])
    *closing, first, second, last = np.median(shares, axis=0)
    assert closing == sorted(closing, reverse=True)
    assert first < second < 1.0
    assert first < 1.0 / 1.1
    assert last == pytest.approx(1.0)


def test_a_film_comes_on_top():
    bare, covered = (
        resistance_Ohm(np.array([1e4]), np.array([2000.0]), 91.0, (22.0, 22.0), (0.0, 0.0), f)
        for f in (0.0, 1.0)
    )
    assert bare[0] == pytest.approx(91e9 * 44e-9 / 2e4)
    assert covered[0] - bare[0] == pytest.approx(1.0 / 2e-3)


def spots(radius_nm, number=1, e_star=91.0):
    """Stiffness (N/m) and area (nm2) of equal, distant round spots."""
    return np.array([2.0 * number * radius_nm * e_star]), np.array([number * np.pi * radius_nm**2])


def test_narrow_spots_end_at_sharvins_resistance_and_wide_ones_at_holms():
    slope, area = spots(0.01)
    sharvin = 4.0 * 22.0 * 37.7 / (3.0 * np.pi * 0.01**2)
    assert resistance_Ohm(slope, area, 91.0, *GOLD)[0] == pytest.approx(sharvin, rel=1e-3)
    slope, area = spots(1e5)
    assert resistance_Ohm(slope, area, 91.0, *GOLD)[0] == pytest.approx(22.0 / 2e5, rel=1e-3)
    one, ten = (resistance_Ohm(*spots(20.0, number), 91.0, *GOLD)[0] for number in (1, 10))
    assert one == pytest.approx(10.0 * ten)
    bodies = [
        resistance_Ohm(*spots(20.0), 91.0, rho, (37.7, 5.0))[0] for rho in ((22, 1e-3), (1e-3, 60))
    ]
    both = resistance_Ohm(*spots(20.0), 91.0, (22.0, 60.0), (37.7, 5.0))[0]
    assert both == pytest.approx(sum(bodies), rel=1e-3)


def returned(place, heading, free_path, through, rng):
    """Which side electrons end on (-1, 1) that leave a hole of radius 1 in a wall at z = 0; 0: in
    the hole again.

    They fly straight between collisions that turn them anywhere, and are mirrored by the wall.
    Beyond `far`, those who come back are counted by the current that the hole takes up, Holm's and
    Sharvin's resistance of one side in a row.

    Parameters
    ----------
    through : follow those that cross the hole again; else these end there.
    """
    far = 20.0 + 10.0 * free_path
    position, heading, left = place.copy(), heading.copy(), rng.exponential(free_path, len(place))
    side, end = np.sign(heading[:, 2]), np.full(len(place), np.nan)
    while (flying := np.flatnonzero(np.isnan(end))).size:
        x, v = position[flying], heading[flying]
        wall = np.where(
            v[:, 2] * side[flying] < 0,
            np.abs(x[:, 2]) / np.maximum(np.abs(v[:, 2]), 1e-300),
            np.inf,
        )
        hits = wall < left[flying]
        flown = np.where(hits, wall, left[flying])
        x += v * flown[:, None]
        x[hits, 2] = 0.0
        crosses = hits & (np.hypot(x[:, 0], x[:, 1]) < 1.0)
        v[hits & ~crosses, 2] *= -1.0
        turned = rng.normal(size=(np.sum(~hits), 3))
        v[~hits] = turned / np.linalg.norm(turned, axis=1)[:, None]
        left[flying] = np.where(hits, left[flying] - flown, rng.exponential(free_path, flying.size))
        position[flying], heading[flying] = x, v
        side[flying[crosses]] *= -1.0
        away = np.linalg.norm(x, axis=1)
        back = rng.random(flying.size) < 2.0 / np.pi / away / (
            1.0 + 16.0 / (3.0 * np.pi) * free_path
        )
        end[flying[away > far]] = np.where(
            back, 0.0 if not through else -side[flying], side[flying]
        )[away > far]
        if not through:
            end[flying[crosses]] = 0.0
    return end


@pytest.mark.parametrize("free_path", [1.0, 3.0])
def test_the_resistance_between_holm_and_sharvin_is_that_of_flying_electrons(free_path):
    """In balance all cross the hole alike. Those conduct that never crossed it before and end on
    the other side.
    """
    rng, number = np.random.default_rng(1), 40_000
    angle, cosine = rng.uniform(0.0, 2.0 * np.pi, number), np.sqrt(rng.random(number))
    heading = np.stack(
        [np.sqrt(1 - cosine**2) * np.cos(angle), np.sqrt(1 - cosine**2) * np.sin(angle), cosine],
        axis=1,
    )
    place = np.sqrt(rng.random((number, 1))) * [[1.0, 0.0, 0.0]]
    conducts = (returned(place, -heading, free_path, False, rng) != 0) & (
        returned(place, heading, free_path, True, rng) == 1
    )
    slope, area = spots(1.0)
    ohm = resistance_Ohm(slope, area, 91.0, (22.0, 22.0), (free_path, free_path))[0]
    sharvin = 4.0 * 22.0 * free_path / (3.0 * np.pi)
    # the published factor gives up to 4 % less; 0.7 % by chance
    assert 0.95 * sharvin / conducts.mean() < ohm < 1.005 * sharvin / conducts.mean()
