"""Measurements in, posteriors of the inputs out (docs/calibration.md)."""
