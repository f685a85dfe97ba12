"""Contact of rough surfaces whose asperities share one elastic half-space (docs/contact.md)."""
