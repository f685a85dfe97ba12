"""What the contact model takes: the seven inputs of Table 1, and how a row of uncertain inputs enters it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields

from mesoscale.errors import InputError
from mesoscale.settings import ContactSettings


@dataclass(frozen=True)
class ContactInputs:
    """The seven inputs of Table 1."""

    hamaker: float  # aJ = 1e-18 J = nN nm
    e_star: float  # GPa
    h_macro: float  # GPa
    h_prime: float  # GPa nm^0.5
    q0: float  # 1/nm
    hurst: float  # 1
    rms: float  # nm

    def __post_init__(self):
        positive = {"e_star", "q0", "hurst"}
        for field in fields(self):
            value = getattr(self, field.name)
            if not math.isfinite(value) or value < 0 or (value == 0 and field.name in positive):
                bound = "> 0" if field.name in positive else ">= 0"
                raise InputError(f"{field.name} = {value}: accepted are finite numbers {bound}")


def contact_of(values: Mapping[str, float], settings: ContactSettings) -> tuple[ContactInputs, ContactSettings]:
    """Contact inputs, and settings with the optional eighth input (the attraction's gap cutoff) put in."""
    named = dict(values)
    cutoff = named.pop("gap_cutoff", None)
    if cutoff is not None:
        settings = settings.model_copy(update={"gap_cutoff_nm": cutoff})
    return ContactInputs(**named), settings
