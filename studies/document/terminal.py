"""Documents on a terminal, however narrow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from quietarm.studies.display.words import print_lines
from quietarm.studies.document.blocks import (
    Block,
    Bullets,
    Document,
    Facts,
    Lines,
    Section,
    Text,
    Verdict,
)
from quietarm.studies.document.table import Table
from rich import box
from rich.console import Console
from rich.padding import Padding
from rich.table import Table as ScreenTable
from rich.text import Text as ScreenText

_WIDEST = 10_000
_LEAST_VALUE = 30
"""Least width of the column of values; below it they would be broken up."""


def show(console: Console, document: Document) -> None:
    """Print a document; its pictures are left out."""
    if document.title:
        console.print(document.title, style="bold", markup=False, highlight=False)
    for block in document.blocks:
        show_block(console, block)


def show_block(console: Console, block: Block) -> None:
    """Print a block; nothing for a picture."""
    match block:
        case Text(words, soft):
            _show_line(console, words, soft)
        case Bullets(lines, soft):
            for line in lines:
                _show_line(console, f"- {line}", soft)
        case Lines(lines) if lines:
            print_lines(console, *lines)
        case Facts(rows):
            _show_facts(console, rows)
        case Table():
            show_table(console, block)
        case Verdict(claim, holds, evidence):
            style = "bold green" if holds else "bold red"
            console.print(ScreenText.assemble((block.word, style), f"  {claim}"))
            for line in evidence:
                indent = 11 if console.width >= 60 else 2
                console.print(Padding(ScreenText(line), (0, 0, 0, indent)))
        case Section(title, blocks, screen):
            if screen:
                show(console, Document(f"\n{title}", blocks))
        case _:
            pass


def _show_line(console: Console, words: str, soft: bool) -> None:
    console.print(words, style="dim" if soft else None, markup=False, highlight=False)


def _show_facts(console: Console, rows: Sequence[tuple[str, str]]) -> None:
    """In two columns, or one below the other on a narrow console."""
    if console.width < max(len(name) for name, _ in rows) + _LEAST_VALUE:
        for name, value in rows:
            print_lines(console, name, f"  {value}")
        return
    table = ScreenTable(box=None, show_header=False, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    for name, value in rows:
        table.add_row(ScreenText(name), ScreenText(value))
    console.print(table)


def show_table(console: Console, table: Table) -> None:
    """Print a table, in pieces below each other where the console is too narrow for it."""
    wide = console.options.update(max_width=_WIDEST)

    def fits(drawn: ScreenTable) -> bool:
        return console.measure(drawn, options=wide).maximum <= console.width

    whole, rows = _drawn(table), list(table.rows)
    if fits(whole):
        console.print(whole)
        return
    while rows:
        pieces = (replace(table, rows=rows[:count]) for count in range(len(rows), 0, -1))
        piece = next((piece for piece in pieces if fits(_drawn(piece, narrow=True))), None)
        if piece is None:
            piece = replace(table, rows=rows[:1])
            print_lines(console, table.title, *(f"  {name}: {text}" for name, text in piece.lines))
        else:
            console.print(_drawn(piece, narrow=True))
        rows = rows[len(piece.rows) :]


def _drawn(table: Table, *, narrow: bool = False) -> ScreenTable:
    """The table for rich's console; a narrow one breaks headings between all words."""
    drawn = ScreenTable(title=table.title, title_justify="left", box=box.SIMPLE_HEAD)
    heading, *lines = table.lines
    drawn.add_column(ScreenText(heading[0]), no_wrap=True)
    for i, name in enumerate(heading[1:], start=1):
        parts = [*name.split(), *(line[i] for line in lines)]
        width = max(map(len, parts), default=1) if narrow else None
        drawn.add_column(ScreenText(name), justify="right", width=width)
    for line in lines:
        drawn.add_row(*map(ScreenText, line))  # a unit in brackets is no markup
    return drawn
