"""Searches from several seeds at the same time, in processes that outlive Ctrl-C and each other."""

from __future__ import annotations

import signal
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from multiprocessing import get_context, resource_tracker
from multiprocessing.connection import Connection, wait
from typing import Any, Protocol

from metaheuristics.search import SearchProgress, search
from ocp import Front, PointToPoint
from ocp.interrupts import defer_interrupts


class Report(Protocol):
    """Called as searches go on."""

    def __call__(self, progress: SearchProgress, seed: int) -> None:
        """Hear where the search of this seed is."""
        ...


_CONTEXT = get_context("spawn")  # a fork would carry casadi's and the threads' state into the child
_PATIENCE = 1.2
"""How long [s] the searches that run at Ctrl-C have to hand over what they found."""
_REPORT_SECONDS = 0.2
ENDED = "status"
"""How the end of a process is told that ended by itself, neither killed nor out of memory."""


class Workers:
    """Processes that share out seeds.

    Parameters
    ----------
    task, method, settings
        As for `search`.
    seeds : iterable of int
        What there is to do.
    report : callable
        Called with a `SearchProgress` and its seed, a few times a second.
    done : callable
        Called with every front that is complete.

    Attributes
    ----------
    fronts : dict of int to Front
        What was found, by seed; incomplete fronts of searches that were stopped among them.
    lost : dict of int to str
        Seeds whose process died, with how it ended.
    """

    def __init__(
        self,
        task: PointToPoint,
        method: str,
        settings: Mapping[str, Any],
        seeds: Iterable[int],
        report: Report,
        done: Callable[[Front], None],
    ) -> None:
        self.fronts: dict[int, Front] = {}
        self.lost: dict[int, str] = {}
        self._work = (task, method, settings)
        self._waiting = deque(seeds)
        self._report, self._done = report, done
        self._busy: dict[Any, _Worker] = {}

    def run(self, number: int) -> None:
        """Search every seed in this many processes; after Ctrl-C keep what was found so far."""
        try:
            while self._waiting and len(self._busy) < number:
                with defer_interrupts():  # no process is started and then forgotten
                    worker = _Worker(*self._work)
                    self._busy[worker.link] = worker
                    worker.send(self._waiting.popleft())
            while self._busy:
                self._listen()
        except KeyboardInterrupt:
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
            worker.send(None)
        until = time.monotonic() + _PATIENCE
        while self._busy and time.monotonic() < until:
            self._listen(until - time.monotonic())

    def _listen(self, seconds: float | None = None) -> None:
        """Take a message of every worker that has one within this time."""
        for link in wait(list(self._busy), seconds):
            with defer_interrupts():  # a message is read whole, and what is in it kept
                worker = self._busy[link]
                seed, message = worker.seed, worker.receive()
                if isinstance(message, Front):
                    self.fronts[seed] = message
                elif isinstance(message, _Death):
                    self.lost[seed] = message.how
                if isinstance(message, Front) and self._waiting:
                    worker.send(self._waiting.popleft())
                elif not isinstance(message, SearchProgress):
                    del self._busy[link]
                    worker.end()
            if isinstance(message, Exception):
                raise message
            if isinstance(message, SearchProgress):
                self._report(message, seed)
            elif isinstance(message, Front) and message.complete:
                self._done(message)


class _Death:
    """What is heard of a process that died, or that has no memory left to go on."""

    def __init__(self, how: str) -> None:
        self.how = how

    @classmethod
    def of(cls, code: int) -> _Death:
        """The death of a process by its exit code."""
        return cls(f"killed by {signal.Signals(-code).name}" if code < 0 else f"{ENDED} {code}")


class _Worker:
    """A process, the link to it, and the seed that it searches."""

    def __init__(self, task: PointToPoint, method: str, settings: Mapping[str, Any]) -> None:
        self.seed = -1
        self.link, theirs = _CONTEXT.Pipe()
        arguments = (theirs, task, method, settings)
        self.process = _CONTEXT.Process(target=_serve, args=arguments, daemon=True)
        with _deaf_to_interrupts():
            self.process.start()
        theirs.close()  # so that the link ends when the process does

    def send(self, seed: int | None) -> None:
        """Give the next seed, or None to stop."""
        self.seed = self.seed if seed is None else seed
        with suppress(OSError):  # it is dead: the next `receive` finds out
            self.link.send(seed)

    def receive(self) -> SearchProgress | Front | Exception | _Death:
        """The message that is there."""
        try:
            message = self.link.recv()
        except (EOFError, OSError):
            self.process.join()
            return _Death.of(self.process.exitcode or 0)
        return _Death("out of memory") if isinstance(message, MemoryError) else message

    def end(self) -> None:
        """End the process, whatever it does."""
        self.process.terminate()
        self.process.join()
        self.link.close()


def _serve(link: Connection, task: PointToPoint, method: str, settings: Mapping[str, Any]) -> None:
    """Search every seed that comes through the link, until None comes or the parent is gone.

    Whatever comes during a search stops it as Ctrl-C does, and what it found is answered.
    """
    said = 0.0

    def report(progress: SearchProgress) -> None:
        nonlocal said
        if link.poll():
            raise KeyboardInterrupt
        if time.monotonic() - said > _REPORT_SECONDS:
            said = time.monotonic()
            link.send(progress)

    with suppress(EOFError, OSError):  # the parent is gone
        for seed in iter(link.recv, None):
            said = 0.0  # of every search its first generation is reported
            try:
                link.send(search(task, method, seed=seed, report=report, **settings))
            except Exception as error:
                link.send(error)


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """Let a process that starts here never see Ctrl-C, which a terminal sends to every process."""
    if sys.platform == "win32":
        yield
        return
    resource_tracker.ensure_running()  # its own start would let the signal through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
