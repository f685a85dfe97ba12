"""Error of the shift of a held switch against run time, on switches of the scene.

The shift is that of the end of the life by the central guess: an error of it is one of the release.
"""

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from mesoscale.answer.switches import PadModel, Solved, surfaces_of
from mesoscale.charging.gaps import GAPS_NM, SEPARATIONS, HeldGaps, held_gaps
from mesoscale.charging.lifetime import times_s
from mesoscale.charging.rates import LOST, guesses, held_s, shifts_V
from mesoscale.settings import ContactSettings, LifetimeSettings
from mesoscale.studies.driver import RELEASE, Array, Choice, Knob, Progress, StudyRow, rows_of

SWITCHES = 4
SHARES, PLACES = "shares of a lost field", "separations of the electrode"
STRIDES = (16, 4, 2, 1)
COUNTS = (1, 3, SEPARATIONS, 15)
BEST_COUNT = 60


def accuracy_points(
    model: PadModel, contact: ContactSettings, settings: LifetimeSettings, progress: Progress
) -> Iterator[StudyRow]:
    """Rows of accuracy/lifetime.csv without the stage.

    Parameters
    ----------
    contact : on the grid of the pads.

    Raises
    ------
    InputError : a switch has no answer.
    """
    numbers = [0, *(int(place) + 1 for place in model.solved[: SWITCHES - 1])]
    switches = [
        (number, model.central if not number else model.points[number - 1]) for number in numbers
    ]

    def gaps_by(count: int) -> list[HeldGaps]:
        return [held_gaps(solved, contact, surfaces_of(k), count) for k, solved in switches]

    usual = gaps_by(SEPARATIONS)
    finest = _finer(LOST)
    samples = f"{len(switches)} switches"

    def by_shares(lost: Array) -> Array:
        return _shifts(switches, usual, settings, lost)

    def by_count(count: int) -> Array:
        return _shifts(switches, gaps_by(count), settings, LOST)

    yield from rows_of(
        [
            Knob(
                SHARES,
                [RELEASE],
                [
                    Choice(LOST[::stride].size, partial(by_shares, LOST[::stride]))
                    for stride in STRIDES
                ],
                LOST.size,
                f"{finest.size} shares",
                partial(by_shares, finest),
                samples,
            ),
            Knob(
                PLACES,
                [RELEASE],
                [Choice(count, partial(by_count, count)) for count in COUNTS],
                SEPARATIONS,
                f"{BEST_COUNT} separations",
                partial(by_count, BEST_COUNT),
                samples,
            ),
        ],
        progress,
    )


def _finer(lost: Array) -> Array:
    """Four times as many shares."""
    places = np.arange(lost.size)
    return np.exp(np.interp(np.linspace(0, lost.size - 1, 4 * lost.size), places, np.log(lost)))


def _shifts(
    switches: Sequence[tuple[int, Solved]],
    gaps: Sequence[HeldGaps],
    settings: LifetimeSettings,
    lost: Array,
) -> Array:
    """Shift (V) of each switch at the end of its life, shape (switches, 1)."""
    end = held_s(times_s(settings)[-1:], settings)
    rates = guesses(settings)["central"]
    shifts = []
    for (_, solved), of_switch in zip(switches, gaps, strict=True):
        assert solved.states is not None
        hold_V = solved.point.device.hold_voltage_V or solved.states.pull_in_V
        places = shifts_V(hold_V, GAPS_NM, end, of_switch.device, settings, rates, lost)
        shifts.append(of_switch.mean_V(places))
    return np.array(shifts)
