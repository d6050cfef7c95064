"""Pieces of work, and what became of them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, field
from typing import Any, TypeVar

from quietarm.metaheuristics.runs.progress import Report
from quietarm.ocp import Front, QuietarmError

INTERRUPTED = "interrupted"


@dataclass
class Done:
    """What became of the pieces of work so far."""

    answers: dict[Hashable, Any] = field(default_factory=dict)
    failures: dict[Hashable, QuietarmError] = field(default_factory=dict)
    parts: dict[Hashable, Any] = field(default_factory=dict)
    stopped: str = ""

    @property
    def number(self) -> int:
        """How many pieces came to an end."""
        return len(self.answers) + len(self.failures)

    def of(self, keys: Iterable[Hashable]) -> Done:
        """What became of these pieces alone."""
        keys = set(keys)
        answers = {key: found for key, found in self.answers.items() if key in keys}
        return Done(answers, {key: why for key, why in self.failures.items() if key in keys})


Tell = Callable[[int, Any], None]
"""Told what a piece, by its number, says before it ends: a `SearchProgress` or a `Front`."""


@dataclass(frozen=True)
class Say:
    """How a piece tells of itself before it ends."""

    report: Report
    found: Callable[[Front], None] | None = None


@dataclass(frozen=True)
class Piece:
    """A piece of work."""

    key: Hashable
    name: str
    work: Callable[[Done, Say], Any]
    after: tuple[Hashable, ...] = ()


class NotTriedError(QuietarmError):
    """A piece of work that is left out, because an earlier one failed."""


class LostPieceError(QuietarmError):
    """A piece of work that ended its worker time and again, or for which there was no memory."""

    @classmethod
    def after(cls, deaths: int) -> LostPieceError:
        """Of so many workers."""
        return cls(f"its worker died {deaths} times")


def in_worker(piece: Piece, known: Done, say: Say) -> Any:
    """Do a piece where others have work as well: it alone is lost where memory runs out."""
    try:
        return piece.work(known, say)
    except MemoryError:
        raise LostPieceError("out of memory") from None


class InterruptedPiece(KeyboardInterrupt):  # no error, as KeyboardInterrupt is none
    """Ctrl-C during a piece of work."""

    def __init__(self, part: Any) -> None:
        super().__init__()
        self.part = part


_Whole = TypeVar("_Whole", bound=Any)


def to_the_end(answer: _Whole) -> _Whole:
    """The same plan, front, polish or floor; InterruptedPiece where Ctrl-C ended it early."""
    if not answer.complete:
        raise InterruptedPiece(answer)
    return answer


@dataclass(frozen=True)
class Listener:
    """Who is told how the work goes."""

    begin: Callable[[str], None] = lambda name: None
    report: Callable[[Any, Any], None] = lambda key, progress: None
    ended: Callable[[Any, Any], None] = lambda key, answer: None
