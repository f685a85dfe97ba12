"""Settings of the propagation of uncertainty."""

from typing import Literal

from pydantic import Field

from mesoscale.settings.base import Settings

RESAMPLES = 200
"""Resamplings for the intervals of what direct runs say."""


class UncertaintySettings(Settings):
    """Propagation of uncertainty and sensitivity (docs/uncertainty.md)."""

    surrogate: Literal["level1", "level2"] = Field(
        default="level1",
        description="design of the surrogate: level1 is the paper's (2n+1 nodes, linear); level2 is the next "
        "Smolyak level with quadratic and interaction terms (113 nodes for seven inputs)",
    )
    response: Literal["linear", "polynomial", "regression"] = Field(
        default="regression",
        description="response behind samples, Sobol' indices and surrogate.json: the paper's linear one; the "
        "polynomial through all nodes; or sparse polynomial chaos fitted to the direct runs. The last two "
        "take C_a, C_r and rho_r in logarithm, so that they stay positive. Table 2 always has the linear one",
    )
    opening_contact: Literal["below_closing", "free"] = Field(
        default="below_closing",
        description="response of d_c on opening: closing's less a positive drop, so that no opening starts above its "
        "closing anywhere in the range of the inputs; or one of its own, as the paper has it. A linear one is its own",
    )
    seeds: int = Field(default=8, ge=1, le=10000, description="surfaces per node, the same ones at every node")
    samples: int = Field(default=10000, ge=10, le=10**7, description="samples of the inputs sent through the response")
    direct_runs: int = Field(
        default=800,
        ge=0,
        le=10**6,
        description="independent cycles, each with its own inputs and surface: they train the regression "
        "and validate all responses",
    )
    model_form_pairs: int = Field(
        default=100,
        ge=10,
        le=10**6,
        description="direct runs computed with both mechanics of the contact (target `model_form`)",
    )
