"""Workers that are processes of this machine."""

from __future__ import annotations

import multiprocessing
import signal
import sys
from collections.abc import Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing import resource_tracker
from queue import Empty, SimpleQueue
from threading import Lock
from typing import Any

from quietarm.metaheuristics.sharing.pieces import (
    Done,
    LostPieceError,
    Piece,
    Say,
    Tell,
    in_worker,
)
from quietarm.ocp import QuietarmError
from quietarm.ocp.interrupts import note_interrupts

_FORKED = "forkserver" in multiprocessing.get_all_start_methods()
_DEATHS = 3
"""Workers that a piece may cost before it is given up."""


@contextmanager
def processes(number: int, tell: Tell) -> Iterator[Processes]:
    """So many processes, which end with the block, whatever they do."""
    crew = Processes(number, tell)
    try:
        yield crew
    finally:
        with note_interrupts():
            crew.end()


class Processes:
    """Processes, each with a thread that hands it one piece after another."""

    def __init__(self, number: int, tell: Tell) -> None:
        self.size, self._tell, self._ended = number, tell, False
        self._context: Any = multiprocessing.get_context("forkserver" if _FORKED else "spawn")
        if _FORKED:  # what is loaded here is loaded once for all of them
            loaded = [name for name in sys.modules if name.startswith("quietarm.")]
            self._context.set_forkserver_preload(loaded)
        self._begun, self._idle, self._turn = list[Any](), SimpleQueue[Any](), Lock()
        self._threads = ThreadPoolExecutor(number, initializer=_be_deaf)

    def submit(self, number: int, piece: Piece, known: Done) -> Future[Any]:
        """Have a piece done."""
        return self._threads.submit(self._do, number, piece, known)

    def _do(self, number: int, piece: Piece, known: Done) -> Any:
        for _ in range(_DEATHS):
            process, line = self._one()
            try:
                line.send((piece, known))
                while (said := line.recv())[0] is not None:
                    self._tell(number, said[0])
            except (EOFError, OSError):
                self._note_death(process)
                continue
            self._idle.put((process, line))
            _, answer, error = said
            if error is not None:
                raise error
            return answer
        raise LostPieceError.after(_DEATHS)

    def _one(self) -> tuple[Any, Any]:
        """A process that does nothing and the line to it; it is started where there is none."""
        with suppress(Empty):
            return self._idle.get_nowait()
        with self._turn:
            line, theirs = self._context.Pipe()
            process = self._context.Process(target=_serve, args=(theirs,), daemon=True)
            process.start()
            theirs.close()
            self._begun.append(process)
            if self._ended:
                process.kill()
        return process, line

    def _note_death(self, process: Any) -> None:
        with self._turn:
            process.join()
        if self._ended:
            raise CancelledError
        if process.exitcode > 0:  # no signal: it never began
            raise QuietarmError(
                "the workers could not be started; in a script of your own run it under "
                "if __name__ == '__main__', or with one worker"
            )

    def end(self) -> None:
        """End the processes at once: what they found has been handed over."""
        self._ended = True
        self._threads.shutdown(wait=False, cancel_futures=True)
        for process in self._begun:
            process.kill()
        self._threads.shutdown()
        for process in self._begun:
            process.join()


def _be_deaf() -> None:
    """Let what this thread starts see neither Ctrl-C nor the end of a batch job.

    Both are sent to every process of a group, but it is this one that ends the others.
    """
    if sys.platform != "win32":
        resource_tracker.ensure_running()  # its own start would let the signal through again
        stops = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
        signal.pthread_sigmask(signal.SIG_BLOCK, stops)


def _serve(line: Any) -> None:
    """Do pieces in a process of their own, until the other end of the line is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def tell(what: Any) -> None:
        line.send((what, None, None))

    with suppress(EOFError, OSError):
        while True:
            piece, known = line.recv()
            try:
                said = None, in_worker(piece, known, Say(tell, tell)), None
            except Exception as error:
                said = None, None, error
            line.send(said)
