"""Settings of the propagation of uncertainty."""

from typing import Literal

from asperity.guards.settings import Settings, key

RESAMPLES = 200
"""Resamplings for the intervals of what direct runs say."""


class UncertaintySettings(Settings):
    """Propagation of uncertainty and sensitivity (docs/uncertainty.md)."""

    opening_contact: Literal["below_closing", "free"] = key(
        "below_closing",
        "response of d_c on opening: closing's less a positive drop, so that no opening starts"
        " above its closing anywhere in the range of the inputs; or one of its own, as the paper"
        " has it",
    )
    seeds: int = key(8, "surfaces at the 2n + 1 nodes of the paper's method", "[1, 10_000]")
    direct_runs: int = key(
        800,
        "independent cycles, each with its own inputs and surface: the regressions behind samples,"
        " Sobol' indices and surrogate.json are fitted to them, and validated by them",
        "[0, 1_000_000]",
    )
