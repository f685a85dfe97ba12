"""Curves of a known closed form, for tests of what is fitted to curves."""

import numpy as np

from mesoscale.pad.compact import CompactPad
from mesoscale.pad.memory import PadLaw


def tabulated(compact: CompactPad, law: PadLaw) -> PadLaw:
    """The closed form at the separations and depths of a pad's curves, for what is driven by such curves."""
    s = law.separation_nm
    opening = np.full(law.opening.shape, np.nan)
    for k, depth in enumerate(law.depth_nm):
        above = s >= depth - 1e-9
        opening[k][:, above] = compact.opening_GPa(s[above], depth)
    return PadLaw(s, np.stack(compact.closing_GPa(s)), law.depth_nm, opening, compact.flats)
