"""Refusals of numbers and arrays that Python callers pass, each one line that says what is
accepted.
"""

import math
import os
from numbers import Integral, Real
from typing import Any

import numpy as np

from mesoscale.errors import InputError
from mesoscale.memory import SITE_MB

MIN_ROUGHNESS, MAX_ROUGHNESS = 1e-9, 1e5
"""RMS height over side beyond which the two are in different units: a factor of 1e9 misses any real
surface.
"""
MIN_LENGTH_NM, MAX_LENGTH_NM = 0.1, 1e9
FEWEST_PERIODIC = 4
"""Sites a side of a map that repeats: with fewer, neighbours on both sides are the same one."""
TILTED = 3.0
"""Tilt of a map from edge to edge, over its roughness: a wave as long as the map seems tilted by
4.3 of it, but has no cliff at its edge; of maps that were levelled, tilts are 0."""


def check_number(
    name: str, value: Any, low: float, high: float, unit: str, zero: bool = False
) -> None:
    """Refuse what is no finite real number within low .. high, both included; `zero` allows 0
    besides.

    Raises
    ------
    InputError
    """
    bounds = f"{low:g} .. {high:g}"
    if zero:
        bounds = f"0 or {bounds}"
    if unit != "1":
        bounds = f"{bounds} {unit}"
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
        raise InputError(f"{name} = {_shown(value)}: accepted is a finite number, {bounds}")
    if not (low <= float(value) <= high or (zero and value == 0)):
        raise InputError(f"{name} = {_shown(value)}: accepted is {bounds}; is it in another unit?")


def check_seed(seed: Any) -> None:
    """Refuse what is no whole number >= 0.

    Raises
    ------
    InputError
    """
    if isinstance(seed, bool) or not isinstance(seed, Integral) or seed < 0:
        raise InputError(f"seed = {_shown(seed)}: accepted is a whole number >= 0")


def machine_MB() -> int:
    """Memory of this machine, in MB."""
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 10**6


def check_memory(sites: int, mechanics: str, maps_MB: float = 0.0) -> None:
    """Refuse a surface whose contact, and maps beside it, need more memory than this machine has,
    before it is made.

    Raises
    ------
    InputError
    """
    needed = (SITE_MB[mechanics] * sites + maps_MB) / 1000
    present = machine_MB() / 1000
    if needed <= present:
        return
    contact = f"a contact of {sites} sites"
    remedy = "take a part of the surface, or every second site"
    if maps_MB:
        contact += f", with {maps_MB / 1000:.3g} GB of maps,"
        remedy += ", or fewer loads"
    raise InputError(
        f"{contact} needs {needed:.3g} GB of memory, this machine has {present:.3g}; {remedy}"
    )


def checked_array(name: str, values: Any, unit: str, missing: bool = False) -> np.ndarray:
    """Real, unmasked numbers as a contiguous array of floats, not copied if it is one already.

    They are finite, but for missing values where these are welcome.

    Raises
    ------
    InputError
    """
    if np.ma.is_masked(values):
        remedy = "make them NaN" if missing else "fill or cut missing data"
        raise InputError(f"{name}: {np.ma.count_masked(values)} values are masked; {remedy}")
    try:
        array = np.asarray(values)
    except ValueError:
        raise InputError(
            f"{name}: rows of different length; accepted is a rectangular array in {unit}"
        ) from None
    if array.dtype.kind not in "fiu":
        raise InputError(
            f"{name}: values of type {array.dtype}; accepted are real numbers in {unit}"
        )
    array = np.ascontiguousarray(array, dtype=float)
    if not missing and (strange := int(np.count_nonzero(~np.isfinite(array)))):
        raise InputError(
            f"{name}: {strange} values are not finite; accepted are numbers in {unit}; fill or cut"
            " them"
        )
    return array


def checked_heights(
    heights: Any, length_nm: float, square: bool = True, name: str = "heights"
) -> np.ndarray:
    """Heights (N, N) in nm of a square of the side `length_nm`, N >= 4; or of any rectangle from 3
    sites a side on.

    Raises
    ------
    InputError : not square, not real and finite, or heights and side in units that do not fit each
        other.
    """
    check_number("length_nm", length_nm, MIN_LENGTH_NM, MAX_LENGTH_NM, "nm")
    array = checked_array(name, heights, "nm")
    fewest = FEWEST_PERIODIC if square else 3
    if (
        array.ndim != 2
        or min(array.shape) < fewest
        or (square and array.shape[0] != array.shape[1])
    ):
        what = "a square array" if square else "a map"
        raise InputError(
            f"{name}: accepted is {what} of at least {fewest} x {fewest} sites, not {array.shape}"
        )
    rms = float(np.std(array))
    flat = rms <= 1e-12 * float(np.abs(array).max())  # to rounding
    if not flat and not MIN_ROUGHNESS <= rms / length_nm <= MAX_ROUGHNESS:
        raise InputError(
            f"{name}: RMS {rms:.3g} nm on a side of {length_nm:.3g} nm; accepted is a ratio of"
            f" {MIN_ROUGHNESS:g} .. {MAX_ROUGHNESS:g}; give both in nm"
        )
    return array


def check_periodic(heights: np.ndarray) -> None:
    """Refuse a map (N, N) that repeats, but is too small for it or tilted, so that it has a cliff
    at its edge.

    Raises
    ------
    InputError
    """
    if len(heights) < FEWEST_PERIODIC:
        raise InputError(
            f"heights: periodic maps have at least {FEWEST_PERIODIC} x {FEWEST_PERIODIC} sites, not"
            f" {heights.shape}"
        )
    position = np.linspace(-0.5, 0.5, len(heights))
    level = heights - heights.mean()
    share = position / (position @ position)
    # from one edge to the other, nm
    tilts = np.array([share @ level.mean(axis=1), share @ level.mean(axis=0)])
    cliffs = np.array([(level[-1] - level[0]).mean(), (level[:, -1] - level[:, 0]).mean()])
    rough = float(np.std(level - tilts[0] * position[:, None] - tilts[1] * position))
    for axis, tilt, cliff in zip("xy", tilts.tolist(), cliffs.tolist(), strict=True):
        if (
            min(tilt * cliff, tilt**2) > (TILTED * rough) ** 2
            and abs(tilt) > 1e-9 * np.abs(heights).max()
        ):
            raise InputError(
                f"heights: tilted by {tilt:.4g} nm along {axis}, the roughness is {rough:.3g} nm; a"
                " map that repeats would have a cliff at its edge: level it, or press it alone by"
                " asp.press(..., periodic=False)"
            )


def _shown(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    text = " ".join(repr(value).split())
    if len(text) <= 60:
        return text
    return text[:57] + "..."
