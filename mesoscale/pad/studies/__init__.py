"""Studies of the pad: its number of cells, and large cells computed directly."""
