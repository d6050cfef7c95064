"""Ctrl-C: never lost, even inside casadi, and delayed where it would break something."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, redirect_stderr
from threading import RLock, get_ident
from types import FrameType
from typing import Any, TextIO

STOPS = [signal.SIGINT]
"""The signals that stop the work; a program of its own may add some."""
_blocks: list[tuple[list[int], bool]] = []
"""The blocks under way: what came during each, and whether it holds that back."""
_before: dict[int, Any] = {}
"""The handlers outside of them."""


def _held() -> bool:
    return any(holds for _, holds in _blocks)


def _note(number: int, frame: FrameType | None) -> None:
    for came, _ in _blocks:
        came.append(number)
    if not _held():
        _before[number](number, frame)


@contextmanager
def _block(holds: bool) -> Iterator[list[int]]:
    """List the interrupts during the block; where no block holds them they act as outside, too."""
    came: list[int] = []
    if threading.current_thread() is not threading.main_thread():  # only it may change handlers
        yield came
        return
    depth = len(_blocks)
    try:
        _blocks.append((came, holds))
        for number in STOPS if depth == 0 else ():
            handler = signal.getsignal(number)
            if callable(handler) and handler is not _note:
                _before[number] = handler
                signal.signal(number, _note)
        yield came
    finally:
        del _blocks[depth:]
        for number, handler in _before.items() if depth == 0 else ():
            if signal.getsignal(number) is _note:  # a handler may have set another
                signal.signal(number, handler)


@contextmanager
def keep_interrupts() -> Iterator[None]:
    """Raise KeyboardInterrupt after the block when Ctrl-C came during it.

    casadi loses it: a solve seems to have failed, or a value is missing and any error follows.
    """
    with _block(holds=False) as came:
        try:
            yield
        except Exception as error:
            if came and not _held():
                raise KeyboardInterrupt from error
            raise
    if came and not _held():
        raise KeyboardInterrupt


def note_interrupts() -> AbstractContextManager[list[int]]:
    """List the interrupts during the block, which runs to its end; the caller decides what then."""
    return _block(holds=True)


_TURN = RLock()


@contextmanager
def _in_turn() -> Iterator[None]:
    with _TURN:
        yield


one_at_a_time = _in_turn()
"""Lets one thread at a time into all the functions that have this decorator.

Two threads that build or solve with casadi at once end the process. A thread that such a function
started itself would wait for ever.
"""


def silent_errors() -> AbstractContextManager[Any]:
    """Drop what this thread writes to standard error in the block; progress in others goes on."""
    muted: Any = _Muted(sys.stderr)
    return redirect_stderr(muted)


class _Muted:
    """A stream that is deaf to the thread that made it."""

    def __init__(self, stream: TextIO) -> None:
        self._stream, self._muted = stream, get_ident()

    def write(self, text: str) -> int:
        """Write, unless this comes from the thread."""
        return len(text) if get_ident() == self._muted else self._stream.write(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)
