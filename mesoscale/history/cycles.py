"""What repeated closing and time under load do to the contact and its law (docs/history.md)."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from mesoscale.contact.energy import dissipated_energy
from mesoscale.history.creep import HeldCycle, follow, hardness_factor
from mesoscale.inputs.contact import ContactInputs
from mesoscale.law.branches import fit_cycle
from mesoscale.law.parameters import PARAMETERS
from mesoscale.settings import ContactSettings, HistorySettings
from mesoscale.settings.contact import NOMINAL_SEED
from mesoscale.settings.history import SURFACES


def follow_all(
    inputs: ContactInputs,
    contact: ContactSettings,
    settings: HistorySettings,
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[tuple[int, HeldCycle]]:
    """Seed and cycle of every surface in turn; the first is that of the nominal curves."""
    for done in range(SURFACES):
        seed = NOMINAL_SEED + done
        for held in follow(inputs, contact, settings, seed):
            yield seed, held
            if progress is not None:
                progress(
                    (done + held.number / settings.cycles) / SURFACES,
                    f"surface {seed}, cycle {held.number}",
                )


def cycle_row(seed: int, held: HeldCycle) -> dict[str, Any]:
    """Row of history/cycles.csv: the cycle, and the law of its opening."""
    cycle = held.cycle
    opening = fit_cycle(cycle).opening
    row: dict[str, Any] = {
        "seed": seed,
        "cycle": held.number,
        "held_s": float(held.held_s[-1]) if len(held.held_s) else 0.0,
        "first_contact_nm": cycle.first_contact_nm,
        "closed_nm": float(cycle.closing.separation_nm[-1]),
        "last_contact_nm": cycle.last_contact_nm,
        "contact_area_nm2": float(cycle.closing.contact_area_nm2[-1]),
        "dissipated_nN_nm": dissipated_energy(cycle)[0],
        "pull_off_nN": -float(cycle.opening.net_nN.min()),
    }
    for name in PARAMETERS:
        value = float(getattr(opening, name))
        row[f"opening_{name}"] = value if np.isfinite(value) else ""
    row["opening_status"] = opening.status
    row["converged"] = bool(cycle.converged and held.missed == 0)
    return row


def dwell_rows(
    seed: int, held: HeldCycle, contact: ContactSettings, settings: HistorySettings
) -> list[dict[str, Any]]:
    """Rows of history/dwell.csv: the contact at each time of the hold."""
    site = (contact.length_nm / contact.pixels) ** 2
    factors = hardness_factor(held.held_s, settings)
    rows = []
    for time, factor, row in zip(held.held_s, factors, held.hold, strict=True):
        rows.append(
            {
                "seed": seed,
                "cycle": held.number,
                "held_s": float(time),
                "hardness_factor": float(factor),
                "separation_nm": row.separation,
                "contact_area_nm2": row.sites * site,
                "asperities": row.asperities,
            }
        )
    return rows
