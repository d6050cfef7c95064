"""Processes that share work; neither Ctrl-C nor the death of one ends the others."""

from __future__ import annotations

import signal
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from multiprocessing import get_context, resource_tracker
from multiprocessing.connection import Connection, wait
from typing import Any

from ocp.base.checks import whole
from ocp.base.interrupts import defer_interrupts

Say = Callable[[Any], None]
Work = Callable[[Any, Say], Any]
"""Does one piece of work, calls `say` now and then with its progress, and returns the answer.

`say` raises KeyboardInterrupt once the work is to stop; what was found until then must be returned
soon. The work is pickled: it is a function of a module, or a `functools.partial` of one.
"""

_CONTEXT = get_context("spawn")  # a fork would carry casadi's and the threads' state into the child
_PATIENCE = 1.2
"""How long [s] the pieces that are worked on at Ctrl-C have to hand over what they found."""
_SAY_SECONDS = 0.2
MOST_WORKERS = 1000
_ENDED = "status"
"""What is said of a process that ended by itself, neither killed nor out of memory."""


_GUARD = (
    "run it under if __name__ == '__main__' in a script of your own, with a plant from a file that "
    "can be imported, or with one worker"
)


def remedy(
    deaths: Iterable[str], killed: str = "where memory ran short, give fewer workers"
) -> str:
    """What to try where processes died.

    Parameters
    ----------
    deaths : iterable of str
        How they ended, from `Workers.lost`.
    killed : str
        What to say where one was killed or had no memory left.

    Returns
    -------
    str
        The remedy.
    """
    return _GUARD if all(how.startswith(_ENDED) for how in deaths) else killed


def death_of_process(how: str) -> str:
    """Why a piece is missing: its process died, as `Workers.lost` says."""
    return f"its process died ({how}); {remedy([how])}"


def number_of_workers(value: object) -> int:
    """A number of processes as an int; ValueError when it is out of range."""
    return whole("workers", value, 1, MOST_WORKERS, "each is a process with 0.1 GB of memory")


class Workers:
    """Processes that share out pieces of work.

    Parameters
    ----------
    work : callable
        What is done with a piece, as `Work` says.
    pieces : mapping of int to Any
        What there is to do, in this order.
    report : callable
        Called with the key of a piece and what was said of it, a few times a second.
    done : callable, optional
        Called with the key of a piece and its answer.

    Attributes
    ----------
    answers : dict of int to Any
        Answers by key; after Ctrl-C those that were stopped among them.
    lost : dict of int to str
        Pieces whose process died, with how it ended.
    interrupted : bool
        Whether Ctrl-C came.
    """

    def __init__(
        self,
        work: Work,
        pieces: Mapping[int, Any],
        report: Callable[[int, Any], None],
        done: Callable[[int, Any], None] = lambda key, answer: None,
    ) -> None:
        self.answers: dict[int, Any] = {}
        self.lost: dict[int, str] = {}
        self.interrupted = False
        self._work, self._waiting = work, deque(pieces.items())
        self._report, self._done = report, done
        self._busy: dict[Any, _Worker] = {}

    def run(self, number: int) -> None:
        """Work on every piece in this many processes; after Ctrl-C keep what was found so far."""
        try:
            while self._waiting and len(self._busy) < number:
                with defer_interrupts():  # no process is started and then forgotten
                    worker = _Worker(self._work)
                    self._busy[worker.link] = worker
                    worker.give(*self._waiting.popleft())
            while self._busy:
                self._listen()
        except KeyboardInterrupt:
            self.interrupted = True
            # it is over soon, and a second signal may be the same one passed on, as `timeout` does
            with suppress(KeyboardInterrupt), defer_interrupts():
                self._stop()
        finally:
            with defer_interrupts():
                for worker in self._busy.values():
                    worker.end()

    def _stop(self) -> None:
        self._waiting.clear()
        for worker in self._busy.values():
            worker.stop()
        until = time.monotonic() + _PATIENCE
        while self._busy and time.monotonic() < until:
            self._listen(until - time.monotonic())

    def _listen(self, seconds: float | None = None) -> None:
        """Take a message of every worker that has one within this time."""
        for link in wait(list(self._busy), seconds):
            with defer_interrupts():  # a message is read whole, and what is in it kept
                worker = self._busy[link]
                key, message = worker.key, worker.receive()
                if isinstance(message, _Answer):
                    self.answers[key] = message.content
                elif isinstance(message, _Death):
                    self.lost[key] = message.content
                if isinstance(message, _Answer) and self._waiting:
                    worker.give(*self._waiting.popleft())
                elif not isinstance(message, _Said):
                    del self._busy[link]
                    worker.end()
            if isinstance(message, _Error):
                raise message.content
            if isinstance(message, _Said):
                self._report(key, message.content)
            elif isinstance(message, _Answer):
                self._done(key, message.content)


class _Message:
    """What comes through a link."""

    def __init__(self, content: Any) -> None:
        self.content = content


class _Said(_Message):
    """How far a piece is."""


class _Answer(_Message):
    """What a piece came to."""


class _Error(_Message):
    """The exception that ended a piece."""


class _Death(_Message):
    """How a process died, or that it has no memory left to go on."""

    @classmethod
    def of(cls, code: int) -> _Death:
        """The death of a process by its exit code."""
        return cls(f"killed by {signal.Signals(-code).name}" if code < 0 else f"{_ENDED} {code}")


class _Worker:
    """A process, the link to it, and the key of the piece that it works on."""

    def __init__(self, work: Work) -> None:
        self.key = -1
        self.link, theirs = _CONTEXT.Pipe()
        self.process = _CONTEXT.Process(target=_serve, args=(theirs, work), daemon=True)
        with _deaf_to_interrupts():
            self.process.start()
        theirs.close()  # so that the link ends when the process does

    def give(self, key: int, piece: Any) -> None:
        """Give the next piece."""
        self.key = key
        self._send((piece,))

    def stop(self) -> None:
        """Ask for what was found until now."""
        self._send(None)

    def _send(self, content: tuple[Any] | None) -> None:
        with suppress(OSError):  # it is dead: the next `receive` finds out
            self.link.send(content)

    def receive(self) -> _Message:
        """The message that is there."""
        try:
            message = self.link.recv()
        except (EOFError, OSError):
            self.process.join()
            return _Death.of(self.process.exitcode or 0)
        if isinstance(message, _Error) and isinstance(message.content, MemoryError):
            return _Death("out of memory")
        return message

    def end(self) -> None:
        """End the process, whatever it does."""
        self.process.kill()
        self.process.join()
        self.link.close()


def _serve(link: Connection, work: Work) -> None:
    """Work on every piece that comes through the link, until None comes or the parent is gone.

    Whatever comes during a piece stops it as Ctrl-C does, and what it found is answered.
    """
    said = 0.0

    def say(content: Any) -> None:
        nonlocal said
        if link.poll():
            raise KeyboardInterrupt
        if time.monotonic() - said > _SAY_SECONDS:
            said = time.monotonic()
            link.send(_Said(content))

    with suppress(EOFError, OSError):  # the parent is gone
        for (piece,) in iter(link.recv, None):
            said = 0.0  # the first report of every piece is sent at once
            try:
                link.send(_Answer(work(piece, say)))
            except Exception as error:
                link.send(_Error(error))


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """Let a process that starts here ignore Ctrl-C and the end of a batch job.

    Both are sent to every process of a group; this one is asked for what it found first.
    """
    if sys.platform == "win32":
        yield
        return
    resource_tracker.ensure_running()  # its own start would let the signal through again
    stops = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, stops)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
