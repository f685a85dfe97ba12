"""The switch on the curves of a pad: pull-in, hold, release, with the memory of the held state.

The force balance is that of `mesoscale.device.switch` with the whole electrode flat on the pad. Nothing is
extrapolated: a held state beyond the computed closing, or an opening from a depth that was not computed, is refused.
"""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from mesoscale.device.beam_switch import solve_beam
from mesoscale.device.statistics import describe, never_closes, probability
from mesoscale.device.switch import GPA, NM, Switch, solve_switch, switch_from_settings
from mesoscale.errors import InputError, NotComputed
from mesoscale.law.branches import law_of_fit
from mesoscale.law.fit import fit_branch
from mesoscale.law.wells import attraction_status, well_of, well_of_law
from mesoscale.pad.compact import fit_compact, tabulated
from mesoscale.pad.curves import PadCells
from mesoscale.pad.memory import PadLaw, law_of
from mesoscale.settings import DeviceSettings, LawSettings

Array = NDArray[np.float64]

POINTS = 400
"""Separations between the end of the pad's table and the gap at rest that bracket the folds."""
RESAMPLES = 200
"""Pads of resampled cells behind the intervals: a 5 % quantile is known to 1.5 %."""


@dataclass(frozen=True)
class PadStates:
    """What the switch does on one pad.

    Attributes
    ----------
    pull_in_V : voltage at which the open switch snaps shut.
    hold_nm : separation while held closed (nm).
    hold_MPa : contact pressure while held closed (MPa).
    release_V : voltage at which the closed switch lets go; 0 where it sticks.
    stuck : whether it stays closed without voltage.
    deepest_net_kPa : largest net adhesive pressure of the pad on opening from the held state (kPa).
    """

    pull_in_V: float
    hold_nm: float
    hold_MPa: float
    release_V: float
    stuck: bool
    deepest_net_kPa: float


def solve_on_pad(switch: Switch, law: PadLaw, hold_voltage_V: float | None) -> PadStates:
    """Close the switch on a pad, hold it, and release it.

    Parameters
    ----------
    hold_voltage_V : voltage of the closed switch; None takes its own pull-in voltage.

    Raises
    ------
    NotComputed : the held state is not on the computed closing curve.
    InputError : the hold voltage does not hold the switch.
    """
    outside = np.geomspace(law.separation_nm[-1], switch.gap_nm, POINTS)[1:]
    grid = np.concatenate([law.separation_nm, outside])
    down = _voltage_squared(switch, grid, law.closing_GPa(grid))
    near = grid <= law.separation_nm[-1]
    # the fold of the way down lies far above the pad, where nothing but the spring acts
    peak = int(np.argmax(np.where(near, -np.inf, down)))
    around = np.linspace(grid[peak - 1], grid[min(peak + 1, grid.size - 1)], POINTS)
    pull_in = float(_voltage_squared(switch, around, law.closing_GPa(around)).max())
    hold = pull_in if hold_voltage_V is None else hold_voltage_V**2
    holds = np.flatnonzero(near & (down >= hold))
    if holds.size == 0:
        raise NotComputed(
            f"device.hold_voltage_V: {np.sqrt(hold):.4g} V presses the pad harder than the computed "
            f"{law.closing_GPa(law.separation_nm[0]) * 1e3:.3g} MPa; raise "
            "pad.grid.max_pressure_MPa, or lower the voltage"
        )
    inner = int(holds[-1])
    if inner + 1 == near.sum():
        raise InputError(
            f"device.hold_voltage_V = {np.sqrt(hold):.4g}: too little to keep the switch on the pad (pull-in is at "
            f"{np.sqrt(pull_in):.4g} V); raise it"
        )
    held = brentq(lambda s: _voltage_squared(switch, s, law.closing_GPa(s)) - hold, grid[inner], grid[inner + 1])
    hold_nm = float(np.asarray(held))
    way_up = np.concatenate([[hold_nm], grid[grid > hold_nm]])
    net = law.opening_GPa(way_up, hold_nm)
    up = _voltage_squared(switch, way_up, net)
    # release is the lowest point before the barrier, the fold that the way down met, too
    barrier = int(np.argmax(np.where(way_up > law.separation_nm[-1], up, -np.inf)))
    release = float(up[: barrier + 1].min())
    return PadStates(
        float(np.sqrt(pull_in)),
        hold_nm,
        float(law.closing_GPa(hold_nm)) * 1e3,
        float(np.sqrt(max(release, 0.0))),
        release <= 0.0,
        -float(net.min()) * 1e6,
    )


def resampled_states(
    switch: Switch, cells: PadCells, hamaker: float, hold_voltage_V: float | None, resamples: int, seed: int
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
        solved.append(solve_on_pad(switch, law_of(cells, hamaker, weights), hold_voltage_V))
    return solved


def switch_on_pad(cells: PadCells, hamaker: float, settings: DeviceSettings, cell_area_nm2: float) -> dict[str, Any]:
    """Content of device/pad_switch.json: the switch on the mean pad, and what the number of cells leaves open.

    A switch whose held state was not computed gets no numbers; `gate` says why.
    """
    switch = switch_from_settings(settings)
    content: dict[str, Any] = {
        "cells_computed": cells.count,
        "cells_of_pad": switch.area_m2 * 1e18 / cell_area_nm2,
        "unsettled_cells": int((~cells.settled).sum()),
        "spring_pressure_kPa": switch.spring_N_per_m * switch.gap_nm * NM / switch.area_m2 * 1e-3,
    }
    try:
        mean = solve_on_pad(switch, law_of(cells, hamaker), settings.hold_voltage_V)
        resampled = resampled_states(switch, cells, hamaker, settings.hold_voltage_V, RESAMPLES, 0)
    except InputError as error:
        return {**content, "mean": None, "gate": {"passed": False, "reasons": [str(error)]}}
    spread = {
        name: describe(np.array([getattr(state, name) for state in resampled]))
        for name in ("pull_in_V", "hold_nm", "hold_MPa", "release_V", "deepest_net_kPa")
    }
    stuck = sum(state.stuck for state in resampled)
    reasons = _doubts(content, spread, stuck)
    bending = None
    try:
        if settings.spring_N_per_m is None:
            bending = asdict(solve_beam(settings, law_of(cells, hamaker)))
    except InputError as error:
        reasons.append(str(error))
    if line := never_closes(settings, bending["pull_in_V"] if bending else mean.pull_in_V):
        reasons.append(line)
    return {
        **content,
        "mean": asdict(mean),
        "beam": bending,
        "by_compact": compact_on_pad(switch, law_of(cells, hamaker), settings.hold_voltage_V),
        "by_law": law_on_pad(switch, cells, hamaker, mean.hold_nm, settings.hold_voltage_V),
        "estimate": {**spread, "stuck": probability(stuck, RESAMPLES)},
        "gate": {"passed": not reasons, "reasons": reasons},
    }


def compact_on_pad(switch: Switch, law: PadLaw, hold_voltage_V: float | None) -> dict[str, Any] | None:
    """The switch on the closed form of the pad; None where the curves give none, or it presses the pad too hard."""
    try:
        return asdict(solve_on_pad(switch, tabulated(fit_compact(law)[0], law), hold_voltage_V))
    except InputError:
        return None


def law_on_pad(
    switch: Switch, cells: PadCells, hamaker: float, hold_nm: float, hold_voltage_V: float | None
) -> dict[str, Any] | None:
    """The compact law fitted to the mean curves of the pad, and the switch on it: what the form of the law alone does.

    The opening is that from the computed depth nearest to the held state. None where a branch gives no law.
    """
    number = int(np.argmin(np.abs(cells.grid.depth_nm - hold_nm)))
    settings, laws, wells = LawSettings(), [], []
    for branch in (cells.closing, cells.opening[:, number]):
        mean = branch.mean(axis=0)
        known = np.isfinite(mean[0])
        at, (repulsive, attractive) = cells.grid.separation_nm[known][::-1], mean[:, known][:, ::-1]
        fit = fit_branch(at, repulsive, attractive, 1.0, hamaker, settings=settings)
        if not np.isfinite(fit.parameters).all():
            return None
        law = law_of_fit(fit, hamaker, settings)
        laws.append(law)
        wells.append((well_of_law(law, float(at[0]), float(at[-1])), well_of(at, repulsive + attractive)))
    states = solve_switch(switch, laws[0], laws[1], hold_voltage_V)
    forgetful = solve_switch(switch, laws[0], laws[0], hold_voltage_V)
    by_law, by_curve = wells[1]
    return {
        "opened_from_nm": float(cells.grid.depth_nm[number]),
        "release_V": float(states.release_V[0]),
        "release_without_memory_V": float(forgetful.release_V[0]),
        "hold_nm": float(states.hold_nm[0]),
        "well_law_kPa": by_law.depth_GPa * 1e6,
        "well_curve_kPa": by_curve.depth_GPa * 1e6,
        "well_status": attraction_status(by_law, by_curve),
    }


def _doubts(content: dict[str, Any], spread: dict[str, Any], stuck: int) -> list[str]:
    reasons = []
    if content["unsettled_cells"]:
        reasons.append(f"{content['unsettled_cells']} cells in which flow did not come to rest")
    if 0.05 * RESAMPLES < stuck < 0.95 * RESAMPLES:
        low, high = (spread["deepest_net_kPa"]["quantiles"][key] for key in ("0.05", "0.95"))
        reasons.append(
            f"the {content['cells_computed']} computed cells do not decide whether the switch sticks: the pad pulls "
            f"with {low:.2g} to {high:.2g} kPa, the spring with {content['spring_pressure_kPa']:.2g} kPa; raise "
            "pad.cells"
        )
    return reasons


def _voltage_squared(switch: Switch, separation_nm: Array, pressure_GPa: Array) -> Array:
    force = switch.net_force_N(separation_nm, None) + switch.area_m2 * pressure_GPa * GPA
    return switch.balancing_V2(separation_nm, force)
