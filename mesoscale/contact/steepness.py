"""Hardness at the slope of a contact's own tops: steep asperities are harder than blunt ones."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from mesoscale.contact.coupled.validity import roughness
from mesoscale.contact.surface import random_surface
from mesoscale.errors import InputError
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.distributions import InputTable
from mesoscale.settings import ContactSettings
from mesoscale.settings.contact import NOMINAL_SEED


def at_slope(
    table: InputTable, entries: Mapping[str, Mapping[str, Any]], contact: ContactSettings
) -> InputTable:
    """The inputs with those of the hardness stage at the RMS slope of the surface at medians.

    On a surface of normal heights, all heights have the same slope: that of the tops is that of the
    surface.

    Parameters
    ----------
    entries : inputs of the hardness stage, by name; `steepness` has `rms_slope` and, at each, a
        `factor`.

    Raises
    ------
    InputError : a slope that no run had.
    """
    steep = {}
    for row in table.rows:
        if _is_steep(row, entries):
            steep[row.name] = entries[row.name]["steepness"]
    if not steep:
        return table
    inputs, settings = contact_of(table.medians(), contact)
    slope = roughness(random_surface(inputs, settings, NOMINAL_SEED), settings.length_nm).slope
    rows = []
    for row in table.rows:
        if known := steep.get(row.name):
            slopes = known["rms_slope"]
            if not slopes[0] <= slope <= slopes[-1]:
                raise InputError(
                    f"{row.source}: the surface has an RMS slope of {slope:.2g}, but hardness was"
                    f" computed from {slopes[0]:.2g} to {slopes[-1]:.2g}; set"
                    f" inputs.{row.name}.origin to literature with values"
                )
            factor = float(np.interp(np.log(slope), np.log(slopes), known["factor"]))
            source = f"{row.source}, times {factor:.2f} at RMS slope {slope:.2f}"
            row = replace(row, distribution=row.distribution.scaled(factor), source=source)
        rows.append(row)
    return replace(table, rows=tuple(rows))


def _is_steep(row: Any, entries: Mapping[str, Mapping[str, Any]]) -> bool:
    return row.origin == "hardness" and "steepness" in entries.get(row.name, {})
