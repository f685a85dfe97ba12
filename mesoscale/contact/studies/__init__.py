"""How far the contact model can be trusted: error against run time, extreme cases, random draws, a half-space."""
