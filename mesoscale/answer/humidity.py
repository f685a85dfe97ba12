"""The switch against humidity: at central inputs by both limits of opening, and over all that is
uncertain.

Two limits hold what menisci do while the switch opens: in balance with the vapour, or with a volume
that stays (docs/humidity.md).
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from mesoscale.answer.release import probability
from mesoscale.answer.switches import PadModel, Solved, solve_point, surfaces_of
from mesoscale.contact.menisci import reach_nm
from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.adhesion import adhesion_of
from mesoscale.settings import ContactSettings
from mesoscale.settings.contact import AirSettings, Opening

Array = NDArray[np.float64]
HALVINGS = 3  # of the step of humidity in which the switch begins to stick


def levels(table: InputTable, contact: ContactSettings) -> Array:
    """Humidities over the range of the input, rising; one where it is known, as that of the air."""
    if "humidity" not in table.names:
        air = contact.air or AirSettings(humidity=0.0)
        return np.array([air.humidity])
    low, high = table.rows[table.names.index("humidity")].distribution.span()
    if low == high:
        return np.array([low])
    # a few per cent of humidity change most
    return low + (high - low) * np.linspace(0.0, 1.0, 7) ** 2


def humidity_rows(
    model: PadModel,
    table: InputTable,
    contact: ContactSettings,
    point_cells: int,
    progress: Callable[[float, str], None] | None = None,
) -> list[dict[str, Any]]:
    """Rows of humidity/humidity.csv: one a humidity and limit of opening, by rising humidity.

    Further humidities halve the step in which the switch begins to stick.

    Parameters
    ----------
    contact : on the grid of the pads.
    """
    rows: list[dict[str, Any]] = []
    humidities = levels(table, contact)
    air = contact.air or AirSettings()
    openings = get_args(Opening)
    if contact.mechanics == "adhesive":
        openings = ("balance",)
    steps = (len(humidities) + HALVINGS) * len(openings)

    def solve(humidity: float, share: dict[str, float]) -> None:
        values = {**model.central.point.values, "humidity": humidity}
        point = replace(model.central.point, values=values)
        humid = air.model_copy(update={"humidity": humidity})
        for opening in openings:
            chosen = contact.model_copy(update={"air": air.model_copy(update={"opening": opening})})
            solved = solve_point(point, chosen, 2 * point_cells, surfaces_of(0))
            row: dict[str, Any] = {
                "humidity": humidity,
                "opening": opening,
                "reach_nm": reach_nm(humid, values["hamaker"]),
                **_numbers(solved),
            }
            if opening == air.opening:
                row |= share
            rows.append(row)
            if progress:
                progress(len(rows) / steps, f"{humidity:.0%} humidity, {opening}")

    for humidity, share in zip(humidities.tolist(), _shares(model, humidities), strict=True):
        solve(humidity, share)
    for _ in range(HALVINGS):
        step = sticking_between([row for row in rows if row["opening"] == air.opening])
        if step is not None:
            solve(0.5 * sum(step), {})
    return sorted(rows, key=lambda row: row["humidity"])


def _numbers(solved: Solved) -> dict[str, float | None]:
    """What the switch and the adhesion of its pad are; None where they are not known."""
    numbers: dict[str, float | None] = dict.fromkeys(
        ("release_V", "error_V", "energy_mJ_m2", "pull_off_kPa")
    )
    if solved.states:
        numbers["release_V"] = solved.states.release_V
        numbers["error_V"] = solved.error_V
    if solved.pad:
        opened = adhesion_of(solved.pad.curves)[0]
        numbers["energy_mJ_m2"] = opened.energy_uJ_m2 * 1e-3
        numbers["pull_off_kPa"] = opened.pull_off_kPa
    return numbers


def sticking_between(rows: Sequence[dict[str, Any]]) -> tuple[float, float] | None:
    """Humidities of two neighbours, of which the switch lets go at the first and sticks at the
    second.
    """
    known = sorted(
        (row["humidity"], row["release_V"]) for row in rows if row["release_V"] is not None
    )
    for (low, release), (high, stuck) in pairwise(known):
        if release > 0.0 == stuck:
            return low, high
    return None


def _shares(model: PadModel, humidities: Array) -> list[dict[str, float]]:
    """Share of the points nearest to each humidity whose switch sticks, with its 95 % interval."""
    stuck = model.states("release_V") == 0.0
    humidity_of_points = np.array(
        [model.points[k].point.values.get("humidity", humidities[0]) for k in model.solved]
    )
    apart = np.abs(humidity_of_points.reshape(-1, 1) - humidities)
    nearest = apart.argmin(axis=1)
    shares = []
    for number in range(len(humidities)):
        stuck_nearby = stuck[nearest == number]
        share: dict[str, float] = {}
        if stuck_nearby.size:
            sticking = probability(int(stuck_nearby.sum()), stuck_nearby.size)
            share["stuck"] = sticking["value"]
            share["stuck_low"] = sticking["low"]
            share["stuck_high"] = sticking["high"]
        share["points"] = stuck_nearby.size
        shares.append(share)
    return shares
