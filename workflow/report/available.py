"""The result files a report may show: what exists is read, what does not exist leaves no section."""

from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from workflow.results import read_csv, read_h5, read_json

Row = dict[str, str]


class Results:
    """Result files of one scene by their path inside `results/<scene>/`.

    Only files named at the start are seen, so that a report depends on its declared inputs and on nothing
    that happens to lie beside them.
    """

    def __init__(self, root: str | Path, paths: Iterable[str | Path]) -> None:
        self.root = Path(root)
        self.paths = {Path(path).relative_to(self.root).as_posix() for path in map(Path, paths)}

    def has(self, *names: str) -> bool:
        """Are all these files there?"""
        return all(name in self.paths for name in names)

    def matching(self, prefix: str, suffix: str) -> list[str]:
        """Names that begin and end so, sorted."""
        return sorted(name for name in self.paths if name.startswith(prefix) and name.endswith(suffix))

    @cache  # noqa: B019 (one object per report)
    def csv(self, name: str) -> list[Row]:
        """Rows of a CSV file."""
        return read_csv(self.root / name)

    @cache  # noqa: B019
    def json(self, name: str) -> dict[str, Any]:
        """Content of a JSON file."""
        return read_json(self.root / name)

    @cache  # noqa: B019
    def h5(self, name: str) -> tuple[dict[str, dict[str, np.ndarray]], dict[str, Any], dict[str, dict[str, Any]]]:
        """Groups, root attributes and group attributes of an HDF5 file."""
        return read_h5(self.root / name)


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
