"""The error of a command that was stopped, and has more to say than that."""

from __future__ import annotations

from quietarm.interrupts import exit_status_of
from quietarm.ocp.errors import QuietarmError


class InterruptedCommandError(QuietarmError):
    """A command was stopped, and says what it has done until then."""

    def __init__(self, words: str, stop: BaseException) -> None:
        super().__init__(words)
        self.status = exit_status_of(stop)
