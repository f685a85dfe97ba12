"""What a pad of many square micrometres sees: both definitions of d_c as the sample's area grows.

First contact is an extreme value. Over n cells pressed together by a rigid plane it is the largest of n; if a
cell's own follows Gumbel's distribution, its mean grows as beta ln n. The separation at a share of the largest
force is no extreme value: the cells' forces add up at a common separation.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit  # Student's quantile, without the slow import of scipy.stats

from mesoscale.contact import Cycle, run_cycle
from mesoscale.inputs.contact import ContactInputs
from mesoscale.law.fit import contact_separation
from mesoscale.settings import ContactSettings, LawSettings

Array = NDArray[np.float64]

CELLS = 48
DIRECT = {2: 6, 4: 4}
"""Surfaces computed as a whole, by their side in cells."""
AREAS = (1, 4, 16, 64, 256, 1024, 10000)
FIRST_SEED = 2_000_000
OVERLOAD = 4.0
"""Cells are closed beyond the mean force, because those that touch early carry more than it."""
EULER = 0.5772156649
GROUPS = 200

COLUMNS = (
    "quantity", "area_in_cells", "method", "mean_nm", "low_nm", "high_nm", "one_sd_nm", "samples", "difference_nm"
)  # fmt: skip


def extreme_rows(
    inputs: ContactInputs,
    contact: ContactSettings,
    law: LawSettings,
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[dict[str, Any]]:
    """Rows of uq/extremes.csv: first contact and the separation at `law.force_fraction` on closing, by area and method.

    `cells`: n of the independent cells pressed together; `gumbel`: the law fitted to single cells; `direct`: one
    surface of that area with the same spectrum, pixels and pressure. Intervals are 90 %, of the mean.
    `difference_nm` is that of `direct` from `cells`.
    """
    law = law.model_copy(update={"contact_definition": "force_fraction"})
    total = CELLS + sum(side**2 * count for side, count in DIRECT.items())
    cycles = []
    for k in range(CELLS):
        cycles.append(run_cycle(inputs, contact, FIRST_SEED + k, OVERLOAD * contact.max_force_nN))
        if progress:
            progress((k + 1) / total, "single cells")
    rng = np.random.default_rng(np.random.SeedSequence([FIRST_SEED]))
    touches = np.array([cycle.first_contact_nm for cycle in cycles])
    fits = [_gumbel(rng.choice(touches, CELLS)) for _ in range(GROUPS)]
    position, width = _gumbel(touches)
    by_cells: dict[tuple[str, int], float] = {}
    for n in AREAS:
        growth = np.log(n) + EULER
        spread = np.quantile([a + b * growth for a, b in fits], [0.05, 0.95])
        yield _row("first contact", n, "gumbel", position + width * growth, spread, width * np.pi / np.sqrt(6), CELLS)
        if n > CELLS // 3:
            continue
        picks = [rng.choice(CELLS, n, replace=False) for _ in range(GROUPS)]
        for quantity, values in (
            ("first contact", np.array([touches[chosen].max() for chosen in picks])),
            ("share of force", np.array([_pressed([cycles[k] for k in chosen], contact, law) for chosen in picks])),
        ):
            # groups share cells: what is independent is CELLS / n of them
            error = stdtrit(CELLS / n - 1, 0.95) * values.std(ddof=1) / np.sqrt(CELLS / n)
            by_cells[quantity, n] = values.mean()
            ends = values.mean() + np.array([-error, error])
            yield _row(quantity, n, "cells", values.mean(), ends, values.std(ddof=1), CELLS)
    done = CELLS
    for side, count in DIRECT.items():
        n = side**2
        whole = contact.model_copy(
            update={"length_nm": side * contact.length_nm, "pixels": side * contact.pixels}
            | {"max_force_nN": n * contact.max_force_nN}
        )
        touching, loaded = [], []
        for k in range(count):
            cycle = run_cycle(inputs, whole, FIRST_SEED + CELLS + k)
            touching.append(cycle.first_contact_nm)
            loaded.append(contact_separation(cycle.closing.separation_nm, cycle.closing.repulsive_nN, law))
            done += n
            if progress:
                progress(done / total, f"surface of {side} x {side} cells")
        for quantity, values in (("first contact", np.array(touching)), ("share of force", np.array(loaded))):
            error = stdtrit(count - 1, 0.95) * values.std(ddof=1) / np.sqrt(count)
            ends = values.mean() + np.array([-error, error])
            row = _row(quantity, n, "direct", values.mean(), ends, values.std(ddof=1), count)
            yield {**row, "difference_nm": values.mean() - by_cells[quantity, n]}


def _row(quantity: str, n: int, method: str, mean: float, ends: Array, scatter: float, samples: int) -> dict[str, Any]:
    return dict(zip(COLUMNS, (quantity, n, method, mean, *ends, scatter, samples), strict=False))


def _gumbel(values: Array) -> tuple[float, float]:
    """Position and width of Gumbel's distribution by moments."""
    width = values.std(ddof=1) * np.sqrt(6) / np.pi
    return float(values.mean() - EULER * width), float(width)


def _pressed(cycles: Sequence[Cycle], contact: ContactSettings, law: LawSettings) -> float:
    """Separation at a share of the force of cells under one rigid plane, closed to the mean force of `contact`."""
    highest = max(float(cycle.closing.separation_nm.max()) for cycle in cycles)
    lowest = max(float(cycle.closing.separation_nm.min()) for cycle in cycles)
    h = np.linspace(highest, lowest, 2000)
    force = np.zeros_like(h)
    for cycle in cycles:
        force += np.interp(h, cycle.closing.separation_nm[::-1], cycle.closing.repulsive_nN[::-1])
    reached = force <= len(cycles) * contact.max_force_nN
    return contact_separation(h[reached], force[reached], law)
