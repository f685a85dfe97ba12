"""Contact of a rough surface with a flat: asperities, flow, attraction (docs/contact.md)."""

from mesoscale.contact.cycle import Branch, Cycle, run_cycle
from mesoscale.inputs.contact import ContactInputs

__all__ = ["Branch", "ContactInputs", "Cycle", "run_cycle"]
