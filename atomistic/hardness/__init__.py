"""Hardness against contact size: oxide asperities pressed by molecular dynamics
(docs/hardness.md).
"""
