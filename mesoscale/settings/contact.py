"""Settings of the contact model."""

import math
from typing import Annotated, Literal

from pydantic import Field

from mesoscale.settings.base import Settings
from mesoscale.settings.surface import SurfaceSettings

DRAWS_PER_CHUNK = 50


class ContactSettings(Settings):
    """Mesoscale contact model (docs/contact.md)."""

    mechanics: Literal["asperity", "coupled"] = Field(
        default="asperity",
        description="how asperities carry load: each on its own by eq. 3, or all on one elastic half-space",
    )
    model: Literal["elastic", "nonlinear", "plastic"] = Field(
        default="plastic",
        description="asperities: eq. 3 alone; eq. 4 as a cap of the force; eq. 4 with plastic flow of the surface",
    )
    pixels: int = Field(default=1024, ge=32, le=16384, description="grid points per side")
    length_nm: float = Field(
        default=1000.0,
        ge=1,
        le=1e6,
        description="side of the square, periodic cell",
        json_schema_extra={"unit": "nm"},
    )
    max_force_nN: float = Field(
        default=7000.0,
        gt=0,
        le=1e12,
        description="repulsive force at which closing turns into opening",
        json_schema_extra={"unit": "nN"},
    )
    convention: Literal["profile", "areal"] = Field(
        default="areal",
        description="slope of the two-dimensional PSD: -(2H+1), as the paper prints it, or -(2H+2), an isotropic "
        "surface's",
    )
    q1_per_nm: float | None = Field(
        default=None,
        gt=0,
        description="short-wave cut-off of the spectrum; null: the grid's Nyquist limit",
        json_schema_extra={"unit": "1/nm"},
    )
    surface: SurfaceSettings = SurfaceSettings()
    gap_cutoff_nm: float = Field(
        default=0.165,
        gt=0,
        le=10,
        description="D0 of eq. 1: smaller gaps attract as if they were D0",
        json_schema_extra={"unit": "nm"},
    )
    retardation_nm: float | None = Field(
        default=None,
        ge=1,
        le=1e6,
        description="wavelength of Gregory's retardation of the attraction, about 100 nm for most solids; null: none",
        json_schema_extra={"unit": "nm"},
    )
    touching_attracts: bool = Field(
        default=False,
        description="whether sites in contact attract (with the gap D0) or are left out of eq. 1",
    )
    prefactor: Literal["paper", "hertz"] = Field(
        default="hertz", description="p of eq. 3: 2/3 as printed, or Hertz's 4/3"
    )
    radius: Literal["curvature", "truncation"] = Field(
        default="curvature",
        description="asperity radius: mean curvature of the sites (eq. 2), or R = A/(2 pi delta)",
    )
    unloading_radius: Literal["curvature", "flattened"] = Field(
        default="curvature",
        description="radius of an asperity that has yielded: as `radius` says, or at least A/(pi delta), that of "
        "Hertz's contact of its area, which unloads more stiffly",
    )
    merge: Literal["as_one", "not_less"] = Field(
        default="as_one",
        description="asperities that merge: one with the radius of all sites, or one that carries at least what they "
        "carried (with flow: up to its hardness)",
    )
    area: Literal["sites", "hertz"] = Field(
        default="sites",
        description="asperity area in eq. 4: its contacting sites, or Hertz's pi R delta",
    )
    neighbours: Literal[4, 8] = Field(
        default=8,
        description="neighbours through which contacting sites are connected",
    )
    flow: Literal["increment", "return"] = Field(
        default="return",
        description="plastic flow: fixed increments, or the amplitude that returns the asperity to its yield surface",
    )
    flow_pair: Literal["paper", "wide"] = Field(
        default="wide",
        description="second Gaussian: 3 times the radius of curvature (s2 = 3^(1/4) s1), or 3 times the width",
    )
    flow_volume: Literal["dropped", "piled_up"] = Field(
        default="dropped",
        description="coupled: what flows is left out of the surface, or fills the gap around its own cluster "
        "(asperities keep it by `flow_pair`)",
    )
    flow_increment_nm: float = Field(
        default=0.3,
        gt=0,
        le=10,
        description="amplitude of one increment (flow: increment)",
        json_schema_extra={"unit": "nm"},
    )
    flow_width_nm: float = Field(
        default=0.3,
        gt=0,
        le=10,
        description="a1 in the width s1 = sqrt(a1 R) of the first Gaussian",
        json_schema_extra={"unit": "nm"},
    )
    flow_floor_pixels: float = Field(
        default=1.0,
        ge=0,
        le=10,
        description="smallest s1, so that the grid resolves the flow; 0: none",
        json_schema_extra={"unit": "pixel"},
    )
    flow_tolerance: float = Field(
        default=1e-3,
        ge=1e-9,
        le=0.1,
        description="an asperity yields above its hardness times 1 + this (flow: return)",
    )
    max_sweeps: int = Field(
        default=500,
        ge=1,
        le=100000,
        description="bound on the flow sweeps of one separation; reaching it raises a flag",
    )
    force_steps: int = Field(
        default=40,
        ge=4,
        le=10000,
        description="force steps from contact to the largest force; separations follow from them",
    )
    gap_bins: int = Field(
        default=4096,
        ge=16,
        le=1048576,
        description="bins of the gap histogram behind the far part of the attraction",
    )
    nominal_seed: int = Field(
        default=1,
        ge=0,
        description="surface seed of the nominal curves (figures 4 and 11)",
    )
    nominal_force_nN: float = Field(
        default=1e4,
        gt=0,
        le=1e12,
        description="largest force of the model comparison (figure 4)",
        json_schema_extra={"unit": "nN"},
    )
    nominal_loads_nN: list[Annotated[float, Field(gt=0, le=1e12)]] = Field(
        default=[1e3, 3e3, 7e3, 1e4, 2e4, 5e4],
        min_length=1,
        description="largest forces of the load series (figure 11)",
        json_schema_extra={"unit": "nN"},
    )
    study_seeds: int = Field(
        default=3,
        ge=1,
        le=1000,
        description="surfaces per case of the accuracy study",
    )
    study_draws: int = Field(
        default=60,
        ge=0,
        le=100000,
        description="random draws from Table 1 of the stability study, on three surfaces each",
    )

    @property
    def nyquist_per_nm(self) -> float:
        """Largest wave vector that the grid resolves, 1/nm."""
        return math.pi * self.pixels / self.length_nm

    @property
    def draw_chunks(self) -> int:
        """Jobs that the random draws of the stability study are spread over."""
        return -(-self.study_draws // DRAWS_PER_CHUNK)
