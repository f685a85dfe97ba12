"""How far the scan analysis can be trusted: error against run time, recovery of known truth, hard cases."""
