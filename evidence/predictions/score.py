"""How good were the predictions that were written down before the measured value was seen?

Each file evidence/predictions/*.yaml is one prediction: date, commit, inputs, and for each value
the quantiles of its predicted distribution at `LEVELS`. Once somebody measured, a value has
`measured`, and the file its source. Scored are the share inside the central 90 % and the continuous
ranked probability score. For a prediction without a width it is the absolute error (Gneiting and
Raftery, J. Am. Stat. Assoc. 102 (2007) 359).
"""

from argparse import Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asperity.guards.foreign_yaml import load_mapping

HERE = Path(__file__).parent
LEVELS = (0.05, 0.15, 0.25, 0.35, 0.45, 0.5, 0.55, 0.65, 0.75, 0.85, 0.95)
STATED = ("what", "unit", "date", "commit", "command", "inputs", "seen_before", "values")


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each value that was predicted."""
    for path in sorted(HERE.glob("*.yaml")):
        for value in registered(path)["values"]:
            yield {
                "prediction": path.stem,
                "at": value["at"],
                **scored(value["quantiles"], value.get("measured")),
            }


def registered(path: Path) -> dict[str, Any]:
    """A prediction of a file.

    Raises
    ------
    ValueError : a key is missing, or quantiles that do not rise or are not those of `LEVELS`.
    """
    content = load_mapping(path, "prediction")
    if missing := [key for key in STATED if key not in content]:
        raise ValueError(f"{path.name}: {', '.join(missing)} missing")
    for value in content["values"]:
        quantiles = value["quantiles"]
        if len(quantiles) != len(LEVELS) or sorted(quantiles) != quantiles:
            raise ValueError(
                f"{path.name}: quantiles at {value['at']}: {len(LEVELS)} that rise are needed"
            )
    return content


def scored(quantiles: Sequence[float], measured: float | None) -> dict[str, float | bool | None]:
    """Ends and middle of a prediction; with a measured value whether it lies inside, and the
    score.
    """
    low, median, high = quantiles[0], quantiles[LEVELS.index(0.5)], quantiles[-1]
    said = {"low": low, "median": median, "high": high, "measured": measured}
    if measured is None:
        return said | {"held": None, "crps": None}
    return said | {"held": low <= measured <= high, "crps": crps(quantiles, measured)}


def crps(quantiles: Sequence[float], measured: float) -> float:
    """Twice the pinball loss over all levels, each of which stands for those nearest to it."""
    levels, below = np.array(LEVELS), measured - np.array(quantiles)
    middles = np.concatenate([[0.0], 0.5 * (levels[1:] + levels[:-1]), [1.0]])
    return float(2.0 * np.diff(middles) @ np.maximum(levels * below, (levels - 1.0) * below))


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """By prediction, of the last scoring: values inside the central 90 %, and the score over the
    median.
    """
    shown = {}
    last = {(row["prediction"], row["at"]): row for row in table if row["measured"]}
    for name in dict.fromkeys(name for name, _ in last):
        of = [row for (of_name, _), row in last.items() if of_name == name]
        shown[f"{name}_held"] = f"{sum(row['held'] == 'True' for row in of)} of {len(of)}"
        shown[f"{name}_crps"] = (
            f"{np.mean([float(row['crps']) / float(row['median']) for row in of]):.0%}"
        )
    return shown
