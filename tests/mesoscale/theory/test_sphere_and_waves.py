"""Exact solutions: forces as integrals of their pressures, limits, scaling, and a half-space by FFT
beside them.
"""

import numpy as np
import pytest
from scipy import fft, integrate

from mesoscale import theory

E_STAR = 91.0
WAVE = {"amplitude": 3.0, "wavelength": 50.0, "e_star": E_STAR}
SHARES = (0.05, 0.3, 0.5, 0.8, 0.95)


def displacement(pressure: np.ndarray, length: float, e_star: float) -> np.ndarray:
    """Displacement of a periodic half-space of any dimension under a pressure: 2 p(q) / (E* q),
    mean zero.
    """
    axes = [2.0 * np.pi * fft.fftfreq(n, length / n) for n in pressure.shape]
    q = np.sqrt(sum(wave**2 for wave in np.meshgrid(*axes, indexing="ij")))
    green = np.divide(2.0 / e_star, q, out=np.zeros_like(q), where=q > 0)
    return fft.ifftn(green * fft.fftn(pressure)).real


def test_a_sphere_by_hand():
    """R = 100 nm, indentation 1 nm, E* = 91 GPa: 1213.3 nN, contact radius 10 nm, highest pressure
    5.793 GPa.
    """
    force = theory.hertz_force(1.0, 100.0, E_STAR)
    assert force == pytest.approx(1213.333, rel=1e-6)
    assert theory.hertz_contact_radius(force, 100.0, E_STAR) == pytest.approx(10.0, rel=1e-12)
    assert theory.hertz_pressure(0.0, force, 100.0, E_STAR) == pytest.approx(5.7932, rel=1e-5)
    assert theory.hertz_indentation(force, 100.0, E_STAR) == pytest.approx(1.0, rel=1e-12)


def test_nothing_pulls():
    assert theory.hertz_force(-1.0, 100.0, E_STAR) == 0.0
    assert theory.punch_force(-1.0, 10.0, E_STAR) == 0.0
    assert theory.hertz_pressure(11.0, 1213.3, 100.0, E_STAR) == 0.0
    assert theory.punch_pressure(11.0, 1.0, 10.0) == 0.0
    assert theory.wave_pressure(25.0, 1.0, **WAVE) == 0.0


def test_pressures_carry_the_forces():
    """r = a sin t takes the singular edges out of the integrals."""
    force, radius = 700.0, 40.0
    for contact, profile in (
        (
            theory.hertz_contact_radius(force, radius, E_STAR),
            lambda r: theory.hertz_pressure(r, force, radius, E_STAR),
        ),
        (12.0, lambda r: theory.punch_pressure(r, force, 12.0)),
    ):

        def ring(angle, a=contact, pressure=profile):
            sine = np.sin(angle)
            return pressure(a * sine) * 2 * np.pi * a**2 * sine * np.cos(angle)

        assert integrate.quad(ring, 0.0, np.pi / 2, epsrel=1e-12)[0] == pytest.approx(
            force, rel=1e-10
        )


@pytest.mark.parametrize("share", [*SHARES, 1.0])
def test_the_pressure_of_a_wave_has_its_mean(share):
    mean = theory.wave_mean_pressure(share, **WAVE)
    # arcsine loses half the digits at 1
    assert theory.wave_area_share(mean, **WAVE) == pytest.approx(share, rel=1e-7)
    edge = np.sin(0.5 * np.pi * share)

    def strip(t):  # sin(pi x / wavelength) = sin(pi a / wavelength) sin(t)
        phase = np.arcsin(edge * np.sin(t))
        x = WAVE["wavelength"] / np.pi * phase
        return theory.wave_pressure(x, mean, **WAVE) * edge * np.cos(t) / (np.pi * np.cos(phase))

    total = integrate.quad(strip, -np.pi / 2, np.pi / 2, epsrel=1e-12, epsabs=1e-13)[0]
    assert total == pytest.approx(mean, rel=1e-10)


@pytest.mark.parametrize("share", SHARES)
def test_a_wave_solves_the_half_space(share):
    """The stated pressure, by the periodic Green's function: gap 0 inside, positive outside, as
    stated.

    A pressure that ends like a square root is integrated on a grid with an error of its spacing to
    the 3/2, whose factor depends on where the edge lies between two sites.
    """
    mean = theory.wave_mean_pressure(share, **WAVE)
    for sites in (1024, 4096):
        x = (np.arange(sites) + 0.5) * WAVE["wavelength"] / sites
        bent = displacement(theory.wave_pressure(x, mean, **WAVE), WAVE["wavelength"], E_STAR)
        undeformed = -WAVE["amplitude"] * np.cos(2 * np.pi * x / WAVE["wavelength"])
        gap = theory.wave_separation(mean, **WAVE) + undeformed + bent
        assert (
            np.abs(gap - theory.wave_gap(x, mean, **WAVE)).max() / WAVE["amplitude"]
            < 10 * sites**-1.5
        )
        inside = np.abs(np.sin(np.pi * x / WAVE["wavelength"])) < np.sin(0.5 * np.pi * share)
        assert np.all(theory.wave_gap(x, mean, **WAVE)[inside] == 0.0)
        assert np.all(theory.wave_gap(x, mean, **WAVE)[~inside] > 0.0)


@pytest.mark.parametrize("share", SHARES)
def test_the_mean_gap_of_a_wave_is_its_separation(share):
    mean = theory.wave_mean_pressure(share, **WAVE)
    half = 0.5 * WAVE["wavelength"]
    gap = (
        integrate.quad(theory.wave_gap, share * half, half, (mean, *WAVE.values()), epsrel=1e-11)[0]
        / half
    )
    assert gap == pytest.approx(theory.wave_separation(mean, **WAVE), rel=1e-9)


def test_limits_of_a_wave():
    assert theory.wave_separation(0.0, **WAVE) == WAVE["amplitude"]
    assert theory.wave_gap(10.0, 0.0, **WAVE) == pytest.approx(3.0 * (1 - np.cos(0.4 * np.pi)))
    full = theory.wave_full_pressure(**WAVE)
    assert theory.wave_separation(1.5 * full, **WAVE) == 0.0
    assert theory.wave_area_share(1.5 * full, **WAVE) == 1.0
    x = np.linspace(0.0, 50.0, 11)
    expected = 1.5 * full + full * np.cos(2 * np.pi * x / 50.0)
    assert theory.wave_pressure(x, 1.5 * full, **WAVE) == pytest.approx(expected)
    # a light line contact is Hertz's: a^2 = 4 P R / (pi E*), P per length, R = wavelength^2 / (4
    # pi^2 amplitude)
    light = 1e-6 * full
    radius = 50.0**2 / (4 * np.pi**2 * 3.0)
    half_width = np.sqrt(4 * light * 50.0 * radius / (np.pi * E_STAR))
    assert theory.wave_area_share(light, **WAVE) == pytest.approx(2 * half_width / 50.0, rel=1e-6)


def test_a_punch_and_a_sphere_solve_the_half_space():
    """In a periodic cell of 16 contact radii, whose images bend the gap by some (a/L)^3; the grid
    costs more.
    """
    n, length, contact, radius = 512, 160.0, 10.0, 100.0
    x = (np.arange(n) - n // 2) * length / n
    r = np.hypot(x[:, None], x[None, :])
    force = theory.hertz_force(contact**2 / radius, radius, E_STAR)
    sphere = r**2 / (2 * radius) + displacement(
        theory.hertz_pressure(r, force, radius, E_STAR), length, E_STAR
    )
    sphere -= sphere[n // 2, n // 2]
    indentation = contact**2 / radius
    assert np.abs(sphere[r < contact]).max() < 3e-3 * indentation
    assert sphere[r > 1.1 * contact].min() > 0

    # at the centre of an isolated contact, u = (2/E*) int p dr
    at_centre = integrate.quad(
        theory.hertz_pressure, 0.0, contact, (force, radius, E_STAR), epsrel=1e-12
    )[0]
    assert 2 / E_STAR * at_centre == pytest.approx(indentation, rel=1e-10)
    force = theory.punch_force(1.0, contact, E_STAR)
    at_centre = integrate.quad(
        lambda t: theory.punch_pressure(contact * np.sin(t), force, contact) * contact * np.cos(t),
        0,
        np.pi / 2,
    )[0]
    assert 2 / E_STAR * at_centre == pytest.approx(1.0, rel=1e-10)


def test_the_stiffness_of_a_sphere_is_a_punch():
    """dF/d(delta) = 2 E* a, whatever the shape."""
    low, high = theory.hertz_force(np.array([1.0 - 1e-5, 1.0 + 1e-5]), 100.0, E_STAR)
    assert (high - low) / 2e-5 == pytest.approx(theory.punch_force(1.0, 10.0, E_STAR), rel=1e-8)


def test_lengths_and_moduli_scale():
    """Twice all lengths: forces four times, pressures the same. Twice E*: forces and pressures
    twice.
    """
    assert theory.hertz_force(2.0, 200.0, E_STAR) == pytest.approx(
        4 * theory.hertz_force(1.0, 100.0, E_STAR)
    )
    assert theory.punch_force(2.0, 20.0, 2 * E_STAR) == pytest.approx(
        8 * theory.punch_force(1.0, 10.0, E_STAR)
    )
    large = {"amplitude": 6.0, "wavelength": 100.0, "e_star": 2 * E_STAR}
    assert theory.wave_separation(2.0, **large) == pytest.approx(
        2 * theory.wave_separation(1.0, **WAVE)
    )
    assert theory.wave_gap(40.0, 2.0, **large) == pytest.approx(
        2 * theory.wave_gap(20.0, 1.0, **WAVE)
    )
    assert theory.wave_pressure(4.0, 2.0, **large) == pytest.approx(
        2 * theory.wave_pressure(2.0, 1.0, **WAVE)
    )
    for area in (theory.bisinusoid_area_at_first_touch, theory.bisinusoid_area_near_full_contact):
        assert area(2.0, **large) == pytest.approx(area(1.0, **WAVE))


def test_the_first_touch_of_two_crossed_waves_is_hertz():
    """Summits of curvature 4 pi^2 amplitude / wavelength^2, two in a wavelength squared."""
    pressure = 1e-3
    radius = WAVE["wavelength"] ** 2 / (4 * np.pi**2 * WAVE["amplitude"])
    contact = theory.hertz_contact_radius(pressure * WAVE["wavelength"] ** 2 / 2, radius, E_STAR)
    share = 2 * np.pi * contact**2 / WAVE["wavelength"] ** 2
    assert theory.bisinusoid_area_at_first_touch(pressure, **WAVE) == pytest.approx(share)


def test_the_last_gaps_of_two_crossed_waves_close_like_pennies():
    """The stress intensity at a gap's edge vanishes: int of the full-contact pressure r / sqrt(a^2
    - r^2) is zero.

    Close to full contact, where the trough of the pressure is a parabola.
    """
    full = theory.bisinusoid_full_pressure(**WAVE)
    assert displacement_at_full_contact() == pytest.approx(0.0, abs=1e-12)
    pressure = (1 - 1e-6) * full
    open_share = 1 - theory.bisinusoid_area_near_full_contact(pressure, **WAVE)
    gap_radius = np.sqrt(open_share * WAVE["wavelength"] ** 2 / (2 * np.pi))

    def trough(t):
        phase = 2 * np.pi * gap_radius * np.sin(t) / WAVE["wavelength"]
        # cos x cos y, averaged over directions to second order: -(1 - phase^2 / 2)
        return (pressure - full + full * phase**2 / 2) * gap_radius * np.sin(t)

    mean = integrate.quad(trough, 0, np.pi / 2, epsabs=1e-16)[0]
    assert abs(mean) < 1e-5 * abs(pressure - full) * gap_radius
    assert theory.bisinusoid_area_near_full_contact(1.1 * full, **WAVE) == 1.0


def displacement_at_full_contact() -> float:
    """Largest gap of crossed waves under their full-contact pressure, nm."""
    x = np.arange(32) * WAVE["wavelength"] / 32
    wave = np.cos(2 * np.pi * x / 50.0)[:, None] * np.cos(2 * np.pi * x / 50.0)[None, :]
    bent = displacement(theory.bisinusoid_full_pressure(**WAVE) * wave, WAVE["wavelength"], E_STAR)
    return float(np.abs(bent - WAVE["amplitude"] * wave).max())
