"""Settings of ohmic contacts."""

from typing import Annotated

from pydantic import Field, model_validator

from asperity.keys import key
from mesoscale.settings.base import Settings

Resistivity = Annotated[float, Field(gt=0, le=1e18)]


class ResistanceSettings(Settings):
    """Electrical resistance of metal on metal (docs/resistance.md); off by default."""

    resistivities_nOhm_m: tuple[Resistivity, Resistivity] | None = key(
        None, "resistivities of the two bodies, such as [22, 22] for gold; null: the stage is not run", "nOhm m"
    )
    film_Ohm_um2: float = key(
        0.0, "resistance of a thin film on the contact times its area, in series", "[0, 1e12] Ohm um^2"
    )
    runs: int = key(64, "surfaces, each with its own draw of the inputs", "[8, 100_000]")

    @model_validator(mode="after")
    def _a_film_needs_metals(self) -> "ResistanceSettings":
        if self.film_Ohm_um2 > 0 and self.resistivities_nOhm_m is None:
            raise ValueError(
                f"film_Ohm_um2 = {self.film_Ohm_um2:g} without resistivities_nOhm_m: give those of the two bodies, "
                "or film_Ohm_um2: 0"
            )
        return self
