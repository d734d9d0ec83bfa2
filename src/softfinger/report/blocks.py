"""Pieces of plain text that make a page.

The template turns them into HTML.
"""

import base64
from dataclasses import dataclass
from typing import ClassVar

from matplotlib.figure import Figure

from softfinger.figures.style import render_figure

ON_SCREEN = 1.25
"""Type of seven points is small on a screen."""


@dataclass(frozen=True)
class Paragraph:
    """One paragraph; `tone` is plain, lead, note or warning."""

    kind: ClassVar[str] = "paragraph"
    text: str
    tone: str = "plain"


@dataclass(frozen=True)
class Listing:
    """A list of sentences."""

    kind: ClassVar[str] = "listing"
    items: tuple[str, ...]


@dataclass(frozen=True)
class Fragment:
    """A fixed piece of the page from the template.

    The model's equations are one.
    """

    kind: ClassVar[str] = "fragment"
    name: str


@dataclass(frozen=True)
class Cell:
    """A table's cell: text, and number behind it.

    The number serves sorting and export.
    """

    text: str
    value: float | None = None


@dataclass(frozen=True)
class Table:
    """A table with a caption.

    The caption names where its numbers come from.
    """

    kind: ClassVar[str] = "table"
    name: str
    title: str
    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    folded: bool = False

    def is_numeric(self, column: int) -> bool:
        """Whether a column contains numbers, and is flush right."""
        return any(row[column].value is not None for row in self.rows)


@dataclass(frozen=True)
class Picture:
    """A figure with alternative text and caption.

    `true_colours` stay as they are in the dark.
    """

    kind: ClassVar[str] = "picture"
    name: str
    title: str
    figure: Figure
    alt: str
    caption: str
    true_colours: bool = False

    @property
    def address(self) -> str:
        """The figure as a data address.

        The page then needs no other file.
        """
        code = base64.b64encode(render_figure(self.figure, "svg")).decode()
        return f"data:image/svg+xml;base64,{code}"

    @property
    def size(self) -> tuple[int, int]:
        """Width and height on the screen [CSS px].

        They are a little larger than on paper.
        """
        width, height = self.figure.get_size_inches() * 96 * ON_SCREEN
        return round(width), round(height)


@dataclass(frozen=True)
class Check:
    """One check against a limit.

    `passed` is None where it could not be made.
    """

    name: str
    found: str
    limit: str
    passed: bool | None
    meaning: str
    powered: bool = True

    @property
    def failed(self) -> bool:
        """Whether the check was made and not passed.

        numpy's truth values work as well.
        """
        return self.passed is not None and not self.passed

    @property
    def word(self) -> str:
        """The result in a word."""
        return {True: "passed", False: "failed", None: "not made"}[self.passed]


@dataclass(frozen=True)
class Checks:
    """Checks that answer one question together."""

    kind: ClassVar[str] = "checks"
    name: str
    title: str
    caption: str
    checks: tuple[Check, ...]


Block = Paragraph | Listing | Fragment | Table | Picture | Checks


def keep_blocks(*blocks: Block | None) -> tuple[Block, ...]:
    """Keep the blocks that there are."""
    return tuple(block for block in blocks if block is not None)


@dataclass(frozen=True)
class Section:
    """A numbered part of the page."""

    anchor: str
    title: str
    blocks: tuple[Block, ...]
    more: tuple[tuple[str, str], ...] = ()
    """Anchors of the parts that it relies on, and their names."""


@dataclass(frozen=True)
class Tile:
    """One of the verdicts at the page's head.

    `passed` is None where nothing was judged.
    """

    question: str
    answer: str
    passed: bool | None
    detail: str
    anchor: str


def text(value: object) -> Cell:
    """Make a cell of words."""
    return Cell(str(value))


def number(shown: str, value: float) -> Cell:
    """A cell of a number, short and in full."""
    return Cell(shown, float(value))
