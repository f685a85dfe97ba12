"""Keys of a scene: default, meaning, accepted range and unit of each, stated in one line.  Imports nothing of ours."""

import re
from typing import Any

from pydantic import Field

_INTERVAL = re.compile(r"([\[(])(\S+), (\S+)([\])])(?: (.+))?")


def key(default: Any, meaning: str, accepted: str = "", **others: Any) -> Any:
    """A field of a class of settings.

    Parameters
    ----------
    default : its default; ``...``: it must be given.
    meaning : one thought, as the documentation shows it.
    accepted : interval and unit of a quantity, such as ``"(0, 30] nm"`` or ``"[1, inf)"``; a unit alone, ``"MPa"``,
        for a list whose entries have an interval of their own; empty: what the type says.
    others : further keywords of `pydantic.Field`, such as `min_length`.
    """
    unit: str | None = accepted
    if match := _INTERVAL.fullmatch(accepted):
        left, low, high, right, unit = match.groups()
        ends = {"ge" if left == "[" else "gt": low, "le" if right == "]" else "lt": high}
        others |= {bound: _number(end) for bound, end in ends.items() if not end.endswith("inf")}
    return Field(default, description=meaning, json_schema_extra={"unit": unit} if unit else None, **others)


def _number(text: str) -> int | float:
    return int(text) if re.fullmatch(r"-?[0-9_]+", text) else float(text)
