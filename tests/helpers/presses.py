"""Ctrl-C exactly where a test wants it."""

import signal
import sys
from contextlib import contextmanager


def press():
    """Ctrl-C, whose handler Python runs at the next opportunity, which is within this call."""
    signal.raise_signal(signal.SIGINT)


@contextmanager
def pressed_at(number, is_meant):
    """Press before one step of the frames that are meant: a list of how many there were."""
    seen = [0]

    def step(frame, event, argument):
        if event == "opcode":
            seen[0] += 1
            if seen[0] == number:
                sys.settrace(None)
                press()
        return step

    def begin(frame, event, argument):
        if not is_meant(frame):
            return None
        frame.f_trace = step  # Python 3.13 needs it first, 3.12 the last line
        frame.f_trace_opcodes = True
        sys.settrace(begin)
        return step

    sys.settrace(begin)
    try:
        yield seen
    finally:
        sys.settrace(None)
