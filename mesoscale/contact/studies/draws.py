"""Random draws from Table 1, each closed and opened on three surfaces and judged by physical invariants."""

import time
from collections.abc import Callable, Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from mesoscale.contact.cycle import run_cycle
from mesoscale.contact.studies.stability import violations
from mesoscale.contact.surface import random_surface
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.settings.contact import DRAWS_PER_CHUNK

SEEDS = (1, 2, 3)
# The ranges of Table 1; `inputs.definitions` has those alone of inputs that no stage computes
RANGES = {
    "hamaker": (0.18, 0.25),
    "e_star": (80.0, 102.0),  # uniform over the central 99.6 % of Table 1's normal(91, 3.8): tails are drawn as often
    "h_macro": (0.7, 3.2),
    "h_prime": (1.95, 14.8),
    "q0": (0.015, 0.035),
    "hurst": (0.5, 1.0),
    "rms": (2.0, 15.0),
}
COLUMNS = (
    "draw",
    *RANGES,
    "seed",
    "pixels",
    "passed",
    "broken",
    "steps",
    "most_sweeps",
    "sweeps",
    "force_miss",
    "radius_bound_events",
    "repeated_steps",
    "wall_s",
)


def draw_inputs(number: int) -> ContactInputs:
    """Random inputs from Table 1 (uniform; E* over its central 99.6 %), the same for the same number."""
    random = np.random.default_rng(np.random.SeedSequence([20130805, number]))
    return ContactInputs(**{name: random.uniform(low, high) for name, (low, high) in RANGES.items()})


def draw_rows(
    chunk: int, settings: ContactSettings, progress: Callable[[float, str], None] | None = None
) -> Iterator[dict[str, Any]]:
    """One row per cycle of a chunk of draws; the grids alternate between an eighth and all of `settings.pixels`."""
    first = chunk * DRAWS_PER_CHUNK
    last = min(first + DRAWS_PER_CHUNK, settings.study_draws)
    grids = [max(settings.pixels // k, 32) for k in (8, 4, 2, 1)]
    for number in range(first, last):
        inputs = draw_inputs(number)
        chosen = settings.model_copy(update={"pixels": grids[number % 4]})
        for seed in SEEDS:
            start = time.perf_counter()
            heights = random_surface(inputs, chosen, seed)
            cycle = run_cycle(inputs, chosen, seed, heights=heights, keep_surface=True)
            broken = violations(cycle, inputs, chosen, heights)
            if not cycle.flags["force_reached"]:
                broken.append("force not reached")
            yield {
                "draw": number,
                **{name: round(value, 6) for name, value in asdict(inputs).items()},
                "seed": seed,
                "pixels": chosen.pixels,
                "passed": not broken,
                "broken": "; ".join(broken),
                "steps": int((cycle.closing.repulsive_nN > 0).sum()),
                "most_sweeps": int(cycle.closing.sweeps.max()),
                "sweeps": int(cycle.closing.sweeps.sum()),
                "force_miss": f"{cycle.flags['force_miss']:.1e}",
                "radius_bound_events": cycle.flags["radius_bound_events"],
                "repeated_steps": cycle.flags["repeated_steps"],
                "wall_s": round(time.perf_counter() - start, 3),
            }
        if progress is not None:
            progress((number + 1 - first) / (last - first), f"draw {number}")
