"""Numerical choices of the contact engines, fixed by their measured errors (target `accuracy`); no
scene sets them.
"""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Numerics:
    """How finely a contact is computed.

    Attributes
    ----------
    force_steps : steps of the force from contact to its largest value; separations follow from
        them.
    gap_bins : bins of the histogram behind the far part of the attraction.
    flow : how a yielding asperity flows: at once to its yield surface, or by fixed increments as in
        the paper, of which
        the return is the limit.
    flow_increment_nm : amplitude of one increment (the paper's, nm).
    flow_width_nm : a1 in the width s1 = sqrt(a1 R) of the first Gaussian of a flow (the paper's,
        nm).
    flow_floor_pixels : smallest s1 in pixels, so that the grid resolves the flow; 0: none.
    flow_tolerance : an asperity yields above its hardness times 1 + this (flow: return).
    max_sweeps : bound on the flow sweeps of one separation; reaching it raises a flag.
    unknown_work : work that a step outside an adhesive contact may leave open, of what parts the
        fresh surface at
        first touch.
    """

    force_steps: int = 40
    gap_bins: int = 4096
    flow: Literal["return", "increment"] = "return"
    flow_increment_nm: float = 0.3
    flow_width_nm: float = 0.3
    flow_floor_pixels: float = 1.0
    flow_tolerance: float = 1e-3
    max_sweeps: int = 500
    unknown_work: float = 0.02


NUMERICS = Numerics()
"""What every scene uses."""
