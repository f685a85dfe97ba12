"""Persson, and Greenwood and Williamson: integrals, limits, and computed contacts beside them."""

import numpy as np
import pytest
from scipy import integrate, special, stats

import asperity as asp
from mesoscale import theory

E_STAR = 91.0
GRADIENT = 0.3
SUMMITS = theory.Summits(density=1e-3, radius=40.0, scatter=2.0, above_mean=3.0)


@pytest.mark.parametrize("mean_pressure", [0.05, 1.0, 8.0, 20.0])
def test_pressures_of_persson_carry_the_load_on_his_area(mean_pressure):
    def density(pressure):
        return theory.persson_pressure_density(pressure, mean_pressure, GRADIENT, E_STAR)

    end = mean_pressure + 10 * E_STAR * GRADIENT
    points = [mean_pressure]
    area, _ = integrate.quad(density, 0, end, points=points, epsabs=1e-12)
    load, _ = integrate.quad(lambda p: p * density(p), 0, end, points=points, epsabs=1e-12)
    share = theory.persson_area_share(mean_pressure, GRADIENT, E_STAR)
    assert area == pytest.approx(share, rel=1e-9)
    assert load == pytest.approx(mean_pressure, rel=1e-9)


def test_area_of_persson_begins_with_his_slope():
    share = theory.persson_area_share(1e-4, GRADIENT, E_STAR)
    assert share == pytest.approx(np.sqrt(8 / np.pi) * 1e-4 / (E_STAR * GRADIENT), rel=1e-6)


@pytest.mark.parametrize("separation", [-3.0, 0.0, 1.0, 5.0, 9.0])
def test_greenwood_and_williamson_are_means_over_their_summits(separation):
    """The integrals of their paper, by quadrature over the heights of the summits."""
    heights = stats.norm(scale=SUMMITS.scatter)

    def mean(of_one):
        def weighed(height):
            return of_one(height - separation) * heights.pdf(height)

        return integrate.quad(weighed, separation, separation + 15 * SUMMITS.scatter)[0]

    area = SUMMITS.density * mean(lambda delta: np.pi * SUMMITS.radius * delta)
    pressure = SUMMITS.density * mean(
        lambda delta: theory.hertz_force(delta, SUMMITS.radius, E_STAR)
    )
    share = theory.greenwood_williamson_area_share(separation, SUMMITS)
    assert share == pytest.approx(area, rel=1e-7)
    assert theory.greenwood_williamson_pressure(separation, SUMMITS, E_STAR) == pytest.approx(
        pressure, rel=1e-7
    )


def surface_of(pixels, side, waves, exponent):
    """Heights of a random surface, and the Fourier amplitudes and wave vectors that they are of."""
    random = np.random.default_rng(7)
    wave = np.fft.fftfreq(pixels, side / pixels) * 2 * np.pi
    q = np.hypot(wave[:, None], wave)
    low, high = waves
    inside = (q > low) & (q < high)
    weight = np.where(inside, q, np.inf) ** exponent
    amplitudes = weight * np.fft.fft2(random.standard_normal((pixels, pixels)))
    return np.fft.ifft2(amplitudes).real, amplitudes, wave


def test_summits_of_a_surface_are_counted_on_it():
    """On a random surface of one octave of waves: number and scatter of local maxima."""
    pixels, side = 512, 512.0
    heights, amplitudes, wave = surface_of(pixels, side, (0.10, 0.20), -0.5)
    slopes = np.fft.ifft2(1j * wave * amplitudes).real
    curvatures = np.fft.ifft2(-(wave**2) * amplitudes).real
    moments = [(field**2).mean() for field in (heights, slopes, curvatures)]
    summits = theory.summits_of(*moments)
    steps = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]
    around = np.array([np.roll(heights, step, (0, 1)) for step in steps])
    tops = heights[(heights > around).all(axis=0)]
    # some 800 summits: 3.5 % by chance each, and a surface that is isotropic by chance alone
    assert tops.size / side**2 == pytest.approx(summits.density, rel=0.1)
    assert tops.mean() == pytest.approx(summits.above_mean, rel=0.1)
    assert tops.std() == pytest.approx(summits.scatter, rel=0.1)


def test_computed_areas_lie_a_little_above_persson_and_meet_him_at_full_contact():
    """At light loads between Persson and Bush, Gibson and Thomas, whose area is pi / 2 of his."""
    pixels, side = 256, 256.0
    heights, amplitudes, wave = surface_of(pixels, side, (0.07, 0.4), -1.8)
    slopes = [np.fft.ifft2(1j * q * amplitudes).real for q in (wave[:, None], wave)]
    heights *= 0.05 / np.sqrt(sum((slope**2).mean() for slope in slopes))
    shares = np.array([0.02, 0.05, 0.2, 0.5, 0.8])
    pressures = special.erfinv(shares) * E_STAR * 0.05 / np.sqrt(2)
    assert theory.persson_area_share(pressures, 0.05, E_STAR) == pytest.approx(shares)
    pressed = asp.press(heights, side, pressures * side**2, E_STAR)
    ratio = pressed.area_share / shares
    assert (ratio > 1.0).all()
    assert (ratio < np.pi / 2).all()
    assert (np.diff(ratio) < 0.0).all()
    assert ratio[-1] == pytest.approx(1.0, abs=0.1)
