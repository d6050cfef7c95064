"""Keep a search in a checkpoint as it goes, and go on from one."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quietarm.metaheuristics.runs.checkpoint import load_checkpoint, save_checkpoint
from quietarm.metaheuristics.runs.loop import Loop
from quietarm.metaheuristics.runs.progress import SearchProgress
from quietarm.metaheuristics.runs.settings import SearchSpec, search_versions
from quietarm.ocp.answers.documents import plain, reading, typed

CHECKPOINT_SECONDS = 2.0


@dataclass(frozen=True)
class Header:
    """What the search of a checkpoint is, and the versions of what computed it."""

    search: SearchSpec
    versions: Mapping[str, str]


class Keeper:
    """Writes the state of a search to a file, every `CHECKPOINT_SECONDS` and at the end.

    A search is not lost with its checkpoint: where that cannot be written the search goes on, and
    the next write is tried all the same.
    """

    def __init__(self, loop: Loop, path: str | Path) -> None:
        self._loop, self._path, self._written = loop, path, time.perf_counter()

    def after_generation(self, progress: SearchProgress) -> None:
        """Write the state if the last one is old enough."""
        if time.perf_counter() - self._written > CHECKPOINT_SECONDS:
            self.write()
            self._written = time.perf_counter()

    def write(self) -> str:
        """Write the state; the reason where it cannot be written, else nothing."""
        try:
            header = plain(Header(self._loop.spec, _versions()))
            save_checkpoint(self._path, header, self._loop.state())
        except ValueError as error:
            return str(error)
        return ""


def resume_from(path: str | Path, loop: Loop) -> None:
    """Let a search go on from a checkpoint; the file is left as it was.

    Other versions are refused too: the objectives kept in the file would be compared with those of
    other code, and the front would be that of neither. A search takes seconds to minutes, and the
    versions that are named can be installed for it.
    """
    document, state = load_checkpoint(path)
    with reading(path, "checkpoint"):
        theirs, mine = typed(document, Header), Header(loop.spec, _versions())
    difference = _difference(plain(theirs.search), plain(mine.search))
    if difference:
        raise ValueError(
            f"{path} is of another search: its {difference}; ask for the same, or begin anew "
            "without it"
        )
    difference = _difference(theirs.versions, mine.versions)
    if difference:
        raise ValueError(
            f"{path} was written with other software: its version of {difference}; install what "
            "it was written with, or begin anew"
        )
    with reading(path, "checkpoint"):
        loop.restore(state)


def _versions() -> dict[str, str]:
    # Python's own is left out: no figure depends on it
    return {name: version for name, version in search_versions().items() if name != "python"}


def _difference(theirs: Mapping[str, Any], mine: Mapping[str, Any]) -> str:
    """The first entry in which two nested tables differ, in words; empty where none does."""
    for name in {**mine, **theirs}:
        other, value = theirs.get(name), mine.get(name)
        if isinstance(value, Mapping) and isinstance(other, Mapping):
            inner = _difference(other, value)
            if inner:
                return inner if name in ("settings", "task") else f"{name} {inner}"
        elif other != value:
            return f"{name} is {other!r}, not {value!r}"
    return ""
