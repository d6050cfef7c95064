"""The state of a search in a file: what a function returned, or what was told, until now."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from quietarm.metaheuristics.evaluation.population import UNUSABLE
from quietarm.ocp.checks import Count, CountFromOne, quoted
from quietarm.ocp.errors import FileFormatError
from quietarm.ocp.front.searched_function import SearchedFunction
from quietarm.ocp.json_text import Texts, texts_of
from quietarm.ocp.record import Setting, versions
from quietarm.ocp.saved import Answer, plain

Array = NDArray[np.float64]
Numbers = tuple[float | None, ...]


@dataclass(frozen=True)
class Told:
    """One candidate and what was told of it; None stands for what is not finite.

    Attributes
    ----------
    number : int
        Which candidate it is, from 1.
    coefficients, objectives, violations : tuple of float
        The candidate and its values.
    """

    number: CountFromOne
    coefficients: tuple[float, ...]
    objectives: Numbers
    violations: Numbers = ()

    @property
    def failed(self) -> bool:
        """Return whether one of its values was not finite."""
        return None in self.objectives or None in self.violations

    @cached_property
    def texts(self) -> Texts:
        """Texts in the file of a state, made once, however often that is written."""
        return texts_of(plain(self), margin="\n    ")


@dataclass(frozen=True)
class SearchState(Answer):
    """The state of a search: what was asked for, and what was told until now.

    Attributes
    ----------
    function : SearchedFunction
        Box, objectives, units and constraints.
    method : str
        Name of the method.
    evaluations, seed, reevaluate : int
        As of a `Search`.
    population : int or None
        As of a `Search`.
    settings : mapping
        The method's settings that were given.
    reference : tuple of float
        The corner of hypervolumes; empty where it follows from what is found.
    told : tuple of Told
        The candidates that were measured, in the order in which they were asked for.
    versions : mapping of str to str
        Of the software: another version may ask for other candidates.
    """

    kind: ClassVar[str] = "search"
    version: ClassVar[int] = 1

    function: SearchedFunction
    method: str
    evaluations: CountFromOne
    seed: Count = 0
    reevaluate: CountFromOne = 1
    population: int | None = None
    settings: Mapping[str, Setting] = field(default_factory=dict, hash=False)
    reference: tuple[float, ...] = ()
    told: tuple[Told, ...] = ()
    versions: Mapping[str, str] = field(default_factory=versions, hash=False)

    def _content(self) -> dict[str, Any]:
        entries = plain(replace(self, told=()))
        return {**entries, "told": [told.texts for told in self.told]}

    def differences(self, other: SearchState) -> list[str]:
        """List what another search would be asked for in another way, such as: seed is 3, not 4.

        The number of evaluations may be another: what is asked for tells whether that matters.
        """
        ours, others = self._stated(), other._stated()
        return [
            f"{_with_verb(name)} {_shown(value)}, not {_shown(others[name])}"
            for name, value in ours.items()
            if value != others[name]
        ]

    def _stated(self) -> dict[str, Any]:
        """Return what was asked for, by name."""
        own = ("told", "versions", "evaluations", "function")
        named = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        of_function = {
            entry.name: getattr(self.function, entry.name) for entry in fields(self.function)
        }
        return of_function | {name: named[name] for name in named if name not in own}


class StateError(ValueError):
    """A state file is of another search, or was changed by another program."""


class StateFile:
    """A state in a file: what it holds from an earlier run, and what is told since.

    Parameters
    ----------
    path : Path, optional
        The file; without one nothing is kept.
    state : SearchState
        What is asked for, with nothing told.

    Raises
    ------
    FileFormatError
        When the file is damaged.
    StateError
        When it is of another search.
    """

    def __init__(self, path: Path | None, state: SearchState) -> None:
        self.path = path
        self._state = state
        self._begun_with = state.evaluations
        self._written = _stamp(path)
        self.told = {told.number: told for told in self._resumed()}

    def known(self, number: int, coefficients: Array) -> Told | None:
        """Return what the file has of a candidate; StateError if its number is another's there."""
        told = self.told.get(number)
        if told is not None and told.coefficients != tuple(coefficients.tolist()):
            raise StateError(self._why_another(number))
        return told

    def save(self, told: Sequence[Told]) -> None:
        """Write what is told; StateError if another program has written the file since."""
        if self.path is None:
            return
        if _stamp(self.path) != self._written:
            raise StateError(
                f"{self.path} was changed by another program since this search read it; begin "
                "again from the file, or give each search a file of its own"
            )
        replace(self._state, told=tuple(told)).save(self.path)
        self._written = _stamp(self.path)

    def _resumed(self) -> tuple[Told, ...]:
        """Return what the file has, if there is one; ValueError if it is of another search."""
        if self.path is None or not self.path.exists():
            return ()
        try:
            before = SearchState.load(self.path)
        except FileFormatError as error:
            what = str(error).partition("; ")[0]
            raise FileFormatError(
                f"{what}; delete it to begin again, or give another file"
            ) from None
        if differences := before.differences(self._state):
            raise StateError(
                f"{self.path} is of another search: its {', its '.join(differences)}; give what "
                "it was begun with, or another file"
            )
        if before.evaluations > self._state.evaluations:
            raise StateError(
                f"{self.path} is of {before.evaluations} evaluations, not "
                f"{self._state.evaluations}; give {before.evaluations} or more, or another file"
            )
        self._begun_with = before.evaluations
        return before.told

    def _why_another(self, number: int) -> str:
        """Say why the file has another candidate than the one that is asked for here."""
        evaluations = self._state.evaluations
        if self._begun_with != evaluations:
            return (
                f"{self.path} was begun with {self._begun_with} evaluations, and with "
                f"{evaluations} {self._state.method} asks for another candidate {number}; give "
                f"{self._begun_with}, or another file"
            )
        return (
            f"{self.path} is of another version: its candidate {number} is not the one that is "
            "asked for here; go on with the versions that it names, or give another file"
        )


class KeptValues:
    """A function's values, kept in a state file so that none is computed again.

    Candidates are numbered in the order in which a search asks for them.
    """

    def __init__(self, file: StateFile) -> None:
        self._file = file
        self._told = dict(file.told)
        self._asked = 0
        self._lock = threading.Lock()  # a function may be called in several threads
        self.resumed = len(file.told)
        """Values that the file has from before."""

    @property
    def count(self) -> int:
        """Number of values that the file has."""
        return len(self._told)

    @property
    def path(self) -> Path | None:
        """The file."""
        return self._file.path

    def take(self, candidates: Array, values: Array) -> tuple[int, NDArray[np.bool_]]:
        """Write known values into a table; the number of its first candidate, and which are new.

        StateError when the file has another candidate of that number.
        """
        first = self._asked + 1
        self._asked += len(candidates)
        known = [self._file.known(first + i, row) for i, row in enumerate(candidates)]
        for told, row in zip(known, values):
            if told is not None:
                row[:] = [UNUSABLE if told.failed else x for x in told.objectives + told.violations]
        return first, np.array([told is None for told in known], dtype=bool)

    def add(self, first: int, candidates: Array, values: Array, objectives: int) -> None:
        """Keep the values of candidates, the first of this number, and write the file."""
        with self._lock:
            for number, (candidate, row) in enumerate(zip(candidates, values), start=first):
                finite = np.where(row < UNUSABLE, row, np.nan)
                self._told[number] = Told(
                    number,
                    tuple(candidate.tolist()),
                    or_none(finite[:objectives]),
                    or_none(finite[objectives:]),
                )
            self._file.save([self._told[number] for number in sorted(self._told)])


def _stamp(path: Path | None) -> tuple[int, int] | None:
    """Return when a file was changed, and its inode, which each whole writing makes anew."""
    if path is None or not path.exists():
        return None
    status = path.stat()
    return status.st_mtime_ns, status.st_ino


def _with_verb(name: str) -> str:
    return f"{name} {'are' if name.endswith('s') else 'is'}"


def _shown(value: Any) -> str:
    """A value of a state in a few words."""
    if value is None or value == () or value == {}:
        return "not given"
    return quoted(list(value) if isinstance(value, tuple) else value)


def or_none(values: Array) -> Numbers:
    """Values of a candidate; None for what is not finite."""
    return tuple(value if np.isfinite(value) else None for value in values.tolist())
