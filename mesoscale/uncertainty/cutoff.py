"""What the short-wave cut-off and the grid do to the outputs of a scene, on the same surfaces.

A surface of a seed has the same waves on every grid that resolves its cut-off, so its outputs differ by the grid alone.
"""

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from mesoscale.contact import ContactInputs, run_cycle
from mesoscale.settings import ContactSettings, LawSettings
from mesoscale.uncertainty.model_form import QUANTITIES, quantities

NAMES = tuple(quantity.name for quantity in QUANTITIES)
CUTOFFS = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Of a scene's own."""
GRIDS = (0.25, 0.5, 1.0, 2.0)
"""Sites a side, of a scene's own."""


def scene_rows(
    inputs: ContactInputs,
    contact: ContactSettings,
    law: LawSettings,
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[dict[str, Any]]:
    """Rows of uq/cutoff.csv: means over `contact.study_seeds` surfaces for other cut-offs and other grids.

    Without a cut-off of its own a scene has the Nyquist limit of its grid. Cut-offs that a grid does not resolve, and
    grids that do not resolve the cut-off, are left out.
    """
    cutoff = contact.q1_per_nm or contact.nyquist_per_nm
    cases = [(factor * cutoff, contact.pixels) for factor in CUTOFFS] + [
        (cutoff, int(factor * contact.pixels)) for factor in GRIDS
    ]
    for done, (q1, pixels) in enumerate(sorted(set(cases))):
        settings = contact.model_copy(update={"q1_per_nm": q1, "pixels": pixels})
        if pixels < 32 or q1 > settings.nyquist_per_nm * (1 + 1e-9):
            continue
        start = time.process_time()
        cycles = [run_cycle(inputs, settings, seed) for seed in range(1, contact.study_seeds + 1)]
        spent = (time.process_time() - start) / len(cycles)
        means = np.nanmean([quantities(cycle, law) for cycle in cycles], axis=0)
        row = {name: value if np.isfinite(value) else "" for name, value in zip(NAMES, means.tolist(), strict=True)}
        settled = sum(cycle.converged for cycle in cycles)
        yield {"q1_per_nm": q1, "pixels": pixels, "cycles": len(cycles), "converged": settled, **row, "cpu_s": spent}
        if progress is not None:
            progress((done + 1) / len(cases), f"cut-off {q1:.3g} 1/nm, {pixels} pixels")
