"""A pad: many cells under one rigid plane, closed by separation, with a memory of the deepest
closing (docs/pad.md).
"""
