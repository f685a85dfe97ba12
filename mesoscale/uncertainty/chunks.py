"""How runs are cut into jobs.  Imports nothing heavy: the workflow reads it to plan."""

from collections.abc import Sequence
from itertools import product

from mesoscale.settings import UncertaintySettings

CHOICES: dict[str, tuple[str, ...]] = {
    "convention": ("profile", "areal"),
    "flow_pair": ("paper", "wide"),
    "prefactor": ("paper", "hertz"),
    "radius": ("curvature", "truncation"),
    "area": ("sites", "hertz"),
    "touching_attracts": ("true", "false"),
}
"""Ambiguities of the contact model, as keys of ContactSettings with the values tried."""


def collocation_level(settings: UncertaintySettings) -> int:
    """Level of the sparse grid."""
    return 2 if settings.surrogate == "level2" else 1


def node_count(inputs: int, level: int) -> int:
    """Number of nodes of the sparse grid: 2n + 1 at level 1, 2n² + 2n + 1 at level 2."""
    return 2 * inputs + 1 if level == 1 else 2 * inputs**2 + 2 * inputs + 1


def collocation_run_count(inputs: int, settings: UncertaintySettings) -> int:
    """Number of contact cycles of the collocation."""
    return node_count(inputs, collocation_level(settings)) * settings.seeds


def chunk_bounds(runs: int, chunk_runs: int) -> dict[str, tuple[int, int]]:
    """First and last+1 run of every chunk, by its three-digit name."""
    starts = range(0, runs, chunk_runs)
    return {f"{k:03d}": (start, min(start + chunk_runs, runs)) for k, start in enumerate(starts)}


def full_chunks(runs: int, chunk_runs: int) -> dict[str, tuple[int, int]]:
    """As `chunk_bounds`, the last chunk filled up, so that more runs leave every chunk as it is."""
    return chunk_bounds(-(-runs // chunk_runs) * chunk_runs, chunk_runs)


def contact_readings() -> list[str]:
    """Names of all readings of the contact model that can be computed, values joined by dots.

    Hertz's area with the mean curvature is left out: the mean curvature of a flattened asperity says nothing
    about its area, no asperity ever stops yielding and cycles do not converge.
    """
    named = (".".join(values) for values in product(*CHOICES.values()))
    return [name for name in named if ".curvature.hertz." not in name]


def audited_readings(names: Sequence[str]) -> list[str]:
    """The readings to audit: those named, or `all`; by default those of the mean curvature.

    R = A/(2 pi delta) with Hertz's area takes several times as long; config/studies/all_readings.yaml has all.
    """
    if list(names) == ["all"]:
        return contact_readings()
    return list(names) or [name for name in contact_readings() if ".curvature." in name]
