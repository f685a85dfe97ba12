"""Effective modulus E* from E(V) and elastic constants of amorphous networks (docs/elastic.md)."""
