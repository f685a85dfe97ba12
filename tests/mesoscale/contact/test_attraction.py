import numpy as np
import pytest

from mesoscale.contact.engine import Contact
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.topography.synthesis import synthesize

INPUTS = ContactInputs(hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5)


def test_plates_follow_hamaker():
    """A_H = 0.215e-18 J, gap 10 nm, 1 um^2: 11.41 nN."""
    contact = Contact(np.zeros((32, 32)), INPUTS, ContactSettings(pixels=32, model="elastic"))
    assert contact.attraction(10.0) == pytest.approx(-11.4061, rel=1e-5)
    assert contact.attraction(0.05) == contact.attraction(0.1)  # both below the cut-off gap


def test_gaussian_heights_far_away_follow_the_asymptotic_series():
    """<(d - h)^-3> = d^-3 (1 + 6 s + 45 s^2 + ...), s = (sigma/d)^2; a realisation's skewness allowed for."""
    heights = synthesize(256, 1000.0, 0.2, 0.75, 1.0, 5)
    contact = Contact(heights, INPUTS, ContactSettings(pixels=256, model="elastic"))
    separation = 20.0
    s = (1.0 / separation) ** 2
    series = 1 + 6 * s + 45 * s**2 - 10 * np.mean(heights**3) / separation**3
    plates = -0.215e6 / (6 * np.pi * separation**3)
    assert contact.attraction(separation) == pytest.approx(plates * series, rel=1e-4)


@pytest.mark.parametrize("bins", [64, 4096])
@pytest.mark.parametrize("touching", [True, False])
def test_the_histogram_agrees_with_the_sum_over_all_sites(bins, touching):
    heights = synthesize(128, 1000.0, 0.05, 0.75, 8.5, 5)
    settings = ContactSettings(pixels=128, model="elastic", gap_bins=bins, touching_attracts=touching)
    contact = Contact(heights, INPUTS, settings)
    for separation in (60.0, 35.0, 20.0, 0.0):
        gap = heights + separation
        gap = np.maximum(gap if touching else gap[gap >= 0], 0.165)
        exact = -0.215 * (1000 / 128) ** 2 / (6 * np.pi) * np.sum(gap**-3.0)
        # next term of the expansion: (w / 2 g)^5 with g > 100 w, so the number of bins does not matter
        assert contact.attraction(separation) == pytest.approx(exact, rel=1e-11)
