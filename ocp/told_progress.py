"""Progress that is told while long work goes on."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[int, int], object]
"""Told how much is done, and how much there is."""


def no_report(done: int, total: int) -> None:
    """Report nothing."""
