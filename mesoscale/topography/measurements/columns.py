"""Tables of columns: which of them say where a point lies, and which how high it is."""

from dataclasses import dataclass

import numpy as np

from mesoscale.errors import InputError
from mesoscale.topography.measurements.channels import (
    base_of,
    holds_heights,
    is_backward,
    listed,
    names_other_unit,
    says,
)
from mesoscale.topography.measurements.text import Text
from mesoscale.topography.measurements.units import unit_of_head, without_unit

LINEAR = 1e-6  # of their range, to which numbers of lines run evenly with positions


@dataclass(frozen=True)
class Columns:
    """Positions and heights of a table, in the units of its heads.

    Attributes
    ----------
    positions : (n, 0), (n, 1) or (n, 2); heights alone have none.
    heights : (n,); NaN where missing.
    names : heads of the columns that were taken, the heights last; empty where no line names them.
    units : of positions and heights; None where the heads name none.
    """

    positions: np.ndarray
    heights: np.ndarray
    names: tuple[str, ...]
    units: tuple[str | None, str | None]


def columns_of(where: str, text: Text, stated: str | None) -> Columns:
    """The columns of a table that hold positions and heights, by their heads or by their order.

    Parameters
    ----------
    stated : the column of heights that the user names.

    Raises
    ------
    InputError : no column of heights, or several; no positions beside them; rows of another number
        of values.
    """
    if text.odd:
        raise InputError(
            f"{where}: {text.odd} lines among the {len(text.rows)} rows of {text.width} values have"
            " another number of them; is the file complete?"
        )
    values = text.values()
    if text.heads:
        places, height = _by_heads(where, text.heads, stated)
    else:
        if stated is not None:
            raise InputError(
                f"{where}: no line names the columns, so that none is {stated!r} (--channel)"
            )
        places, height = _by_order(where, values)
    places = _without_constant(values, places)
    names: tuple[str, ...] = ()
    if text.heads:
        names = tuple(text.heads[k] for k in (*places, height))
    units = [unit_of_head(name) for name in names]
    position_unit = next((unit for unit in units[:-1] if unit), None)
    height_unit = units[-1] if units else None
    return Columns(values[:, places], values[:, height], names, (position_unit, height_unit))


def _by_heads(where: str, heads: tuple[str, ...], stated: str | None) -> tuple[list[int], int]:
    """Places of the columns of positions, and of the one of heights."""
    names = [without_unit(head) for head in heads]
    lengths = [not names_other_unit(head) for head in heads]
    may_be = [length and holds_heights(name) for length, name in zip(lengths, names, strict=True)]
    positions = [k for k, name in enumerate(names) if lengths[k] and says("position", name)]
    called_height = [
        length and says("height", name) for length, name in zip(may_be, names, strict=True)
    ]
    heights = [k for k in range(len(names)) if called_height[k] and k not in positions]
    if stated is not None:
        heights = [k for k, head in enumerate(heads) if stated in (head, names[k])]
        if not heights:
            raise InputError(f"{where}: no column {stated!r} (--channel); it has: {listed(heads)}")
        if not may_be[heights[0]]:
            raise InputError(f"{where}: column {stated!r} holds no heights (--channel)")
    if not heights and len(heads) <= 3 and may_be[-1]:  # X and y1, distance and raw
        heights = [len(heads) - 1]
        positions = [k for k in positions if k < len(heads) - 1]
    # a curve of one height over another
    if len({base_of(names[k]) for k in heights}) > 1 and len(heads) == 2:
        heights = []
    if not heights:
        raise InputError(
            f"{where}: a table of {listed(heads)}, in which no column holds heights of a surface;"
            " give a line of distance and height, or a map"
        )
    if len({base_of(names[k]) for k in heights}) > 1:
        raise InputError(
            f"{where}: several columns of heights: {listed([heads[k] for k in heights])}; name one"
            " in topography.channel (--channel)"
        )
    height = next((k for k in heights if not is_backward(names[k])), heights[0])
    if not positions and len(heads) == 1:
        return [], height
    if not positions and len(heads) <= 3:
        other = [k for k in range(len(heads)) if k != height and may_be[k]]
        positions = [k for k in other if not says("height", names[k])]
    if not 1 <= len(positions) <= 2:
        raise InputError(
            f"{where}: a table of {listed(heads)}: {heads[height]} stands over no distance along"
            " the surface; give a line of distance and height, or a map"
        )
    return positions, height


def _by_order(where: str, values: np.ndarray) -> tuple[list[int], int]:
    """Places of positions and heights in a table without heads."""
    width = values.shape[1]
    if width > 3:
        raise InputError(
            f"{where}: {width} columns that no line names: neither a map, which has at least 32 a"
            " side, nor points x, y, z; name the columns in a line above them"
        )
    if width == 3 and _runs_with(values[:, 0], values[:, 1]):  # numbers of points before positions
        return [1], 2
    return list(range(width - 1)), width - 1


def _runs_with(first: np.ndarray, second: np.ndarray) -> bool:
    """Is one column a linear function of the other?"""
    known = np.isfinite(first) & np.isfinite(second)
    first = first[known]
    second = second[known]
    if len(first) < 3 or np.ptp(first) == 0 or np.ptp(second) == 0:
        return False
    fitted = np.polyval(np.polyfit(second, first, 1), second)
    return bool(np.abs(first - fitted).max() < LINEAR * np.ptp(first))


def _without_constant(values: np.ndarray, places: list[int]) -> list[int]:
    """Positions that change: a line across a map has one place along the other axis."""
    if len(places) < 2:
        return places
    highest = np.nanmax(values[:, places], axis=0)
    lowest = np.nanmin(values[:, places], axis=0)
    changing = [k for k, top, bottom in zip(places, highest, lowest, strict=True) if top > bottom]
    return changing or places[:1]
