"""Studies of the calibration: simulation-based calibration, direct sampling on the engine, hard cases."""
