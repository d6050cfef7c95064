"""Standard output and error that may be full, or read only in part."""

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

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
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
    if os.environ.get("COLUMNS") == "0":  # as some terminals have it that do not know their width
        del os.environ["COLUMNS"]
    before = sys.stdout, sys.stderr
    out, err = Stream(sys.stdout), Stream(sys.stderr)
    sys.stdout, sys.stderr = out, err  # pyright: ignore[reportAttributeAccessIssue]
    try:
        yield out
    finally:
        out.flush()
        err.flush()
        sys.stdout, sys.stderr = before
