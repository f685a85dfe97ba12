"""How often a switch fails, down to one in a million."""
