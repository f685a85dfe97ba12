"""The engine against the plain implementation of the model (benchmarks/plain_contact.py)."""

import numpy as np
import pytest

from benchmarks import plain_contact
from mesoscale.contact.asperity.engine import Contact
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.topography.synthesis import synthesize

INPUTS = ContactInputs(hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.06, hurst=0.75, rms=3.0)
READINGS = {
    "default": {},
    "paper": {"flow": "increment", "flow_pair": "paper", "flow_floor_pixels": 0, "max_sweeps": 50},
    "wide increments": {"flow": "increment", "flow_pair": "wide"},
    "truncation": {"radius": "truncation", "area": "hertz", "gap_cutoff_nm": 0.3, "max_sweeps": 60},
    "as printed": {"convention": "profile", "prefactor": "paper", "touching_attracts": True, "neighbours": 4},
    "flattened": {"unloading_radius": "flattened"},
    "not less": {"merge": "not_less"},
    "both mended": {"unloading_radius": "flattened", "merge": "not_less", "neighbours": 4},
    "mended truncation": {"unloading_radius": "flattened", "merge": "not_less", "radius": "truncation"},
}


@pytest.mark.parametrize("reading", READINGS)
@pytest.mark.parametrize("model", ["elastic", "nonlinear", "plastic"])
def test_forces_and_surface_agree_with_the_plain_model(reading, model):
    pixels = 80
    settings = ContactSettings(pixels=pixels, length_nm=0.977 * pixels, model=model, **READINGS[reading])
    heights = synthesize(pixels, settings.length_nm, 0.06, 0.75, 3.0, 3, settings.convention)
    lowest = np.unravel_index(np.argmin(heights), heights.shape)
    heights = np.roll(heights, (-lowest[0], -lowest[1]), (0, 1))  # the first asperity straddles the corner
    separations = -heights.min() - np.linspace(0.05, 3.5, 20)
    expected, surface = plain_contact.walk(heights, separations, INPUTS, settings)
    contact = Contact(heights.copy(), INPUTS, settings)
    found = [(contact.move_to(d, model == "plastic")[0], contact.attraction(d)) for d in separations]
    tolerance = 1e-8 if model == "plastic" else 1e-10
    np.testing.assert_allclose(found, expected, rtol=tolerance)
    np.testing.assert_allclose(contact.heights.reshape(heights.shape), surface, atol=1e-8)
    assert expected[-1, 0] > 100.0  # nN: many asperities, well beyond first yield
