"""Heights along a line, from a stylus or a side view, made ready for a spectrum."""

import itertools
from dataclasses import dataclass, field, replace

import numpy as np

from mesoscale.checks import MAX_LENGTH_NM, MIN_LENGTH_NM, check_number, checked_array
from mesoscale.errors import InputError
from mesoscale.settings import TopographySettings
from mesoscale.topography.measurements.cleaning import MAX_MISSING, form_step, stand_in_steps
from mesoscale.topography.measurements.missing import without_stand_ins

MIN_POINTS = 64
THERE_AND_BACK = "measured there and back"
OVERHANG = "the line overhangs"
"""How steps begin of which the user should hear."""
MAX_POINTS = 4_000_000


@dataclass(frozen=True)
class Profile:
    """Heights measured at even steps along a line.

    Attributes
    ----------
    heights_nm : (n,) heights.
    length_nm : n times the step.
    name : what messages and results call the profile.
    resampled : the points were not at even steps and were interpolated.
    bow : the instrument's own bow is part of the heights, so that a parabola is taken off.
    steps : what has been done to the heights so far, in order, in words.
    """

    heights_nm: np.ndarray
    length_nm: float
    name: str
    resampled: bool = False
    bow: bool = False
    steps: tuple[str, ...] = field(default=())

    def __post_init__(self):
        heights = checked_array(f"{self.name}: heights_nm", self.heights_nm, "nm")
        if heights.ndim != 1:
            raise InputError(
                f"{self.name}: heights_nm has shape {heights.shape}; accepted is a line (n,)"
            )
        check_number(f"{self.name}: length_nm", self.length_nm, MIN_LENGTH_NM, MAX_LENGTH_NM, "nm")

    @property
    def step_nm(self) -> float:
        """Distance of neighbouring points."""
        return self.length_nm / len(self.heights_nm)

    @property
    def rms_nm(self) -> float:
        """RMS height about the mean."""
        return float(np.std(self.heights_nm))


def profile_of(positions_nm: np.ndarray, heights_nm: np.ndarray, name: str) -> Profile:
    """A profile at even steps from points (n,).

    Uneven points are joined by straight lines and read at their mean distance. Of a line that was
    measured there and back, the way there counts; of one that overhangs, what is seen from above.
    Points without order are sorted.

    Raises
    ------
    InputError : too few points, points without extent, or a hole among them.
    """
    count = len(positions_nm)
    if not MIN_POINTS <= count <= MAX_POINTS:
        raise InputError(
            f"{name}: a line of {count} points; accepted are {MIN_POINTS} .. {MAX_POINTS}"
        )
    heights_nm, notes = _without_missing(positions_nm, heights_nm)
    known = np.isfinite(positions_nm) & np.isfinite(heights_nm)
    x, z, done = _from_above(positions_nm[known], heights_nm[known])
    notes = (*notes, *done)
    if len(x) < MIN_POINTS or x[-1] <= x[0]:
        raise InputError(
            f"{name}: {len(x)} points with a position and a height; at least {MIN_POINTS} are"
            " needed"
        )
    gaps = np.diff(x)
    step = (x[-1] - x[0]) / (len(x) - 1)
    if gaps.max() > 16.0 * step:  # too far for a straight line
        raise InputError(
            f"{name}: a hole of {gaps.max():.3g} nm between points that are {step:.3g} nm apart; "
            "give the longer part alone"
        )
    # text files round positions: a step that is even to 1 % is even
    places = x[0] + step * np.arange(len(x))
    tolerance = 0.01 * step + 1e-4 * (x[-1] - x[0]) / len(x)
    even = np.abs(gaps - step).max() < tolerance
    rounded = np.abs(x - places).max() < 0.05 * step
    if even or rounded:
        return Profile(z, len(x) * step, name, steps=notes)
    heights = np.interp(places, x, z)
    note = f"read at even steps of {step:.3g} nm between {len(x)} uneven points"
    return Profile(heights, len(x) * step, name, resampled=True, steps=(*notes, note))


def _without_missing(x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, tuple[str, ...]]:
    """Heights with few missing points filled from neighbours along the line, and this in words.

    Numbers that stand for missing points are told. Where more are missing, they stay NaN, and so do
    those at the ends.
    """
    z, stand_ins = without_stand_ins(z)
    steps = stand_in_steps(stand_ins, len(z))
    missing = ~np.isfinite(z)
    forth = np.diff(x)
    in_order = bool(np.isfinite(x).all() and (forth > 0).all())
    if not missing.any() or not in_order or missing.mean() > MAX_MISSING:
        return z, steps
    first, last = np.flatnonzero(~missing)[[0, -1]]
    place = np.arange(len(z))
    inside = missing & (place > first) & (place < last)
    z = np.where(inside, np.interp(x, x[~missing], z[~missing]), z)
    return z, (*steps, f"filled {int(inside.sum())} missing points from their neighbours")


def _from_above(x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    """Points in rising order of x, one height a place, and in words what was done for that."""
    order = np.argsort(x, kind="stable")
    steps = np.diff(x)
    forth = steps if steps.sum() >= 0 else -steps
    if len(x) < MIN_POINTS or (forth >= 0).all():
        return x[order], z[order], ()
    turn = int(np.argmax(np.abs(x - x[0])))  # the far end of the way there
    outward = steps[:turn] * np.sign(x[turn] - x[0])
    goes_far = abs(x[turn] - x[0]) > 0.9 * np.ptp(x)
    if goes_far and (outward >= 0).all() and turn < 0.8 * len(x):
        x = x[: turn + 1]
        z = z[: turn + 1]
        order = np.argsort(x, kind="stable")
        return x[order], z[order], (f"{THERE_AND_BACK}: took the {len(x)} points of the way there",)
    back = int(np.count_nonzero(forth < 0))
    if back > 0.25 * len(steps):
        return x[order], z[order], ("sorted points that were in no order",)
    # upper envelope of all pieces of the line, on as many points
    even = np.linspace(x.min(), x.max(), len(x))
    seen = np.full(len(x), -np.inf)
    pieces = zip(itertools.pairwise(x), itertools.pairwise(z), strict=True)
    for (x1, x2), (z1, z2) in pieces:
        if x2 < x1:
            x1, x2, z1, z2 = x2, x1, z2, z1
        first, last = np.searchsorted(even, [x1 - 1e-12, x2 + 1e-12])
        heights = np.interp(even[first:last], (x1, x2), (z1, z2))
        seen[first:last] = np.maximum(seen[first:last], heights)
    return (
        even,
        seen,
        (f"{OVERHANG}: {back} of {len(steps)} steps go back, took what is seen from above",),
    )


def clean_profile(profile: Profile, settings: TopographySettings) -> Profile:
    """Subtract a line, or a parabola where the instrument bows; the step is recorded.

    Raises
    ------
    InputError : all heights are the same.
    """
    if np.ptp(profile.heights_nm) == 0:
        raise InputError(
            f"{profile.name}: all heights are equal; this is no measurement of a surface"
        )
    heights = profile.heights_nm - profile.heights_nm.mean()
    steps = profile.steps
    if settings.detrend != "none":
        x = np.linspace(-1, 1, len(heights))
        line = heights - np.polynomial.Polynomial.fit(x, heights, 1)(x)
        parabola = heights - np.polynomial.Polynomial.fit(x, heights, 2)(x)
        line_square = max(np.var(line), 1e-300)
        form = float(np.log(line_square / max(np.var(parabola), 1e-300)))
        if profile.bow or settings.detrend == "quadratic":
            heights, note = parabola, "subtracted a parabola"
        elif settings.detrend == "auto" and form > 3.5:
            # 400 lines across C ~ q^-4 without a plateau reach 3.3
            heights = parabola
            note = form_step(form)
            profile = replace(profile, bow=True)
        else:
            heights, note = line, "subtracted a line"
        steps = (*steps, note)
    return replace(profile, heights_nm=heights, steps=steps)
