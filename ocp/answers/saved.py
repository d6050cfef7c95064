"""Answers that save to a file and load to an equal value."""

from __future__ import annotations

from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, Self, get_type_hints

from quietarm.ocp.answers.documents import read_document, write_document
from quietarm.ocp.answers.encoding import plain, typed


class Saved:
    """An answer that has a file format: JSON, versioned, never executed.

    A subclass is a dataclass; its file has its attributes.
    """

    kind: ClassVar[str]
    """What it is, in a word: its format is named quietarm-<kind>."""
    version: ClassVar[int]
    """Version of its format; files of later ones are refused."""

    def _check_entries(self, *others: str) -> None:
        """Convert the entries to what a file would give back, so that any value made can be loaded.

        NumPy's numbers become Python's, lists become tuples.

        Parameters
        ----------
        *others : str
            Entries that are checked elsewhere.

        Raises
        ------
        ValueError
            When an entry is not what it should be: with its name, its value and why.
        """
        for name, kind in _kinds(type(self)).items():
            if name not in others:
                object.__setattr__(self, name, typed(plain(getattr(self, name)), kind, name))

    def save(self, path: str | Path) -> None:
        """Write the answer as JSON, whole or not at all.

        Parameters
        ----------
        path : str or Path
            The file.

        Raises
        ------
        ValueError
            When the file cannot be written.
        """
        write_document(path, self.kind, self.version, plain(self))

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """Read an answer that `save` wrote.

        Parameters
        ----------
        path : str or Path
            The file.

        Returns
        -------
        Self
            A value equal to the one saved.

        Raises
        ------
        FileFormatError
            When the file holds something else, is not whole, or of a newer version.
        """
        return read_document(path, cls.kind, cls.version, cls)


@cache
def _kinds(of: type[Any]) -> dict[str, Any]:
    """The types of a dataclass's entries, with their ranges."""
    hints = get_type_hints(of, include_extras=True)
    return {entry.name: hints[entry.name] for entry in fields(of)}
