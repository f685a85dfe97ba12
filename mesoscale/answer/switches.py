"""The switches of the points, each on a pad that is pressed for it.

Nothing is fitted between points. Each pad has a few cells of its own, so their error averages out
over the points as surfaces common to all would not let it. Half of its cells against the other half
tells the error of a point; one that they leave undecided has more cells.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mesoscale.answer.points import Design, Point
from mesoscale.errors import InputError
from mesoscale.pad.cells import FIRST_SEED, sample_cells
from mesoscale.pad.closing import press_cells
from mesoscale.pad.grid import DEPTHS, usual_step_nm
from mesoscale.pad.pilots import Pilots, closed_until
from mesoscale.pad.pressed import Pad
from mesoscale.settings import ContactSettings
from mesoscale.settings.pad import MORE_CELLS
from mesoscale.switch import States, release_or_nan_V, switch_of

Array = NDArray[np.float64]
Progress = Callable[[float, str], None]

UNDECIDED_SHARE = 0.008
"""Error of a release, over the pull-in voltage, from which a pad has more cells: 0.6 V of the
default switch."""
UNDECIDED_OF_RELEASE = 0.1
"""The same over the release; it must exceed both."""
NEARLY_STICKS = 0.04
"""Release over pull-in, below which the steps of separation matter: there a small change of the
pull moves the release by volts (python -m evidence answer.steps)."""
HALVINGS = 2
"""Most of these steps."""
SEEDS_APART = 1_000_000
"""Between the first surfaces of two points."""


@dataclass(frozen=True)
class Solved:
    """The switch of a point.

    Attributes
    ----------
    pad : None where it cannot be pressed.
    states : what the switch does; None where it has no answer.
    halves_V : release on either half of the cells; NaN where it cannot carry the switch.
    refused : why it has no answer; empty where it has one.
    """

    point: Point
    pad: Pad | None
    states: States | None
    halves_V: tuple[float, float]
    refused: str = ""

    @property
    def pressed(self) -> Pad:
        """The pad.

        Raises
        ------
        InputError : it cannot be pressed.
        """
        if self.pad is None:
            raise InputError(self.refused)
        return self.pad

    @property
    def held_V(self) -> float:
        """Voltage that holds it: as stated, or that of its pull-in.

        Raises
        ------
        InputError : it has no answer.
        """
        if self.states is None:
            raise InputError(self.refused)
        return self.point.device.hold_voltage_V or self.states.pull_in_V

    @property
    def outcome(self) -> str:
        """What the switch does, in words."""
        if self.states is None:
            return f"no switch: {self.refused}"
        release_V = self.states.release_V
        opens = f"lets go at {release_V:.3g} V" if release_V > 0.0 else "sticks"
        closes = "touches" if self.states.touches else "closes"
        return f"the switch {closes} at {self.states.pull_in_V:.3g} V and {opens}"

    @property
    def sticks(self) -> bool:
        """Whether it has an answer, which is that it sticks."""
        return self.states is not None and self.states.release_V == 0.0

    @property
    def error_V(self) -> float:
        """Estimated standard error of the release by the number of cells."""
        return 0.5 * abs(self.halves_V[0] - self.halves_V[1])

    @property
    def undecided(self) -> bool:
        """Whether more cells are wanted: the halves disagree by much, or on whether the switch
        sticks, or fail.
        """
        if self.states is None:
            return False
        first_V, second_V = self.halves_V
        disagree = (first_V == 0.0) != (second_V == 0.0)
        enough_V = max(
            UNDECIDED_SHARE * self.states.pull_in_V, UNDECIDED_OF_RELEASE * self.states.release_V
        )
        return disagree or not self.error_V <= enough_V

    @property
    def nearly_sticks(self) -> bool:
        """Whether it lets go at a voltage so low that the steps of separation matter."""
        return (
            self.states is not None
            and 0.0 < self.states.release_V < NEARLY_STICKS * self.states.pull_in_V
        )

    def moves_little(self, finer: States) -> bool:
        """Whether shorter steps move the release by less than the number of cells does."""
        if self.states is None:
            return False
        enough_V = max(self.error_V, UNDECIDED_OF_RELEASE * self.states.release_V)
        return abs(finer.release_V - self.states.release_V) <= enough_V


def solve_point(
    point: Point,
    contact: ContactSettings,
    cells: int,
    first_seed: int,
    progress: Progress | None = None,
    step_nm: float | None = None,
) -> Solved:
    """The switch of a point on a pad of so many cells; a point without an answer has the reason."""
    try:
        pad = press_pad(point, contact, cells, first_seed, step_nm=step_nm, progress=progress)
    except InputError as error:
        return Solved(point, None, None, (np.nan, np.nan), str(error))
    return solved_on(point, pad)


def solved_on(point: Point, pad: Pad) -> Solved:
    """The switch of a point on a pad that is pressed; one without an answer has the reason."""
    solved = solved_without_error(point, pad)
    if solved.states is None:
        return solved
    first, second = (release_or_nan_V(point.device, half, coarse=True) for half in pad.halves)
    return replace(solved, halves_V=(first, second))


def solved_without_error(point: Point, pad: Pad) -> Solved:
    """The same without its error by the number of cells, in a third to a half of the time."""
    try:
        states = switch_of(point.device).states(pad.curves)
    except InputError as error:
        return Solved(point, pad, None, (np.nan, np.nan), str(error))
    return Solved(point, pad, states, (np.nan, np.nan))


def press_pad(
    point: Point,
    contact: ContactSettings,
    cells: int,
    first_seed: int,
    *,
    step_nm: float | None = None,
    depths: int = DEPTHS,
    progress: Progress | None = None,
) -> Pad:
    """The pad of a point, closed as hard as its switch presses, and opened.

    Parameters
    ----------
    step_nm : of separation in and near contact, at most; None: `usual_step_nm`.
    depths : from which the pad is opened.

    Raises
    ------
    InputError : inputs that the contact does not accept, or cells that never reach the pressure.
    """
    inputs, settings = point.contact_of(contact)
    pad_cells = point.device.pad_um2 * 1e6 / settings.length_nm**2
    drawn = sample_cells(inputs, cells, first_seed, pad_cells)
    switch = switch_of(point.device.level)
    pilots = closed_until(switch.carried_by, Pilots(inputs, settings, drawn, step_nm))
    grid = pilots.grid(depths)
    return press_cells(inputs, settings, grid, drawn, progress)


def surfaces_of(number: int) -> int:
    """First seed of the surfaces of a point; number 0 is the central one."""
    return FIRST_SEED + SEEDS_APART * number


def solve_points(
    points: Sequence[tuple[int, Point]], contact: ContactSettings, cells: int
) -> Iterator[Solved]:
    """The switches of points, each with its number.

    One that is undecided has more cells, and one that nearly sticks has shorter steps.
    """
    for number, point in points:
        solved = solve_point(point, contact, cells, surfaces_of(number))
        if solved.undecided:
            solved = solve_point(point, contact, MORE_CELLS * cells, surfaces_of(number))
        if solved.nearly_sticks:
            solved = _in_shorter_steps(solved, contact, surfaces_of(number))
        yield solved


def _in_shorter_steps(solved: Solved, contact: ContactSettings, first_seed: int) -> Solved:
    """The same switch, its steps of separation halved until its release is stable."""
    inputs, _ = solved.point.contact_of(contact)
    step_nm = usual_step_nm(inputs.rms)
    cells = solved.pressed.count
    for _ in range(HALVINGS):
        step_nm *= 0.5
        finer = solve_point(solved.point, contact, cells, first_seed, step_nm=step_nm)
        if finer.states is None:
            break
        stable = solved.moves_little(finer.states)
        solved = finer
        if stable:
            break
    return solved


@dataclass(frozen=True)
class PadModel:
    """Everything that was computed of a pad: content of pad/model.h5.

    Attributes
    ----------
    central : the switch at central inputs.
    design : the points, and what is drawn for them.
    points : the switch at each of them.
    """

    central: Solved
    design: Design
    points: tuple[Solved, ...]

    @property
    def solved(self) -> NDArray[np.int_]:
        """Positions of the points that have an answer."""
        return np.flatnonzero([not point.refused for point in self.points])

    @property
    def refused(self) -> list[str]:
        """Why the others have none."""
        return [point.refused for point in self.points if point.refused]

    def states(self, name: str) -> Array:
        """A state of all solved switches, by its name in `States`, shape (solved,)."""
        solved = [point.states for point in self.points if point.states is not None]
        return np.array([getattr(states, name) for states in solved], float)
