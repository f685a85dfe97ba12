"""What the measurements say about the surface: spectrum, heights, and the parameters in use."""
