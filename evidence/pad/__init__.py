"""Studies of the pad."""
