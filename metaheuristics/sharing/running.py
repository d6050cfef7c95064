"""A list of work, run piece by piece here or shared by workers."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from concurrent.futures import CancelledError, Future
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, TypeAlias

from quietarm.metaheuristics.runs.progress import SearchProgress
from quietarm.metaheuristics.sharing.pieces import (
    INTERRUPTED,
    Done,
    InterruptedPiece,
    Listener,
    LostPieceError,
    Piece,
    Say,
    Tell,
)
from quietarm.metaheuristics.sharing.processes import Processes, processes
from quietarm.metaheuristics.sharing.workers import HERE, Workers
from quietarm.ocp import QuietarmError
from quietarm.ocp.interrupts import hear_interrupts, note_interrupts

if TYPE_CHECKING:
    from quietarm.metaheuristics.sharing.scheduler import Scheduler

    Crew: TypeAlias = "Processes | Scheduler | _Here"


def run_pieces(
    pieces: Sequence[Piece],
    listener: Listener | None = None,
    *,
    workers: Workers = HERE,
    note: type[QuietarmError] | tuple[()] = (),
) -> Done:
    """Run pieces of work until Ctrl-C.

    A piece whose worker dies is tried again by another, a few times.
    """
    run = _Run(pieces, Listener() if listener is None else listener, note)
    try:
        with _crew(workers, run) as crew, hear_interrupts() as came:
            run.all_of_it(crew, came)
    except KeyboardInterrupt:
        run.done.stopped = INTERRUPTED
    except _GoneError:
        run.done.stopped = f"the scheduler at {workers.scheduler} is gone"
    with note_interrupts():
        return run.kept()


def _crew(workers: Workers, run: _Run) -> AbstractContextManager[Crew]:
    if workers.scheduler is not None:
        # Not at the top: dask is an extra, and takes longer to load than all of quietarm.
        from quietarm.metaheuristics.sharing.scheduler import scheduler_at

        return scheduler_at(workers.scheduler, run.told)
    number = workers.local(len(run.pieces))
    return nullcontext(_Here(run.report)) if number <= 1 else processes(number, run.told)


class _Here:
    """The process itself."""

    size = 1

    def __init__(self, report: Tell) -> None:
        self._report = report

    def submit(self, number: int, piece: Piece, known: Done) -> Future[Any]:
        """Do a piece."""
        future = Future[Any]()
        try:
            future.set_result(piece.work(known, Say(partial(self._report, number))))
        except Exception as error:
            future.set_exception(error)
        return future


class _GoneError(Exception):
    """The scheduler is gone."""


class _Run:
    """Pieces of work on their way: no more are given out than there are workers.

    So those that are given out are at work, and a worker's death never counts against one that
    waits. What is told and answered comes in threads, where no Ctrl-C comes between.
    """

    def __init__(
        self, pieces: Sequence[Piece], listener: Listener, note: type[QuietarmError] | tuple[()]
    ) -> None:
        self.pieces, self.listener, self.note, self.done = pieces, listener, note, Done()
        self.waiting, self.busy = list(range(len(pieces))), set[int]()
        self.futures, self.parts = dict[int, Future[Any]](), dict[int, Any]()
        self.news: SimpleQueue[tuple[int, SearchProgress | None]] = SimpleQueue()
        """Numbers of pieces with how far they are, or None where they have come to an end."""

    def told(self, number: int, what: Any) -> None:
        """Take what a piece tells."""
        if isinstance(what, SearchProgress):
            self.news.put((number, what))
        else:
            self.parts[number] = what

    def report(self, number: int, progress: SearchProgress) -> None:
        """Tell how far a piece is."""
        self.listener.report(self.pieces[number].key, progress)

    def all_of_it(self, crew: Crew, came: list[int]) -> None:
        """Run to the end, or to the first interrupt in the list."""
        while self.waiting or self.busy:
            self._give(crew)
            number, progress = self.news.get()
            if progress is None:
                self._take(number, came)
            else:
                self.report(number, progress)
            if came:  # a piece that ended well in spite of Ctrl-C raises nothing
                raise KeyboardInterrupt

    def _give(self, crew: Crew) -> None:
        """Give out the pieces that can begin, as far as there are workers."""
        ended: set[Hashable] = {*self.done.answers, *self.done.failures}
        ready = [one for one in self.waiting if ended.issuperset(self.pieces[one].after)]
        size = crew.size if ready else 1
        if size == 0:
            raise _GoneError
        for number in ready[: max(0, size - len(self.busy))]:
            piece = self.pieces[number]
            self.listener.begin(piece.name)
            self.waiting.remove(number)
            self.busy.add(number)
            try:
                future = crew.submit(number, piece, self.done.of(piece.after))
            except InterruptedPiece as stop:
                self.parts[number] = stop.part
                raise
            self.futures[number] = future
            future.add_done_callback(lambda _, number=number: self.news.put((number, None)))

    def _take(self, number: int, came: list[int]) -> None:
        """Take the answer of a piece, or its error."""
        self.busy.remove(number)
        key = self.pieces[number].key
        try:
            answer = self.futures[number].result()
        except CancelledError:  # not by this process, which goes on
            raise _GoneError from None
        except Exception as error:
            deaths = getattr(error, "allowed_failures", None)  # as dask's KilledWorker has them
            failure = error if deaths is None else LostPieceError.after(deaths + 1)
            if came:  # it may have failed of that
                return
            if not isinstance(failure, self.note):
                raise failure from failure.__cause__
            self.done.failures[key] = failure
        else:
            self.done.answers[key] = answer
            self.listener.ended(key, answer)

    def kept(self) -> Done:
        """All that came back, also where Ctrl-C came twice."""
        for number, piece in enumerate(self.pieces):
            future = self.futures.get(number)
            if future and future.done() and not future.cancelled() and not future.exception():
                self.done.answers[piece.key] = future.result()
            elif number in self.parts and piece.key not in self.done.failures:
                self.done.parts[piece.key] = self.parts[number]
        return self.done
