import numpy as np
import pytest

from mesoscale.contact.asperity.engine import AsperityContact
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings

INPUTS = ContactInputs(
    hamaker=0.0, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5
)


def sphere_tip(pixels: int, spacing: float, radius: float) -> np.ndarray:
    x = (np.arange(pixels) - pixels // 2) * spacing
    squared = np.minimum(x[:, None] ** 2 + x[None, :] ** 2, 0.99 * radius**2)
    return radius - np.sqrt(radius**2 - squared)


def settings_for(pixels: int, spacing: float, **changes) -> ContactSettings:
    return ContactSettings(
        **{
            "mechanics": "asperity",
            "pixels": pixels,
            "length_nm": pixels * spacing,
            "model": "elastic",
            **changes,
        }
    )


@pytest.mark.parametrize(("prefactor", "force"), [("hertz", 1213.3), ("paper", 606.7)])
@pytest.mark.parametrize("radius", ["curvature", "truncation"])
def test_a_sphere_follows_hertz(prefactor, force, radius):
    """R = 100 nm, indentation 1 nm, E* = 91 GPa; a cap's profile curvatures are 1/R to within 1
    %.
    """
    heights = sphere_tip(128, 0.5, 100.0)
    contact = AsperityContact(
        heights, INPUTS, settings_for(128, 0.5, reading={"prefactor": prefactor, "radius": radius})
    )
    assert contact.move_to(-1.0, False)[0] == pytest.approx(force, rel=0.01)


def test_hertz_error_falls_with_the_grid_spacing():
    errors = []
    for spacing in (2.0, 1.0, 0.5):
        pixels = int(64 / spacing)
        contact = AsperityContact(
            sphere_tip(pixels, spacing, 100.0),
            INPUTS,
            settings_for(pixels, spacing, reading={"radius": "truncation"}),
        )
        sites = contact.move_to(-1.0, False)[1]
        errors.append(abs(sites * spacing**2 / (np.pi * (2 * 100.0 - 1.0)) - 1))
    assert errors[2] < errors[0]
    assert errors[2] < 0.01


def test_greenwood_williamson_with_exponential_heights():
    """F = sqrt(pi) N E* sqrt(R) sigma^1.5 exp(-d/sigma), from 1024 equal caps at exponential
    heights.

    The mean profile curvature over a cap exceeds 1/R by some delta / (2 R), about 1 % here, and the
    quantile heights miss the tail beyond the last summit, another 1 %.
    """
    cell, cells, spacing, radius, sigma, separation = 32, 32, 0.5, 20.0, 0.2, 0.4
    pixels = cell * cells
    tip = sphere_tip(cell, spacing, radius)
    summits = -sigma * np.log((np.arange(cells**2) + 0.5) / cells**2)
    np.random.default_rng(0).shuffle(summits)
    heights = np.kron(np.ones((cells, cells)), tip) - np.kron(
        summits.reshape(cells, cells), np.ones((cell, cell))
    )
    settings = settings_for(pixels, spacing)
    force, _, asperities, *_ = AsperityContact(heights, INPUTS, settings).move_to(separation, False)
    theory = (
        np.sqrt(np.pi)
        * cells**2
        * 91.0
        * np.sqrt(radius)
        * sigma**1.5
        * np.exp(-separation / sigma)
    )
    assert asperities == np.sum(summits > separation)
    assert force == pytest.approx(theory, rel=0.03)


def test_diagonal_sites_belong_together():
    heights = np.ones((32, 32))
    heights[0, 0] = heights[31, 31] = -1.0  # neighbours across the periodic corner
    contact = AsperityContact(heights, INPUTS, settings_for(32, 1.0))
    assert contact.move_to(0.0, False)[2] == 1


def test_moving_down_in_steps_finds_the_same_asperities_as_at_once():
    heights = np.random.default_rng(2).normal(size=(64, 64))
    stepwise = AsperityContact(heights, INPUTS, settings_for(64, 1.0))
    for separation in np.linspace(3, 0, 40):
        in_steps = stepwise.move_to(separation, False)
    at_once = AsperityContact(heights, INPUTS, settings_for(64, 1.0)).move_to(0.0, False)
    assert in_steps[1:3] == at_once[1:3]
    assert in_steps[0] == pytest.approx(at_once[0], rel=1e-12)


def test_the_bound_on_the_radius_is_a_rigid_punch_of_the_asperity_area():
    """A flat has no curvature; its force is that of a rigid punch, 2 E* a delta, not infinite."""
    flat = AsperityContact(np.zeros((32, 32)), INPUTS, settings_for(32, 1.0))
    force, sites, _, bounds, *_ = flat.move_to(-0.1, False)
    assert (sites, bounds) == (1024, 1)
    assert force == pytest.approx(2 * 91.0 * np.sqrt(sites / np.pi) * 0.1, rel=1e-9)
