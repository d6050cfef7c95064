"""Text from files on its way into other formats, from C to HTML, and into a terminal.

A name in a URDF may hold anything. Whatever writes such a text takes the function of its format,
so that a reader of that format finds the text again and nothing else.
"""

from __future__ import annotations

import html
import json
import math
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

_KEPT = "\N{NO-BREAK SPACE}"
"""What a terminal prints although Python calls it not printable."""


def printable(text: str) -> str:
    """A text for a terminal, which would obey the control characters of a stranger's file."""
    if text.isprintable():
        return text
    whitespace = "\n\t" + _KEPT
    return "".join(
        letter if letter.isprintable() or letter in whitespace else "?" for letter in text
    )


def one_line(text: str) -> str:
    """Return a text in one line: a name with line breaks would be lines of its own making."""
    return printable(re.sub(r"[\n\r\t\v\f\x1c-\x1e\x85\u2028\u2029]+", " ", text))


def c_string(text: str) -> str:
    """A string literal of C, in ASCII, whose bytes are the text in UTF-8."""
    plain = {ord(letter): letter for letter in map(chr, range(0x20, 0x7F))}
    # of ??/ and eight more a compiler may make other letters
    plain |= {ord(letter): f"\\{letter}" for letter in '"\\?'}
    content = text.encode("utf-8", "surrogateescape")
    return '"' + "".join(plain.get(byte, f"\\{byte:03o}") for byte in content) + '"'


def c_comment(text: str) -> str:
    """Words within a comment of C, which they neither end nor begin again."""
    line = one_line(text).replace("\\", "/")  # at the end of a line it would join the next
    return re.sub(r"\*(?=/)|/(?=\*)|\?(?=\?)", lambda match: f"{match[0]} ", line)


def st_comment(text: str) -> str:
    """Words within a comment of IEC 61131-3, (* and *), which they neither end nor nest."""
    return re.sub(r"\*(?=\))|\((?=\*)", lambda match: f"{match[0]} ", one_line(text))


def st_number(value: float, digits: int = 17) -> str:
    """A real literal of IEC 61131-3, which has digits on both sides of its point."""
    if not math.isfinite(value):
        raise ValueError(f"{value} is no number of IEC 61131-3; give a finite number")
    text = repr(float(value)) if digits >= 17 else f"{value:.{digits}g}"
    mantissa, _, exponent = text.partition("e")
    mantissa = mantissa if "." in mantissa else f"{mantissa}.0"
    return f"{mantissa}E{int(exponent)}" if exponent else mantissa


def yaml_string(text: str) -> str:
    """A scalar of YAML that is read as the text; in double quotes where it holds controls."""
    if text.isprintable():
        return "'" + text.replace("'", "''") + "'"
    return '"' + "".join(map(_yaml_letter, text)) + '"'


def _yaml_letter(letter: str) -> str:
    if letter in '"\\':
        return f"\\{letter}"
    return letter if letter.isprintable() else f"\\U{ord(letter):08X}"


def csv_table(columns: Any, form: str = "%r") -> str:
    """Comma-separated values under a heading, numbers by a format such as ``%.12g``.

    A cell of no value is empty. A text never is a formula of a spreadsheet: where it would be, or
    begins with an apostrophe, it has an apostrophe in front, by which spreadsheets mark a text.

    Parameters
    ----------
    columns : mapping of str to array_like, or DataFrame
        The columns by their headings.
    form : str
        How real numbers are written; by default with every digit.
    """
    heading = [_csv_cell(str(name)) for name, _ in columns.items()]
    cells = [_csv_column(np.asarray(column), form) for _, column in columns.items()]
    return "\n".join(map(",".join, [heading, *zip(*cells, strict=True)])) + "\n"


def _csv_column(values: Any, form: str) -> list[str]:
    """The cells of a column."""
    if values.dtype.kind == "f":
        return ["" if value != value else form % value for value in values.tolist()]
    return [_csv_value(value, form) for value in values.tolist()]


def _csv_value(value: Any, form: str) -> str:
    if value is None or value != value:
        return ""
    return form % value if isinstance(value, float) else _csv_cell(str(value))


def _csv_cell(text: str) -> str:
    """A text of a table, in quotation marks where it has what parts cells and rows."""
    formula = "=+-@\t\r\n'\N{FULLWIDTH EQUALS SIGN}\N{FULLWIDTH PLUS SIGN}" + (
        "\N{FULLWIDTH HYPHEN-MINUS}\N{FULLWIDTH COMMERCIAL AT}"
    )
    number = re.fullmatch(r"[+-]?[\d.]+(e[+-]?\d+)?", text)
    if text.lstrip(" ").startswith(tuple(formula)) and not number:
        text = f"'{text}"
    if re.search(r'[",;\t\r\n\v\f\x1c-\x1e\x85\u2028\u2029]|^ | $', text):
        return '"' + text.replace('"', '""') + '"'
    return text


def matlab_names(headings: Mapping[str, Any]) -> list[str]:
    """Variables of MATLAB for the headings of a table: letters, digits and _, each of its own."""
    longest = 63  # what MATLAB reads; it drops the rest
    names = list[str]()
    for heading in headings:
        words = heading.replace("-", "minus ").replace("+", "plus ").replace(" %", "")
        name = re.sub(r"\W+", "_", words, flags=re.ASCII).strip("_")
        name = name if re.match("[A-Za-z]", name) else f"x_{name}"
        tail = name[-longest // 2 :]  # with the quantity and its unit
        name = name if len(name) <= longest else f"{name[: longest - len(tail)]}{tail}"
        number = 1
        plain = name
        while name in names:
            number += 1
            ending = f"_{number}"
            name = f"{plain[: longest - len(ending)]}{ending}"
        names.append(name)
    return names


def script_json(value: Any) -> str:
    """JSON that ends no script and speaks to no terminal, whatever the names in it are."""
    text = json.dumps(_printable_in(value), separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _printable_in(value: Any) -> Any:
    """A document whose texts are printable."""
    match value:
        case str():
            return printable(value)
        case Mapping():
            return {printable(str(name)): _printable_in(entry) for name, entry in value.items()}
        case list() | tuple() if value and not isinstance(value[0], float | int):
            return [_printable_in(entry) for entry in value]
    return value


def html_text(text: str) -> str:
    """A text within a page."""
    return html.escape(one_line(text))


class Markdown(str):
    """A text that is Markdown already, and is not escaped again."""

    __slots__ = ()


_MARKS = re.compile(
    r"[\\`*~$](?!\s)|(?<![^\W_])_(?=\S)|(?<=\S)_(?![^\W_])|<(?=[A-Za-z/!?])|(?<=\])[(\[:]"
    r"|&(?=#?\w+;)|^[#>]|^(?:[-+]|\d+[.)])(?=\s|$)|\|"
)
"""What Markdown would take for a mark: emphasis, code, a link, HTML, an entity, a cell's end."""


def markdown(text: str) -> Markdown:
    """Words within Markdown, as they are, in one line."""
    if isinstance(text, Markdown):
        return text
    return Markdown(_MARKS.sub(_escaped, one_line(text)))


def _escaped(match: re.Match[str]) -> str:
    """A mark with a backslash; of a list's number before its point."""
    return f"{match[0][:-1]}\\{match[0][-1]}"


def code(text: str) -> Markdown:
    """A text in a code span of Markdown, between more backticks than it has in a row."""
    line = one_line(text)
    longest = max(map(len, re.findall("`+", line)), default=0)
    fence = "`" * (longest + 1)
    room = " " if longest else ""
    return Markdown(f"{fence}{room}{line}{room}{fence}")


def words_of_markdown(text: str) -> str:
    """The words of a line of Markdown, without its backslashes."""
    return re.sub(r"\\([!-/:-@\[-`{-~])", r"\1", text)
