"""Effective modulus E* from energy-volume curves and elastic constants of amorphous networks
(docs/elastic.md).
"""
