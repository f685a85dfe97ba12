"""Settings of ohmic contacts."""

from typing import Annotated

from pydantic import Field, model_validator

from asperity.guards.settings import Settings, key

Resistivity = Annotated[float, Field(ge=1e-3, le=1e18)]
FreePath = Annotated[float, Field(ge=0, le=1e6)]


class ResistanceSettings(Settings):
    """Electrical resistance of metal on metal (docs/resistance.md); off by default."""

    resistivities_nOhm_m: tuple[Resistivity, Resistivity] | None = key(
        None, "resistivities of the two bodies, such as [22, 22] for gold; null: the stage is not run", "nOhm m"
    )
    mean_free_paths_nm: tuple[FreePath, FreePath] | None = key(
        None,
        "mean free paths of the electrons in the two bodies, to be given with resistivities; 37.7 in gold at 20 C "
        "(Gall, J. Appl. Phys. 119 (2016) 085101); 0 leaves Sharvin's resistance out",
        "nm",
    )
    film_Ohm_um2: float = key(0.0, "resistance of a film on the contact times its area", "[0, 1e12] Ohm um^2")
    runs: int = key(64, "surfaces, each with its own draw of the inputs", "[8, 100_000]")

    @model_validator(mode="after")
    def _what_goes_together(self) -> "ResistanceSettings":
        if (self.resistivities_nOhm_m is None) != (self.mean_free_paths_nm is None):
            raise ValueError(
                "resistivities_nOhm_m and mean_free_paths_nm go together: give both, such as [22, 22] and [38, 38] for "
                "gold, or neither"
            )
        if self.film_Ohm_um2 > 0 and self.resistivities_nOhm_m is None:
            raise ValueError(
                f"film_Ohm_um2 = {self.film_Ohm_um2:g} without resistivities_nOhm_m: give those of the two bodies, "
                "or film_Ohm_um2: 0"
            )
        return self
