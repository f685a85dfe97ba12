"""How far the propagation can be trusted: brute force, work and precision, readings, unusual cases."""
