"""Hardness at the slope of the contact's own tops."""

import numpy as np
import pytest

from mesoscale.contact.steepness import at_slope
from mesoscale.contact.surface import random_surface
from mesoscale.errors import InputError
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import collect
from mesoscale.settings import ContactSettings, InputRow
from mesoscale.settings.contact import NOMINAL_SEED
from tests.mesoscale import paper

CONTACT = ContactSettings(pixels=128, length_nm=500.0)
KNOWN = {"rms_slope": [0.2, 0.4, 0.8], "factor": [0.5, 1.0, 1.5]}
ENTRIES = {"h_prime": {"distribution": "uniform", "a": 4.0, "b": 12.0, "steepness": KNOWN}}


def inputs(rms):
    row = InputRow(distribution="fixed", values=(rms,))
    settings = paper.INPUTS.model_copy(update={"rms": row, "h_prime": InputRow(origin="hardness")})
    stage = {"inputs": ENTRIES, "gate": {"passed": True}}
    return collect(settings, {"hardness": stage}, {"hardness": "hardness/fit.json"})


def slope(rms):
    heights = random_surface(*contact_of(inputs(rms).medians(), CONTACT), NOMINAL_SEED)
    step = CONTACT.length_nm / CONTACT.pixels
    wave = np.fft.fftfreq(CONTACT.pixels, step) * 2 * np.pi
    power = np.abs(np.fft.fft2(heights) / heights.size) ** 2
    return float(np.sqrt(np.sum(power * (wave[:, None] ** 2 + wave**2))))


@pytest.mark.parametrize(
    ("wanted", "factor"), [(0.2 * 2**0.5, 0.75), (0.4, 1.0), (0.4 * 2**0.5, 1.25)]
)
def test_hardness_is_that_at_the_slope_of_the_surface(wanted, factor):
    table = inputs(wanted / slope(1.0))  # slopes are proportional to heights
    row = next(row for row in at_slope(table, ENTRIES, CONTACT).rows if row.name == "h_prime")
    assert (row.distribution.a, row.distribution.b) == pytest.approx(
        (4 * factor, 12 * factor), rel=1e-6
    )
    assert row.source == f"hardness/fit.json, times {factor:.2f} at RMS slope {wanted:.2f}"


def test_inputs_that_are_stated_stay():
    assert at_slope(table := inputs(3.0), {}, CONTACT) is table


@pytest.mark.parametrize("wanted", [0.19, 0.81])
def test_a_slope_outside_the_runs_is_refused_in_one_line(wanted):
    with pytest.raises(
        InputError,
        match=r"hardness/fit.json: the surface has an RMS slope of .* from 0.2 to 0.8; set",
    ):
        at_slope(inputs(wanted / slope(1.0)), ENTRIES, CONTACT)
