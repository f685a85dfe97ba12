"""Error of the shift of a held switch against run time, on switches of the scene.

The shift is that of the end of the life by the central guess: an error of it is one of the release.
"""

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from mesoscale.answer.switches import PadModel, Solved, surfaces_of
from mesoscale.charging.cycles import PER_DECADE, cycled_V
from mesoscale.charging.gaps import (
    GAPS_NM,
    PEELING,
    SEPARATIONS,
    HeldGaps,
    held_gaps,
    shares_of_pull,
)
from mesoscale.charging.lifetime import times_s
from mesoscale.charging.rates import LOST, guesses, held_s, shifts_V
from mesoscale.settings import ContactSettings, LifetimeSettings
from mesoscale.studies.driver import RELEASE, Array, Choice, Knob, Progress, StudyRow, rows_of

SWITCHES = 4
SHARES, PLACES = "shares of a lost field", "separations of the electrode"
PEELED = "separations of places about to peel off"
CLASSES = "classes of gaps"
SPACINGS_NM = (8.0, 4.0, 2.0, 1.0, 0.5)
"""Of classes; the last is that of `GAPS_NM`."""
FINEST_NM = 0.0625
STRIDES = (16, 4, 2, 1)
CYCLES = "known cycles a decade"
PER_DECADES = (5, 10, PER_DECADE, 40)
BEST_PER_DECADE = 160
COUNTS = (1, 3, SEPARATIONS, 15)
PEELING_COUNTS = (0, 1, 2, 4, 8)
BEST_PEELING = 32


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

    def gaps_by(pull_shares: Array) -> list[HeldGaps]:
        return [held_gaps(solved, contact, surfaces_of(k), pull_shares) for k, solved in switches]

    usual = gaps_by(shares_of_pull())
    finest = _finer(LOST)
    samples = f"{len(switches)} switches"

    def by_shares(lost: Array) -> Array:
        return _shifts(switches, usual, settings, lost)

    def by_spacing(spacing_nm: float) -> Array:
        return _shifts(switches, usual, settings, LOST, _classes_nm(spacing_nm))

    def by_count(count: int, peeling: int) -> Array:
        return _shifts(switches, gaps_by(shares_of_pull(count, peeling)), settings, LOST)

    best_count = partial(by_count, SEPARATIONS, BEST_PEELING)
    best = f"{SEPARATIONS + BEST_PEELING} separations"

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
                CLASSES,
                [RELEASE],
                [
                    Choice(_classes_nm(spacing).size, partial(by_spacing, spacing))
                    for spacing in SPACINGS_NM
                ],
                GAPS_NM.size,
                f"{_classes_nm(FINEST_NM).size} classes",
                partial(by_spacing, FINEST_NM),
                samples,
            ),
            Knob(
                PLACES,
                [RELEASE],
                [Choice(count, partial(by_count, count, PEELING)) for count in COUNTS],
                SEPARATIONS,
                best,
                best_count,
                samples,
            ),
            Knob(
                PEELED,
                [RELEASE],
                [
                    Choice(peeling, partial(by_count, SEPARATIONS, peeling))
                    for peeling in PEELING_COUNTS
                ],
                PEELING,
                best,
                best_count,
                samples,
            ),
        ],
        progress,
    )
    if settings.period_s is None:
        return
    end = times_s(settings)[-1:]
    rates = guesses(settings)["central"]

    def by_cycles(per_decade: int) -> Array:
        shifts = []
        for (_, solved), of_switch in zip(switches, usual, strict=True):
            device = of_switch.device
            hold_V = solved.held_V
            places = cycled_V(hold_V, GAPS_NM, end, device, settings, rates, per_decade)
            shifts.append(of_switch.mean_V(places))
        return np.array(shifts)

    yield from rows_of(
        [
            Knob(
                CYCLES,
                [RELEASE],
                [Choice(count, partial(by_cycles, count)) for count in PER_DECADES],
                PER_DECADE,
                f"{BEST_PER_DECADE} a decade",
                partial(by_cycles, BEST_PER_DECADE),
                samples,
            )
        ],
        progress,
    )


def _classes_nm(spacing_nm: float) -> Array:
    """Classes of gaps in other steps than `GAPS_NM`."""
    return np.concatenate([[0.0], np.arange(0.5 * spacing_nm, GAPS_NM[-1] + 0.25, spacing_nm)])


def _finer(lost: Array) -> Array:
    """Four times as many shares."""
    places = np.arange(lost.size)
    return np.exp(np.interp(np.linspace(0, lost.size - 1, 4 * lost.size), places, np.log(lost)))


def _shifts(
    switches: Sequence[tuple[int, Solved]],
    gaps: Sequence[HeldGaps],
    settings: LifetimeSettings,
    lost: Array,
    classes_nm: Array = GAPS_NM,
) -> Array:
    """Shift (V) of each switch at the end of its life, shape (switches, 1)."""
    end = held_s(times_s(settings)[-1:], settings)
    rates = guesses(settings)["central"]
    shifts = []
    for (_, solved), of_switch in zip(switches, gaps, strict=True):
        places = shifts_V(solved.held_V, classes_nm, end, of_switch.device, settings, rates, lost)
        shifts.append(of_switch.shares_at(classes_nm)[:-1] @ places)
    return np.array(shifts)
