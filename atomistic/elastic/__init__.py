"""Effective modulus E* from energy-volume curves of amorphous networks (docs/elastic.md)."""
