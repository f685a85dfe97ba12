"""Made-up curves and witnesses of closings of known hardness, for hard cases and tests."""

from collections.abc import Callable
from typing import Any

import numpy as np

APPROACH_NM = 0.3
TRAVEL_NM = np.arange(0.0125, 1.2, 0.025)
CELL_AREA_NM2 = 36.0
HARDNESS_GPA = 10.0
Rows = list[dict[str, Any]]


def contact_length_nm(travel_nm: np.ndarray = TRAVEL_NM) -> np.ndarray:
    """A contact that grows from 0.25 nm of travel on."""
    return np.maximum(0, 3.2 * (travel_nm - 0.25))


def curve(
    stress: Callable[[float], float],
    length: np.ndarray | None = None,
    temperature: float = 300.0,
    drift: float = 0.0,
) -> Rows:
    """Rows of a curve.

    Parameters
    ----------
    stress : GPa, by the contact length.
    length : contact length of each row, nm.
    temperature : K; above 300 it rises by 100.
    drift : of the energy between rows, meV per atom.
    """
    if length is None:
        length = contact_length_nm()
    rows = []
    for k in range(len(TRAVEL_NM)):
        row = {"time_ps": 0.5 * (k + 1), "displacement_nm": float(TRAVEL_NM[k])}
        row["contact_length_nm"] = float(length[k])
        row["contact_area_nm2"] = float(length[k] ** 2)
        row["contact_stress_GPa"] = float(stress(length[k]))
        row["temperature_K"] = temperature
        if temperature > 300:
            row["temperature_K"] += 100.0 * k / len(TRAVEL_NM)
        row["energy_drift_meV_per_atom"] = drift * k
        rows.append(row)
    return rows


def witness(
    onset: float = 0.8, background: int = 2, after: int = 40, lowering: float = 0.1
) -> Rows:
    """Rows of a witness: a snapshot every 0.1 nm.

    Parameters
    ----------
    onset : travel from which bonds are exchanged and the top stays lower, nm.
    background, after : bonds exchanged between snapshots before the onset, and how many more after
        it.
    lowering : of the top, nm.
    """
    rows = []
    for k in range(1, 12):
        travel = 0.1 * k
        yields = travel >= onset
        new = background + after if yields else background
        if k == 1:
            new = 0
        row = {"displacement_nm": travel, "new_exchanges": new}
        row["lowering_nm"] = lowering if yields else 0.0
        rows.append(row)
    return rows


def plateau(length_nm: float) -> float:
    """Stress that rises with the contact and then stays, GPa."""
    return HARDNESS_GPA if length_nm > 1.6 else 6 * length_nm
