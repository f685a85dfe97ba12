"""Hardness of a contact against its area."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np


class HardnessLaw(NamedTuple):
    """H = H_b + (H_film - H_b) / (1 + k (L/t)^m), a film on a base; L: root of the contact's area.

    The base has H_b(A) = H_macro + H' A^-1/4 (eq. 4). Without a film (t = 0) H is that of the base.

    Attributes
    ----------
    h_macro : hardness of large contacts, GPa.
    h_prime : size effect of hardness, GPa nm^0.5.
    h_film : hardness of the film by itself, GPa.
    t_film : thickness t of the film, nm; 0: no film.
    k_film, m_film : how fast the base softens the contact, k and m.
    """

    h_macro: Any
    h_prime: Any = 0.0
    h_film: Any = 0.0
    t_film: Any = 0.0
    k_film: Any = 0.0
    m_film: Any = 0.0

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> "HardnessLaw":
        """The law of inputs by name, other inputs among them."""
        return cls(**{name: values[name] for name in cls._fields if name in values})

    def pressure(self, area: Any) -> Any:
        """Hardness (GPa) of contacts of an area in nm^2; fields and area broadcast."""
        length = np.sqrt(area)
        base = self.h_macro + self.h_prime / np.sqrt(length)
        if not np.any(self.t_film):
            return base
        crossover = self.k_film * (length / self.t_film) ** self.m_film
        return base + (self.h_film - base) / (1.0 + crossover)

    def scaled(self, factor: float) -> "HardnessLaw":
        """The law of a material with this share of the hardness."""
        return self._replace(
            h_macro=factor * self.h_macro,
            h_prime=factor * self.h_prime,
            h_film=factor * self.h_film,
        )

    @property
    def constant(self) -> bool:
        """Whether all contacts are equally hard."""
        return not (self.h_prime or self.t_film)
