"""One thread for small dense algebra, whatever the machine has, and what there was afterwards.

The matrices here have some hundred rows. A second thread of the linear algebra shortens nothing,
takes a core from other processes, and adds up in another order: the last digits of an answer would
depend on the number of cores. The number of threads is mostly one of the whole process, so it is
counted how many calls need it to be one: the last to end restores what the first found. Libraries
that have a number for each thread of Python are counted for each.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from threading import RLock, local
from typing import Any, ParamSpec, TypeVar
from weakref import WeakSet

P = ParamSpec("P")
R = TypeVar("R")


class _Call:
    """A call that needs one thread; where Ctrl-C leaves it unended, it is forgotten with it."""


class _Libraries:
    """Some libraries of linear algebra, on one thread while a call needs it."""

    def __init__(self, by_thread: bool) -> None:
        """Take libraries whose threads are set for each thread of Python, or the others."""
        self._by_thread = by_thread
        self._turn = RLock()
        self._calls = WeakSet[_Call]()
        self._known: list[Any] | None = None
        self._before: list[tuple[Any, int]] = []

    def enter(self, call: _Call) -> None:
        """Set one thread, unless another call did."""
        with self._turn:
            if not self._calls:
                self._restore()  # what an interrupted call left
                self._set_one()
            self._calls.add(call)

    def leave(self, call: _Call) -> None:
        """Restore the threads if no other call needs one; a call that never entered may leave."""
        with self._turn:
            self._calls.discard(call)
            if not self._calls:
                self._restore()

    def _set_one(self) -> None:
        for library in self._found():
            threads = library.get_num_threads()
            if threads is not None and threads > 1:
                self._before.append((library, threads))
                _set(library, 1)

    def _restore(self) -> None:
        while self._before:
            library, threads = self._before[-1]
            if library.get_num_threads() == 1:  # else somebody chose another number meanwhile
                _set(library, threads)
            self._before.pop()

    def _found(self) -> list[Any]:
        """The libraries, looked for once: numpy's is loaded before anything is solved."""
        if self._known is None:
            from threadpoolctl import ThreadpoolController  # not needed before anything is solved

            controller: Any = ThreadpoolController().select(user_api="blas")
            self._known = [
                library
                for library in controller.lib_controllers
                if (getattr(library, "threading_layer", "") == "openmp") == self._by_thread
            ]
        return self._known


def _set(library: Any, threads: int) -> None:
    """Set a library's threads, whichever thread set them before: threadpoolctl lets one alone."""
    release = getattr(library, "clear_controlling_thread", None)
    if release is None:
        library.set_num_threads(threads)
        return
    release(force=True)
    library.set_num_threads(threads)
    release(force=True)


class _OfThread(local):
    """Values that each thread of Python has of its own."""

    def __init__(self) -> None:
        self.libraries = _Libraries(by_thread=True)


_OF_PROCESS = _Libraries(by_thread=False)
_OF_THREAD = _OfThread()


def on_one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Call a function with the linear algebra on one thread; within another such call it is so."""

    @wraps(function)
    def alone(*args: P.args, **kwargs: P.kwargs) -> R:
        call = _Call()
        try:
            _OF_PROCESS.enter(call)
            _OF_THREAD.libraries.enter(call)
            return function(*args, **kwargs)
        finally:
            _OF_THREAD.libraries.leave(call)
            _OF_PROCESS.leave(call)

    return alone
