"""Settings of ohmic contacts."""

from typing import Annotated

from pydantic import Field, model_validator

from mesoscale.settings.base import Settings

Resistivity = Annotated[float, Field(gt=0, le=1e18)]


class ResistanceSettings(Settings):
    """Electrical resistance of metal on metal (docs/resistance.md); off by default."""

    resistivities_nOhm_m: tuple[Resistivity, Resistivity] | None = Field(
        default=None,
        description="resistivities of the two bodies, such as [22, 22] for gold; null: the stage is not run",
        json_schema_extra={"unit": "nOhm m"},
    )
    film_Ohm_um2: float = Field(
        default=0.0,
        ge=0,
        le=1e12,
        description="resistance of a thin film on the contact times its area, in series",
        json_schema_extra={"unit": "Ohm um^2"},
    )
    runs: int = Field(default=64, ge=8, le=100000, description="surfaces, each with its own draw of the inputs")

    @model_validator(mode="after")
    def _a_film_needs_metals(self) -> "ResistanceSettings":
        if self.film_Ohm_um2 > 0 and self.resistivities_nOhm_m is None:
            raise ValueError(
                f"film_Ohm_um2 = {self.film_Ohm_um2:g} without resistivities_nOhm_m: give those of the two bodies, "
                "or film_Ohm_um2: 0"
            )
        return self
