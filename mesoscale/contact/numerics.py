"""Numerical choices of the contact engines, by their measured errors (target `accuracy`)."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Numerics:
    """How finely a contact is computed."""

    force_steps: int = 40
    """From contact to the largest force; separations follow from them."""

    gap_bins: int = 4096
    """Of the histogram behind the far part of the attraction."""

    flow: Literal["return", "increment"] = "return"
    """An asperity flows at once to its yield surface, or by fixed increments as in the paper.

    The return is the limit of small increments."""

    flow_increment_nm: float = 0.3
    """Amplitude of one increment, the paper's."""

    flow_width_nm: float = 0.3
    """a1 in the width s1 = sqrt(a1 R) of the first Gaussian of a flow, the paper's."""

    flow_floor_pixels: float = 1.0
    """Smallest s1, so that the grid resolves the flow; 0: none."""

    flow_tolerance: float = 1e-3
    """An asperity yields above its hardness times 1 + this (flow: return)."""

    max_sweeps: int = 500
    """Flow sweeps of one separation; reaching them raises a flag."""

    unknown_work: float = 0.02
    """Largest unknown work of a step outside an adhesive contact.

    As a share of what parts the fresh surface at first touch."""


NUMERICS = Numerics()
"""What every scene uses."""
