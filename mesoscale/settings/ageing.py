"""Settings of what time does to a held switch beside charge."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from asperity.guards.settings import Settings, key

Positive = Annotated[float, Field(gt=0.0)]
Share = Annotated[float, Field(gt=0.0, le=1.0)]
Ends = tuple[Positive, Positive]
GUESSED = ("relaxing", "grain_nm", "tops", "bonds_mJ_m2")


class AgeingSettings(Settings):
    """Creep of beam and contact, and bonds, of a switch that is held (docs/lifetime.md); each off
    by default.

    A range is the least and the largest value of what is one unknown for all devices.
    """

    beam: Literal["gold", "nickel", "aluminium"] | None = key(
        None, "metal by whose law the held beam creeps; null: it does not"
    )
    relaxing: tuple[Share, Share] = key(
        (0.05, 0.2),
        "gold and aluminium: share of the stress of the hold that relaxes in the end; assumption",
    )
    grain_nm: Ends = key((20.0, 100.0), "nickel: size of its grains; assumption", "nm")
    tops: Ends | None = key(
        None,
        "c of the hardness 1/(1 + c ln(1 + t/s)) under which the tops of the contact creep"
        " (docs/history.md), 0.02 for instance; null: they do not",
    )
    bonds_mJ_m2: Ends | None = key(
        None,
        "work by which bonds of oxides grow for each ten times of time, of what touches, 3 to 100"
        " for instance; null: they do not",
        "mJ/m^2",
    )

    @model_validator(mode="after")
    def _rising(self) -> "AgeingSettings":
        for name in GUESSED:
            bounds = getattr(self, name)
            if bounds is not None and bounds[0] > bounds[1]:
                raise ValueError(
                    f"{name} = [{bounds[0]:g}, {bounds[1]:g}]: give the least value first"
                )
        if not (self.beam or self.tops or self.bonds_mJ_m2):
            raise ValueError("nothing ages: give beam, tops or bonds_mJ_m2, or leave ageing out")
        return self
