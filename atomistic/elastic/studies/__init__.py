"""How far E* can be trusted: error against run time and hard cases."""
