"""What stops a command besides Ctrl-C."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from quietarm.ocp.interrupts import STOPS


@contextmanager
def as_ctrl_c() -> Iterator[None]:
    """Let SIGTERM and SIGHUP stop the block as Ctrl-C does.

    For a program that is a process of its own. Signals that are handled or ignored stay so.
    """
    others = [one for one in signal.Signals if one.name in ("SIGTERM", "SIGHUP")]
    main = threading.current_thread() is threading.main_thread()  # only it may change handlers
    taken = [one for one in others if main and signal.getsignal(one) is signal.SIG_DFL]
    for one in taken:
        signal.signal(one, signal.default_int_handler)
    STOPS.extend(taken)
    try:
        yield
    finally:
        for one in taken:
            STOPS.remove(one)
            signal.signal(one, signal.SIG_DFL)
