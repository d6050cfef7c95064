"""A list of work, run piece by piece: what `quietarm study` and `quietarm reproduce` share."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar

from metaheuristics.ensemble import search_many
from ocp import CycloidPolynomial, Front, QuietarmError
from ocp.base.interrupts import hear_interrupts
from studies.methods import Method
from studies.paper.case import Case

Begin = Callable[[str], None]
"""Called with the name of a piece of work when it begins."""


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
        What a piece that was interrupted had found, by its key.
    interrupted : bool
        Whether Ctrl-C came; the pieces after it were not begun.
    """

    answers: dict[Hashable, Any] = field(default_factory=dict)
    failures: dict[Hashable, QuietarmError] = field(default_factory=dict)
    parts: dict[Hashable, Any] = field(default_factory=dict)
    interrupted: bool = False

    @property
    def number(self) -> int:
        """How many pieces came to an end."""
        return len(self.answers) + len(self.failures)


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
        Gives the answer; it may look at what was done before it.
    """

    key: Hashable
    name: str
    work: Callable[[Done], Any]


class NotTriedError(QuietarmError):
    """A piece of work that is left out, because an earlier one failed."""


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


def run_pieces(pieces: Sequence[Piece], begin: Begin, *, go_on: bool = False) -> Done:
    """Run pieces of work one after another, until Ctrl-C.

    Parameters
    ----------
    pieces : sequence of Piece
        The work, in order.
    begin : callable
        Called with the name of every piece when it begins.
    go_on : bool
        Whether to note a piece that fails and go on with the next.

    Returns
    -------
    Done
        Every answer, and every failure that was noted; after Ctrl-C those that there are.

    Raises
    ------
    QuietarmError
        When a piece fails, unless `go_on`.
    """
    done = Done()
    with hear_interrupts() as came:
        for piece in pieces:
            try:
                begin(piece.name)
                done.answers[piece.key] = piece.work(done)
            except QuietarmError as error:
                if not go_on and not came:
                    raise
                if not came:  # else it may have failed of that
                    done.failures[piece.key] = error
            except KeyboardInterrupt as stop:
                done.interrupted = True
                if isinstance(stop, InterruptedPiece):
                    done.parts[piece.key] = stop.part
            # a piece that ended well in spite of Ctrl-C raises nothing
            done.interrupted = done.interrupted or bool(came)
            if done.interrupted:
                break
    return done


class _Answer(Protocol):
    @property
    def complete(self) -> bool: ...


_Whole = TypeVar("_Whole", bound=_Answer)


def to_the_end(answer: _Whole) -> _Whole:
    """The same plan, front or floor; InterruptedPiece where Ctrl-C ended the work on it early."""
    if not answer.complete:
        raise InterruptedPiece(answer)
    return answer


def searched(case: Case, method: Method, terms: int, runs: int = 1, **settings: Any) -> list[Front]:
    """The fronts of a metaheuristic on a case, one for each seed.

    Parameters
    ----------
    case : Case
        The task and the box.
    method : Method
        A metaheuristic.
    terms : int
        Terms of the polynomial.
    runs : int
        Number of seeds.
    **settings : Any
        As for `search_many`: seed, workers, population, generations.

    Returns
    -------
    list of Front
        The fronts, in the order of the seeds.

    Raises
    ------
    InterruptedPiece
        When a search was interrupted, with the fronts that have a point.
    """
    profile = CycloidPolynomial(terms)
    fronts = search_many(
        case.task, method.name, runs, profile=profile, bound=case.bound, **settings
    )
    if len(fronts) < runs or not all(front.complete for front in fronts):
        raise InterruptedPiece([front for front in fronts if front.points])
    return fronts
