"""Ctrl-C during casadi's own loops, which swallow it."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_deferring = False


@contextmanager
def keep_interrupts() -> Iterator[None]:
    """Raise KeyboardInterrupt after the block when Ctrl-C came during it.

    casadi's solver stops at Ctrl-C, but returns as if the solve had merely failed; where Ctrl-C
    comes while casadi takes an array, a value is missing afterwards and any error may follow.
    """
    with _noting(at_once=True) as came:
        try:
            yield
        except Exception as error:
            if came:
                raise KeyboardInterrupt from error
            raise
    if came:
        raise KeyboardInterrupt


@contextmanager
def defer_interrupts() -> Iterator[None]:
    """Let the block run to its end when Ctrl-C comes during it; raise KeyboardInterrupt then."""
    with note_interrupts() as came:
        yield
    if came:
        raise KeyboardInterrupt


@contextmanager
def note_interrupts() -> Iterator[list[int]]:
    """Let the block run to its end when Ctrl-C comes during it, and tell it.

    Yields
    ------
    list of int
        The interrupts until now. To end at them, early or not, is left to the caller.
    """
    global _deferring
    outer, _deferring = _deferring, True
    try:
        with _noting(at_once=False) as came:
            yield came
    finally:
        _deferring = outer


@contextmanager
def _noting(at_once: bool) -> Iterator[list[int]]:
    """Note the interrupts that come during the block; `at_once` they act as before, too."""
    came: list[int] = []
    before = signal.getsignal(signal.SIGINT)
    in_main = threading.current_thread() is threading.main_thread()
    if not in_main or not callable(before) or (at_once and _deferring):
        yield came
        return

    def note(number: int, frame: FrameType | None) -> None:
        came.append(number)
        if at_once:
            before(number, frame)

    signal.signal(signal.SIGINT, note)
    try:
        yield came
    finally:
        signal.signal(signal.SIGINT, before)
