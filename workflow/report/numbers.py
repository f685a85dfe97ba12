"""Numbers and names as a person writes them."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from mesoscale.law.parameters import LAW_OUTPUTS, LawParameter
from mesoscale.settings.definitions import BY_NAME

SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
SYMBOLS = {name: row.symbol for name, row in BY_NAME.items()}


def _shown(row: LawParameter) -> tuple[str, str, float]:
    """Symbol of an output, the unit that it is shown in, and the factor from the file's unit to
    that.
    """
    power = f"10{str(row.power).translate(SUPERSCRIPT)} " if row.power else ""
    return row.symbol, power + row.unit, 10.0**-row.power


OUTPUTS = {row.name: _shown(row) for row in LAW_OUTPUTS}


def shown_unit(unit: str) -> str:
    """A unit of the result files as a person writes it; empty where there is none."""
    written = {"1": "", "um": "µm", "um^2": "µm²", "1e-18 J": "10⁻¹⁸ J", "GPa nm^0.5": "GPa nm½"}
    return written.get(unit, unit)


def number(text: Any) -> float:
    """A number of a result file; NaN where there is none."""
    try:
        return float(text)
    except (TypeError, ValueError):
        return float("nan")


def yes_or_no(flag: Any) -> str:
    """A flag of a result file, in words."""
    if flag in (True, "True"):
        return "yes"
    return "no"


def column(rows: Iterable[Mapping[str, Any]], name: str) -> np.ndarray:
    """A numeric column; NaN where there is no number."""
    return np.array([number(row.get(name)) for row in rows], dtype=float)


def show(value: Any, digits: int = 3) -> str:
    """A number as a person writes it: `digits` significant ones, no exponent between 0.001 and 100
    000.
    """
    value = number(value)
    if not np.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    size = abs(value)
    if 1e-3 <= size < 1e5:
        decimals = max(0, digits - 1 - int(np.floor(np.log10(size))))
        text = f"{value:.{decimals}f}"
        return text.replace("-", "−")
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    superscript = str(int(exponent)).translate(SUPERSCRIPT)
    return f"{mantissa.replace('-', '−')}·10{superscript}"


def cell(name: str, digits: int = 3) -> Callable[[Mapping[str, Any]], str]:
    """Column of a table: the number of this name."""
    return lambda row: show(row.get(name), digits)


def spread(
    row: Mapping[str, Any], middle: str, low: str, high: str, digits: int = 3, factor: float = 1.0
) -> str:
    """A number with its interval; a dash where there is none, the number alone without an
    interval.
    """
    value, *interval = (
        show(number(row.get(name)) * factor, digits) for name in (middle, low, high)
    )
    return f"{value} [{', '.join(interval)}]" if "–" not in (value, *interval) else value
