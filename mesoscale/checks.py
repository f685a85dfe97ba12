"""Refusals of numbers and arrays that Python callers pass, each one line that says what is accepted."""

import math
import os
from numbers import Integral, Real
from typing import Any

import numpy as np

from mesoscale.errors import InputError

MIN_ROUGHNESS, MAX_ROUGHNESS = 1e-9, 1e5
"""RMS height over side beyond which the two are in different units: a factor of 1e9 misses any real surface."""
MIN_LENGTH_NM, MAX_LENGTH_NM = 0.1, 1e9
SITE_MB = {"asperity": 62e-6, "coupled": 140e-6, "adhesive": 260e-6}  # 4096^2 sites take 1.1 GB, 1024^2 323 and 515 MB


def check_number(name: str, value: Any, low: float, high: float, unit: str, zero: bool = False) -> None:
    """Refuse what is no finite real number within low .. high, both included; `zero` allows 0 besides.

    Raises
    ------
    InputError
    """
    bounds = f"{'0 or ' if zero else ''}{low:g} .. {high:g}{' ' + unit if unit != '1' else ''}"
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


def check_memory(sites: int, mechanics: str) -> None:
    """Refuse a surface whose contact needs more memory than this machine has (InputError), before it is made."""
    needed, present = SITE_MB[mechanics] * sites / 1000, machine_MB() / 1000
    if needed > present:
        needs = f"a contact of {sites} sites needs {needed:.3g} GB of memory, this machine has {present:.3g}"
        raise InputError(f"{needs}; take a part of the surface, or every second site")


def checked_array(name: str, values: Any, unit: str, missing: bool = False) -> np.ndarray:
    """Real, unmasked numbers as a contiguous array of floats, not copied if it is one already.

    They are finite, but for missing values where these are welcome.

    Raises
    ------
    InputError
    """
    if np.ma.is_masked(values):
        raise InputError(
            f"{name}: {np.ma.count_masked(values)} values are masked; "
            f"{'make them NaN' if missing else 'fill or cut missing data'}"
        )
    try:
        array = np.asarray(values)
    except ValueError:
        raise InputError(f"{name}: rows of different length; accepted is a rectangular array in {unit}") from None
    if array.dtype.kind not in "fiu":
        raise InputError(f"{name}: values of type {array.dtype}; accepted are real numbers in {unit}")
    array = np.ascontiguousarray(array, dtype=float)
    if not missing and (strange := int(np.count_nonzero(~np.isfinite(array)))):
        raise InputError(f"{name}: {strange} values are not finite; accepted are numbers in {unit}; fill or cut them")
    return array


def checked_heights(heights: Any, length_nm: float, square: bool = True) -> np.ndarray:
    """Heights (N, N) in nm of a square of the side `length_nm`, N >= 3; or of any rectangle.

    Raises
    ------
    InputError : not square, not real and finite, or heights and side in units that do not fit each other.
    """
    check_number("length_nm", length_nm, MIN_LENGTH_NM, MAX_LENGTH_NM, "nm")
    array = checked_array("heights", heights, "nm")
    if array.ndim != 2 or min(array.shape) < 3 or (square and array.shape[0] != array.shape[1]):
        what = "a square array" if square else "a map"
        raise InputError(f"heights: accepted is {what} of at least 3 x 3 sites, not {array.shape}")
    rms = float(np.std(array))
    flat = rms <= 1e-12 * float(np.abs(array).max())  # to rounding
    if not flat and not MIN_ROUGHNESS <= rms / length_nm <= MAX_ROUGHNESS:
        raise InputError(
            f"heights: RMS {rms:.3g} nm on a side of {length_nm:.3g} nm; accepted is a ratio of {MIN_ROUGHNESS:g} .. "
            f"{MAX_ROUGHNESS:g}; give both in nm"
        )
    return array


def _shown(value: Any) -> str:
    text = " ".join((f"{value:g}" if isinstance(value, float) else repr(value)).split())
    return text if len(text) <= 60 else text[:57] + "..."
