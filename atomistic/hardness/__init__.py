"""Hardness against contact size: oxide asperities pressed by MD (docs/hardness.md)."""
