"""Ctrl-C: never lost, even inside casadi, and delayed where it would break something."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from types import FrameType
from typing import Any

_deferring = False
_listeners: list[list[int]] = []
_signals = [signal.SIGINT]
"""What stops the work."""
_ALARMS = [
    getattr(signal, name)
    for name in ("SIGALRM", "SIGVTALRM", "SIGPROF", "SIGUSR1", "SIGUSR2")
    if hasattr(signal, name)
]
"""Signals by which a program limits its own time, or is told something."""


@contextmanager
def as_ctrl_c() -> Iterator[None]:
    """Let SIGTERM and SIGHUP stop the block as Ctrl-C does.

    For a program that is a process of its own. Both raise KeyboardInterrupt in the block, unless
    they are handled or ignored already.
    """
    wanted = [getattr(signal, name, None) for name in ("SIGTERM", "SIGHUP")]
    taken = [one for one in wanted if one and signal.getsignal(one) is signal.SIG_DFL]
    if threading.current_thread() is not threading.main_thread():
        taken = []
    for one in taken:
        signal.signal(one, signal.default_int_handler)
    _signals.extend(taken)
    try:
        yield
    finally:
        for one in taken:
            _signals.remove(one)
            signal.signal(one, signal.SIG_DFL)


@contextmanager
def keep_interrupts() -> Iterator[None]:
    """Raise KeyboardInterrupt after the block when Ctrl-C came during it.

    casadi's solver stops at Ctrl-C, but returns as if the solve had merely failed; where Ctrl-C
    comes while casadi takes an array, a value is missing afterwards and any error may follow. What
    the user's own handler of an alarm raises, as for a limit of time, is lost in the same way, and
    raised after the block as well.
    """
    with _noting(at_once=True) as came, _noting_alarms() as raised:
        try:
            yield
        except Exception as error:
            if came:
                raise KeyboardInterrupt from error
            if raised and error is not raised[0]:
                raise raised[0] from error
            raise
    if came:
        raise KeyboardInterrupt
    if raised:
        raise raised[0]


@contextmanager
def _noting_alarms() -> Iterator[list[BaseException]]:
    """Note what the user's handlers of `_ALARMS` raise during the block."""
    raised: list[BaseException] = []
    before = _handlers(_ALARMS)

    def note(number: int, frame: FrameType | None) -> None:
        try:
            before[number](number, frame)
        except BaseException as error:
            raised.append(error)
            raise

    with _handled_by(note, before):
        yield raised


@contextmanager
def note_interrupts() -> Iterator[list[int]]:
    """Let the block run to its end when Ctrl-C comes during it; the block can see that it came.

    Yields
    ------
    list of int
        The interrupts until now. The caller decides whether to stop.
    """
    global _deferring
    outer, _deferring = _deferring, True
    try:
        with _noting(at_once=False) as came:
            yield came
    finally:
        _deferring = outer


@contextmanager
def hear_interrupts() -> Iterator[list[int]]:
    """List the interrupts during the block, including those that the work inside handles itself.

    An interrupt still acts as it would without this block. Work that keeps what it found may return
    an answer all the same; the list then tells the caller that the user wants to stop.

    Yields
    ------
    list of int
        The interrupts until now.
    """
    with _noting(at_once=True) as came:
        _listeners.append(came)
        try:
            yield came
        finally:
            _listeners.pop()


@contextmanager
def _noting(at_once: bool) -> Iterator[list[int]]:
    """Note the interrupts that come during the block; `at_once` they act as before, too."""
    came: list[int] = []
    before = {} if at_once and _deferring else _handlers(_signals)

    def note(number: int, frame: FrameType | None) -> None:
        came.append(number)
        if at_once:
            before[number](number, frame)
        else:  # swallowed here: no outer block would notice it
            for heard in _listeners:
                heard.append(number)

    with _handled_by(note, before):
        yield came


_Handler = Callable[[int, FrameType | None], object]


def _handlers(numbers: Iterable[int]) -> dict[int, _Handler]:
    """What handles these signals now, where a function does; only the main thread may change it."""
    if threading.current_thread() is not threading.main_thread():
        return {}
    handlers: dict[int, Any] = {number: signal.getsignal(number) for number in numbers}
    return {number: handler for number, handler in handlers.items() if callable(handler)}


@contextmanager
def _handled_by(note: _Handler, before: Mapping[int, _Handler]) -> Iterator[None]:
    """Let a function handle these signals during the block, and what did before after it."""
    for number in before:
        signal.signal(number, note)
    try:
        yield
    finally:
        for number, handler in before.items():
            if signal.getsignal(number) is note:  # a handler may have set another
                signal.signal(number, handler)
