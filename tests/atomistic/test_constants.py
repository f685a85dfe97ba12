"""The constants are those of CODATA."""

import pytest
from scipy import constants as codata

from atomistic import constants


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("EV_PER_A3_IN_GPA", codata.e * 1e21),
        ("COULOMB_EV_A", codata.e * 1e10 / (4 * codata.pi * codata.epsilon_0)),
        ("AVOGADRO", codata.N_A),
        ("AMU_PER_A3_IN_G_CM3", codata.atomic_mass * 1e27),
    ],
)
def test_constant_is_that_of_codata(name, value):
    # seven to ten digits are written out, and editions differ in the ninth
    assert getattr(constants, name) == pytest.approx(value, rel=1e-7, abs=0)
