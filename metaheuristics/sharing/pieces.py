"""Pieces of work, and what became of them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar

from quietarm.metaheuristics.runs.progress import Report
from quietarm.ocp import Front, QuietarmError

INTERRUPTED = "interrupted"


@dataclass
class Done:
    """What became of the pieces of work so far.

    Attributes
    ----------
    answers : dict
        Answers by the key of their piece.
    failures : dict
        Errors by the key of their piece.
    parts : dict
        What a piece that was stopped had found, by its key.
    stopped : str
        Why the work ended early, as `INTERRUPTED`; empty where it did not. Pieces that are in none
        of the tables were not begun, or had found nothing.
    """

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


@dataclass(frozen=True)
class Say:
    """How a piece tells of itself before it ends.

    Attributes
    ----------
    report : callable
        To be called with a `SearchProgress` after every generation.
    found : callable or None
        To be called with the front that there is, now and then: it is kept should the piece come to
        no end. None where nobody needs it, as the piece itself hears of Ctrl-C.
    """

    report: Report
    found: Callable[[Front], None] | None = None


@dataclass(frozen=True)
class Piece:
    """A piece of work.

    Attributes
    ----------
    key : hashable
        What its answer is kept under.
    name : str
        What is shown when it begins.
    work : callable
        Gives the answer; it is given what became of the pieces that it comes after, and a `Say`.
        To go to a worker it is a function of a module, or a `functools.partial` of one.
    after : tuple of hashable
        Keys of the pieces, earlier in the list, that must have come to an end before.
    """

    key: Hashable
    name: str
    work: Callable[[Done, Say], Any]
    after: tuple[Hashable, ...] = ()


class NotTriedError(QuietarmError):
    """A piece of work that is left out, because an earlier one failed."""


class LostPieceError(QuietarmError):
    """A piece of work that ended its worker time and again, or for which there was no memory."""


class InterruptedPiece(KeyboardInterrupt):  # no error, as KeyboardInterrupt is none
    """Ctrl-C during a piece of work.

    Attributes
    ----------
    part : Any
        What it had found.
    """

    def __init__(self, part: Any) -> None:
        super().__init__()
        self.part = part


class _Answer(Protocol):
    @property
    def complete(self) -> bool: ...


_Whole = TypeVar("_Whole", bound=_Answer)


def to_the_end(answer: _Whole) -> _Whole:
    """The same plan, front, polish or floor; InterruptedPiece where Ctrl-C ended it early."""
    if not answer.complete:
        raise InterruptedPiece(answer)
    return answer


@dataclass(frozen=True)
class Listener:
    """Who is told how the work goes.

    Attributes
    ----------
    begin : callable
        Called with the name of every piece when it begins.
    report : callable
        Called with the key of a piece and its `SearchProgress`.
    ended : callable
        Called with the key of a piece and its answer.
    """

    begin: Callable[[str], None] = lambda name: None
    report: Callable[[Any, Any], None] = lambda key, progress: None
    ended: Callable[[Any, Any], None] = lambda key, answer: None
