"""Answers that save to a file and load to an equal value."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path
from typing import ClassVar, Self

from ocp.answers.documents import Document, read_document, reading, write_document


class Saved(ABC):
    """An answer that has a file format: JSON, versioned, never executed."""

    kind: ClassVar[str]
    """What it is, in a word; its format is called quietarm- and this."""
    version: ClassVar[int] = 1
    """Version of its format; files of later ones are refused."""
    oldest: ClassVar[int] = 1
    """Oldest version that is read."""

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
        write_document(path, f"quietarm-{self.kind}", self.version, self.to_document())

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
        document = read_document(path, f"quietarm-{cls.kind}", cls.version, cls.oldest)
        with reading(path, cls.kind):
            return cls.from_document(document)

    @abstractmethod
    def to_document(self) -> Document:
        """The answer in JSON's types, SI units and radians."""

    @classmethod
    @abstractmethod
    def from_document(cls, document: Document) -> Self:
        """The answer of a document; KeyError, TypeError or ValueError where it is not one."""
