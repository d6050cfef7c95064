"""Answers that save to a file and load to an equal value."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar, Self

from quietarm.ocp.answers.documents import plain, read_document, write_document


class Saved:
    """An answer that has a file format: JSON, versioned, never executed.

    A subclass is a dataclass; its file has its attributes.
    """

    kind: ClassVar[str]
    """What it is, in a word: its format is named quietarm-<kind>."""
    version: ClassVar[int]
    """Version of its format; files of later ones are refused."""

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
