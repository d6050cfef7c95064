"""What can go wrong, each with the remedy in its text."""

from __future__ import annotations


class QuietarmError(Exception):
    """Base of quietarm's own exceptions."""


class SolverFailedError(QuietarmError):
    """No start of the solver ended at an optimum; the text says why and what to try."""


class InfeasibleTaskError(SolverFailedError):
    """No motion of the given profile meets the task; the text says what would be feasible."""


class FileFormatError(QuietarmError, ValueError):
    """A file is not what it should be: truncated, of another kind, or of a newer version."""
