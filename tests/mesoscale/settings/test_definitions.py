"""The rows of the table of inputs, and how an input that replaces a setting enters the contact
model.
"""

from operator import attrgetter

import pytest

from mesoscale.errors import InputError
from mesoscale.inputs.contact import contact_of
from mesoscale.settings import ContactSettings
from mesoscale.settings.definitions import INPUTS

MIDDLE = {
    "hamaker": 0.2,
    "e_star": 90.0,
    "h_macro": 2.0,
    "h_prime": 8.0,
    "q0": 0.025,
    "hurst": 0.7,
    "rms": 5.0,
}


@pytest.mark.parametrize("row", [row for row in INPUTS if row.setting], ids=lambda row: row.name)
def test_a_setting_that_an_input_replaces_takes_all_of_its_range(row):
    for value in (row.low, row.high):
        settings = contact_of({**MIDDLE, row.name: value}, ContactSettings())[1]
        assert attrgetter(row.setting)(settings) == value


def test_a_value_that_the_setting_does_not_accept_is_refused():
    with pytest.raises(InputError, match="gap_cutoff_nm"):
        contact_of({**MIDDLE, "gap_cutoff": -1.0}, ContactSettings())
