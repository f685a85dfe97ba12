"""Settings of the pad."""

from typing import Annotated

from pydantic import Field, field_validator

from asperity.guards.settings import Settings, key

RmsScatter = Annotated[float, Field(ge=0, le=2)]

PILOTS = 16
"""Most cells of a pad that are closed side by side, to find the range of separations."""
MORE_CELLS = 4
"""Times as many cells has a point that is undecided."""
POINTS_PER_JOB = {"asperity": 16, "coupled": 16, "adhesive": 2}
"""Points of the joint distribution per job and file, by mechanics."""


class PadSettings(Settings):
    """Pads of many cells that share one separation (docs/pad.md)."""

    cells: int = key(64, "cells of the pad at central inputs", "[2, 100_000]")
    points: int = key(
        128,
        "points of the joint distribution, each with a pad and a switch; 0: no interval",
        "[0, 100_000]",
    )
    point_cells: int = key(
        12, "cells of a point's pad; undecided: four times as many", "[2, 10_000]"
    )
    rms_scatter: tuple[RmsScatter, RmsScatter] | None = key(
        None,
        "range of the standard deviation of ln RMS between places of a film, of which a pad holds"
        " all; `inputs.rms` is then that of the median place. null: by topography where RMS comes"
        " from there, else none",
    )

    @field_validator("rms_scatter")
    @classmethod
    def _a_range(cls, stated: tuple[float, float] | None) -> tuple[float, float] | None:
        if stated and stated[0] > stated[1]:
            raise ValueError(
                f"[{stated[0]:g}, {stated[1]:g}]: the first must not exceed the second"
            )
        return stated
