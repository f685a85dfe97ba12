"""Settings of the comparison with an elastic half-space."""

from typing import Annotated

from pydantic import Field

from mesoscale.settings.base import Settings


class CouplingSettings(Settings):
    """Error of neglecting the elastic coupling of asperities (docs/coupling.md); off by default.

    Needs the optional extra `peers`.
    """

    surfaces: int = Field(
        default=0,
        ge=0,
        le=1000,
        description="surfaces that are compared; 0: the stage is not run",
    )
    pixels: int = Field(default=512, ge=32, le=4096, description="grid points per side of both models")
    loads_nN: list[Annotated[float, Field(gt=0, le=1e12)]] = Field(
        default=[100.0, 1000.0, 7000.0, 50000.0],
        min_length=1,
        description="loads at which both models are solved",
        json_schema_extra={"unit": "nN"},
    )
    tolerance: float = Field(
        default=1e-8,
        gt=0,
        le=1e-2,
        description="relative error at which the boundary-element solution stops",
    )
    max_iterations: int = Field(
        default=5000,
        ge=1,
        le=1000000,
        description="bound on its iterations; reaching it is reported",
    )
