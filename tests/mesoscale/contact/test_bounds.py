"""What settings accept, the arithmetic holds: cycles at the ends of their ranges end, or are
refused in one line.
"""

import warnings

import numpy as np
import pytest
from annotated_types import Ge, Le

from mesoscale.contact import ContactInputs, run_cycle
from mesoscale.errors import InputError
from mesoscale.settings import ContactSettings
from mesoscale.settings.surface import SpectrumSettings

INPUTS = ContactInputs(
    hamaker=0.2, e_star=91.0, h_macro=1.95, h_prime=8.4, q0=0.025, hurst=0.75, rms=4.4
)


def ends(model, name):
    """The least and the largest number that a field accepts."""
    bounds = model.model_fields[name].metadata
    return [
        getattr(bound, kind)
        for kind, of in (("ge", Ge), ("le", Le))
        for bound in bounds
        if isinstance(bound, of)
    ]


def corners():
    for name in ("max_force_nN", "gap_cutoff_nm", "q1_per_nm", "retardation_nm"):
        yield from ({name: value} for value in ends(ContactSettings, name))
    for q0 in ends(SpectrumSettings, "q0"):
        for hurst in ends(SpectrumSettings, "hurst"):
            yield {
                "surface": {
                    "spectrum": {"q": [0.02, 0.1], "psd": [1e-30, 1e12], "q0": q0, "hurst": hurst}
                }
            }


@pytest.mark.parametrize("changes", list(corners()), ids=str)
@pytest.mark.parametrize("mechanics", ["asperity", "coupled"])
def test_every_end_of_a_range_can_be_computed_or_is_refused(changes, mechanics):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            cycle = run_cycle(INPUTS, ContactSettings(mechanics=mechanics, pixels=32, **changes), 1)
        except InputError:
            return
    for branch in (cycle.closing, cycle.opening):
        assert np.isfinite([branch.separation_nm, branch.repulsive_nN, branch.attractive_nN]).all()
