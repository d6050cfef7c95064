"""Ctrl-C: never lost, even inside CasADi, and delayed where it would break something."""

from __future__ import annotations

import signal
import threading
from importlib import import_module
from types import FrameType, TracebackType
from typing import Any, Literal

STOPS = [signal.SIGINT]
"""The signals that stop the work; a program of its own may add some."""
_watches: list[Watch] = []
"""Those under way, the outermost first."""
_handlers_outside: dict[int, Any] = {}
"""The handlers that act outside of them."""
_IN_C: Any = import_module("_signal")
"""Its functions take a tenth of the time of those of `signal`, which make enumerations."""


class Watch:
    """Notes the signals that come during a block.

    Where it `holds` them, the block runs to its end, and the caller decides what then. Otherwise
    they act as outside; and where CasADi swallowed one, KeyboardInterrupt is raised after the
    block, in place of any error.
    """

    def __init__(self, holds: bool) -> None:
        self.holds = holds
        self.signals: list[int] = []
        self._is_outermost = False
        self._depth: int | None = None

    def __enter__(self) -> list[int]:
        if threading.get_ident() != threading.main_thread().ident:
            return self.signals  # only the main thread may change handlers
        self._depth = len(_watches)
        self._is_outermost = not _watches
        try:
            _watches.append(self)
            if self._is_outermost:
                _take_handlers()
        except BaseException:
            self._leave()
            raise
        return self.signals

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> Literal[False]:
        self._leave()
        lost = self.signals and not self.holds and not _are_held()
        if lost and (error is None or isinstance(error, Exception)):
            raise KeyboardInterrupt from error
        return False

    def _leave(self) -> None:
        if self._depth is None:
            return
        del _watches[self._depth :]
        if self._is_outermost:
            _return_handlers()


def note_interrupts() -> Watch:
    """List the interrupts during the block, which runs to its end; the caller decides what then."""
    return Watch(holds=True)


def _are_held() -> bool:
    return any(watch.holds for watch in _watches)


def _note(number: int, frame: FrameType | None) -> None:
    for watch in _watches:
        watch.signals.append(number)
    if not _are_held():
        _handlers_outside[number](number, frame)


def _take_handlers() -> None:
    for number in STOPS:
        handler = _IN_C.getsignal(number)
        if callable(handler) and handler is not _note:
            _handlers_outside[number] = handler
            _IN_C.signal(number, _note)


def _return_handlers() -> None:
    for number, handler in _handlers_outside.items():
        if _IN_C.getsignal(number) is _note:  # a handler may have set another
            _IN_C.signal(number, handler)
