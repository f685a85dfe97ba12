"""How runs are cut into jobs.  Imports nothing heavy: the workflow reads it to plan."""

from mesoscale.settings import UncertaintySettings

CHUNK_RUNS = 200
"""Contact cycles per job and file: jobs of some seconds to minutes, of which an interruption loses
one.
"""
MOST_REPEATED = 100
"""Direct runs that are repeated on a second surface: they tell scatter between surfaces from what
inputs explain.
"""


def collocation_run_count(inputs: int, settings: UncertaintySettings) -> int:
    """Number of contact cycles of the collocation: 2n + 1 nodes on each surface."""
    return (2 * inputs + 1) * settings.seeds


def chunk_bounds(runs: int, chunk_runs: int = CHUNK_RUNS) -> dict[str, tuple[int, int]]:
    """First and last+1 run of every chunk, by its three-digit name."""
    starts = range(0, runs, chunk_runs)
    return {f"{k:03d}": (start, min(start + chunk_runs, runs)) for k, start in enumerate(starts)}


def full_chunks(runs: int) -> dict[str, tuple[int, int]]:
    """Chunks of runs, the last of several filled up, so that more runs leave each as it is."""
    if runs > CHUNK_RUNS:
        runs = -(-runs // CHUNK_RUNS) * CHUNK_RUNS
    return chunk_bounds(runs)
