"""Settings of the pad."""

from typing import Annotated, Literal

from pydantic import Field, field_validator

from mesoscale.settings.base import Settings
from mesoscale.settings.inputs import WorkAndRangeSettings

Length = Annotated[float, Field(gt=0, le=1e6)]

Scatter = Annotated[float, Field(ge=0, le=2)]

PILOTS = 16
"""Most cells of a pad that are closed side by side, to find the range of separations."""
POINTS_PER_JOB = {"asperity": 16, "coupled": 16, "adhesive": 2}
"""Points of the joint distribution per job and file, by mechanics."""


class PadSettings(Settings):
    """Pads of many cells that share one separation (docs/pad.md)."""

    cells: int = Field(default=64, ge=2, le=100_000, description="cells of the pad at central inputs")
    points: int = Field(
        default=128,
        ge=0,
        le=100_000,
        description="points of the joint distribution of inputs, D0 and devices, each with a pad and a switch of its "
        "own: the interval of the release; 0: none",
    )
    point_cells: int = Field(
        default=12,
        ge=2,
        le=10_000,
        description="cells of each of these pads; a point that they leave undecided has four times as many",
    )
    rms_scatter: tuple[Scatter, Scatter] | None = Field(
        default=None,
        description="range of the standard deviation of ln RMS between places of a film, of which a pad holds all; "
        "`inputs.rms` is then that of the median place. null: by topography where RMS comes from there, else none",
    )

    @field_validator("rms_scatter")
    @classmethod
    def _a_range(cls, given: tuple[float, float] | None) -> tuple[float, float] | None:
        if given and given[0] > given[1]:
            raise ValueError(f"[{given[0]:g}, {given[1]:g}]: the first must not exceed the second")
        return given


class AdhesionSettings(Settings):
    """Energy and pull-off of pads against roughness, load and attraction (docs/adhesion.md); off by default."""

    pads: int = Field(
        default=0, ge=0, le=1000, description="pads of each case, whose scatter is the band; 0: the stage is not run"
    )
    cells: int = Field(default=4, ge=2, le=10_000, description="cells of a pad, each with a surface of its own")
    mechanics: tuple[Literal["asperity", "coupled", "adhesive"], ...] = Field(
        default=("asperity", "coupled"), min_length=1, description="mechanics that are compared"
    )
    loads_MPa: tuple[Annotated[float, Field(gt=0, le=1e6)], ...] = Field(
        default=(0.05, 0.5, 2.0, 7.0),
        min_length=1,
        description="largest mean pressures from which a pad is opened",
        json_schema_extra={"unit": "MPa"},
    )
    rms_nm: tuple[Length, ...] = Field(
        default=(), description="RMS heights beside that of the inputs", json_schema_extra={"unit": "nm"}
    )
    gap_cutoffs_nm: tuple[Annotated[float, Field(gt=0, le=10)], ...] = Field(
        default=(), description="D0 beside that of the contact", json_schema_extra={"unit": "nm"}
    )
    retardations_nm: tuple[Annotated[float, Field(ge=1, le=1e6)], ...] = Field(
        default=(),
        description="wavelengths of retardation beside that of the contact",
        json_schema_extra={"unit": "nm"},
    )
    works: tuple[WorkAndRangeSettings, ...] = Field(
        default=(), description="attractions by work and range beside that of the inputs"
    )
    sphere_radius_um: float = Field(
        default=250.0,
        gt=0,
        le=1e6,
        description="radius of the sphere whose pull-off is computed by Derjaguin's integral",
        json_schema_extra={"unit": "um"},
    )

    @property
    def case_count(self) -> int:
        """Cases of all mechanics: the central one, and one for each value beside it."""
        beside = len(self.rms_nm) + len(self.gap_cutoffs_nm) + len(self.retardations_nm) + len(self.works)
        return len(self.mechanics) * (1 + beside)
