"""Documents: blocks of text, tables, pictures and verdicts, written once and shown in three forms.

`terminal.show` prints one, `files.markdown` and `files.page` make files of it. A new form is one
more function beside these.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from quietarm.studies.document.table import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Text:
    """A paragraph; a soft one explains, and stands back."""

    words: str
    soft: bool = False


@dataclass(frozen=True)
class Bullets:
    """A list of sentences; those of a card are what is to be read first."""

    lines: Sequence[str]
    soft: bool = False
    card: bool = False


@dataclass(frozen=True)
class Facts:
    """Names and their values, one below the other."""

    rows: Sequence[tuple[str, str]]


@dataclass(frozen=True)
class Lines:
    """Lines that stay as they are: on a terminal as text, elsewhere in a fixed font."""

    lines: Sequence[str]


@dataclass(frozen=True)
class Picture:
    """A figure that is drawn when it is written; a terminal leaves it out."""

    name: str
    """Of its file, with the suffix."""
    draw: Callable[[], Figure]
    caption: str = ""
    alternative: str = ""
    """What it shows, in words, for those who do not see it."""
    narrow: bool = False


@dataclass(frozen=True)
class Verdict:
    """A claim, whether it holds, and why."""

    claim: str
    holds: bool
    evidence: Sequence[str]

    @property
    def word(self) -> str:
        """What the figures say of it."""
        return "supported" if self.holds else "refuted"


@dataclass(frozen=True)
class Grid:
    """Pictures side by side, as many as fit."""

    pictures: Sequence[Picture]


@dataclass(frozen=True)
class Section:
    """Blocks under a heading."""

    title: str
    blocks: Sequence[Block]
    screen: bool = True
    """Whether a terminal shows it as well."""


@dataclass(frozen=True)
class Contents:
    """Links to the sections, in a page."""

    titles: Sequence[str]


Block = Text | Bullets | Facts | Lines | Picture | Grid | Verdict | Section | Contents | Table


@dataclass(frozen=True)
class Document:
    """A title and blocks; and tables that are written as CSV beside it, by their names."""

    title: str
    blocks: Sequence[Block]
    data: Mapping[str, Table] = field(default_factory=dict)

    @property
    def pictures(self) -> list[Picture]:
        """Every picture, in order."""
        return [block for block in _flat(self.blocks) if isinstance(block, Picture)]


def _flat(blocks: Sequence[Block]) -> Iterator[Block]:
    """Blocks, those of sections and grids in the place of these."""
    for block in blocks:
        match block:
            case Section(_, inner) | Grid(inner):
                yield from _flat(inner)
            case _:
                yield block
