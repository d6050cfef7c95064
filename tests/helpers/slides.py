"""Where the cells of a notebook stand on slides: on one as long as they fit, answers on demand."""

import base64
import re
from itertools import pairwise

WALL = 640
"""Height of a full slide [pixels] of the 648 of `offline.py`; a higher one scrolls."""
BEGINS = ("slide", "subslide")
HIDDEN = ("%matplotlib", "# Your attempt")
"""How the code cells begin that are left out."""

_HEADINGS = {"# ": 80, "## ": 61, "###": 48}
_LINE, _PARAGRAPH, _DISPLAYED, _CELL = 27, 17, 67, 4
_CHARACTERS, _PRINTED_CHARACTERS = 101, 105
"""How many characters a line of text has, and one of what is printed."""
_PRINTED_LINE, _FOLDED_LINE, _SHOWN = 22, 17.5, 10
_LEAST = 0.9
"""A picture fills what the words leave: of its own height no less than this."""
_FENCED = re.compile(r"```.*?```", re.DOTALL)
_PICTURES = {"image/png": "", "text/html": "data:image/gif;base64,"}
"""Outputs with a picture, and what its bytes follow."""


def slide_types(cells):
    """Begin a slide at each `#` and `##`, one below it at each `###` and where one is full.

    What a code cell shows is a fragment: it appears on demand, under the question.
    """
    places, filled = [], 0
    for cell in cells:
        tall = height(cell)
        place = _place(cell, fits=filled + tall <= WALL)
        filled = tall + (0 if place in BEGINS else filled)
        places.append(place)
    return places


def height(cell):
    """About how high a cell is on a slide without code [pixels], as measured in Chromium.

    Solutions count unfolded, since a slide cannot grow.
    """
    if cell.cell_type == "markdown":
        fenced = _FENCED.findall(cell.source)
        blocks = _FENCED.sub("", cell.source).split("\n\n")
        return _CELL + sum(map(_block_height, blocks)) + sum(map(_fenced_height, fenced))
    return 0 if cell.source.startswith(HIDDEN) else sum(map(_output_height, cell.outputs))


def slide_heights(cells):
    """Heights of all slides of a notebook, in order."""
    types = slide_types(cells)
    begins = [n for n, place in enumerate(types) if place in BEGINS]
    return [
        sum(height(cell) for cell in cells[begin:end])
        for begin, end in pairwise([*begins, len(cells)])
    ]


def _place(cell, fits):
    if cell.cell_type == "code":
        if cell.source.startswith(HIDDEN):
            return "skip"
        if not cell.outputs:
            return "-"
        return "fragment" if fits else "subslide"
    if cell.source.startswith(("# ", "## ")):
        return "slide"
    return "-" if fits and not cell.source.startswith("#") else "subslide"


def _block_height(block):
    """A paragraph, a list, a displayed equation or a heading."""
    for mark, high in _HEADINGS.items():
        if block.startswith(mark):
            return high
    if block.lstrip().startswith("$$"):
        return _DISPLAYED
    if not block.strip() or block.startswith("</details>"):
        return 0
    words = re.sub(r"\\[a-zA-Z]+|[*$`{}]", "", block)
    items = re.split(r"\n(?=- |\d\. )", words)
    return _LINE * sum(-(-len(item) // _CHARACTERS) for item in items) + _PARAGRAPH


def _fenced_height(block):
    return _FOLDED_LINE * (len(block.splitlines()) - 1)


def _output_height(output):
    data = output.get("data", {})
    for kind, before in _PICTURES.items():
        begin = data.get(kind, "").find(before)
        if kind in data and begin >= 0:
            return _SHOWN + _LEAST * _picture_height(data[kind][begin + len(before) :][:32])
    text = output.get("text", data.get("text/plain", ""))
    lines = sum(-(-max(len(line), 1) // _PRINTED_CHARACTERS) for line in text.rstrip().splitlines())
    return _SHOWN + _PRINTED_LINE * lines


def _picture_height(encoded):
    """Height [pixels] that a PNG or a GIF says at its beginning."""
    content = base64.b64decode(encoded)
    if content.startswith(b"GIF"):
        return int.from_bytes(content[8:10], "little")
    return int.from_bytes(content[20:24], "big")
