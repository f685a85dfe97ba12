"""Names of channels and columns: which hold heights, and the direction of their scan.

The words stand in config/channels.yaml.
"""

import re
import unicodedata
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from typing import Any

import numpy as np

from asperity.guards.bundle import ROOT
from asperity.guards.foreign_yaml import load_mapping
from mesoscale.errors import InputError
from mesoscale.topography.measurements.units import BRACKETS

WORDS = ROOT / "config" / "channels.yaml"
ALONE = 4  # letters of a Latin word up to which it must stand alone
WHOLE = 2  # letters up to which a word must be the whole name: I is the current, Height I is none
MOST_NAMES = 10  # of channels in a message: a file may have hundreds
AMPERE = {"gwy", "ezd", "ibw", "jpk", "mi"}
"""Formats, by their name in SurfaceTopography, that write units of the SI: A is the ampere, not the
ångström.
"""
PARTS = re.compile(r"[^\W\d_]+|\d+|[<>=-]*[<>][<>=-]*|[\u2190-\u21ff\u25b6\u25c0\u00ab\u00bb]")
ACROSS = re.compile(
    r"\b(l(?:eft)?)\W*(?:to|[-=]*>|\u2192)\W*r(?:ight)?\b|\br(?:ight)?\W*(?:to|[-=]*>|\u2192)\W*l(?:eft)?\b",
    re.I,
)
"""From left to right (a group), or back."""
# has Strom in it, which is German for a current
ANGSTROM = re.compile(r"[a\u00e5]ngstr[o\u00f6]ms?", re.I)
CAPITALS = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


@cache
def words(kind: str) -> frozenset[str]:
    """The words of one section of config/channels.yaml."""
    rows = load_mapping(WORDS, "list of words")[kind]
    return frozenset(
        unicodedata.normalize("NFC", word).lower() for row in rows for word in row["words"]
    )


def parts_of(name: str) -> list[str]:
    """A name in small letters, split at capitals, digits, blanks, underscores and arrows."""

    def in_words(arrow: re.Match[str]) -> str:
        return " forward " if arrow[1] else " backward "

    plain = ACROSS.sub(in_words, unicodedata.normalize("NFC", name))
    spaced = CAPITALS.sub(" ", plain)
    return [name_part.lower() for name_part in PARTS.findall(spaced)]


def says(kind: str, name: str) -> bool:
    """Has a name a word of this section?"""
    name = ANGSTROM.sub(" ", name)
    name_parts = parts_of(name)
    joined = " ".join(name_parts)
    for word in words(kind):
        if word in name_parts and (
            len(word) > WHOLE or kind != "no_height" or base_of(name) == word
        ):
            return True
        inside = len(word) > ALONE or not word.isascii()
        if inside and (word in joined or word in name.lower()):
            return True
    return False


def names_other_unit(head: str) -> bool:
    """Does the head of a column name a unit that is no length? A alone may be the ångström."""
    return any(text.lower() in words("no_length") for text in BRACKETS.findall(head))


def base_of(name: str) -> str:
    """A name without its words of direction, even those that end a word, as in HEIGHTTRACE."""
    directions = words("backward") | words("forward") | words("slow")
    stems = [_without_end(part) for part in parts_of(name) if part not in directions]
    return " ".join(part for part in stems if part)


def is_backward(name: str) -> bool:
    """Was a channel of this name scanned on the way back?"""
    name_parts = parts_of(name)
    endings = tuple(word for word in words("backward") if _may_end(word))
    return any(
        name_part in words("backward") or name_part.endswith(endings) for name_part in name_parts
    )


def _may_end(word: str) -> bool:
    return len(word) > ALONE or word in ("fwd", "bwd")


def _without_end(name_part: str) -> str:
    endings = sorted(filter(_may_end, words("backward") | words("forward")), key=len, reverse=True)
    return next(
        (name_part.removesuffix(end) for end in endings if name_part.endswith(end)), name_part
    )


def holds_heights(name: str) -> bool:
    """May a channel of this name hold heights, where its unit is a length?"""
    made = says("made_of_heights", name) and not says("height", name)
    return not made and not says("no_height", name)


def listed(names: Sequence[str]) -> str:
    """Names in a message, some of many."""
    more = len(names) - MOST_NAMES
    text = ", ".join(names[:MOST_NAMES]) or "none"
    if more > 0:
        text += f" and {more} more"
    return text


def with_lengths(channels: Iterable[Any], reader: str) -> list[Any]:
    """Channels whose unit is a length, or that state none.

    Parameters
    ----------
    reader : the format, by its name in SurfaceTopography.
    """
    # some readers call a phase a height, but then its unit is no length
    heights = [item for item in channels if item.is_height_channel]
    lengths = [item for item in heights if item.unit is None or isinstance(item.unit, str)]
    return [item for item in lengths if not (reader in AMPERE and _unit_of(item) == "A")]


def _unit_of(channel: Any) -> str | None:
    """The unit of the heights as the file states it."""
    raw = (getattr(channel, "info", None) or {}).get("raw_metadata", {})
    if not isinstance(raw, dict):
        raw = {}
    for key, value in raw.items():
        if str(key).endswith("/data") and isinstance(value, dict):  # Gwyddion's
            field = value.get("GwyDataField", {})
            unit = field.get("si_unit_z", {}).get("GwySIUnit", {})
            return str(unit.get("unitstr", ""))
    return getattr(channel, "data_unit", None) or channel.unit


def height_channel(
    where: str, channels: Sequence[Any], reader: str, stated: str | None, also: Callable[[Any], str]
) -> tuple[Any, tuple[str, ...]]:
    """The channel of heights, and a note where there was a choice.

    Parameters
    ----------
    reader : the format, by its name in SurfaceTopography.
    stated : the name that the user states.
    also : what else the file leaves open of a channel, in words for a message.

    Raises
    ------
    InputError : none, or several and none of them stated.
    """
    lengths = with_lengths(channels, reader)
    pixels = {}
    for item in lengths:
        pixels[id(item)] = int(np.prod(getattr(item, "nb_grid_pts", None) or 1))
    smallest = max(pixels.values(), default=0) / 16  # of a thumbnail
    heights = [
        item for item in lengths if holds_heights(str(item.name)) and pixels[id(item)] > smallest
    ]
    names = list(dict.fromkeys(str(item.name) for item in heights))
    present = list(dict.fromkeys(str(item.name) for item in channels))
    if stated is not None:
        chosen = [item for item in heights if str(item.name) == stated]
        if not chosen and stated in present:
            raise InputError(
                f"{where}: channel {stated!r} holds no heights; those that do (--channel):"
                f" {listed(names)}"
            )
        if not chosen:
            raise InputError(
                f"{where}: no height channel {stated!r} (--channel, topography.channel); it has:"
                f" {listed(names)}"
            )
        heights = chosen
    elif len({base_of(name) for name in names}) > 1:
        called = [item for item in heights if says("height", str(item.name))]
        if len({base_of(str(item.name)) for item in called}) != 1:
            raise InputError(
                f"{where}: several height channels: {listed(names)}; name one in topography.channel"
                f" (--channel){also(heights[0])}"
            )
        heights = called
    if not heights:
        has = f"; it has {listed(present)}" if present else ""
        raise InputError(
            f"{where}: no channel of heights in a unit of length (m, um, nm, Å){has}; save the"
            " topography too, or calibrate heights that are in V"
        )
    forward = next((item for item in heights if not is_backward(str(item.name))), heights[0])
    further = len(heights) - 1
    if not further:
        return forward, ()
    return forward, (f"took {forward.name}, one of {further + 1} channels of heights",)
