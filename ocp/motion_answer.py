"""An answer that is one motion: its file holds what was decided, its figures are computed."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, Self

from quietarm.ocp.checks import clipped, quoted
from quietarm.ocp.figures import ENERGY, Figures, figures_in
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import FILE, RESIDUAL
from quietarm.ocp.record import Record
from quietarm.ocp.saved import Answer, read_content, refusals

STATED = "stated"
"""Entry of a file: figures of its motion, for whoever reads it, and for a check."""


class MotionAnswer(Answer):
    """An answer that is one motion. A subclass is a dataclass that gives the `candidate`.

    What is computed of the motion is computed once, and stays with an answer that differs in other
    entries alone (`with_entries`).
    """

    record: Record

    @cached_property
    def candidate(self) -> JudgedMotion:
        """The motion, evaluated by CVODES."""
        raise NotImplementedError

    @property
    def figures(self) -> Figures:
        """All figures of the motion by name, by the independent integrator."""
        return self.candidate.figures

    @property
    def motion(self) -> Figures:
        """Figures of the motion, by the name that they had in 2.0."""
        return self.candidate.figures

    @property
    def energy(self) -> float:
        """Driving energy [J], by the independent integrator."""
        return self.candidate.energy

    @property
    def residual(self) -> float:
        """Residual: the largest absolute tip displacement after arrival [m], by the same."""
        return self.candidate.residual

    def with_candidate(self, candidate: JudgedMotion) -> Self:
        """Return this answer with a candidate as its motion, which is not evaluated again."""
        answer = self.with_entries()
        vars(answer)["candidate"] = candidate
        return answer

    def with_entries(self, **entries: Any) -> Self:
        """Return this motion with other entries that say nothing of it, such as the record's."""
        answer: Any = self
        changed = dataclasses.replace(answer, **entries)
        fields = {entry.name for entry in dataclasses.fields(answer)}
        computed = {name: value for name, value in vars(self).items() if name not in fields}
        vars(changed).update(computed)
        return changed

    def restated(self, **changes: Any) -> Self:
        """Return this answer with other entries of its record."""
        return self.with_entries(record=dataclasses.replace(self.record, **changes))

    def _content(self) -> dict[str, Any]:
        names = [figure.name for figure in figures_in(FILE, self.candidate.task)]
        stated = {name: self.figures[name] for name in names if name in self.figures}
        return {**super()._content(), STATED: stated}

    @classmethod
    def _entries_of(cls, content: Mapping[str, Any]) -> dict[str, Any]:
        _stated_in(content)  # a file without them is refused
        return {name: entry for name, entry in content.items() if name != STATED}

    @classmethod
    def stated_by(cls, path: str | Path) -> dict[str, float]:
        """Read the figures that a file states of its motion, to be held against computed ones.

        FileFormatError where it is no such file.
        """
        content = read_content(path, cls)
        with refusals(path, cls.kind):
            return _stated_in(content)


def _stated_in(content: Mapping[str, Any]) -> dict[str, float]:
    """The figures among the content of a file; ValueError without residual and energy."""
    stated = content.get(STATED, {})
    if not isinstance(stated, dict):
        raise ValueError(f"its {STATED} is {quoted(stated)}; give figures by name")
    for name, figure in stated.items():
        if isinstance(figure, bool) or not isinstance(figure, int | float):
            raise ValueError(f"its {STATED}.{clipped(name)} is {quoted(figure)}; give a number")
    missing = [name for name in (RESIDUAL, ENERGY) if name not in stated]
    if missing:
        raise ValueError(f"it does not state its {' and its '.join(missing)}")
    return stated
