"""Saved answers with an entry that is wrong."""

import hashlib
import json
from pathlib import Path


def edit(path, place, value, *, seal=True):
    """Change the entry at a place such as `points/1/energy`, by a function or to a value.

    A file with a checksum gets that of what it says then; without `seal` it keeps the old one.
    """
    document = inner = json.loads(Path(path).read_text())
    *outer, last = (int(name) if name.isdecimal() else name for name in place.split("/"))
    for name in outer:
        inner = inner[name]
    inner[last] = value(inner[last]) if callable(value) else value
    if seal and "checksum" in document:
        renew_checksum(document)
    Path(path).write_text(json.dumps(document))


def renew_checksum(document):
    """Give a document the checksum of its entries, as whoever computes it can."""
    document.pop("checksum", None)
    text = json.dumps(with_whole_numbers(document), sort_keys=True)
    document["checksum"] = hashlib.sha256(text.encode()).hexdigest()[:32]


def with_whole_numbers(entry):
    """An entry of a document with 1 in the place of 1.0, as checksums are of."""
    if isinstance(entry, dict):
        return {name: with_whole_numbers(value) for name, value in entry.items()}
    if isinstance(entry, list):
        return [with_whole_numbers(value) for value in entry]
    return int(entry) if isinstance(entry, float) and entry.is_integer() else entry
