"""The switch for circuit simulators: its pad as tables, its electrode as lumps, netlists, corners
and draws.
"""
