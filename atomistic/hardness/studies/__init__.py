"""How far the hardness can be trusted: error against run time, detection of yield, hard cases."""
