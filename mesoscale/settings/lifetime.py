"""Settings of the life of a switch that is held."""

from typing import Annotated, Any, Literal

from pydantic import (
    Field,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from asperity.guards.settings import Settings, key
from mesoscale.settings.ageing import AgeingSettings

Positive = Annotated[float, Field(gt=0.0)]
Range = tuple[Positive, Positive]
Exponent = Annotated[float, Field(ge=0.0, le=5.0)]
Energy = Annotated[float, Field(ge=0.0, le=5.0)]
RANGES = ("injection_A_m2", "barrier_eV", "traps_e_cm2", "recovery_exponent", "activation_eV")


class LifetimeSettings(Settings):
    """Charge that enters the dielectric while the switch is held (docs/lifetime.md); off by
    default.

    A range is the least and the largest value of what is one unknown for all devices.
    """

    years: float | None = key(
        None, "life that is asked for; null: the stage is not run", "(0, 1000] years"
    )
    injection_A_m2: Range = key(
        (1e-12, 4e-5),
        "current that stays in the dielectric where it touches, at 1 MV/cm; largest: the whole"
        " leakage of a film (Persano et al., J. Appl. Phys. 107 (2010) 114502), least: assumption",
        "A/m^2",
    )
    barrier_eV: Range = key(
        (4.33, 5.15),
        "barrier of emission through gaps; titanium to nickel (Michaelson, J. Appl. Phys. 48 (1977)"
        " 4729; values from memory, not checked against the publication)",
        "eV",
    )
    traps_e_cm2: Range = key(
        (1e12, 1e13), "most charge that the surface holds; assumption", "1/cm^2"
    )
    electrode: Literal["negative", "positive"] = key(
        "negative", "sign of the drive of the moving electrode; a positive one emits nothing"
    )
    contactless_V: float = key(
        0.0,
        "shift of the other sign by charge that needs no contact, a decade of time from 1 s on;"
        " 1 V in minutes was seen at 25 V (Michalas et al. 2015, doi 10.2298/FUEE1501113M)",
        "[0, 100] V",
    )
    optical_permittivity: float = key(
        4.0, "relative permittivity of the dielectric to light, for its traps", "[1, 100]"
    )
    duty: float = key(1.0, "share of the time for which the switch is held", "(0, 1]")
    other_polarity: float = key(
        0.0,
        "share of the time held with the other polarity, which undoes as much; not 0.5",
        "[0, 1]",
    )
    period_s: float | None = key(
        None,
        "period of the drive: hold, hold of the other polarity, rest, in which charge leaks; null:"
        " cycles are not followed, the time that counts is held time",
        "[1e-6, 1e9] s",
    )
    recovery_exponent: tuple[Exponent, Exponent] = key(
        (0.05, 0.3),
        "charge left after a rest r is (1 + r / recovery_s)^-exponent; 0: all of it; a power law is"
        " what is measured (Koutsoureli et al., IRPS 2011, doi 10.1109/IRPS.2011.5784490), its"
        " exponent is an assumption",
    )
    activation_eV: tuple[Energy, Energy] = key(
        (0.1, 1.0),
        "energy by which injection grows with temperature, between those of a measured drift;"
        " assumption",
        "eV",
    )
    recovery_s: Positive = key(1.0, "rest after which the power law begins; assumption", "s")
    ageing: AgeingSettings | None = key(
        None, "creep and bonds while it is held; null: charge alone"
    )

    @model_serializer(mode="wrap")
    def _without_ageing(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Ageing that nobody asks for is left out, so that results without it stay as they were."""
        return {
            name: value for name, value in dump(self).items() if (name, value) != ("ageing", None)
        }

    @model_validator(mode="after")
    def _rising(self) -> "LifetimeSettings":
        for name in RANGES:
            low, high = getattr(self, name)
            if low > high:
                raise ValueError(f"{name} = [{low:g}, {high:g}]: give the least value first")
        if self.other_polarity == 0.5:
            raise ValueError(
                "other_polarity = 0.5: the polarities sum to nothing, so that nothing is left to"
                " follow; give another share"
            )
        return self
