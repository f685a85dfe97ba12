"""The engine of each mechanics: it presses a flat onto a surface."""

import numpy as np

from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.contact.pressed import Contact
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings


def contact_on(
    surface: np.ndarray,
    inputs: ContactInputs,
    settings: ContactSettings,
    numerics: Numerics = NUMERICS,
) -> Contact:
    """Contact on (N, N) heights in nm, by the engine of `settings.mechanics`."""
    engine = _engine_of(settings.mechanics)
    return engine(surface, inputs, settings, numerics)


def _engine_of(mechanics: str) -> type[Contact]:
    """The class of an engine. Each compiles when it is imported, so no other one is."""
    if mechanics == "adhesive":
        from mesoscale.contact.coupled.adhesive import AdhesiveContact

        return AdhesiveContact
    if mechanics == "coupled":
        from mesoscale.contact.coupled.engine import CoupledContact

        return CoupledContact
    from mesoscale.contact.asperity.engine import AsperityContact

    return AsperityContact
