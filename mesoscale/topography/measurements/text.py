"""Text as programs of many countries export it: rows of numbers, and what the lines above them say.

Decimal commas, semicolons, quotes, encodings and exponents such as 1.0D-3 are understood. A word
among numbers stands for a missing point, so that no row of a map is lost.
"""

import csv
import re
import tempfile
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

HEAD_BYTES = 8192  # in which a file shows whether it is text
SAMPLE, SAMPLE_WORDS = 60, 30  # lines by which separators are told, and words of each
SEPARATORS = ("\t", ";", ",", None)  # None: blanks
PLAIN = str.maketrans("", "", "0123456789+-.eE \t")
BARE_SIGNS = re.compile(r"(?:^|\s)[-+.eE]+(?=\s|$)")
NUMBER = re.compile(r"[-+\u2212]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+\u2212]?\d+)?")
WITH_COMMA = re.compile(r"[-+\u2212]?\d*,\d+(?:[eEdD][-+]?\d+)?")
COMMENT = "#%!*/ \t"
NAME = re.compile(r"[^\s(\[]+(?:\s*[(\[][^)\]]*[)\]])?")
BROADEST_TABLE = 31  # columns: more are a map


@dataclass(frozen=True)
class Text:
    """A text with rows of numbers.

    Attributes
    ----------
    header : lines before the first row.
    rows : of as many values each, as text; one that is no number stands for a missing point.
    width : values of a row.
    odd : lines among the rows with numbers, but not as many as a row has.
    comma : numbers have decimal commas.
    plain : a reader of numbers takes the rows as they are.
    """

    header: tuple[str, ...]
    rows: tuple[Sequence[str] | str, ...]
    separator: str | None
    width: int
    odd: int
    comma: bool
    plain: bool

    def values(self) -> np.ndarray:
        """(rows, width) numbers; NaN where there is none."""
        split = (self._split(row) for row in self.rows)
        return np.array([[self._number(word) for word in words] for words in split])

    @cached_property
    def words(self) -> Counter[str]:
        """Words among the numbers, which stand for missing points, and how often each does."""
        if self.plain:
            return Counter()
        split = (self._split(row) for row in self.rows)
        return Counter(word for words in split for word in words if not self._is_number(word))

    @cached_property
    def heads(self) -> tuple[str, ...]:
        """Names of the columns with their units; empty where no line names them."""
        lines = [line.strip(COMMENT) for line in self.header if line.strip(COMMENT)][-2:]
        named = [self._names(line) for line in lines]
        if not named or not named[-1]:
            return ()
        last = named[-1]
        units = all(re.fullmatch(r"[\[(]?[^\s\])]{0,12}[\])]?", word) for word in last)
        if len(named) < 2 or not named[0] or not units:
            return last
        first = named[0]
        if any(re.search(r"[(\[]", word) for word in first):
            return last
        # a line of names, then one of units
        pairs = zip(first, last, strict=True)
        return tuple(f"{name} ({unit.strip('[]()')})" for name, unit in pairs)

    def _names(self, line: str) -> tuple[str, ...]:
        """As many names as there are columns; none where the line has another number of them."""
        by_separator = _split(line, self.separator)
        for pieces in (by_separator, NAME.findall(line), re.split(r"\s{2,}|\t", line)):
            words = [word for word in (word.strip() for word in pieces) if word]
            if len(words) == self.width and all(re.search(r"[^\W\d]|#", word) for word in words):
                return tuple(words)
        return ()

    def copy(self, name: str) -> Path:
        """A file with decimal points, tabs and UTF-8, and `nan` where a value is missing."""
        path = Path(tempfile.mkdtemp()) / name
        header = self.header
        if self.comma:
            header = tuple(re.sub(r"(?<=\d),(?=\d)", ".", line) for line in header)
        split = (self._split(row) for row in self.rows)
        rows = ("\t".join(self._plain(word) for word in words) for words in split)
        path.write_text("\n".join((*header, *rows)) + "\n", encoding="utf-8")
        return path

    def _split(self, row: Sequence[str] | str) -> Sequence[str]:
        if isinstance(row, str):
            return _split(row, self.separator)
        return row

    def _is_number(self, word: str) -> bool:
        return _as_number(word, self.comma) is not None

    def _number(self, word: str) -> float:
        return float(_as_number(word, self.comma) or "nan")

    def _plain(self, word: str) -> str:
        return _as_number(word, self.comma) or "nan"


def text_of(raw: bytes) -> Text | None:
    """The rows of a text; None of a file that is no text, or has no rows of numbers.

    Text is what begins without signs that do not print, and has no byte 0 unless it is UTF-16.
    """
    text = decoded(raw)
    if text is None:
        return None
    lines = text.splitlines()
    separator, comma = _layout(lines)
    places, rows, width = _rows(lines, separator, comma)
    if not places:
        return None
    first = places[0]
    last = places[-1]
    # a line more: the last may be cut
    all_lines = range(first, min(last + 2, len(lines)))
    between = set(all_lines) - set(places)
    odd = sum(_numeric(_split(lines[k], separator), comma) for k in between)
    as_it_is = raw.isascii() or (raw[:3] != b"\xef\xbb\xbf" and _is_utf8(raw))
    unbroken = all(isinstance(row, str) for row in rows)
    plain = as_it_is and separator in ("\t", None) and not comma and unbroken
    return Text(tuple(lines[:first]), tuple(rows), separator, width, odd, comma, plain)


def _is_utf8(raw: bytes) -> bool:
    try:
        raw.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


def decoded(raw: bytes) -> str | None:
    """Text of bytes in UTF-8, UTF-16 with its mark, or Latin-1; None of what is no text."""
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff") and raw[:4] != b"\xff\xfe\x00\x00":
        try:
            return raw.decode("utf-16")
        except UnicodeDecodeError:
            return None
    if not raw or any(byte < 9 or 13 < byte < 32 for byte in raw[:HEAD_BYTES]) or b"\0" in raw:
        return None
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _layout(lines: Sequence[str]) -> tuple[str | None, bool]:
    """Separator of values, and whether numbers have decimal commas."""
    numbers = [line for line in lines if re.search(r"\d", line)]
    # past most of a header
    sample = numbers[len(numbers) // 4 :: max(1, len(numbers) // SAMPLE)][:SAMPLE]
    if _one_column(sample):
        return None, True
    best = 0.0
    layout = (None, False)
    for comma in (False, True):
        for separator in SEPARATORS:
            score = _understood(sample, separator, comma)
            if score > best:
                best = score
                layout = (separator, comma)
    return layout


def _understood(sample: Sequence[str], separator: str | None, comma: bool) -> float:
    """How many words of these lines are numbers, less where others are beside them."""
    score = 0.0
    for line in sample:
        # empty places are missing points
        words = [word for word in _split(line, separator) if word][:SAMPLE_WORDS]
        numbers = sum(_as_number(word, comma) is not None for word in words)
        score += numbers**2 / max(1, len(words))
    return score


def _one_column(sample: Sequence[str]) -> bool:
    """Are these heights with decimal commas, one a line, and no pairs of whole numbers?"""
    if not sample or not all(WITH_COMMA.fullmatch(line.strip().strip('"')) for line in sample):
        return False
    whole_words = (line.split(",")[0] for line in sample)
    first = np.array([float(re.sub(r"[^\d-]", "", word) or 0) for word in whole_words])
    return not (np.diff(first) > 0).all()


def _rows(
    lines: Sequence[str], separator: str | None, comma: bool
) -> tuple[list[int], list[Sequence[str] | str], int]:
    """Places of the rows, the rows and their width; a row that readers take stays a line."""
    plain: dict[int, int] = {}  # width by place
    worded: dict[int, list[str]] = {}
    for place, line in enumerate(lines):
        if separator in ("\t", None) and not line.translate(PLAIN) and not BARE_SIGNS.search(line):
            count = len(line.split())
            if count and (separator is None or count == line.count("\t") + 1):
                plain[place] = count
                continue
        if line.strip():
            worded[place] = list(_split(line, separator))
    numeric = {place for place, words in worded.items() if _numeric(words, comma)}
    widths = Counter(plain.values()) + Counter(len(worded[place]) for place in numeric)
    if not widths:
        return [], [], 0
    width = widths.most_common(1)[0][0]
    rows: dict[int, Sequence[str] | str] = {}
    rows |= {place: lines[place] for place, count in plain.items() if count == width}
    for place in numeric:
        words = worded[place]
        if separator is not None and len(words) < width <= lines[place].count(separator) + 1:
            words += [""] * (width - len(words))  # the last values are missing
        if len(words) == width:
            rows[place] = words
    first = min(rows)
    last = max(rows)
    for place, words in worded.items():  # a row of words alone, among rows of numbers
        may_be_lost = len(words) == width and (width > 3 or width == 1 or len(set(words)) == 1)
        inside = first < place < last and place not in numeric
        short = not any(len(word) > 12 for word in words)
        if inside and may_be_lost and short:
            rows[place] = words
    places = sorted(rows)
    return places, [rows[place] for place in places], width


def _numeric(words: Sequence[str], comma: bool) -> bool:
    """Are at least half of the words numbers?"""
    numbers = sum(_as_number(word, comma) is not None for word in words)
    return numbers > 0 and 2 * numbers >= sum(bool(word) for word in words)


def _split(line: str, separator: str | None) -> Sequence[str]:
    """Words of a line; an empty place between separators is a word, after the last it is none."""
    if separator is None:
        return line.replace('"', "").split()
    if '"' in line:
        pieces = next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    else:
        pieces = line.split(separator)
    words = [word.strip().strip('"').strip() for word in pieces]
    while words and not words[-1]:
        words.pop()
    return words


def _as_number(word: str, comma: bool) -> str | None:
    """A number as Python reads it; None of what is none."""
    if comma and word.count(",") == 1 and "." not in word:
        word = word.replace(",", ".", 1)
    if not NUMBER.fullmatch(word):
        return None
    return word.replace("D", "e").replace("d", "e").replace("\u2212", "-")
