"""Which cells of a notebook stand on which slide, so that none is nearly blank and none overflows.

A slide begins at every heading, and at most questions and equations: a short one goes on below what
is there already. What does not fit goes on, below its question, on the next slide. Sentences are
speaker notes, unless a slide has room for them.
"""

import base64
import re
import struct
from dataclasses import dataclass, field

from nbformat.v4 import new_code_cell, new_markdown_cell, new_output

FULL = 760
"""Height up to which a slide is filled [pixels]: it is made smaller, but not too small to read."""
FULL_WITH_OUTPUT = 900
"""The same with a short output, which alone would leave the next slide nearly blank."""
FULL_WITH_PICTURE = 720
"""The same with a picture, whose letters have to be read from the last row."""
ROOM = 330
"""A slide that is less high than this has room for sentences, and follows on the one before."""
TOGETHER = 720
"""Height up to which it does [pixels]."""
WITH_SENTENCES = 600
"""Height up to which a slide without a picture has its sentences [pixels]."""
NEARLY_BLANK = 216
"""A text that is less high does not fill a slide without a program or a picture [pixels]."""
PROGRAM_LINES = 22
"""Most lines of a program on one slide; a longer one is cut before a definition."""
OUTPUT_LINES = 26
"""Most lines that are printed on one slide."""

# How high things are on a slide that is neither enlarged nor made smaller [pixels].
CODE_LINE = 23
TEXT_LINE = 32
EQUATION = 80
HEADING = 64
TABLE_ROW = 30
FILM = 430
WITHOUT_ITS_WORDS = 90
"""By which a page to drag is less high on a slide, where it has neither invitation nor foot."""
LETTERS = 95
"""Letters on a line of text."""

HIDDEN = re.compile(r"%matplotlib|# Your attempt|(?:.*\n)*from checks import ")
"""Code cells that are not on slides: settings, attempts, and what finds the checks."""
_SHOWN = re.compile(r"#|\||- |\d\. |```|<|\s*\$\$")
"""How the blocks of text begin that are on slides as they stand."""
_LIST = re.compile(r"- |1\. ")
"""How a list begins: the sentence before it, which ends with a colon, is on its slide."""
_SENTENCE_ENDS = re.compile(r"(?<=[.?!)])\s+(?=[A-Z])")
_QUESTION = re.compile(r"\*\*[^*]+\?\*\*")
_BEGINS = re.compile(rf"^(?:#|\||- |\$\$)|{_QUESTION.pattern}", re.MULTILINE)
"""What a text has that is worth a slide without a program."""
_HEADING = re.compile(r"^#+ .*", re.MULTILINE)
_FRAME = re.compile(r'<iframe[^>]*\bheight="(?P<height>\d+)"')
_FOLDED = re.compile(r"<details>.*?</details>", re.DOTALL)


@dataclass
class _Unit:
    """A text and the cells that follow it, up to the next text that begins a slide."""

    text: str
    shown: str
    said: list[str] = field(default_factory=list)
    """The sentences of the text, and those of later texts that show nothing."""
    pieces: list = field(default_factory=list)
    """Cells of one program, one output or one text each, in their order."""


def split_text(source):
    """What of a text is on its slide, and what the speaker says."""
    if "<details>" in source:
        return source, ""
    shown = []
    said = []
    blocks = source.split("\n\n")
    for block, following in zip(blocks, [*blocks[1:], ""], strict=True):
        questions = _QUESTION.findall(block)
        if _SHOWN.match(block) or ("**" in block and not questions):
            shown.append(block)
            continue
        shown += questions
        if block.endswith(":") and _LIST.match(following):
            shown.append(_SENTENCE_ENDS.split(block)[-1])
        said.append(block)
    return "\n\n".join(shown), "\n\n".join(said)


def as_slides(cells):
    """The cells with their places on slides."""
    slides = []
    for unit in _units(cells):
        following = _slides_of(unit)
        if slides and _goes_on(unit, following, slides[-1]):
            slides[-1] += [_revealed(cell) for cell in following[0]]
        elif not unit.pieces and not _BEGINS.search(unit.shown):
            slides[-1].append(_place(new_markdown_cell(unit.text), "notes"))
        else:
            slides += following
    return [cell for slide in slides for cell in slide]


def _goes_on(unit, following, slide):
    """Whether a short unit follows on a slide that has room for it."""
    height = sum(map(_height, following[0]))
    return (
        len(following) == 1
        and not unit.shown.startswith("#")
        and (not unit.pieces or height < ROOM)
        and height + sum(map(_height, slide)) < TOGETHER
    )


def _revealed(cell):
    """A cell that appears when one goes on."""
    return cell if _is_note(cell) else _place(cell, "fragment")


def _is_note(cell):
    return cell.metadata.get("slideshow", {}).get("slide_type") == "notes"


def _units(cells):
    units = []
    for cell in cells:
        if cell.cell_type == "code":
            if not HIDDEN.match(cell.source):
                units[-1].pieces += _pieces(cell)
            continue
        shown, said = split_text(cell.source)
        if "<details>" in cell.source and not shown.startswith("#"):
            units[-1].pieces.append(new_markdown_cell(shown))
        elif shown:
            units.append(_Unit(cell.source, shown, [said]))
        else:
            units[-1].said.append(said)
    return units


def _pieces(cell):
    """A program and what it shows, each in parts that fit a slide."""
    pieces = []
    if "hide-input" not in cell.metadata.get("tags", []):
        pieces += [new_code_cell(part) for part in _parts_of_program(cell.source)]
    for output in cell.outputs:
        parts = [_on_the_wall(output)]
        if output.output_type == "stream":
            texts = _parts(output.text.strip("\n").split("\n"), OUTPUT_LINES)
            parts = [new_output("stream", name=output.name, text=text) for text in texts]
        pieces += [
            new_code_cell("", outputs=[part], metadata={"tags": ["hide-input"]}) for part in parts
        ]
    return pieces


def _on_the_wall(output):
    """An output as a slide has it: a page to drag in a frame of its height without words."""
    page = output.get("data", {}).get("text/html", "")
    frame = _FRAME.search(page)
    if not frame:
        return output
    lower = str(int(frame["height"]) - WITHOUT_ITS_WORDS)
    page = page[: frame.start("height")] + lower + page[frame.end("height") :]
    return new_output(output.output_type, {**output.data, "text/html": page})


def _parts_of_program(source):
    """A program, cut before definitions where it is too long for a slide."""
    if source.count("\n") < PROGRAM_LINES:
        return [source]
    parts = [""]
    for definition in re.split(r"\n\n\n(?=\S)", source):
        joined = f"{parts[-1]}\n\n\n{definition}" if parts[-1] else definition
        if not parts[-1] or joined.count("\n") < PROGRAM_LINES:
            parts[-1] = joined
        else:
            parts.append(definition)
    return parts


def _parts(lines, most):
    """Lines in as few parts as possible, of nearly the same length."""
    count = -(-len(lines) // most)
    size = -(-len(lines) // count)
    return ["\n".join(lines[begin : begin + size]) for begin in range(0, len(lines), size)]


def _slides_of(unit):
    """The slides of a unit, one or more, each a list of cells."""
    slides = [[new_markdown_cell(unit.shown)]]
    for number, piece in enumerate(unit.pieces):
        if _begins_a_slide(slides[-1], unit, number):
            slides.append([_title(unit.shown)])
        slides[-1].append(piece)
    sentences = unit.said[:1]
    if _has_room(slides[0], unit.text):
        slides[0][0] = new_markdown_cell(unit.text)
        sentences = []
    later = "\n\n".join(filter(None, unit.said[1:]))
    with_later = sum(map(_height, slides[-1])) + _height_of_text(later)
    if later and with_later < WITH_SENTENCES and not _pictures(slides[-1]):
        slides[-1].append(_place(new_markdown_cell(later), "fragment"))
    else:
        sentences.append(later)
    notes = "\n\n".join(filter(None, sentences))
    if notes:
        slides[0].append(_place(new_markdown_cell(notes), "notes"))
    for number, cells in enumerate(slides):
        begins_section = number == 0 and unit.shown.startswith(("# ", "## "))
        _place(cells[0], "slide" if begins_section else "subslide")
    return slides


def _has_room(slide, text):
    """Whether a slide has room for all of its text."""
    height = sum(map(_height, slide))
    with_text = height - _height(slide[0]) + _height_of_text(text)
    return height < ROOM or (with_text < WITH_SENTENCES and not _pictures(slide))


def _place(cell, place):
    cell.metadata["slideshow"] = {"slide_type": place}
    return cell


def _begins_a_slide(slide, unit, number):
    """Whether a piece has to stand on the next slide, or better does, to stay with its output."""
    if len(slide) == 1 and _height_of_text(unit.text) < NEARLY_BLANK:
        return False
    piece = unit.pieces[number]
    if _is_short_output(piece) and sum(map(_height, [*slide, piece])) <= FULL_WITH_OUTPUT:
        return False
    outputs = [cell for cell in unit.pieces[number + 1 : number + 2] if not cell.source]
    together = [piece, *outputs] if piece.source else [piece]
    parts_them = _fits([_title(unit.shown), *together]) and not _fits([*slide, *together])
    return parts_them or not _fits([*slide, piece])


def _is_short_output(piece):
    return not piece.source and not _pictures([piece]) and _height(piece) < NEARLY_BLANK


def _fits(cells):
    return sum(map(_height, cells)) <= (FULL_WITH_PICTURE if _pictures(cells) else FULL)


def _pictures(cells):
    """The pictures that cells show, and films."""
    outputs = [output for cell in cells for output in cell.get("outputs", [])]
    return [
        output
        for output in outputs
        if "image/png" in output.get("data", {})
        or "<img" in output.get("data", {}).get("text/html", "")
    ]


def _title(text):
    """The last question of a text, or its heading: it stands again where a slide goes on."""
    questions = _QUESTION.findall(text)
    headings = _HEADING.findall(text)
    return new_markdown_cell((questions or headings or [""])[-1])


def _height(cell):
    """About how high a cell is on a slide [pixels]."""
    if _is_note(cell):
        return 0
    if cell.cell_type == "markdown":
        return _height_of_text(cell.source)
    if cell.source:
        return CODE_LINE * (cell.source.count("\n") + 2)
    return sum(map(_height_of_output, cell.outputs))


def _height_of_text(text):
    height = 0
    for block in _FOLDED.sub("Solution", text).split("\n\n"):
        if block.startswith("#"):
            height += HEADING
        elif block.startswith("$$"):
            height += EQUATION * max(1, block.count("\\tag"), block.count("\\displaystyle"))
        elif block.startswith("|"):
            height += TEXT_LINE * (block.count("\n") + 1)
        else:
            lines = re.split(r"\n(?=- |\d\. )", block)
            height += TEXT_LINE * (1 + sum(-(-len(line) // LETTERS) for line in lines))
    return height


def _height_of_output(output):
    data = output.get("data", {})
    if output.output_type == "stream":
        return CODE_LINE * (output.text.count("\n") + 2)
    if "image/png" in data:
        (height,) = struct.unpack(">I", base64.b64decode(data["image/png"])[20:24])
        return height
    if "text/html" in data:
        page = data["text/html"]
        if frame := _FRAME.search(page):
            return int(frame["height"])
        rows = page.count("<tr")
        return TABLE_ROW * rows if rows else FILM
    return CODE_LINE * (data.get("text/plain", "").count("\n") + 2)
