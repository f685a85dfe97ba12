"""Words of the command line that say how a film, its material and its device are."""

from argparse import Namespace

import pytest

from asperity.door import device_of, material_of, topography_of
from mesoscale.errors import InputError


@pytest.mark.parametrize(
    ("words", "of"),
    [(["e_star=75", "e_star=80"], material_of), (["gap_um=2", "gap_um=3"], device_of)],
)
def test_a_number_that_is_given_twice_is_refused(words, of):
    with pytest.raises(InputError, match="is given twice; leave one of them out"):
        of(words)


@pytest.mark.parametrize("unit", ["um", "\u00b5m", "\u03bcm"])
def test_micrometres_have_either_micro_sign(unit):
    given = Namespace(
        channel=None,
        unit=f"{unit},nm",
        size=None,
        crop=None,
        points=None,
        detrend=None,
        tip_nm=None,
    )
    (instrument,) = topography_of(given)["instruments"]
    assert (instrument.unit, instrument.height_unit) == ("um", "nm")
