"""The switch at the ends of what its settings accept: an answer or none, and no warning."""

import random
import warnings

import pytest

from mesoscale.errors import InputError
from mesoscale.settings import DeviceSettings
from mesoscale.studies.answer_stability import published_beam
from mesoscale.switch import switch_of
from tests.mesoscale.circuit.test_tables import pad


def ends(field):
    """The bounds of a field that it accepts."""
    return [
        getattr(bound, key)
        for bound in field.metadata
        for key in ("ge", "le")
        if hasattr(bound, key)
    ]


def test_devices_at_the_ends_of_their_ranges_give_an_answer_or_none():
    rng = random.Random(0)
    fields = {
        name: ends(field)
        for name, field in DeviceSettings.model_fields.items()
        if name != "samples"
    }
    law = pad()
    for _ in range(60):
        chosen = {
            name: rng.choice(values)
            for name, values in fields.items()
            if values and rng.random() < 0.5
        }
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                states = switch_of(published_beam(**chosen)).states(law)
            except InputError:
                # a beam that stands on the dielectric at rest, or presses beyond the pad
                continue
        assert states.release_V >= 0
        assert not states.pull_in_V < 0


@pytest.mark.parametrize(
    "mistake",
    [{"length_um": 1e-9}, {"spring_N_per_m": 1e-300}, {"width_um": 1e-300}, {"thickness_um": 1e-9}],
)
def test_a_device_smaller_than_atoms_is_refused(mistake):
    (key,) = mistake
    with pytest.raises(InputError, match=f"{key} = 1e-"):
        published_beam(**mistake)
