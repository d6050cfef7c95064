"""Ctrl-C while the command is still being loaded, which takes a third of a second."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from types import FrameType

_COMMANDS = ("quietarm", "-m")
"""Names of the running program at the time that this is loaded, where it is the command:
`python -m studies` has not found its file yet."""


def end_in_one_line() -> None:
    """Let Ctrl-C and SIGTERM end the command in one line until `ready`; do nothing elsewhere."""
    if Path(next(iter(sys.argv), "")).stem in _COMMANDS:
        for number in (signal.SIGINT, signal.SIGTERM):
            if signal.getsignal(number) in (signal.default_int_handler, signal.SIG_DFL):
                signal.signal(number, _end)


def ready() -> bool:
    """Leave signals to the command, which can handle them now; whether they were handled here."""
    was = signal.getsignal(signal.SIGINT) is _end
    for number, usual in (
        (signal.SIGINT, signal.default_int_handler),
        (signal.SIGTERM, signal.SIG_DFL),
    ):
        if signal.getsignal(number) is _end:
            signal.signal(number, usual)
    return was


def _end(number: int, frame: FrameType | None) -> None:
    # An exception would pass through what is half loaded, and be shown with its traceback.
    os.write(2, b"quietarm: interrupted; nothing was written\n")
    os._exit(1)
