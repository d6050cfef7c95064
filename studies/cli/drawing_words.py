"""What matplotlib warns of, as a matplotlibrc that it cannot read: one line each, once."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager

import click
from quietarm.ocp.base.printable import printable


class _OneLineEach(logging.Handler):
    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._said = set[str]()

    def emit(self, record: logging.LogRecord) -> None:
        """Say what is new."""
        said = next(filter(None, map(str.strip, record.getMessage().splitlines())), "")
        if said not in self._said:
            self._said.add(said)
            remedy = "mend that line, or take it out" if " in file " in said else ""
            line = "; ".join(filter(None, [said.rstrip("."), remedy]))
            click.echo(f"quietarm: matplotlib says: {printable(line)}", err=True)


@contextmanager
def matplotlib_in_one_line() -> Iterator[None]:
    """Let what matplotlib warns of during the block be told in quietarm's manner."""
    logger, handler = logging.getLogger("matplotlib"), _OneLineEach()
    handed_on, logger.propagate = logger.propagate, False
    logger.addHandler(handler)
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.propagate = handed_on
