"""The law fitted to both branches of a cycle, computed just now or stored in a file."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact import Cycle
from mesoscale.contact.cycle import Branch
from mesoscale.errors import InputError
from mesoscale.law.compact import Law
from mesoscale.law.fit import LawFit, fit_branch, row_of
from mesoscale.law.parameters import PARAMETERS

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Outcome:
    """What one cycle gave.

    Attributes
    ----------
    status : ok, unconverged, or failed: why.
    """

    closing: LawFit
    opening: LawFit
    status: str = "ok"


NO_FIT = LawFit(np.nan, np.nan, np.nan, np.nan, status="no_curve")


def fit_cycle(cycle: Cycle) -> Outcome:
    """The law fitted to both branches of a cycle."""
    area = cycle.cell_area_nm2
    hamaker = cycle.inputs.hamaker
    closing = _fit(cycle.closing, area, hamaker, cycle.first_contact_nm)
    opening = _fit(cycle.opening, area, hamaker, cycle.last_contact_nm)
    return Outcome(closing, opening, "ok" if cycle.converged else "unconverged")


def _fit(branch: Branch, area_nm2: float, hamaker: float, touch_nm: float) -> LawFit:
    separation_nm = branch.separation_nm
    forces = branch.repulsive_nN, branch.attractive_nN
    return fit_branch(separation_nm, *forces, area_nm2, hamaker, touch_nm)


def laws_of(cycle: Cycle) -> tuple[Law, Law]:
    """The force-separation laws of closing and opening, ready for `pressure`, `force` and a switch.

    Raises
    ------
    InputError : a branch does not determine its law; the message says why.
    """
    outcome = fit_cycle(cycle)
    for branch, fit in (("closing", outcome.closing), ("opening", outcome.opening)):
        if not np.isfinite(fit.parameters).all():
            raise InputError(f"law of {branch}: {fit.status}; choose a larger force")
    laws = []
    for fit in (outcome.closing, outcome.opening):
        parameters = dict(zip(PARAMETERS, fit.parameters.tolist(), strict=True))
        laws.append(Law(**parameters, hamaker=cycle.inputs.hamaker))
    closing, opening = laws
    return closing, opening


def stored_rows(
    curves: Mapping[str, Mapping[str, Array]],
    name: str,
    attributes: Mapping[str, Any],
    cell_area_nm2: float,
) -> Iterator[dict[str, Any]]:
    """Columns of the tables in law/ for both branches of a stored curve.

    Parameters
    ----------
    curves : datasets by group `<name>/closing` and `<name>/opening`; a missing group gives no curve
        and no fit.
    attributes : the curve's: hamaker, first_contact_nm, last_contact_nm, status.
    """
    for branch, touch in (("closing", "first_contact_nm"), ("opening", "last_contact_nm")):
        fit = NO_FIT
        if curve := curves.get(f"{name}/{branch}"):
            forces = curve["repulsive_nN"], curve["attractive_nN"]
            hamaker = float(attributes["hamaker"])
            touched = attributes.get(touch)
            fit = fit_branch(curve["separation_nm"], *forces, cell_area_nm2, hamaker, touched)
        yield {"branch": branch, **row_of(fit), "curve_status": attributes.get("status", "")}
