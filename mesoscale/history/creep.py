"""Many cycles of one surface, each held at its largest force: shakedown, creep (docs/history.md).

An asperity at its hardness H whose indentation is kept relaxes by Norton's law, dp/dt = -(H/t0)
(p/H)^(m + 1), so that p = H (1 + m t/t0)^(-1/m). Every asperity is held to this envelope, or to the
logarithmic one H / (1 + c ln(1 + t/t0)): the hardness of eq. 4 falls with the time under load, the
asperities flow, and the flat sinks until it carries its force again. Closing and opening are fast:
they meet the full hardness.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from mesoscale.contact.cycle import Cycle, run_cycle
from mesoscale.contact.path import solve_force
from mesoscale.contact.pressed import Contact, Row, State
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings, HistorySettings
from mesoscale.settings.history import CREEP_TIME_S, DWELL_STEPS


@dataclass(frozen=True)
class HeldCycle:
    """One cycle of a history.

    Attributes
    ----------
    number : which cycle, counted from 1.
    held_s : time under load since the first cycle at which the contact was solved, shape (k + 1,).
    hold : the contact at these times; separations from the mean plane.
    missed : times at which the force could not be brought back exactly (it jumps).
    """

    number: int
    cycle: Cycle
    held_s: np.ndarray
    hold: list[Row] = field(repr=False)
    missed: int


def hardness_factor(held_s: np.ndarray | float, settings: HistorySettings) -> np.ndarray:
    """Share of the hardness that is left after a time under load."""
    time = np.asarray(held_s, dtype=float) / CREEP_TIME_S
    if (exponent := settings.creep_exponent) is not None:
        return (1.0 + exponent * time) ** (-1.0 / exponent)
    return 1.0 / (1.0 + settings.creep_strength * np.log1p(time))


def follow(
    inputs: ContactInputs,
    contact: ContactSettings,
    settings: HistorySettings,
    seed: int,
) -> Iterator[HeldCycle]:
    """Close and open one surface repeatedly; each cycle starts from the surface of the last.

    Raises
    ------
    InputError : no cycle is asked for, or cycles of a model without history.
    """
    check(contact, settings)
    heights = None
    for number in range(1, settings.cycles + 1):
        times = _times(settings, (number - 1) * settings.dwell_s)
        hold = Hold(settings, times)
        cycle = run_cycle(
            inputs,
            contact,
            seed,
            heights=heights,
            contact_at="lowest",
            keep_surface=True,
            hold=hold if settings.dwell_s > 0 else None,
        )
        heights = cycle.heights
        yield HeldCycle(number, cycle, times[: len(hold.rows)], hold.rows, hold.missed)


def check(contact: ContactSettings, settings: HistorySettings) -> None:
    """Refuse what leads to no history (InputError)."""
    if settings.cycles == 0:
        raise InputError(
            "history.cycles = 0: no cycle is asked for; give a number of cycles in the scene"
        )
    if contact.model != "plastic":
        raise InputError(
            f"contact.model = {contact.model} with history.cycles = {settings.cycles}: only plastic"
            " contacts have a history; choose contact.model: plastic"
        )


@dataclass
class Hold:
    """Keeps the force of a contact while its hardness falls; `run_cycle` calls it at the turn.

    Attributes
    ----------
    times : time under load, s; the first is the start of this hold.
    """

    settings: HistorySettings
    times: np.ndarray
    rows: list[Row] = field(default_factory=list)
    missed: int = 0

    def __call__(self, contact: Contact, last: Row) -> list[Row]:
        """Rows of the contact at all times but the first, which is `last` itself."""
        self.rows.append(_from_mean(contact, last))
        states = []
        row = last
        for factor in hardness_factor(self.times[1:], self.settings):
            contact.soften(factor)
            row = self._sink(contact, row.separation, last.force)
            states.append(row)
            self.rows.append(_from_mean(contact, row))
        contact.soften(1.0)
        return states

    def _sink(self, contact: Contact, separation: float, force: float) -> Row:
        """Let the asperities flow, then lower the flat until the force is back."""
        path = [(separation, contact.move_to(separation, True))]

        def accept(target: float, moved: State) -> None:
            path.append((target, moved))

        step = smallest = 1e-7 * max(contact.rms, contact.spacing)
        while path[-1][1].force < force * (1.0 - contact.FORCE_TOLERANCE):
            separation, moved = path[-1]
            target = separation - step
            trial = contact.move_to(target, True)
            if trial.force > force * (1.0 + contact.FORCE_TOLERANCE):
                contact.back()
                solve_force(
                    contact,
                    separation,
                    target,
                    moved.force,
                    trial.force,
                    force,
                    True,
                    smallest,
                    accept,
                )
                break
            accept(target, trial)
            step *= 2.0
        separation, moved = path[-1]
        self.missed += abs(moved.force - force) > 1e-3 * force
        held = moved._replace(sweeps=sum(passed.sweeps for _, passed in path))
        return held.row(separation, contact.attraction(separation))


def _times(settings: HistorySettings, start_s: float) -> np.ndarray:
    """Times of one hold, evenly in ln(1 + t/t0), the start included."""
    end_s = start_s + settings.dwell_s
    log_times = np.log1p(np.array([start_s, end_s]) / CREEP_TIME_S)
    inner = np.linspace(log_times[0], log_times[1], DWELL_STEPS + 1)[1:-1]
    return np.array([start_s, *CREEP_TIME_S * np.expm1(inner), end_s])


def _from_mean(contact: Contact, row: Row) -> Row:
    return row._replace(separation=row.separation + contact.offset)
