"""Standard output and error that may be closed, full or read only in part."""

from __future__ import annotations

import errno
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, TextIO


class Stream:
    """A stream to which writing never fails, even where nobody can read; else as the stream itself.

    Progress, tables and names of files only describe the work: where they cannot be written, the
    work goes on, and its files are written.
    """

    def __init__(self, stream: TextIO, closed: bool = False) -> None:
        self._stream, self.closed = stream, closed
        self.failure: OSError | None = None
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # the name of a file may be any bytes

    def write(self, text: str) -> int:
        """Write, if anybody reads."""
        if self.failure is None:
            try:
                return self._stream.write(text)
            except OSError as error:
                self._give_up(error)
        return len(text)

    def flush(self) -> None:
        """Flush, if anybody reads."""
        if self.failure is None:
            try:
                self._stream.flush()
            except OSError as error:
                self._give_up(error)

    def close(self) -> None:
        """Stay open: a plant's file that closes it ends no output."""

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    @property
    def trouble(self) -> str:
        """Why not everything was written; empty where it was, or the reader had read enough."""
        if self.failure is None or self.failure.errno == errno.EPIPE:
            return ""
        return (self.failure.strerror or str(self.failure)).lower()

    def _give_up(self, error: OSError) -> None:
        self.failure = error
        with suppress(OSError, ValueError):  # what is still in the buffer goes nowhere, silently
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self._stream.fileno())
            os.close(nowhere)


@contextmanager
def patient_streams() -> Iterator[Stream]:
    """Let the block write to both streams even where they fail; yields the output's."""
    closed = _open_what_is_closed()
    if os.environ.get("COLUMNS") == "0":  # as some terminals have it that do not know their width
        del os.environ["COLUMNS"]
    before = sys.stdout, sys.stderr
    with _of_its_own(sys.stdout) as stdout:
        out, err = Stream(stdout, 1 in closed), Stream(sys.stderr, 2 in closed)
        sys.stdout, sys.stderr = out, err  # pyright: ignore[reportAttributeAccessIssue]
        try:
            yield out
        finally:
            out.flush()
            err.flush()
            sys.stdout, sys.stderr = before


@contextmanager
def _of_its_own(stdout: TextIO) -> Iterator[TextIO]:
    """The process's output under a number of its own, and number 1 as another one of its errors.

    What a plant's file, a library or a command that they start write to number 1 is no answer.
    """
    if stdout is not sys.__stdout__:
        yield stdout
        return
    stdout.flush()
    own = os.dup(1)
    os.dup2(2, 1)
    try:
        yield os.fdopen(own, "w", encoding=stdout.encoding, errors=stdout.errors, closefd=False)
    finally:
        os.dup2(own, 1)
        os.close(own)


def _open_what_is_closed() -> list[int]:
    """Open the streams that the shell closed; else a file that is opened later takes their number.

    Returns the numbers of those.
    """
    closed = list[int]()
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            closed.append(os.open(os.devnull, os.O_RDWR))  # takes the lowest number that is free
    for name, number in (("stdout", 1), ("stderr", 2)):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, "w", closefd=False))
    return closed
