"""Keep a search in a checkpoint as it goes, and go on from one.

A checkpoint holds what the search is and every figure that it computed. All else follows from the
seed: the search goes on by doing again what it did, with these figures in the place of new ones.
"""

from __future__ import annotations

import hashlib
import io
import json
import math
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.objective.population import PopulationObjective
from quietarm.metaheuristics.objective.problem import MoveProblem
from quietarm.metaheuristics.runs.progress import SearchProgress, now_and_then
from quietarm.metaheuristics.runs.settings import SearchSpec, search_versions
from quietarm.ocp import FileFormatError
from quietarm.ocp.files import read_bytes, write_whole
from quietarm.ocp.saved import content_of, plain

KIND, VERSION = "checkpoint", 3
CHECKPOINT_SECONDS = 2.0
"""Least time [s] between two writes."""


@dataclass(frozen=True)
class Known:
    """What a search computed: residual, energy and violations of every candidate, a row each.

    And the SHA-256 of their coefficients and figures, and how long it took.
    """

    figures: NDArray[np.float64]
    digest: str
    seconds: float


class KeptProblem(MoveProblem):
    """A move whose figures are kept, and those that are known not computed anew."""

    def __init__(
        self, objective: PopulationObjective, bound: float, known: Known | None = None
    ) -> None:
        super().__init__(objective, bound)
        self._known, self._done = known, 0
        self._tables, self._sha256 = list[NDArray[np.float64]](), hashlib.sha256()

    @property
    def repeating(self) -> bool:
        """Whether figures are known that the search has not come to yet."""
        return self._known is not None and self._done < len(self._known.figures)

    def known(self, seconds: float) -> Known:
        """All that was computed."""
        if self._known is not None and self.repeating:
            return self._known
        return Known(np.vstack(self._tables), self._sha256.hexdigest(), seconds)

    def figures(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """As of `MoveProblem`."""
        known = self._known if self.repeating else None
        if known is None:
            table = super().figures(x)
        else:
            table = known.figures[self._done : self._done + len(x)].copy()
            self._done += len(x)
        for part in (x, table):
            self._sha256.update(np.ascontiguousarray(part).tobytes())
        if known is not None and not self.repeating and self._sha256.hexdigest() != known.digest:
            raise ValueError(
                "the search does not come to what is in its checkpoint again; begin anew without it"
            )
        self._tables.append(table.copy())
        return table


class Keeper:
    """Writes a search to a file, every few seconds and at the end.

    A search is not lost with its checkpoint: where that cannot be written the search goes on, and
    the next write is tried all the same.
    """

    def __init__(self, spec: SearchSpec, problem: KeptProblem, path: str | Path) -> None:
        self._spec, self._problem, self._path = spec, problem, path
        self.after_generation = now_and_then(
            self._write_anew, CHECKPOINT_SECONDS, math.inf, begin=CHECKPOINT_SECONDS
        )

    def _write_anew(self, progress: SearchProgress) -> None:
        if not self._problem.repeating:
            self.write(progress.seconds)

    def write(self, seconds: float) -> str:
        """Write the search; the reason where it cannot be written, else nothing."""
        known, content = self._problem.known(seconds), io.BytesIO()
        document = {"format": f"quietarm-{KIND}", "version": VERSION, **_header(self._spec),
                    "digest": known.digest, "seconds": known.seconds}  # fmt: skip
        header = np.frombuffer(json.dumps(document).encode(), dtype=np.uint8)
        np.savez(content, allow_pickle=False, header=header, figures=known.figures)
        try:
            write_whole(self._path, content.getvalue())
        except ValueError as error:
            return str(error)
        return ""


def load_checkpoint(path: str | Path, spec: SearchSpec) -> Known:
    """What a search had computed; the file is left as it was.

    Other versions are refused too: the figures in the file would be compared with those of other
    code, and the front would be that of neither. A search takes seconds to minutes, and the
    versions that are named can be installed for it.
    """
    content = read_bytes(path)
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as archive:
            document = json.loads(bytes(archive["header"]))
            figures = np.array(archive["figures"], dtype=float)
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        raise FileFormatError(
            f"{path} is not a checkpoint, or not a whole one; give a file that --checkpoint wrote"
        ) from None
    theirs, mine = content_of(path, document, KIND, VERSION), _header(spec)
    difference = _difference(theirs.get("search", {}), mine["search"])
    if difference:
        raise ValueError(
            f"{path} is of another search: its {difference}; ask for the same, or begin anew "
            "without it"
        )
    difference = _difference(theirs.get("versions", {}), mine["versions"])
    if difference:
        raise ValueError(
            f"{path} was written with other software: its version of {difference}; install what "
            "it was written with, or begin anew"
        )
    return Known(figures, str(theirs.get("digest")), float(theirs.get("seconds", 0.0)))


def _header(spec: SearchSpec) -> dict[str, Any]:
    # Python's own version is left out: no figure depends on it
    versions = {name: one for name, one in search_versions().items() if name != "python"}
    return {"search": plain(spec), "versions": versions}


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
