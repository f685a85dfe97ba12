"""Attacks on the program: mutated scenes, damaged files, kills, full disks (docs/robustness.md).

`python -m attacks NAME` runs a campaign and writes its table; a small part of each runs in the tests.
"""
