"""Text of a stranger: shown on the terminal, in tables that a spreadsheet opens, and handed to
Snakemake.
"""

import difflib
import re
import textwrap
from collections.abc import Iterable, Sequence
from urllib.parse import quote, unquote

PLAIN = re.compile(r"[A-Za-z0-9_./-]*[A-Za-z][A-Za-z0-9_./-]*")
ENCODED = "percent:"
COLUMNS = 80
LEAST_PART = 3
"""Letters from which on a part of a name may stand for it."""
COMPUTED = "=+@\uff1d\uff0b\uff20\uff0d-"
"""Begin what a spreadsheet computes; those of full width do in the Excel of East Asia. The last is
one in brackets.
"""


def shown(text: str) -> str:
    """Text on one line without control characters: they could colour, hide or overwrite what a
    terminal shows.
    """
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape", "surrogatepass").decode() for c in text
    )


def wrapped(text: str) -> str:
    """A line broken at the 80 columns of a terminal, its rest indented; one that fits stays as it
    is.
    """
    return textwrap.fill(
        text, COLUMNS, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False
    )


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """End of a line on an unknown word: the nearest of the known ones; empty where it is known or
    none is near.
    """
    names = list(known)
    close = difflib.get_close_matches(word, names, n=1) or _with_its_parts(word, names)
    return f"; did you mean {close[0]}?" if close and close[0] != word else ""


def _with_its_parts(word: str, known: Sequence[str]) -> list[str]:
    """Known words that a part of a name stands for, the shortest first, as hold does for
    hold_voltage_V.
    """
    if len(word) < LEAST_PART:
        return []
    beginnings = word.lower().split("_")
    named = []
    for name in known:
        name_parts = name.lower().split("_")
        if all(any(part.startswith(begins) for part in name_parts) for begins in beginnings):
            named.append(name)
    return sorted(named, key=len)


def as_cell(text: str) -> str:
    """Text that a spreadsheet shows as it stands: behind an apostrophe where it would compute it.

    `=HYPERLINK(...)` would send out what stands in other cells.
    """
    # where a spreadsheet that separates by these begins a cell
    text = re.sub(rf"([;\t\r\n])(?=[{COMPUTED}])", r"\1'", text)
    if not text or text[0] not in COMPUTED + "\t\r":
        return text
    try:
        float(text)
    except ValueError:
        return f"'{text}"
    return text


def as_file_name(text: str) -> str:
    """Text as the name of a file or scene, of 100 characters at most; empty where none are left."""
    return re.sub(r"[^A-Za-z0-9_.-]+", "_", text).strip("_.-")[:100]


def as_word(text: str) -> str:
    """Text as a word that YAML, Snakemake and a shell hand on unchanged; plain names stay as they
    are.
    """
    return text if PLAIN.fullmatch(text) and text[0].isalpha() else ENCODED + quote(text)


def from_word(word: str) -> str:
    """The text that `as_word` made a word of."""
    return unquote(word.removeprefix(ENCODED)) if word.startswith(ENCODED) else word
