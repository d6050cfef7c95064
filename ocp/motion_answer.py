"""An answer that is one motion: its file holds what was decided, its figures are computed."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Self

from quietarm.ocp.candidate import Candidate
from quietarm.ocp.checks import IF_STATED
from quietarm.ocp.record import Record, Verification
from quietarm.ocp.robustness import Worst
from quietarm.ocp.saved import Answer, plain, read_content, refusals, typed
from quietarm.ocp.simulation.objective import Motion


@dataclass(frozen=True)
class MainFigures:
    """F1 [m] and F2 [J]."""

    residual: float
    energy: float


@dataclass(frozen=True)
class Stated:
    """What a file says of its motion: for whoever reads the file, and for a check.

    A loaded answer does not take them: its figures are computed from its motion.

    Attributes
    ----------
    stated : MainFigures
        A file without them is refused.
    """

    worst: ClassVar[Worst | None] = None

    stated: MainFigures

    @property
    def figures(self) -> dict[str, float]:
        """The figures by name."""
        return dataclasses.asdict(self.stated)


@dataclass(frozen=True)
class StatedBefore:
    """The same of files of before, which held every figure as an entry of its own."""

    motion: Motion
    verification: Verification
    worst: Worst | None = field(default=None, metadata=IF_STATED)

    @property
    def figures(self) -> dict[str, float]:
        """The figures of the motion by name."""
        return figures_of(self.motion)


def figures_of(motion: Motion) -> dict[str, float]:
    """Every figure of a motion by its name; of a peak that it does not have there is none."""
    entries = dataclasses.asdict(motion)
    ranges = entries.pop("ranges")
    figures = {name: value for name, value in entries.items() if value is not None}
    for name, (least, largest) in ranges.items():
        figures[f"least_{name}"] = least
        figures[f"largest_{name}"] = largest
    return figures


class MotionAnswer(Answer):
    """An answer that is one motion. A subclass is a dataclass that gives the `candidate`.

    What is computed of the motion is computed once, and stays with an answer that differs in other
    entries alone (`with_entries`).
    """

    earlier: ClassVar[tuple[int, ...]]
    """Versions of its file that held every figure, and are read as well."""
    record: Record

    @cached_property
    def candidate(self) -> Candidate:
        """The motion, evaluated by CVODES."""
        raise NotImplementedError

    @property
    def motion(self) -> Motion:
        """Residual, energy, peaks and other diagnostics, by the independent integrator."""
        return self.candidate.motion

    @property
    def energy(self) -> float:
        """F2, the driving energy [J], by the independent integrator."""
        return self.candidate.energy

    @property
    def residual(self) -> float:
        """F1, the largest absolute tip displacement after arrival [m], by the same."""
        return self.candidate.residual

    def with_candidate(self, candidate: Candidate) -> Self:
        """The same answer, whose motion is not evaluated again: this candidate is it."""
        answer = self.with_entries()
        vars(answer)["candidate"] = candidate
        return answer

    def with_entries(self, **entries: Any) -> Self:
        """The same motion with other entries that say nothing of it, as of the record."""
        answer: Any = self
        changed = dataclasses.replace(answer, **entries)
        fields = {entry.name for entry in dataclasses.fields(answer)}
        computed = {name: value for name, value in vars(self).items() if name not in fields}
        vars(changed).update(computed)
        return changed

    def restated(self, **changes: Any) -> Self:
        """The same answer with other entries of its record."""
        return self.with_entries(record=dataclasses.replace(self.record, **changes))

    def _content(self) -> dict[str, Any]:
        figures = MainFigures(residual=self.residual, energy=self.energy)
        return {**super()._content(), "stated": plain(figures)}

    @classmethod
    def _entries_of(cls, content: Mapping[str, Any], version: int) -> dict[str, Any]:
        stated = cls._stated_in(content, version)
        groups = {group.name for group in dataclasses.fields(stated)}
        entries = {name: entry for name, entry in content.items() if name not in groups}
        if isinstance(stated, StatedBefore):
            entries |= cls._decided_before(stated.verification)
        return entries

    @classmethod
    def _stated_in(cls, content: Mapping[str, Any], version: int) -> Stated | StatedBefore:
        """The figures among the content of a file; ValueError where one is not of its kind."""
        kind = StatedBefore if version in cls.earlier else Stated
        names = {group.name for group in dataclasses.fields(kind)}
        groups = {name: entry for name, entry in content.items() if name in names}
        return typed(groups, kind)

    @classmethod
    def _decided_before(cls, verification: Verification) -> dict[str, Any]:
        """What was decided, and a file of before has in its verification alone."""
        raise NotImplementedError

    @classmethod
    def stated_by(cls, path: str | Path) -> Stated | StatedBefore:
        """What a file states of the figures of its motion, to be held against computed ones.

        FileFormatError where it is no such file.
        """
        content, version = read_content(path, cls.kind, cls.version, cls.earlier)
        with refusals(path, cls.kind):
            return cls._stated_in(content, version)
