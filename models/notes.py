"""Warnings about a plant, in one line each, which stand beside the figures of its motions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Note:
    """A warning about a plant, and which figures it touches.

    Attributes
    ----------
    words : str
        One line, without "warning".
    about : tuple of str
        Of "energy", "torque" and "residual": beside these figures it is shown; a note about none
        has a line of its own.
    """

    words: str
    about: tuple[str, ...] = ()


def about(notes: Iterable[Note], figure: str) -> list[str]:
    """The words of the notes that touch a figure."""
    return [note.words for note in notes if figure in note.about]
