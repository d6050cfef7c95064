"""A document says the same on a terminal, in Markdown and on a page that stands alone."""

import io
import xml.etree.ElementTree as ElementTree

import pytest
from matplotlib.figure import Figure
from quietarm.studies.document.blocks import (
    Bullets,
    Contents,
    Document,
    Facts,
    Grid,
    Lines,
    Picture,
    Section,
    Text,
    Verdict,
)
from quietarm.studies.document.files import markdown, page
from quietarm.studies.document.table import Column, Table
from quietarm.studies.document.terminal import show
from rich.console import Console

NASTY = '<script>alert("1 & 2")</script>'


def line():
    figure = Figure(figsize=(2, 1))
    figure.subplots().plot([0, 1], [0, 1])
    return figure


TABLE = Table(
    "Energies",
    [Column("method"), Column("energy [J]", "{:.2f}".format), Column("  quartiles")],
    [["NSGA-II", 0.123, "1 to 2"], ["VEPSO", None, None]],
)
DOCUMENT = Document(
    NASTY,
    [
        Contents(["What was found"]),
        Section(
            "What was found",
            [
                Text("A paragraph & more."),
                Bullets(["one [bold]", "two"], card=True),
                Facts([("energy F2", "0.1 J")]),
                TABLE,
                Verdict("It is quieter.", True, ["0.1 against 0.2 mm"]),
            ],
        ),
        Picture("line.png", line, "A line & no more", "A line."),
        Grid([Picture("other.svg", line, "Another")]),
        Lines(["@article{key}"]),
    ],
    {"energies": TABLE},
)
WORDS = ["A paragraph & more.", "one [bold]", "energy F2", "0.1 J", "0.12", "quartiles",
         "It is quieter.", "0.1 against 0.2 mm", "What was found"]  # fmt: skip


def on_a_terminal(width):
    console = Console(file=io.StringIO(), width=width)
    show(console, DOCUMENT)
    return console.file.getvalue()


def of_the_page():
    text = page(DOCUMENT)
    assert text.startswith("<!DOCTYPE html>\n")
    return ElementTree.fromstring(text)


@pytest.mark.parametrize("form", ["terminal", "narrow", "markdown", "page"])
def test_every_form_holds_every_word_and_number(form):
    text = {
        "terminal": lambda: on_a_terminal(80),
        "narrow": lambda: on_a_terminal(34),
        "markdown": lambda: markdown(DOCUMENT),
        "page": lambda: "".join(of_the_page().itertext()),
    }[form]()
    assert [word for word in (*WORDS, NASTY) if word not in text] == []
