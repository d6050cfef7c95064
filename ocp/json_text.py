"""Documents as JSON: as their files have them, and as their checksums are of; and read back."""

from __future__ import annotations

import json
from typing import Any, NamedTuple

from quietarm.ocp.checks import quoted

LEAVES = frozenset({float, int, str, bool, type(None)})
"""Of JSON, and as they are."""
_ENCODER = json.JSONEncoder(allow_nan=False)
"""Made once: a file has a thousand lists of its own line."""


class Texts(NamedTuple):
    """A document, one entry a line; and its canonical text, sorted, with 1 in the place of 1.0."""

    indented: str
    canonical: str


def texts_of(document: Any, margin: str = "\n") -> Texts:
    """Both texts of a document in JSON's types; ValueError where a number is none of JSON.

    A list of numbers or texts stands on one line. The canonical text is the same however a program
    that saved a file again wrote its numbers and spaces. An entry may be `Texts` already, made with
    the margin of its place.
    """
    inner = f"{margin}  "
    match document:
        case Texts():
            return document
        case dict() if document:
            return _texts_of_entries(document, margin)
        case list() if not LEAVES.issuperset(map(type, document)):
            entries = [texts_of(entry, inner) for entry in document]
            indented = f",{inner}".join(entry.indented for entry in entries)
            canonical = ", ".join(entry.canonical for entry in entries)
            return Texts(f"[{inner}{indented}{margin}]", f"[{canonical}]")
    text = _ENCODER.encode(document)
    if ".0" not in text and "e+" not in text:  # most lists have no whole number
        return Texts(text, text)
    return Texts(text, _ENCODER.encode(_with_whole_numbers(document)))


def _texts_of_entries(document: dict[str, Any], margin: str) -> Texts:
    inner = f"{margin}  "
    entries = {name: texts_of(entry, inner) for name, entry in document.items()}
    lines = (f"{json.dumps(name)}: {entry.indented}" for name, entry in entries.items())
    ordered = (f"{json.dumps(name)}: {entries[name].canonical}" for name in sorted(entries))
    return Texts(f"{{{inner}{f',{inner}'.join(lines)}{margin}}}", f"{{{', '.join(ordered)}}}")


def _with_whole_numbers(entry: Any) -> Any:
    """A number, or a list, with 1 in the place of 1.0."""
    if type(entry) is list:
        return [*map(_with_whole_numbers, entry)]
    return int(entry) if type(entry) is float and entry.is_integer() else entry


def refuse_repeated(text: str | bytes) -> None:
    """Refuse JSON that has an entry twice; ValueError names the entry.

    Parsers disagree about such a text: most take the last entry, others the first.
    """
    json.loads(text, object_pairs_hook=_once, parse_float=str, parse_int=str)


def _once(pairs: list[tuple[str, Any]]) -> None:
    """Refuse a table in which a name comes twice."""
    names = set[str]()
    for name, _ in pairs:
        if name in names:
            raise ValueError(f"entry {quoted(name)} is given twice; give it once")
        names.add(name)
