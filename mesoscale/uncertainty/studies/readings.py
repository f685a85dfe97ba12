"""The readings of the contact model that the audit compares.  Imports nothing heavy: the workflow reads it to plan."""

from collections.abc import Sequence
from itertools import product

from mesoscale.errors import InputError

CHOICES: dict[str, tuple[str, ...]] = {
    "convention": ("profile", "areal"),
    "flow_pair": ("paper", "wide"),
    "prefactor": ("paper", "hertz"),
    "radius": ("curvature", "truncation"),
    "area": ("sites", "hertz"),
    "touching_attracts": ("true", "false"),
}
"""Ambiguities of the contact model, as keys of ContactSettings with the values tried."""

MENDED: dict[str, tuple[str, ...]] = {"unloading_radius": ("curvature", "flattened"), "merge": ("as_one", "not_less")}
"""Readings that mend the asperity model; not the paper's, so that a name without them has their first values."""

NEAREST = "areal.wide.hertz.curvature.sites.false"
"""The reading nearest to the paper's tables (docs/data/audit.csv), the default."""

COUPLED = "coupled"
"""Ends the name of the nearest reading with all asperities on one half-space; not the paper's either."""


def contact_readings() -> list[str]:
    """Names of all readings of the contact model that can be computed, values joined by dots.

    Hertz's area with the mean curvature is left out: the mean curvature of a flattened asperity says nothing
    about its area, no asperity ever stops yielding and cycles do not converge.
    """
    named = (".".join(values) for values in product(*CHOICES.values()))
    return [name for name in named if ".curvature.hertz." not in name]


def audited_readings(names: Sequence[str]) -> list[str]:
    """The readings to audit: those named, `all`, or `mended`; by default those of the mean curvature.

    ``mended`` are the nearest reading and what mends it, named with the values of `MENDED` at the end. The nearest
    reading with `COUPLED` at the end must be named.
    R = A/(2 pi delta) with Hertz's area takes several times as long; config/studies/all_readings.yaml has all.

    Raises
    ------
    InputError : a name that is no reading.
    """
    if list(names) == ["all"]:
        return contact_readings()
    if list(names) == ["mended"]:
        return [".".join((NEAREST, *values)) for values in product(*MENDED.values())]
    known = [*contact_readings(), *(".".join((NEAREST, *values)) for values in product(*MENDED.values()))]
    known.append(f"{NEAREST}.{COUPLED}")
    if unknown := sorted(set(names) - set(known)):
        raise InputError(
            f"audit_readings: {unknown[0]!r:.60} is no reading; accepted: all, mended, or names as {NEAREST}"
        )
    return list(names) or [name for name in contact_readings() if ".curvature." in name]
