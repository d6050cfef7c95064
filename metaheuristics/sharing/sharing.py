"""Pieces of work given to the workers of dask, and what comes back."""

from __future__ import annotations

import json
from collections.abc import Hashable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from functools import partial
from queue import Empty, SimpleQueue
from typing import Any
from uuid import uuid4

from distributed import Client, Future, KilledWorker
from quietarm.metaheuristics.runs.progress import SearchProgress
from quietarm.metaheuristics.sharing.cluster import Cluster, connected
from quietarm.metaheuristics.sharing.pieces import (
    INTERRUPTED,
    Done,
    Listener,
    LostPieceError,
    Piece,
)
from quietarm.metaheuristics.sharing.worker import do_piece
from quietarm.metaheuristics.sharing.workers import Workers
from quietarm.ocp import Front, QuietarmError
from quietarm.ocp.interrupts import note_interrupts
from quietarm.ocp.saved import typed

_INSISTENT = 3
"""After this many more Ctrl-C, answers on their way are no longer waited for."""


def share(
    pieces: Sequence[Piece],
    listener: Listener,
    workers: Workers,
    note: type[QuietarmError] | tuple[()],
) -> Done:
    """Share pieces of work, as `run_pieces` says.

    A piece whose worker dies is tried again by another. After `DEATHS` deaths it is a
    `LostPieceError`; on a scheduler that exists that number is one more than its setting
    ``allowed-failures``.
    """
    sharing = _Sharing(pieces, listener, note)
    try:
        with connected(workers, len(pieces)) as cluster:
            sharing.run(cluster)
    except KeyboardInterrupt:
        sharing.done.stopped = INTERRUPTED
    with note_interrupts():
        return sharing.kept()


class _Inbox:
    """What was handed over, kept by dask's own threads, in which no Ctrl-C comes between."""

    def __init__(self) -> None:
        self.fronts: dict[int, Front] = {}
        self.answers: dict[int, Any] = {}
        self.errors: dict[int, BaseException] = {}
        self.news: SimpleQueue[tuple[int, SearchProgress | None]] = SimpleQueue()
        """Numbers of pieces with how far they are, or None where they have come to an end."""

    def heard(self, event: tuple[float, dict[str, Any]]) -> None:
        """Take what a piece told."""
        _, said = event
        if "front" in said:
            self.fronts[said["piece"]] = typed(json.loads(said["front"]), Front)
        else:
            progress = SearchProgress(**json.loads(said["progress"]))
            self.news.put((said["piece"], progress))

    def ended(self, number: int, future: Future) -> None:
        """Take the answer or the error of a piece."""
        try:
            self.answers[number] = future.result()
        except (Exception, CancelledError) as error:
            self.errors[number] = error
        self.news.put((number, None))

    def has(self, number: int) -> bool:
        """Whether the end of a piece is known."""
        return number in self.answers or number in self.errors


class _Sharing:
    """Pieces of work on their way: no more are given out than there are workers.

    So those that are given out are at work, and a worker's death never counts against one that
    waits.
    """

    def __init__(
        self,
        pieces: Sequence[Piece],
        listener: Listener,
        note: type[QuietarmError] | tuple[()],
    ) -> None:
        self.listener, self.note, self.done = listener, note, Done()
        self.pieces = dict(enumerate(pieces))
        self.waiting = list(self.pieces)
        self.busy: dict[int, Future] = {}
        self.inbox, self.topic = _Inbox(), f"quietarm-{uuid4().hex}"

    def run(self, cluster: Cluster) -> None:
        """Have every piece done; at Ctrl-C, or without a scheduler, end what is at work."""
        try:
            cluster.client.subscribe_topic(self.topic, self.inbox.heard)
            while self.waiting or self.busy:
                self._give(cluster)
                self._listen()
        except KeyboardInterrupt:
            self.done.stopped = INTERRUPTED
        except _SchedulerGone:
            self.done.stopped = f"{cluster.name} is gone"
        finally:
            with note_interrupts() as came:
                self._stop(cluster.client, came)

    def _give(self, cluster: Cluster) -> None:
        """Give out the pieces that can begin, as far as there are workers."""
        ended: set[Hashable] = {*self.done.answers, *self.done.failures}
        ready = [one for one in self.waiting if ended.issuperset(self.pieces[one].after)]
        with _gone_without(cluster.client):
            size = max(1, cluster.size()) if ready else 0
        for number in ready[: max(0, size - len(self.busy))]:
            piece = self.pieces[number]
            self.listener.begin(piece.name)
            with _gone_without(cluster.client):
                self.busy[number] = cluster.client.submit(
                    do_piece, self.topic, number, piece, self.done.of(piece.after),
                    key=f"{self.topic}-{number}", pure=False,
                )  # fmt: skip
            self.waiting.remove(number)
            self.busy[number].add_done_callback(partial(self.inbox.ended, number))

    def _listen(self) -> None:
        """Take the next news."""
        number, progress = self.inbox.news.get()
        piece = self.pieces[number]
        if progress is not None:
            self.listener.report(piece.key, progress)
            return
        del self.busy[number]
        if number in self.inbox.answers:
            self.done.answers[piece.key] = self.inbox.answers[number]
            self.listener.ended(piece.key, self.inbox.answers[number])
            return
        error = _error_for_people(self.inbox.errors[number])
        if isinstance(error, CancelledError):  # not by this client, which goes on
            raise _SchedulerGone
        if not isinstance(error, self.note):
            raise error
        self.done.failures[piece.key] = error

    def _stop(self, client: Client, came: list[int]) -> None:
        """End what is at work, and wait for answers that are on their way."""
        at_work = [future for future in self.busy.values() if not future.done()]
        with suppress(Exception):  # a scheduler that has gone has ended them
            client.cancel(at_work, force=True)
        for number, future in self.busy.items():
            while future.status == "finished" and not self.inbox.has(number):
                if len(came) >= _INSISTENT:
                    break
                with suppress(Empty):
                    self.inbox.news.get(timeout=0.1)

    def kept(self) -> Done:
        """All that was handed over, also where Ctrl-C came twice."""
        for number, piece in self.pieces.items():
            if number in self.inbox.answers:
                self.done.answers[piece.key] = self.inbox.answers[number]
            elif number in self.inbox.fronts and piece.key not in self.done.failures:
                self.done.parts[piece.key] = self.inbox.fronts[number]
        return self.done


class _SchedulerGone(Exception):  # noqa: N818  # it is what happened
    """The connection to the scheduler has ended."""


@contextmanager
def _gone_without(client: Client) -> Iterator[None]:
    """Tell errors of dask's that mean that the connection has ended."""
    try:
        yield
    except Exception as error:
        if client.status == "running":
            raise
        raise _SchedulerGone from error


def _error_for_people(error: BaseException) -> BaseException:
    """The error of a piece, in words where it is dask's own."""
    if isinstance(error, KilledWorker):
        return LostPieceError(f"its worker died {error.allowed_failures + 1} times")
    if isinstance(error, MemoryError):
        return LostPieceError("out of memory")
    return error
