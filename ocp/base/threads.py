"""casadi and threads: one thread at a time, and silence for it alone."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from threading import RLock, get_ident
from typing import Any, ParamSpec, TextIO, TypeVar

P = ParamSpec("P")
T = TypeVar("T")

_TURN = RLock()


def one_at_a_time(function: Callable[P, T]) -> Callable[P, T]:
    """Let one thread at a time into all the functions that have this decorator.

    casadi is not made for several: two threads that build or solve at once end the process. A
    function that is called from inside another goes on; a thread that it started itself would wait
    for ever.
    """

    @wraps(function)
    def in_turn(*args: P.args, **kwargs: P.kwargs) -> T:
        with _TURN:
            return function(*args, **kwargs)

    return in_turn


@contextmanager
def silent_errors() -> Iterator[None]:
    """Drop what this thread writes to standard error in the block; progress in others goes on."""
    everybody = sys.stderr
    sys.stderr = _Muted(everybody)
    try:
        yield
    finally:
        sys.stderr = everybody


class _Muted:
    """A stream that is deaf to the thread that made it."""

    def __init__(self, stream: TextIO) -> None:
        self._stream, self._muted = stream, get_ident()

    def write(self, text: str) -> int:
        """Write, unless this comes from the thread."""
        return len(text) if get_ident() == self._muted else self._stream.write(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)
