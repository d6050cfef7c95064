"""Words that no line breaks, and lines that do.

A browser would break an option, a method's name or an angle after its hyphen, and a number from its
unit. Cells of tables have a least width, long ones everywhere and others on a phone, so that a row
is not many lines high. In what a cell of a notebook prints, a sentence goes on in the next line; a
row of columns stays, and scrolls.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import pairwise
from typing import Any

from sphinx.application import Sphinx

_COMMAND = re.compile(r'<div class="highlight-(?:console|sh)\b.*?</pre>', re.DOTALL)
_TYPED = re.compile(
    r'<div class="highlight-text\b(?=[^>]*>\s*<div class="highlight"><pre>(?:<span></span>)?'
    r"(?:\.venv\S+|quietarm|git|cd|python3?|py|pipx|uvx?) )"
)
"""Commands that no test runs, which have the fence of a text."""
_PRINTED = re.compile(
    r'(<div class="output [^"]*\bhighlight-[^"]*"><div class="highlight"><pre>)(.*?)(</pre>)',
    re.DOTALL,
)
"""What a cell of a notebook prints, and no code of one."""
_CELL = re.compile(r"<(?P<tag>t[dh])\b(?P<attributes>[^>]*)>(?P<content>.*?)</(?P=tag)>", re.DOTALL)
_LEFT_ALONE = re.compile(
    r"<(pre|script|style|svg|math|button|code|td|th)\b.*?</\1>|<[^>]*>", re.DOTALL
)
_BEFORE_ARGUMENTS = '<span class="sig-paren">(</span>'
"""Of a signature: there a name that is wider than a phone goes on in the next line."""
_NAME_ITSELF = '<span class="sig-name descname">'
"""Of a signature, behind its package: there a long one goes on in the next line."""
_LONG = re.compile(r'<span class="pre">([^<]{33,})</span>')
_HYPHENATED = re.compile(r"(?<![^\s>])[^\s<>]*-[^\s<>]*(?![^<]*>)")
_UNITS = (
    r"%|ms|us|s|h|um|mm|cm|m|kN|N(?: m)?(?: s)?(?:/rad)?|mJ|J|mW|W|kHz|Hz|deg|"
    r"rad(?:/s(?:\^[23])?)?|m/s(?:\^[23])?|kg(?: m\^2)?|g|t|kB|MB|GB|V|A|"
    r"points?|seconds?|minutes?|hours?|px"
)
_NUMBER = r"[-+]?\d[\d.,]*(?:e[-+]?\d+)?"
_WITH_UNIT = rf"(?<![\w.^/-]){_NUMBER}[ \n](?:{_UNITS})(?![\w^/])"
_NAME = r"(?<![^\s(,;\"])-?\w+(?:[-/]\w+)*[-/]\w*[A-Z0-9]\w*(?![\w-])|(?<![^\s(])-\w+(?:/\w+)?"
_IN_BRACKETS = r"\[[^\[\]\s]+(?: (?:m|s|rad)(?:\^\d)?)*\]"
_RANGE = rf"(?<![\w.]){_NUMBER} (?:to|of) {_NUMBER}(?![\w.])"
_OPTION = r"(?<![\w-])--\w[\w-]*(?:=[^\s<>,;)]+)?"
_WHOLE = re.compile(rf"{_WITH_UNIT}|{_IN_BRACKETS}|{_OPTION}|{_NAME}")
_IN_CELLS = re.compile(
    rf"{_RANGE}|{_WITH_UNIT}|{_IN_BRACKETS}|[^\s<>]+-[^\s<>]+|(?<!\S)-\w+(?:/\w+)?"
)
_WIDTH_OF_A_LETTER = 0.88
"""Of a usual one, by that of a zero."""
MOST_LETTERS = 32
"""Of a word that is kept whole: an address may break."""


def keep_whole(body: str) -> str:
    """A page with every word that must not break in an element of its own."""
    body = _TYPED.sub('<div class="highlight-sh', body)
    body = _COMMAND.sub(lambda block: _HYPHENATED.sub(_as_word, block[0]), body)
    body = body.replace(_BEFORE_ARGUMENTS, f"{_BEFORE_ARGUMENTS}<wbr>")
    body = body.replace(_NAME_ITSELF, f"<wbr>{_NAME_ITSELF}")
    body = _LONG.sub(_long_word, body)
    body = _PRINTED.sub(lambda block: block[1] + _flowing(block[2]) + block[3], body)
    body = _CELL.sub(_with_room, body)
    return _in_texts(body, lambda text: _WHOLE.sub(_as_word, text))


def _long_word(match: re.Match[str]) -> str:
    """A word of code that is wider than a phone: it breaks behind its option, or a folder."""
    option, equals, value = match[1].partition("=") if match[1].startswith("--") else ("", "", "")
    if equals and len(option) <= MOST_LETTERS:
        kept = f'<span class="pre">{option}=</span><wbr>'
        return f'{kept}<span class="pre long">{value}</span>'
    folders = re.sub(r"(?<=[\w.])/(?=\w)", "/<wbr>", match[1])
    return f'<span class="pre long">{folders}</span>'


def _as_word(match: re.Match[str]) -> str:
    """A word in an element of its own; a longer one breaks behind its commas."""
    if len(match[0]) <= MOST_LETTERS:
        return f'<span class="word">{match[0]}</span>'
    parts = re.split(r"(?<=,)", match[0])
    if len(parts) == 1:
        return match[0]
    return "<wbr>".join(f'<span class="word">{part}</span>' for part in parts)


def _in_texts(body: str, change: Callable[[str], str]) -> str:
    """A page with a change in its texts, and none in code, formulas, cells and tags."""
    pieces = list[str]()
    end = 0
    for left_alone in _LEFT_ALONE.finditer(body):
        pieces += [change(body[end : left_alone.start()]), left_alone[0]]
        end = left_alone.end()
    return "".join([*pieces, change(body[end:])])


def _flowing(printed: str) -> str:
    """What a cell prints, with every sentence in an element that goes on in the next line.

    Blocks between empty lines that have columns stay as they are: their rows scroll together.
    """
    blocks = re.split(r"(\n\s*\n)", printed)
    return "".join(block if _has_columns(block) else _flowing_block(block) for block in blocks)


def _flowing_block(block: str) -> str:
    return "\n".join(
        f'<span class="sentence">{_HYPHENATED.sub(_as_word, line)}</span>'
        if _is_sentence(line)
        else line
        for line in _joined(block.split("\n"))
    )


def _joined(lines: list[str]) -> list[str]:
    """Lines of a block, those in one that a program has broken because they were full."""
    full = 70  # letters; programs break at 80 to 90
    joined = lines[:1]
    for before, line in pairwise(lines):
        if (
            len(_text_of(before)) >= full
            and _is_indented_as(line, before)
            and _is_prose(before)
            and _is_prose(line)
        ):
            joined[-1] += f" {line.lstrip()}"
        else:
            joined.append(line)
    return joined


def _is_indented_as(line: str, before: str) -> bool:
    indents = [len(_text_of(text)) - len(_text_of(text).lstrip()) for text in (line, before)]
    return indents[0] == indents[1]


def _text_of(line: str) -> str:
    return re.sub(r"<[^>]*>", "", line)


def _has_columns(block: str) -> bool:
    """Whether a line of a block has two spaces between its words."""
    return any("  " in _text_of(line).strip() for line in block.split("\n"))


def _is_sentence(line: str) -> bool:
    """Whether a line is too long for a phone, and has words."""
    letters_on_a_phone = 40
    whole = line.count("<span") == line.count("</span>")
    return whole and len(_text_of(line).strip()) > letters_on_a_phone and _is_prose(line)


def _is_prose(line: str) -> bool:
    """Whether a line has so many words as a row of a file has not."""
    fewest_words = 5
    return len(_text_of(line).split()) >= fewest_words


def _with_room(cell: re.Match[str]) -> str:
    """A cell of a table with its least width on a phone, and its words whole."""
    letters = len(" ".join(re.sub(r"<[^>]*>", "", cell["content"]).split()))
    short = 20  # letters, up to which a cell is one line
    lines = 4  # of a longer cell
    most = 46
    room = letters if letters <= short else min(most, max(short, letters // lines))
    length = "short" if letters <= lines * short else "long"
    content = _in_texts(cell["content"], lambda text: _IN_CELLS.sub(_as_word, text))
    width = f'data-room="{length}" style="--room: {_WIDTH_OF_A_LETTER * room:.1f}ch"'
    if "style=" in cell["attributes"]:  # of a notebook's own table
        width = ""
    return f"<{cell['tag']}{cell['attributes']} {width}>{content}</{cell['tag']}>"


def _on_page(app: Sphinx, page: str, template: str, context: dict[str, Any], tree: Any) -> None:
    if body := context.get("body"):
        context["body"] = keep_whole(body)


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect with Sphinx."""
    app.connect("html-page-context", _on_page)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
