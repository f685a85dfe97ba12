"""The engine against the plain implementation of the model (evidence/contact/plain_contact.py)."""

from dataclasses import replace

import numpy as np
import pytest

from evidence.contact import plain_contact
from mesoscale.contact.asperity.engine import AsperityContact
from mesoscale.contact.numerics import Numerics
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.topography.synthesis import synthesize

INPUTS = ContactInputs(
    hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.06, hurst=0.75, rms=3.0
)
# asperities of 1 to 20 nm
FILM = replace(INPUTS, h_prime=0.0, h_film=8.0, t_film=2.0, k_film=0.24, m_film=1.2)
CASES: dict[str, tuple[dict, dict, dict]] = {  # settings, reading, numerics
    "default": ({}, {}, {}),
    "paper": (
        {},
        {"flow_pair": "paper"},
        {"flow": "increment", "flow_floor_pixels": 0, "max_sweeps": 50},
    ),
    "wide increments": ({}, {}, {"flow": "increment"}),
    "truncation": (
        {"gap_cutoff_nm": 0.3},
        {"radius": "truncation", "area": "hertz"},
        {"max_sweeps": 60},
    ),
    "film": ({}, {}, {}),
    "clamped": ({"attraction": "clamped"}, {}, {}),
    "as printed": (
        {"attraction": "clamped"},
        {"convention": "profile", "prefactor": "paper", "touching_attracts": True},
        {},
    ),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("model", ["elastic", "nonlinear", "plastic"])
def test_forces_and_surface_agree_with_the_plain_model(case, model):
    pixels = 80
    changes, reading, choices = CASES[case]
    numerics = Numerics(**choices)
    inputs = FILM if case == "film" else INPUTS
    settings = ContactSettings(
        mechanics="asperity",
        pixels=pixels,
        length_nm=0.977 * pixels,
        model=model,
        reading=reading,
        **changes,
    )
    heights = synthesize(
        pixels, settings.length_nm, 0.06, 0.75, 3.0, 3, settings.reading.convention
    )
    lowest = np.unravel_index(np.argmin(heights), heights.shape)
    # the first asperity straddles the corner
    heights = np.roll(heights, (-lowest[0], -lowest[1]), (0, 1))
    separations = -heights.min() - np.linspace(0.05, 3.5, 20)
    expected, surface = plain_contact.walk(heights, separations, inputs, settings, numerics)
    contact = AsperityContact(heights.copy(), inputs, settings, numerics)
    found = [
        (contact.move_to(d, model == "plastic")[0], contact.attraction(d)) for d in separations
    ]
    tolerance = 1e-8 if model == "plastic" else 1e-10
    np.testing.assert_allclose(found, expected, rtol=tolerance)
    np.testing.assert_allclose(contact.heights.reshape(heights.shape), surface, atol=1e-8)
    assert expected[-1, 0] > 100.0  # nN: many asperities, well beyond first yield
