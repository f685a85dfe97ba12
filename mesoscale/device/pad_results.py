"""Content of device/pad_switch.json at central inputs: the switch on the mean pad, and what the cells leave open."""

from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.device.beam_switch import solve_beam
from mesoscale.device.pad_switch import PadStates, solve_on_pad
from mesoscale.device.statistics import describe, never_closes, probability
from mesoscale.device.switch import NM, Switch, switch_from_settings
from mesoscale.errors import InputError
from mesoscale.pad.curves import PadCells
from mesoscale.pad.memory import Flats, PadLaw, attracting, law_of
from mesoscale.settings import DeviceSettings

RESAMPLES = 200
"""Pads of resampled cells behind the intervals of a plate: a 5 % quantile is known to 1.5 %."""
WORKS = (1.0 / 3.0, 1.0, 3.0)
"""Both laws of attraction differ by a factor of 3 in their work at touch (docs/contact.md); no statistics decides."""


def switch_on_pad(
    cells: PadCells,
    flats: Flats,
    settings: DeviceSettings,
    cell_area_nm2: float,
    released: Callable[[], NDArray[np.float64]],
) -> dict[str, Any]:
    """Content of device/pad_switch.json: the switch on the mean pad, and what the number of cells leaves open.

    A switch whose held state was not computed gets no numbers; `gate` says why. The gate judges the electrode of the
    scene: that a plate could not be solved says nothing of one that bends.

    Parameters
    ----------
    released : gives release voltages (V) on pads of resampled cells; called where the electrode bends.
    """
    switch = switch_from_settings(settings)
    content: dict[str, Any] = {
        "electrode": "bending" if settings.bends else "flat",
        "cells_computed": cells.count,
        "cells_of_pad": settings.pad_um2 * 1e6 / cell_area_nm2,
        "unsettled_cells": int((~cells.settled).sum()),
        "spring_pressure_kPa": switch.spring_N_per_m * switch.gap_nm * NM / switch.area_m2 * 1e-3,
    }
    law, bends = law_of(cells, flats), settings.bends
    reasons, plate, beam = [], None, None
    if content["unsettled_cells"]:
        reasons.append(f"{content['unsettled_cells']} cells in which flow did not come to rest")
    try:
        plate = _plate(switch, law, cells, settings)
    except InputError as error:
        if not bends:
            return {**content, "mean": None, "gate": {"passed": False, "reasons": [str(error)]}}
    try:
        if bends:
            beam = asdict(solve_beam(settings, law))
            by_cells = released()
            reasons += _undecided(cells.count, int((by_cells == 0).sum()), len(by_cells), "")
        elif plate:
            pulled = plate["estimate"]["deepest_net_kPa"]["quantiles"]
            pulls = (
                f": the pad pulls with {pulled['0.05']:.2g} to {pulled['0.95']:.2g} kPa, the spring with "
                f"{content['spring_pressure_kPa']:.2g} kPa"
            )
            reasons += _undecided(cells.count, plate["estimate"]["stuck"]["count"], RESAMPLES, pulls)
    except InputError as error:
        reasons.append(str(error))
    solved = beam or (plate and plate["mean"])
    if solved and (line := never_closes(settings, solved["pull_in_V"])):
        reasons.append(line)
    return {
        **content,
        "mean": plate["mean"] if plate else None,
        "beam": beam,
        "by_attraction": [{"times": times, "release_V": _release_V(settings, law, times)} for times in WORKS],
        **({"estimate": plate["estimate"]} if plate else {}),
        "gate": {"passed": not reasons, "reasons": reasons},
    }


def _plate(switch: Switch, law: PadLaw, cells: PadCells, settings: DeviceSettings) -> dict[str, Any]:
    """The switch as a plate on the mean pad, and on pads of resampled cells.

    Raises
    ------
    InputError : see `solve_on_pad`.
    """
    mean = solve_on_pad(switch, law, settings.hold_voltage_V)
    resampled = resampled_states(switch, cells, law.flats, settings.hold_voltage_V, RESAMPLES, 0)
    names = ("pull_in_V", "hold_nm", "hold_MPa", "release_V", "deepest_net_kPa")
    spread = {name: describe(np.array([getattr(state, name) for state in resampled])) for name in names}
    stuck = sum(state.stuck for state in resampled)
    return {"mean": asdict(mean), "estimate": {**spread, "stuck": probability(stuck, RESAMPLES)}}


def _release_V(settings: DeviceSettings, law: PadLaw, times: float) -> float | None:
    """Release at `times` the attraction; None where the held state was not computed."""
    scaled = attracting(law, times)
    try:
        if settings.bends:
            return solve_beam(settings, scaled).release_V
        return solve_on_pad(switch_from_settings(settings), scaled, settings.hold_voltage_V).release_V
    except InputError:
        return None


def resampled_states(
    switch: Switch, cells: PadCells, flats: Flats, hold_voltage_V: float | None, resamples: int, seed: int
) -> list[PadStates]:
    """The switch on pads made of cells drawn with replacement: what the finite number of computed cells leaves open.

    Raises
    ------
    InputError : see `solve_on_pad`.
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 0x9AD5]))
    solved = []
    for _ in range(resamples):
        weights = rng.multinomial(cells.count, np.full(cells.count, 1.0 / cells.count)) / cells.count
        solved.append(solve_on_pad(switch, law_of(cells, flats, weights), hold_voltage_V))
    return solved


def _undecided(cells: int, stuck: int, pads: int, why: str) -> list[str]:
    """Why the computed cells do not decide whether the switch sticks; nothing where they do."""
    if not 0.05 * pads < stuck < 0.95 * pads:
        return []
    return [
        f"the {cells} computed cells do not decide whether the switch sticks, which it does on {stuck} of {pads} "
        f"resampled pads{why}; raise pad.cells"
    ]
