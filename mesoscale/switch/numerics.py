"""Numerical choices of the switch, fixed by their measured errors (target `accuracy`); no scene
sets them.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class SwitchNumerics:
    """How a switch is solved. What the kernels of the beam take stands in
    `mesoscale.switch.beam_kernels`.

    Attributes
    ----------
    elements : of a beam. The last places that adhesion holds are some 5 um long. Releases at 24
        points of `reduced` are
        within 0.06 V of those of 512 elements (0.02 V root mean square). The attraction that sticks
        is known to 1 to 4 %.
    coarse_elements : where the halves of a pad are compared with each other: 0.08 V root mean
        square, 0.3 V at most.
    middle, landing : of lumped beams, shares of half the beam: of the last contact, 3 um of the
        default, and of what
        lands when the beam pulls in.
    rest_steps, rests_nm : Newton steps of a beam that heat or its stress moves to rest, and the
        last of them.
    rounding_nm : steps below this that do not shrink any more are rounding: of 48 lumps they stay
        at 2e-4 nm.
    landed : a place has landed where it is pushed with more than this part of the pull of the
        spring
        (`mesoscale.switch.beam.Beam.spring_Pa`), 1 kPa of the default switch.
    release_tolerance : relative error of a release.
    little : of the hold voltage: a beam that is closed at less is tried without any.
    free_steps : steps to the balance of a free beam, each from that of the voltage before.
    down : separations of the way down, from rest to touch.
    free_share : off the pad is a beam that is nowhere below this share of its separation at rest;
        it pulls in from two
        thirds.
    fold_points : separations between the end of the pad's table and the gap at rest that bracket
        the folds of a plate.
    pull_in_error : of the pull-in by the number of elements.
    edge : local over electrostatic pressure to which pads are computed at least. The edge of what
        has landed bears the
        beam, too, and presses with 1.6 to 2.3 of it on pads of Table 1.
    deepened_by : how often the pressure to which a pad was computed is doubled by continuing its
        curves.
    highest_gap_cutoff_nm : upper end of a D0 that is no input: a distance of atoms, above
        Israelachvili's 0.165 nm
        (docs/pad.md).
    undecided, of_release : error of a release from which a pad has more cells, over the pull-in
        voltage (0.6 V of the
        default switch) and over the release: what exceeds both.
    more_cells : so many times as many cells has a point that is undecided.
    seeds : between the first surfaces of two points.
    solved : share of the points that must be solved, since those that cannot be are no random part
        of them.
    resamples : of the points, for the errors of quantiles.
    """

    elements: int = 128
    coarse_elements: int = 64
    middle: float = 0.012
    landing: float = 0.56
    rest_steps: int = 200
    rests_nm: float = 1e-6
    rounding_nm: float = 1e-3
    landed: float = 0.066
    release_tolerance: float = 1e-3
    little: float = 0.05
    free_steps: int = 12
    down: int = 81
    free_share: float = 0.5
    fold_points: int = 400
    pull_in_error: float = 1e-3
    edge: float = 2.5
    deepened_by: int = 2
    highest_gap_cutoff_nm: float = 0.3
    undecided: float = 0.008
    of_release: float = 0.1
    more_cells: int = 4
    seeds: int = 1_000_000
    solved: float = 0.8
    resamples: int = 1000


SWITCH = SwitchNumerics()
"""What every scene uses."""
