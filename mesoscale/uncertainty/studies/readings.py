"""The readings of the contact model that the audit compares.  Imports nothing heavy: the workflow reads it to plan."""

from collections.abc import Sequence
from itertools import product

CHOICES: dict[str, tuple[str, ...]] = {
    "convention": ("profile", "areal"),
    "flow_pair": ("paper", "wide"),
    "prefactor": ("paper", "hertz"),
    "radius": ("curvature", "truncation"),
    "area": ("sites", "hertz"),
    "touching_attracts": ("true", "false"),
}
"""Ambiguities of the contact model, as keys of ContactSettings with the values tried."""


def contact_readings() -> list[str]:
    """Names of all readings of the contact model that can be computed, values joined by dots.

    Hertz's area with the mean curvature is left out: the mean curvature of a flattened asperity says nothing
    about its area, no asperity ever stops yielding and cycles do not converge.
    """
    named = (".".join(values) for values in product(*CHOICES.values()))
    return [name for name in named if ".curvature.hertz." not in name]


def audited_readings(names: Sequence[str]) -> list[str]:
    """The readings to audit: those named, or `all`; by default those of the mean curvature.

    R = A/(2 pi delta) with Hertz's area takes several times as long; config/studies/all_readings.yaml has all.
    """
    if list(names) == ["all"]:
        return contact_readings()
    return list(names) or [name for name in contact_readings() if ".curvature." in name]
