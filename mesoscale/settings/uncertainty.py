"""Settings of the propagation of uncertainty."""

from typing import Literal

from pydantic import Field

from mesoscale.settings.base import Settings


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
    chaos_degree: int = Field(default=3, ge=1, le=6, description="highest total degree of the regression")
    seeds: int = Field(default=8, ge=1, le=10000, description="surfaces per node, the same ones at every node")
    first_seed: int = Field(default=0, ge=0, le=2**31, description="seed of the first surface")
    central_share: float = Field(
        default=0.999,
        gt=0.5,
        lt=1,
        description="central share of an unbounded distribution that the nodes span",
    )
    chunk_runs: int = Field(default=100, ge=1, le=100000, description="contact cycles per job and file")
    samples: int = Field(default=10000, ge=10, le=10**7, description="samples of the inputs sent through the response")
    sample_seed: int = Field(default=1, ge=0, le=2**31, description="seed of those samples")
    sobol_samples: int = Field(
        default=2048, ge=64, le=10**6, description="size of each of the n + 2 samples behind the Sobol' indices"
    )
    audit_seeds: int = Field(
        default=20, ge=1, le=1000, description="surfaces per reading of the reproduction audit (target `audit`)"
    )
    audit_readings: tuple[str, ...] = Field(
        default=(),
        description="readings of the contact model to audit, named as in audit/ranking.csv; [all]: all of them; "
        "[mended]: the nearest with the contact model's mended readings; empty: those of the mean curvature",
    )
    sobol_bootstrap: int = Field(
        default=40, ge=0, le=10000, description="resamplings for the intervals of Sobol' indices"
    )
    bootstrap: int = Field(default=200, ge=20, le=100000, description="resamplings for intervals")
    direct_runs: int = Field(
        default=800,
        ge=0,
        le=10**6,
        description="independent cycles, each with its own inputs and surface: they train the regression "
        "and validate all responses",
    )
    morris_trajectories: int = Field(
        default=24,
        ge=2,
        le=10000,
        description="trajectories of Morris' elementary effects, through the response and, in the study, the engine",
    )
    study_runs: int = Field(
        default=1600,
        ge=100,
        le=10**6,
        description="direct runs that are the truth of the study of responses (target `work_precision`)",
    )
    study_replicates: int = Field(
        default=150,
        ge=10,
        le=10**6,
        description="direct runs repeated on another surface each: the surface's share of the variance",
    )
    model_form_pairs: int = Field(
        default=100,
        ge=10,
        le=10**6,
        description="direct runs computed with both mechanics of the contact (target `model_form`)",
    )
