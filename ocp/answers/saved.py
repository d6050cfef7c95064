"""Answers that save to a file and load to an equal value."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar, Self

from ocp.answers.documents import NO_UPGRADES, Upgrades, read_document, write_document
from ocp.answers.encoding import plain


class Saved:
    """An answer that has a file format: JSON, versioned, never executed.

    A subclass is a dataclass; its file has its attributes.
    """

    kind: ClassVar[str]
    """What it is, in a word; its format is called quietarm- and this."""
    version: ClassVar[int]
    """Version of its format; files of later ones are refused."""
    upgrades: ClassVar[Upgrades] = NO_UPGRADES
    """What makes today's document of one of an older version; by version."""

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
        return read_document(path, cls.kind, cls.version, cls, cls.upgrades)
