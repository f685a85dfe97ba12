"""What the contact model takes: Table 1, a film, and how uncertain inputs enter it."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from mesoscale.checks import check_number
from mesoscale.errors import InputError
from mesoscale.inputs.hardness import HardnessLaw
from mesoscale.settings import ContactSettings
from mesoscale.settings.definitions import BY_NAME, RMS_SCATTER, definition


@dataclass(frozen=True)
class ContactInputs:
    """The inputs of Table 1, and a film; ranges stand in `mesoscale.settings.definitions`.

    Attributes
    ----------
    hamaker : Hamaker constant, aJ = 1e-18 J = nN nm; 0: no attraction.
    e_star : effective elastic modulus E* of both bodies, GPa.
    h_macro : hardness of large asperities, GPa.
    h_prime : size effect of hardness H', GPa nm^0.5.
    q0 : roll-off wave vector of the surface, 1/nm.
    hurst : Hurst exponent of the surface.
    rms : RMS height of the surface, nm.
    h_film, t_film, k_film, m_film : hardness (GPa) and thickness (nm) of a film, and how the base
        softens it (`HardnessLaw`); a film needs all four.

    Raises
    ------
    InputError : a number out of its range, a part of a film, or a film softer than its base.
    """

    hamaker: float
    e_star: float
    h_macro: float
    h_prime: float
    q0: float
    hurst: float
    rms: float
    h_film: float = 0.0
    t_film: float = 0.0
    k_film: float = 0.0
    m_film: float = 0.0

    def __post_init__(self):
        for field in fields(self):
            row = BY_NAME[field.name]
            value = getattr(self, row.name)
            check_number(row.name, value, row.low, row.high, row.unit, row.zero)
        film = {name: getattr(self, name) for name in ("h_film", "k_film", "m_film")}
        if self.t_film == 0 and any(film.values()):
            stated = ", ".join(f"{name} = {value:g}" for name, value in film.items() if value)
            raise InputError(
                f"{stated} without t_film: a film needs its thickness; give t_film, or leave"
                " them out"
            )
        if self.t_film > 0 and not (self.k_film or self.m_film):
            raise InputError(
                f"t_film = {self.t_film:.4g} nm without k_film and m_film: nothing says how the"
                " base softens the film; give both, or without t_film the film's hardness as"
                " h_macro"
            )
        # contacts that harden as they grow have no one pressure
        if self.t_film > 0 and self.h_film < self.h_macro:
            raise InputError(
                f"h_film = {self.h_film:.4g} GPa on h_macro = {self.h_macro:.4g} GPa: accepted are"
                " films at least as hard as their base"
            )

    @property
    def hardness(self) -> HardnessLaw:
        """Hardness against contact area."""
        return HardnessLaw.of({name: float(value) for name, value in vars(self).items()})


@dataclass(frozen=True, kw_only=True)  # behind inputs of `ContactInputs` that have a default
class FilmInputs(ContactInputs):
    """Inputs of a film whose places differ: `rms` is that of the median place.

    Attributes
    ----------
    rms_scatter : standard deviation of ln RMS between places.
    """

    rms_scatter: float


def contact_of(
    values: Mapping[str, float], settings: ContactSettings
) -> tuple[ContactInputs, ContactSettings]:
    """Contact inputs from values by name, and the settings with the inputs that replace one.

    Raises
    ------
    InputError : a value that the input or the setting does not accept.
    """
    replaced: dict[str, Any] = {}
    for name, value in values.items():
        section, _, field = definition(name).setting.rpartition(".")
        if section:
            replaced[section] = {**dict(getattr(settings, section) or {}), field: value}
        elif field:
            replaced[field] = value
    kind = FilmInputs if RMS_SCATTER.name in values else ContactInputs
    contact_values = {name: value for name, value in values.items() if not definition(name).setting}
    inputs = kind(**{"h_prime": 0.0, **contact_values})  # laws without it: `inputs.hardness`
    if not replaced:
        return inputs, settings
    return inputs, ContactSettings(**(dict(settings) | replaced))
