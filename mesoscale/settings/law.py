"""Settings of the fit of the force-separation law."""

from typing import Literal

from pydantic import Field

from mesoscale.settings.base import Settings


class LawSettings(Settings):
    """Fit of the compact force-separation law (docs/law.md)."""

    contact_definition: Literal["first_contact", "force_fraction", "free_fit"] = Field(
        default="first_contact",
        description="what d_c is: where the first (on opening the last) asperity touches; where the "
        "repulsion reaches `force_fraction` of its maximum; or fitted to attraction and repulsion together",
    )
    force_fraction: float = Field(
        default=0.03,
        gt=0,
        lt=0.5,
        description="share of the largest repulsion that counts as contact",
    )
    rho_a_nm: float = Field(
        default=2.0,
        ge=0,
        le=100,
        description="attraction length rho_a (the paper fixes 2 nm)",
        json_schema_extra={"unit": "nm"},
    )
    shield_nm: float = Field(
        default=2.0, gt=0, le=1000, description="shielding distance alpha of eq. 12", json_schema_extra={"unit": "nm"}
    )
    weights: Literal["uniform", "relative"] = Field(
        default="uniform", description="misfit of the repulsion: absolute, or relative above `relative_floor`"
    )
    relative_floor: float = Field(
        default=0.01,
        gt=0,
        le=1,
        description="floor of relative weights, share of the largest repulsion",
    )
    points: int = Field(
        default=200, ge=20, le=10000, description="even points in separation that a branch is resampled to"
    )
    min_points: int = Field(default=4, ge=3, le=1000, description="fewest points of the curve in contact for a fit")
    min_depth_ratio: float = Field(
        default=0.2,
        gt=0,
        lt=1,
        description="smallest (window / rho_r) that counts as identified",
    )
    max_depth_ratio: float = Field(
        default=200.0,
        gt=1,
        le=600,
        description="largest (window / rho_r) that counts as identified",
    )
    max_relative_error: float = Field(
        default=1.0,
        gt=0,
        le=100,
        description="largest relative error of C_r and rho_r that counts as identified",
    )
    max_residual: float = Field(
        default=0.15,
        gt=0,
        le=1,
        description="misfit above which a fit is marked poor, share of the largest repulsion",
    )
