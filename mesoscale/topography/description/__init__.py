"""What the measurements say about the surface: its spectrum, its heights, and the parameters in
use.
"""
