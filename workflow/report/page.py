"""Building blocks of the page; a stage of it is a title, its files, and a generator of blocks."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from workflow.report.available import COMPUTED, Results


@dataclass(frozen=True)
class Figure:
    """An SVG with its caption; `paper` names the paper's figure that it corresponds to.

    Attributes
    ----------
    svg : the picture; without one, the figure is left out.
    front : whether it stands on the page itself, not folded away with how the numbers came about.
    """

    svg: str | None
    caption: str
    paper: str = ""
    wide: bool = False
    front: bool = False


@dataclass(frozen=True)
class PageTable:
    """A table of text cells.

    Attributes
    ----------
    heads : columns from the left that are row headers.
    faint : first cells of the rows that are greyed, as their numbers are not to be trusted.
    front : as of a figure.
    """

    caption: str
    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    heads: int = 1
    faint: Collection[str] = ()
    front: bool = False


@dataclass(frozen=True)
class DoubtNote:
    """A doubt, beside the numbers that it touches."""

    text: str


Block = str | Figure | PageTable | DoubtNote
"""Text is a note, which stands below the figures and tables."""
CellText = str | Callable[[Any], str | None]


@dataclass(frozen=True)
class Gate:
    """Whether a number can be trusted, and why not.

    Attributes
    ----------
    used : whether anything else on the page depends on the stage.
    answer : whether the release on the first screen rests on it.
    """

    stage: str
    passed: bool
    reasons: Sequence[str] = ()
    used: bool = True
    answer: bool = True


@dataclass(frozen=True)
class Section:
    """How the numbers of one stage came about: folded on the page, but for `front`."""

    anchor: str
    title: str
    lead: str
    origin: str
    blocks: Sequence[Block]
    files: Sequence[str]

    @property
    def front(self) -> list[Block]:
        """What stands on the page itself."""
        return [block for block in self.blocks if getattr(block, "front", False)]

    @property
    def folded(self) -> list[Block]:
        """Figures, tables and doubts, then the notes."""
        folded_blocks = [block for block in self.blocks if not getattr(block, "front", False)]
        return sorted(folded_blocks, key=lambda block: isinstance(block, str))


def section(
    anchor: str,
    title: str,
    lead: str,
    blocks: Iterable[Block],
    files: Sequence[str],
    origin: str = COMPUTED,
) -> Section:
    """A section without the figures that have nothing to draw."""
    drawn = [block for block in blocks if not isinstance(block, Figure) or block.svg]
    return Section(anchor, title, lead, origin, drawn, files)


def stage(
    title: str, *needs: str, also: Sequence[str] = ()
) -> Callable[[Callable[[Results], Iterator[Block]]], Callable[[Results], Section | None]]:
    """Make of a generator, which yields the lead and then blocks, what the page says of the stage
    of its module.

    Parameters
    ----------
    needs : result files without which the page has no such section.
    also : files that are linked where they are there.
    """

    def declare(build: Callable[[Results], Iterator[Block]]) -> Callable[[Results], Section | None]:
        anchor = build.__module__.rpartition(".")[2].replace("_", "-")

        def describe(results: Results) -> Section | None:
            if not results.has(*needs):
                return None
            lead, *blocks = build(results)
            files = [*needs, *(name for name in also if results.has(name))]
            return section(anchor, title, str(lead), blocks, files, results.origin_of(anchor))

        return describe

    return declare


def table(
    caption: str,
    rows: Iterable[Mapping[str, Any]],
    columns: Mapping[str, CellText],
    heads: int = 1,
    faint: Collection[str] = (),
    front: bool = False,
) -> PageTable:
    """Rows of a result file under column heads; a column is the key of its text, or a function of
    the row.
    """
    lines = [tuple(_text(row, column) or "–" for column in columns.values()) for row in rows]
    return PageTable(caption, tuple(columns), lines, heads, faint, front)


def _text(row: Mapping[str, Any], column: CellText) -> str:
    return str(row.get(column, "")) if isinstance(column, str) else column(row) or ""
