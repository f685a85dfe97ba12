"""What the contact model takes: the seven inputs of Table 1, and how a row of uncertain inputs enters it."""

from collections.abc import Mapping
from dataclasses import dataclass

from mesoscale.checks import check_number
from mesoscale.settings import ContactSettings


@dataclass(frozen=True)
class ContactInputs:
    """The seven inputs of Table 1."""

    hamaker: float
    """Hamaker constant, aJ = 1e-18 J = nN nm; 0: no attraction."""
    e_star: float
    """Effective elastic modulus E* of both bodies, GPa."""
    h_macro: float
    """Hardness of large asperities, GPa."""
    h_prime: float
    """Size effect of hardness H', GPa nm^0.5."""
    q0: float
    """Roll-off wave vector of the surface, 1/nm."""
    hurst: float
    """Hurst exponent of the surface."""
    rms: float
    """RMS height of the surface, nm."""

    def __post_init__(self):
        for name, (low, high, unit, zero) in ACCEPTED.items():
            check_number(name, getattr(self, name), low, high, unit, zero)


ACCEPTED = {
    "hamaker": (1e-6, 1e4, "aJ (1e-18 J)", True),
    "e_star": (1e-6, 1e6, "GPa", False),
    "h_macro": (1e-9, 1e6, "GPa", True),
    "h_prime": (1e-9, 1e6, "GPa nm^0.5", True),
    "q0": (1e-7, 1e3, "1/nm", False),
    "hurst": (1e-6, 2.0, "1", False),
    "rms": (1e-5, 1e6, "nm", True),
}
"""Smallest and largest value of an input, its unit, and whether 0 is accepted besides.

Wide, from the softest gels to beyond diamond, yet narrow enough to refuse metres, pascals and joules.
"""


def contact_of(values: Mapping[str, float], settings: ContactSettings) -> tuple[ContactInputs, ContactSettings]:
    """Contact inputs, and settings with the optional eighth input (the attraction's gap cutoff) put in."""
    named = dict(values)
    cutoff = named.pop("gap_cutoff", None)
    if cutoff is not None:
        settings = settings.model_copy(update={"gap_cutoff_nm": cutoff})
    return ContactInputs(**named), settings
