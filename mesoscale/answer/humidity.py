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
from mesoscale.answer.switches import PadModel, solve_point, surfaces_of
from mesoscale.contact.menisci import reach_nm
from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.adhesion import adhesion_of
from mesoscale.settings import ContactSettings
from mesoscale.settings.contact import AirSettings, Opening

Array = NDArray[np.float64]
HALVINGS = 3  # of the step of humidity in which the switch begins to stick


def levels(table: InputTable, contact: ContactSettings) -> Array:
    """Humidities over the range of the input, rising; without this input that of the air alone."""
    if "humidity" not in table.names:
        return np.array([contact.air.humidity if contact.air else 0.0])
    low, high = table.rows[table.names.index("humidity")].distribution.span()
    return (
        low + (high - low) * np.linspace(0.0, 1.0, 7) ** 2
    )  # a few per cent of humidity change most


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
    openings = ("balance",) if contact.mechanics == "adhesive" else get_args(Opening)
    steps = (len(humidities) + HALVINGS) * len(openings)

    def solve(humidity: float, share: dict[str, float]) -> None:
        point = replace(
            model.central.point, values={**model.central.point.values, "humidity": humidity}
        )
        for opening in openings:
            chosen = contact.model_copy(update={"air": air.model_copy(update={"opening": opening})})
            solved = solve_point(point, chosen, 2 * point_cells, surfaces_of(0))
            opened = adhesion_of(solved.pad.curves)[0] if solved.pad else None
            rows.append(
                {
                    "humidity": humidity,
                    "opening": opening,
                    "reach_nm": reach_nm(air.model_copy(update={"humidity": humidity})),
                    "release_V": solved.states.release_V if solved.states else None,
                    "error_V": solved.error_V if solved.states else None,
                    "energy_mJ_m2": opened.energy_uJ_m2 * 1e-3 if opened else None,
                    "pull_off_kPa": opened.pull_off_kPa if opened else None,
                    **(share if opening == air.opening else {}),
                }
            )
            if progress:
                progress(len(rows) / steps, f"{humidity:.0%} humidity, {opening}")

    for humidity, share in zip(humidities.tolist(), _shares(model, humidities), strict=True):
        solve(humidity, share)
    for _ in range(HALVINGS):
        step = sticking_between([row for row in rows if row["opening"] == air.opening])
        if step is not None:
            solve(0.5 * sum(step), {})
    return sorted(rows, key=lambda row: row["humidity"])


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
    at = np.array(
        [model.points[k].point.values.get("humidity", humidities[0]) for k in model.solved]
    )
    nearest = np.abs(at[:, None] - humidities).argmin(axis=1) if at.size else at.astype(int)
    shares = []
    for number in range(len(humidities)):
        sticking_here = stuck[nearest == number]
        said = (
            probability(int(sticking_here.sum()), sticking_here.size) if sticking_here.size else {}
        )
        names = {"value": "stuck", "low": "stuck_low", "high": "stuck_high"}
        shares.append(
            {name: said[key] for key, name in names.items() if said}
            | {"points": sticking_here.size}
        )
    return shares
