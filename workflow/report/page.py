"""Building blocks of the page: figures, tables, gates and sections."""

from collections.abc import Sequence
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
    """A table of text cells; the first `heads` columns are row headers."""

    caption: str
    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    heads: int = 1


@dataclass(frozen=True)
class Doubt:
    """A doubt, beside the numbers that it touches."""

    text: str


@dataclass(frozen=True)
class Gate:
    """Whether a number can be trusted, and why not.

    Attributes
    ----------
    used : whether anything else on the page depends on the stage.
    """

    stage: str
    passed: bool
    reasons: Sequence[str] = ()
    used: bool = True


@dataclass
class Section:
    """One part of the page."""

    anchor: str
    title: str
    lead: str
    origin: str = ""
    blocks: list[Figure | Table | Doubt] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    files: list[str] = field(default_factory=list)
    gates: list[Gate] = field(default_factory=list)

    def add(self, svg: str | None, caption: str, paper: str = "", wide: bool = False) -> None:
        """Append a figure if there was anything to draw."""
        if svg:
            self.blocks.append(Figure(svg, caption, paper, wide))


def kind(block: Figure | Table | Doubt) -> str:
    """Name of a block's class, for the template."""
    return type(block).__name__.lower()


@dataclass(frozen=True)
class Page:
    """All that the template needs."""

    scene: str
    beside_paper: bool
    answer: dict[str, Any]
    sections: Sequence[Section]
    gates: Sequence[Gate]
    limits: Sequence[str]
    provenance: Sequence[tuple[str, str]]
    live: dict[str, dict[str, Any]]
    moves: bool
    terms: Sequence[tuple[str, str]]
    files: Sequence[str]
