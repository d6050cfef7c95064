"""Saved answers with an entry that is wrong."""

import json
from pathlib import Path


def edit(path, place, value):
    """Change the entry at a place such as `points/1/energy`, by a function or to a value."""
    document = inner = json.loads(Path(path).read_text())
    *outer, last = (int(name) if name.isdecimal() else name for name in place.split("/"))
    for name in outer:
        inner = inner[name]
    inner[last] = value(inner[last]) if callable(value) else value
    Path(path).write_text(json.dumps(document))


def with_whole_numbers(entry):
    """An entry of a document with 1 in the place of 1.0, as checksums are of."""
    if isinstance(entry, dict):
        return {name: with_whole_numbers(value) for name, value in entry.items()}
    if isinstance(entry, list):
        return [with_whole_numbers(value) for value in entry]
    return int(entry) if isinstance(entry, float) and entry.is_integer() else entry
