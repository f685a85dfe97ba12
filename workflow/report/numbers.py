"""Numbers and names as a person writes them."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from workflow.report.available import Row

SYMBOLS = {
    "hamaker": "A_H",
    "e_star": "E*",
    "h_macro": "H_macro",
    "h_prime": "H′",
    "q0": "q₀",
    "hurst": "Hurst",
    "rms": "RMS",
    "gap_cutoff": "D₀",
}
OUTPUTS = {  # shown name, unit shown, factor from the file's unit
    "d_c_nm": ("d_c", "nm", 1.0),
    "C_a_GPa_nm": ("C_a", "10⁻⁵ GPa/nm", 1e5),
    "C_r_GPa": ("C_r", "10⁻⁴ GPa", 1e4),
    "rho_r_nm": ("ρ_r", "nm", 1.0),
}
OUTPUTS |= {f"delta_{name}": (f"δ{symbol}", unit, factor) for name, (symbol, unit, factor) in OUTPUTS.items()}


def number(text: Any) -> float:
    """A number of a result file; NaN where there is none."""
    try:
        return float(text)
    except (TypeError, ValueError):
        return float("nan")


def column(rows: Iterable[Row], name: str) -> np.ndarray:
    """A numeric column; NaN where there is no number."""
    return np.array([number(row.get(name)) for row in rows], dtype=float)


def show(value: Any, digits: int = 3) -> str:
    """A number as a person writes it: `digits` significant ones, no exponent between 0.001 and 100 000."""
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
    superscript = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"{mantissa.replace('-', '−')}·10{superscript}"
