"""Building blocks of the page: figures, tables, gates, sections and parts."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Any

COMPUTED, LITERATURE, SYNTHETIC = "computed", "literature", "synthetic"


@dataclass(frozen=True)
class Figure:
    """An SVG with its caption; `paper` names the paper's figure that it corresponds to."""

    svg: str
    caption: str
    paper: str = ""
    wide: bool = False


@dataclass(frozen=True)
class Table:
    """A table of text cells.

    Attributes
    ----------
    heads : columns from the left that are row headers.
    faint : first cells of the rows that are greyed, as their numbers are not to be trusted.
    """

    caption: str
    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    heads: int = 1
    faint: Collection[str] = ()


@dataclass(frozen=True)
class Doubt:
    """A doubt, beside the numbers that it touches."""

    text: str


Block = Figure | Table | Doubt


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


@dataclass
class Section:
    """How the numbers of one stage came about: folded on the page, but for `front`."""

    anchor: str
    title: str
    lead: str
    origin: str = ""
    front: list[Block] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    files: list[str] = field(default_factory=list)

    def add(self, svg: str | None, caption: str, paper: str = "", wide: bool = False, front: bool = False) -> None:
        """Append a figure if there was anything to draw."""
        if svg:
            (self.front if front else self.blocks).append(Figure(svg, caption, paper, wide))


def kind(block: Block) -> str:
    """Name of a block's class, for the template."""
    return type(block).__name__.lower()


@dataclass(frozen=True)
class Part:
    """One of the parts of the page."""

    anchor: str
    title: str
    sections: Sequence[Section]


@dataclass(frozen=True)
class Page:
    """All that the template needs."""

    scene: str
    beside_paper: bool
    first: Any
    parts: Sequence[Part]
    studies: Sequence[Section]
    light: tuple[str, str]
    gates: Sequence[Gate]
    limits: Sequence[str]
    provenance: Sequence[tuple[str, str]]
    live: dict[str, dict[str, Any]]
    moves: bool
    terms: Sequence[tuple[str, str]]
    files: Sequence[str]
