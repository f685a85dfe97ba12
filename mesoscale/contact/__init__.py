"""Contact of a rough surface with a flat: asperities, plastic flow, attraction (docs/contact.md)."""

from mesoscale.contact.cycle import Branch, ContactInputs, Cycle, run_cycle

__all__ = ["Branch", "ContactInputs", "Cycle", "run_cycle"]
