"""The walk along a force-separation curve, of either mechanics."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from mesoscale.contact.pressed import Contact, Row, State


@dataclass
class Path:
    """Rows in the order of falling separation, and what happened on the way.

    Attributes
    ----------
    reached : whether the wanted end was reached, up to a jump of the force.
    load : largest force of an asperity over its yield force.
    full : whether every site has touched.
    """

    rows: list[Row] = field(default_factory=list)
    unconverged: int = 0
    bounds: int = 0
    repeated: int = 0
    reached: bool = True
    load: float = 0.0
    full: bool = False


@dataclass(frozen=True)
class WayBack:
    """Opening from where closing ended, in the order of rising separation.

    Attributes
    ----------
    touching : rows until nothing touches, the first where closing ended.
    apart : rows beyond, where only attraction acts.
    """

    touching: list[Row]
    apart: list[Row]
    unconverged: int = 0
    repeated: int = 0


def trace(
    contact: Contact,
    steps: int,
    with_flow: bool,
    stop_force: float = np.inf,
    stop_separation: float = -np.inf,
    start: Row | None = None,
) -> Path:
    """Bring the flat down from first contact, or from the row `start`, in steps of the force.

    Steps aim at force increments of a ``steps``-th of the final force, and at 30 % of the force
    reached so far in the foot of the curve; a step that misses by more than a factor of two is
    undone and repeated smaller. The last step is solved for the requested force (the force can jump
    when asperities merge: then the closer side of the jump is taken). A step in which flow is stuck
    is undone and repeated smaller, too; the path ends where it is stuck within 1 % of the
    roughness.
    """
    path = Path()
    final = stop_force
    if start is None:
        path.rows += contact.way(contact.touching_separation)
    else:
        path.rows.append(start)
    separation = path.rows[-1].separation
    force = path.rows[-1].force
    scale = max(contact.rms, 1e-3 * contact.spacing)
    smallest = contact.SMALLEST_STEP * scale
    step = scale / 300.0
    limit = -contact.highest - 2.0 * contact.length

    def accept(target: float, moved: State) -> None:
        nonlocal separation, force
        separation = target
        force = moved.force
        path.rows.append(moved.row(target, contact.attraction(target)))
        path.bounds += moved.bounds
        path.unconverged += not moved.settled
        path.load = max(path.load, moved.load)
        path.full |= moved.sites == contact.heights.size

    while separation > stop_separation and force < final * (1.0 - contact.FORCE_TOLERANCE):
        target = max(separation - step, stop_separation)
        if target < limit:
            path.reached = False
            break
        moved = contact.move_to(target, with_flow)
        if moved.stuck:
            contact.back()
            if step <= 0.01 * scale:
                path.reached = False
                break
            path.repeated += 1
            step *= 0.25
            continue
        if moved.force > final * (1.0 + contact.FORCE_TOLERANCE):
            contact.back()
            solve_force(
                contact, separation, target, force, moved.force, final, with_flow, smallest, accept
            )
            break
        rise = moved.force - force
        aim = min(final / steps, max(0.3 * force, 0.02 * final / steps))
        if rise > 2.0 * aim and step > smallest:
            contact.back()
            path.repeated += 1
            step *= max(0.25, aim / rise)
            continue
        accept(target, moved)
        aim = min(final / steps, max(0.3 * force, 0.02 * final / steps))
        # far below first contact, as on a flat surface, the roughness is no measure of a step
        largest = max(scale, 0.1 * (path.rows[0].separation - separation)) / 30.0
        growth = aim / rise if rise > 0 else 2.0
        step = min(step * min(2.0, max(0.5, growth)), largest)
        if contact.AIMS_AT_END and rise > 0 and force + aim > final:
            last_step = path.rows[-2].separation - separation
            step = min(step, last_step * (final - force) / rise)
    return path


def open_again(contact: Contact, closing: Path, approach: list[Row], steps: int) -> WayBack:
    """Lift the flat from where closing ended until nothing touches, and away.

    Parameters
    ----------
    approach : rows of the way to first contact.
    steps : of the force, see `trace`.
    """
    last = closing.rows[-1]
    if not contact.REVERSIBLE:
        return _open_by_its_own_way(contact, last, steps)
    changed = contact.changed_sites > 0 or contact.keeps_liquid
    if changed and last.force > 0:
        return _open_without_flow(contact, last, steps)
    # nothing has changed: the way back is the way there
    touching = [row._replace(sweeps=0) for row in closing.rows[::-1]]
    return WayBack(touching, approach[::-1])


def _open_by_its_own_way(contact: Contact, last: Row, steps: int) -> WayBack:
    """For contacts that come back another way than they went."""
    path = _reopen(contact, steps, last)
    apart = []
    for gap in contact.gaps_apart_nm:
        apart += contact.way(path.rows[-1].separation + gap)
    return WayBack(path.rows, apart, path.unconverged + contact.unsettled, path.repeated)


def _open_without_flow(contact: Contact, last: Row, steps: int) -> WayBack:
    """By closing the changed surface again without flow, up to the same force."""
    contact.hold_liquid(last.separation)
    contact.adopt_changes()
    touching_separation = contact.touching_separation
    apart = [contact.away(touching_separation + gap) for gap in contact.gaps_apart_nm]
    path = trace(contact, steps, False, last.force, stop_separation=last.separation)
    # the last row of the way down is the state in which closing ended
    return WayBack([last._replace(sweeps=0), *path.rows[-2::-1]], apart)


def _reopen(contact: Contact, steps: int, last: Row) -> Path:
    """Lift the flat from the end of closing until nothing touches, in steps of both forces.

    Where a force jumps, the step is as small as a path allows.
    """
    path = Path([last._replace(sweeps=0)])
    scale = max(contact.rms, 1e-3 * contact.spacing)
    smallest = contact.SMALLEST_STEP * scale
    step = scale / 300.0
    usual = (last.force - last.attraction) / steps
    while path.rows[-1].sites > 0:
        before = path.rows[-1]
        target = before.separation + step
        moved = contact.move_to(target, False)
        pull = contact.attraction(target)
        change = max(abs(moved.force - before.force), abs(pull - before.attraction))
        aim = min(usual, max(0.1 * (before.force - before.attraction), 0.02 * usual))
        if change > 2.0 * aim and step > smallest:
            contact.back()
            path.repeated += 1
            step = max(step * max(0.25, aim / change), smallest)
            continue
        path.rows.append(moved.row(target, pull))
        path.unconverged += not moved.settled
        largest = max(scale, target - last.separation) / 30.0
        growth = aim / change if change > 0.0 else 2.0
        step = min(step * min(2.0, max(0.5, growth)), largest)
    return path


def solve_force(
    contact: Contact,
    start: float,
    below: float,
    start_force: float,
    below_force: float,
    target: float,
    with_flow: bool,
    smallest: float,
    accept: Callable[[float, State], None],
) -> None:
    """Bring the flat down to where the force is the target.

    Regula falsi (Illinois) between ``start``, the last separation, and ``below``, where the force
    is too large. Trials below the target are steps of the path and handed to ``accept``;
    those above it are undone. Where the force jumps over the target, the closer side is taken,
    unless flow is stuck there.
    """
    high = start  # force below the target
    low = below  # force above the target
    short = target - start_force
    excess = below_force - target
    weight_high = weight_low = 1.0
    last_side = 0
    for trial in range(60):
        if high - low <= smallest:
            break
        share = 0.5
        if trial % 4 < 3 and math.isfinite(excess):
            share = short * weight_high / (short * weight_high + excess * weight_low)
        middle = high + share * (low - high)
        moved = contact.move_to(middle, with_flow)
        tolerance = 0.5 * contact.FORCE_TOLERANCE * target
        reached = abs(moved.force - target) <= tolerance and not moved.stuck
        if reached or (moved.force < target and not moved.stuck):
            accept(middle, moved)
            high = middle
            short = target - moved.force
            if reached:
                return
            weight_high = 1.0
            if last_side == 1:
                weight_low = weight_low * 0.5
            last_side = 1
        else:
            contact.back()
            low = middle
            excess = moved.force - target
            if moved.stuck:
                excess = math.inf
            weight_low = 1.0
            if last_side == -1:
                weight_high = weight_high * 0.5
            last_side = -1
    if excess < short:
        accept(low, contact.move_to(low, with_flow))
