"""Ctrl-C: never lost, never another error, and delayed where it would break something.

Python runs the handler of a signal between two steps of any function, and what it raises may be
lost there: CasADi's wrapper catches everything and tries its next overload, or returns as if
nothing were; Python itself reports what a weak reference's callback, `__del__` or a callback of the
garbage collector raises, and goes on. Within an import it leaves half a module behind, within
`__enter__` or `__exit__` what these should have put back.

So one handler stands during the operations of quietarm. It looks at the frames: where one of them
loses what is raised, a trace raises it at the next step of the nearest frame outside, as it does
where Python reports that something was lost. Operations are marked by `interruptible`. The
outermost installs the handler in the main thread, and puts back the one that was there; commands
install it once, before anything else is imported. Whatever came and was lost nevertheless is raised
when the operation ends.

This module needs the standard library alone, as the entry of the commands imports it first.
"""

from __future__ import annotations

import gc
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterable
from functools import wraps
from importlib import import_module
from types import CodeType, FrameType, TracebackType
from typing import Any, Literal, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")

INTERRUPTED = "interrupted; only files that were written before are kept"
"""The last word of a command that was stopped."""
_IMPATIENT_SECONDS = 1.0
"""So long after a press that waits, the next one no longer waits."""
_LOSING_MODULES = {"casadi", "weakref", "_weakrefset"}
_IMPORTS = {"importlib._bootstrap", "importlib._bootstrap_external"}
_HALVES = {"__enter__", "__exit__"}
_EVALUATIONS = {"call", "__call__"}
"""Functions of CasADi's wrapper that evaluate, and end early where the handler raises."""
_doors = set[CodeType]()
"""Functions of quietarm that call CasADi's C++ without its wrapper."""
_operations = set[CodeType]()
_IN_C: Any = import_module("_signal")
"""Its functions take a tenth of the time of those of `signal`, which make enumerations."""
_MAIN = threading.main_thread().ident


class _State:
    """State of the handler.

    Each change is one assignment, which no signal divides.
    """

    def __init__(self) -> None:
        self.acts = False
        """Whether the handler may raise; otherwise it keeps what it would raise."""
        self.kept: list[BaseException] = []
        self.outside: dict[int, Callable[[int, FrameType | None], Any]] = {}
        """By signal the handler that was there."""
        self.base: FrameType | None = None
        """The frame of the outermost operation; what is imported or entered outside of it does not
        wait, as that may take as long as a whole program."""
        self.raised: BaseException | None = None
        """What the handler has raised last."""
        self.waits_since: float | None = None
        self.tracer: Any = None
        """The tracer of a debugger that gave way."""
        self.unraisablehook: Any = None
        """The hook that gave way to `_raise_again`."""


_state = _State()


def interruptible(work: Callable[P, R]) -> Callable[P, R]:
    """Mark an operation, during which no Ctrl-C is lost.

    One within another costs a microsecond. In other threads than the main one nothing changes.
    """

    @wraps(work)
    def operation(*args: P.args, **kwargs: P.kwargs) -> R:
        if threading.get_ident() != _MAIN:
            return work(*args, **kwargs)
        handler = _IN_C.getsignal(signal.SIGINT)
        if handler is defer:
            return _inner(work, args, kwargs)
        if not callable(handler):  # ignored, or ends the process
            return work(*args, **kwargs)
        return _outermost(handler, work, args, kwargs)

    marked: Any = operation
    _operations.add(marked.__code__)
    return operation


def is_interruptible(work: object) -> bool:
    """Return whether a function is marked as interruptible."""
    return getattr(work, "__code__", None) in _operations


def _outermost(handler: Any, work: Callable[..., R], args: Any, kwargs: Any) -> R:
    kept: list[BaseException] = []
    try:
        _install(handler, kept)
        return _act(work, args, kwargs)
    finally:
        _put_back(handler)
        if kept:
            raise kept.pop()


def _act(work: Callable[..., R], args: Any, kwargs: Any) -> R:
    """Do the work, in which the handler may raise."""
    try:
        _state.acts = True
        if _state.kept:
            raise _state.kept.pop()
        return _inner(work, args, kwargs)
    finally:
        _state.acts = False


def _install(handler: Any, kept: list[BaseException]) -> None:
    """From the last line on nothing is raised, until `acts` is set."""
    _state.acts = False
    _state.kept = kept
    _state.raised = None
    _state.base = sys._getframe(1)
    _state.outside = {signal.SIGINT: handler}
    _IN_C.signal(signal.SIGINT, defer)


def _put_back(handler: Any) -> None:
    """After its line with `signal` the handler of before raises, and nothing is left to be done."""
    _state.acts = False
    if _state.tracer is not None:
        sys.settrace(_state.tracer)
    if _state.unraisablehook is not None:
        sys.unraisablehook = _state.unraisablehook
    _state.tracer = _state.unraisablehook = _state.base = _state.raised = None
    if _IN_C.getsignal(signal.SIGINT) is defer:  # the work may have set another
        _IN_C.signal(signal.SIGINT, handler)


def _inner(work: Callable[..., R], args: Any, kwargs: Any) -> R:
    """Do the work; if it swallows what the handler raised, raise it in place of what comes."""
    before = _state.raised
    try:
        result = work(*args, **kwargs)
    except Exception as error:
        if lost := _lost_since(before, error):
            raise lost from None
        raise
    if lost := _lost_since(before):
        raise lost
    return result


def _lost_since(
    before: BaseException | None, error: Exception | None = None
) -> BaseException | None:
    raised = _state.raised
    return None if raised is before or raised is error else raised


class note_interrupts:  # noqa: N801  # a context manager, used as a function
    """List the interrupts during the block, which runs to its end; the caller decides what then.

    Within another such block the outer one lists them. In other threads than the main one, and
    where Ctrl-C is ignored, nothing is listed.
    """

    def __enter__(self) -> list[BaseException]:
        self._handler: Any = None
        self._kept: list[BaseException] | None = None
        came: list[BaseException] = []
        if threading.get_ident() != _MAIN:
            return came
        handler = _IN_C.getsignal(signal.SIGINT)
        if handler is defer:
            if _state.acts:
                self._kept = _state.kept
                _state.kept = came
                _state.acts = False
        elif callable(handler):
            self._handler = handler
            _install(handler, came)
        return came

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> Literal[False]:
        if self._handler is not None:
            _put_back(self._handler)
        elif self._kept is not None:
            _state.acts = True
            _state.kept = self._kept
        return False


def calls_casadi(function: Callable[P, R]) -> Callable[P, R]:
    """Mark a function of a few lines that calls CasADi's C++ without its wrapper."""
    _doors.add(function.__code__)
    return function


def as_command(
    work: Callable[[], int],
    answer: Callable[[KeyboardInterrupt], int],
    handler: Callable[[int, FrameType | None], Any],
    numbers: Iterable[int],
) -> int:
    """Do the work of a process, whose status it gives, or the answer to the signal that stops it.

    The handler raises KeyboardInterrupt, and stands for these signals behind the one that defers.
    Once the work has ended or the first signal is being answered, others change nothing.
    """
    _state.outside = dict.fromkeys(numbers, handler)
    try:
        _state.acts = True
        for number in _state.outside:
            _IN_C.signal(number, defer)
        status = work()
        _state.acts = False
    except KeyboardInterrupt as stop:
        _state.acts = False
        status = answer(stop)
    for number in _state.outside:  # Python's end is not stopped either
        signal.signal(number, signal.SIG_IGN)
    return status


def exit_status_of(stop: BaseException) -> int:
    """Return the shell's exit status: 128 and the number of the signal, which of Ctrl-C is 2."""
    number = next(iter(stop.args), signal.SIGINT)
    return 128 + (number if isinstance(number, int) else signal.SIGINT)


def defer(number: int, frame: FrameType | None) -> None:
    """The handler: call the one outside; what it raises, raise where it is not lost."""
    try:
        _state.outside[number](number, frame)
    except BaseException as error:
        stop = error.with_traceback(None)
    else:
        return
    if not _state.acts:
        _state.kept.append(stop)
        return
    _state.raised = stop
    if sys.unraisablehook is not _raise_again:
        _state.unraisablehook = sys.unraisablehook
        sys.unraisablehook = _raise_again
    outside, within = _frame_outside(frame)
    if outside is None or _is_impatient():
        _state.waits_since = None
        raise stop
    if outside is not frame:
        _state.waits_since = time.monotonic()
        _raise_at(outside, stop)
        if not all(map(_evaluates, within)):
            return  # CasADi's evaluations end early where the handler raises
    raise stop


def _raise_again(lost: Any) -> None:
    """Raise what Python lost in a callback that nothing tells from other frames."""
    if lost.exc_value is not _state.raised:
        _state.unraisablehook(lost)
        return
    stop = lost.exc_value
    outside, _ = _frame_outside(sys._getframe(1))
    if outside is not None:
        _raise_at(outside, stop.with_traceback(None))


def _frame_outside(frame: FrameType | None) -> tuple[FrameType | None, list[FrameType]]:
    """The nearest frame that neither loses nor breaks anything, and those within that do."""
    callbacks = {getattr(callback, "__code__", None) for callback in gc.callbacks}
    outside = frame
    within: list[FrameType] = []
    is_ours = True
    while frame is not None:
        if _loses(frame) or frame.f_code in callbacks or (is_ours and _breaks(frame)):
            within.append(frame)
            outside = frame.f_back
        if frame is _state.base:
            is_ours = False
        frame = frame.f_back
    return outside, within


def _loses(frame: FrameType) -> bool:
    """Return whether what is raised in a frame is lost."""
    is_named = frame.f_code.co_name == "__del__" or frame.f_code in _doors
    return is_named or _module(frame).partition(".")[0] in _LOSING_MODULES


def _breaks(frame: FrameType) -> bool:
    """Return whether something half done stays when a frame ends early."""
    return frame.f_code.co_name in _HALVES or _module(frame) in _IMPORTS


def _module(frame: FrameType) -> str:
    return str(frame.f_globals.get("__name__"))


def _is_impatient() -> bool:
    since = _state.waits_since
    return since is not None and time.monotonic() - since > _IMPATIENT_SECONDS


def _evaluates(frame: FrameType) -> bool:
    """Return whether CasADi evaluates a function, be it with callbacks."""
    if frame.f_code in _doors:
        return True
    return _module(frame).startswith("casadi") and frame.f_code.co_name in _EVALUATIONS


def _raise_at(outside: FrameType, stop: BaseException) -> None:
    """Raise at a frame's next step, or in place of the error that reaches it.

    Whatever traces this thread gives way until the operation ends: Python takes a tracer that
    raises away, and its neighbours with it.
    """

    def step(frame: FrameType, event: str, argument: object) -> None:
        sys.settrace(None)
        frame.f_trace_opcodes = False  # first: from 3.13 on it does nothing without a trace
        frame.f_trace = None
        _state.waits_since = None
        raise stop

    def wait(frame: FrameType, event: str, argument: object) -> None:
        """No local trace for frames that begin."""

    tracer = sys.gettrace()
    if getattr(tracer, "__module__", None) != __name__:
        _state.tracer = tracer
    outside.f_trace = step
    outside.f_trace_opcodes = True
    sys.settrace(wait)  # last: 3.12 looks only now at what the frame asks for
