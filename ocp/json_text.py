"""Documents as JSON: as their files have them, and as their checksums are of; in one pass."""

from __future__ import annotations

import json
import re
from itertools import chain
from typing import Any, NamedTuple

import msgspec

LEAVES = frozenset({float, int, str, bool, type(None)})
"""Of JSON, and as they are."""
_ENCODER = json.JSONEncoder(allow_nan=False)
"""Made once: a file has a thousand lists of its own line."""
_SMALL = re.compile(r"0\.0000(?<!\d0\.0000)\d+")
"""Numbers below 1e-4, which msgspec writes without an exponent; it begins with letters alone, for
which a text is searched ten times as fast."""
_EXPONENT = re.compile(r"e(-?)(\d+)")
_WHOLE = re.compile(r"\.0(?=[,\]])")
_LARGE = re.compile(r"\d(?:\.\d+)?e\+\d+")
"""Numbers from 1e16 on, which are all whole."""


class Texts(NamedTuple):
    """A document, one entry a line; and its canonical text, sorted, with 1 in the place of 1.0."""

    indented: str
    canonical: str


def texts_of(document: Any, margin: str = "\n") -> Texts:
    """Both texts of a document in JSON's types; ValueError where a number is none of JSON.

    A list of numbers or texts stands on one line. The canonical text is the same however a program
    that saved a file again wrote its numbers and spaces.
    """
    inner = f"{margin}  "
    match document:
        case dict() if document:
            return _texts_of_entries(document, margin)
        case list() if document and _are_rows(document):
            row_by_row = _numbers(document)
            rows = row_by_row[1:-1].replace("], [", f"],{inner}[")
            return Texts(f"[{inner}{rows}{margin}]", _with_whole_numbers(row_by_row))
        case list() if document and _are_floats(document):
            numbers = _numbers(document)
            return Texts(numbers, _with_whole_numbers(numbers))
        case list() if not LEAVES.issuperset(map(type, document)):
            entries = [texts_of(entry, inner) for entry in document]
            indented = f",{inner}".join(entry.indented for entry in entries)
            canonical = ", ".join(entry.canonical for entry in entries)
            return Texts(f"[{inner}{indented}{margin}]", f"[{canonical}]")
    text = _ENCODER.encode(document)
    match document:
        case float():
            return Texts(text, _ENCODER.encode(_as_whole(document)))
        case list() if float in map(type, document):
            return Texts(text, _ENCODER.encode([*map(_as_whole, document)]))
    return Texts(text, text)


def _texts_of_entries(document: dict[str, Any], margin: str) -> Texts:
    inner = f"{margin}  "
    entries = {name: texts_of(entry, inner) for name, entry in document.items()}
    lines = (f"{json.dumps(name)}: {entry.indented}" for name, entry in entries.items())
    ordered = (f"{json.dumps(name)}: {entries[name].canonical}" for name in sorted(entries))
    return Texts(f"{{{inner}{f',{inner}'.join(lines)}{margin}}}", f"{{{', '.join(ordered)}}}")


def _are_rows(entries: list[Any]) -> bool:
    """Whether these are lists of floats, as the coefficients of many candidates."""
    return {list}.issuperset(map(type, entries)) and _are_floats(chain.from_iterable(entries))


def _are_floats(entries: Any) -> bool:
    return {float}.issuperset(map(type, entries))


def _numbers(entries: list[Any]) -> str:
    """Floats, or lists of them, as Python's json writes them; by msgspec in a tenth of its time."""
    text = msgspec.json.encode(entries).decode().replace(",", ", ")
    if "null" in text:  # what msgspec makes of a number that is none of JSON
        return _ENCODER.encode(entries)
    text = _EXPONENT.sub(lambda match: f"e{match[1] or '+'}{match[2]:0>2}", text)
    return _SMALL.sub(lambda match: repr(float(match[0])), text)


def _with_whole_numbers(numbers: str) -> str:
    """Floats as text with 1 in the place of 1.0, as some programs write it."""
    text = numbers.replace("-0.0,", "0,").replace("-0.0]", "0]")
    if "e+" in text:  # found ten times as fast as the pattern
        text = _LARGE.sub(lambda match: str(int(float(match[0]))), text)
    return _WHOLE.sub("", text)


def _as_whole(entry: Any) -> Any:
    """The same of one entry."""
    return int(entry) if type(entry) is float and entry.is_integer() else entry
