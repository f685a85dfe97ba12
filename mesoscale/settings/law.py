"""Settings of the fit of the force-separation law."""

from typing import ClassVar, Literal

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
    # alpha of eq. 12, which the paper does not give: as long as rho_a. It acts where the attraction is C_a's
    shield_nm: ClassVar[float] = 2.0
