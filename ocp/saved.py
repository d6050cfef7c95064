"""Answers as JSON files, loaded to equal values; and as tables of a notebook."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import re
from codecs import BOM_UTF8
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from enum import Enum
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar, Self, TypeVar, get_type_hints

import msgspec
import numpy as np

from quietarm.interrupts import interruptible
from quietarm.models import Plant, file_of_plant, known_plants
from quietarm.ocp.checks import clipped, known, quoted, with_article
from quietarm.ocp.energy import Energy, Mix
from quietarm.ocp.errors import FileFormatError
from quietarm.ocp.escapes import html_text
from quietarm.ocp.files import read_bytes, write_whole
from quietarm.ocp.json_text import LEAVES, refuse_repeated, texts_of
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.profiles.term_profile import import_profiles


def to_html(rows: Iterable[Iterable[str]], head: Iterable[str] = ()) -> str:
    """A table in HTML, of rows of text."""
    cells = ["".join(f"<td>{html_text(cell)}</td>" for cell in row) for row in rows]
    first = "".join(f"<th>{html_text(cell)}</th>" for cell in head)
    lines = [first, *cells] if first else cells
    return f"<table>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


T = TypeVar("T")
_FAMILIES: Mapping[Any, str] = {Plant: "plant", JointProfile: "profile", Energy: "energy"}
"""What is saved with its name, by which its class is found again."""
PLANT_FILE = "plant_file"
"""Entry of a plant: the file it was loaded from."""
CHECKSUM = "checksum"
"""Entry of an answer's file: a digest of all the others."""
_MISSING = re.compile("Object missing required field `(.*?)`")
_MOST_OF_PARSER = 120
"""Letters of a parser's message: its own words, and what it quotes of a file."""


def plain(value: Any, whole: bool = False) -> Any:
    """A value in JSON's types, SI units and radians.

    Fields that are `IF_STATED` are left out where they have nothing, unless it is to be `whole`.
    """
    kind = type(value)
    if kind in LEAVES:
        return value
    if kind is tuple or kind is list:
        # most entries are numbers, of which a file may have ten thousands
        return [entry if type(entry) in LEAVES else plain(entry, whole) for entry in value]
    match value:
        case Plant() | JointProfile() | Energy():
            return _named(value) | _entries(value, whole)
        case Enum():
            return value.value
        case Mapping():
            return {name: plain(entry, whole) for name, entry in value.items()}
        case np.ndarray() | np.generic():
            return value.tolist()
        case float():
            return float(value)  # also of a class of its own, as a default window
        case list() | tuple():  # of a class of its own
            return plain(list(value), whole)
        case _ if dataclasses.is_dataclass(value):
            return _entries(value, whole)
    return value


def _entries(value: Any, whole: bool) -> dict[str, Any]:
    entries = {
        entry.name: plain(getattr(value, entry.name), whole)
        for entry in dataclasses.fields(value)
        if entry.init and (whole or _has_something(value, entry))
    }
    as_saved = getattr(value, "as_saved", None)
    return entries if as_saved is None else as_saved(entries)


def _may_be_missing(value: Any) -> set[str]:
    """The entries that a file has only where they say something."""
    if not dataclasses.is_dataclass(value):
        return set()
    return {entry.name for entry in dataclasses.fields(value) if "if_stated" in entry.metadata}


def _has_something(value: Any, entry: dataclasses.Field[Any]) -> bool:
    """Return whether a field is always written, or says more than its default."""
    if "if_stated" not in entry.metadata:
        return True
    content = getattr(value, entry.name)
    factory = entry.default_factory
    return content != (entry.default if factory is dataclasses.MISSING else factory())


def _known_of(family: type[Any]) -> Mapping[str, type[Any]]:
    """The classes by name; quietarm's own profiles are loaded for it."""
    if family is Plant:
        return known_plants()
    if family is JointProfile:
        import_profiles()
    return known(family)


def _named(value: Any) -> dict[str, Any]:
    """The name by which a value's class is found again, and the file that a plant is of."""
    (family,) = (family for family in _FAMILIES if isinstance(value, family))
    kind = type(value)
    if _known_of(family).get(value.name) is not kind:
        raise ValueError(
            f"{kind.__name__} has no name of its own, and {value.name!r} would load as another "
            "class; set `name` in the class"
        )
    file = file_of_plant(kind) if isinstance(value, Plant) else None
    origin = {PLANT_FILE: {"path": file.path, "sha256": file.digest}} if file else {}
    return {"name": value.name} | origin


def typed(document: Any, kind: type[T]) -> T:
    """The value of a document; ValueError where an entry is missing, unknown or not of its kind."""
    document = _as_meant(document, kind)
    try:
        value = msgspec.convert(_meant(document, kind), kind, dec_hook=_known_here)
    except msgspec.ValidationError as error:
        ours = error.__cause__ is not None  # words of a constructor, which quote little
        words = str(error) if ours else clipped(str(error), _MOST_OF_PARSER)
        raise ValueError(_MISSING.sub(r"it has no \1", words)) from None
    complete = plain(value, whole=True)
    if unknown_here := _unknown(document, complete):
        names = clipped(", ".join(sorted(unknown_here)))
        raise ValueError(f"it has entries that are not known here: {names}")
    missing = complete.keys() - _may_be_missing(value) - {*document}
    if missing and isinstance(document, dict):
        raise ValueError(f"it has no {clipped(', '.join(sorted(missing)))}")
    return value


def as_loaded(value: T) -> T:
    """A value as its file would load: a window of 1 is one of 1.0 s."""
    kind = type(value)
    return msgspec.convert(_meant(plain(value), kind), kind, dec_hook=_known_here)


def _meant(document: Any, kind: Any) -> Any:
    """A document as the class and its entries' classes take it, by their `of_saved`."""
    if not isinstance(document, dict) or not isinstance(kind, type):
        return document
    parts = _parts_of(kind)
    inner = {
        name: _meant(entry, parts[name]) if name in parts else entry
        for name, entry in document.items()
    }
    return _as_meant(inner, kind)


@lru_cache(maxsize=64)
def _parts_of(kind: type[Any]) -> Mapping[str, type[Any]]:
    """The entries of a dataclass that are dataclasses themselves."""
    if not dataclasses.is_dataclass(kind):
        return {}
    hints = get_type_hints(kind).items()
    return {name: hint for name, hint in hints if dataclasses.is_dataclass(hint)}  # pyright: ignore[reportReturnType]


def _unknown(document: Any, known: Any) -> set[str]:
    """Entries of a document, at any depth, that what is known does not have."""
    match document, known:
        case dict(), dict():
            inner = (_unknown(document[name], known[name]) for name in document.keys() & known)
            return (document.keys() - known.keys()).union(*inner)
        case list(), list() if document and type(document[0]) not in LEAVES:
            return set().union(*map(_unknown, document, known))
    return set()


def _known_here(kind: Any, entry: Any) -> Any:
    """Convert what msgspec does not know: plants, profiles and energies by their name, arrays."""
    if kind not in _FAMILIES:
        return np.array(msgspec.convert(entry, list[float]))
    if not isinstance(entry, dict) or "name" not in entry:
        raise ValueError(f"{kind.__name__} is {quoted(entry)}; give a table with its name")
    if entry["name"] == Mix.name:
        return typed(entry, Mix)
    family = _FAMILIES[kind]
    classes = _known_of(kind)
    table = dict(entry)
    name = table.pop("name")
    file = table.pop(PLANT_FILE, None)
    if file is not None:
        _check_file(name, file["path"], file["sha256"])
    if name not in classes:
        by_file = ", or name it by --plant-file" if kind is Plant else ""
        raise ValueError(
            f"its {family} {quoted(name)} is not known here (known: {', '.join(sorted(classes))}); "
            f"import the file that defines it first{by_file}"
        )
    try:
        return classes[name](**_with_content(classes[name], table))
    except TypeError as error:  # an entry too many or too few
        raise ValueError(f"its {family} {name!r}: {clipped(str(error), _MOST_OF_PARSER)}") from None


def _with_content(kind: type[Any], table: Mapping[str, Any]) -> dict[str, Any]:
    """The entries of a table, those that are no numbers as values of their classes."""
    names = [
        entry.name
        for entry in dataclasses.fields(kind)
        if "content" in entry.metadata and entry.name in table
    ]
    classes = get_type_hints(kind) if names else {}
    return {**table, **{name: typed(table[name], classes[name]) for name in names}}


def _as_meant(document: Any, kind: type[Any]) -> Any:
    """Return a file's value as its class reads it: by `of_saved` if that has changed since."""
    of_saved = getattr(kind, "of_saved", None)
    return document if of_saved is None else of_saved(document)


def _check_file(name: str, path: str, sha256: str) -> None:
    """Refuse a plant that is here of another file, or none: only what the user named is run."""
    plant = known_plants().get(name)
    loaded = None if plant is None else file_of_plant(plant)
    if loaded is None or loaded.digest != sha256:
        here = "nowhere"
        if loaded is not None:
            here = f"of {_shown(loaded.digest)!r} in {loaded.path!r}"
        raise ValueError(
            f"its plant {quoted(name)} is of file {quoted(path)} with SHA-256 {_shown(sha256)!r}, "
            f"and here {here}; give the file as it was, by --plant-file or load_plant_file, or "
            "compute anew"
        )


def _shown(digest: str) -> str:
    """Return as much of a digest as a message shows."""
    return digest[:12]


def read_document(path: str | Path, kind: str) -> Any:
    """Read the JSON of a file; FileFormatError where it is none."""
    content = read_bytes(path).removeprefix(BOM_UTF8)
    try:
        document = msgspec.json.decode(content)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        if odd := _no_json_number(path):
            raise FileFormatError(
                f"{path} is not a valid {kind}: {odd}, which is no number of JSON; write the "
                f"{kind} again"
            ) from None
        raise FileFormatError(
            f"{path} is not {with_article(kind)}: it is not whole, valid JSON in UTF-8 ({error}); "
            f"write the {kind} again, or save it so"
        ) from None
    try:
        refuse_repeated(content)
    except (ValueError, RecursionError) as error:
        raise FileFormatError(f"{path} is not a valid {kind}: {error}") from None
    return document


def read_content(path: str | Path, kind: type[Answer]) -> dict[str, Any]:
    """Read an answer's file but for format, version and checksum, which are checked."""
    return _content_of(read_document(path, kind.kind), path, kind)


def _content_of(document: Any, path: str | Path, kind: type[Answer]) -> dict[str, Any]:
    """Return a document but for format, version and checksum, which are checked."""
    content = dict(document) if isinstance(document, dict) else {}
    content.pop(CHECKSUM, None)
    stated_format = content.pop("format", None)
    stated_version = content.pop("version", None)
    name = kind.kind
    if stated_format != f"quietarm-{name}":
        raise FileFormatError(
            f"{path} is not {with_article(name)}: its format is {quoted(stated_format)}; give "
            f"{with_article(name)} file"
        )
    if stated_version in kind.read_by_2_0:
        raise FileFormatError(
            f"{path} has version {stated_version} of the {name} format, of before 2.0.0, and this "
            f"quietarm reads {kind.version}; load it with quietarm 2.0 and save it again"
        )
    if stated_version != kind.version:
        raise FileFormatError(
            f"{path} has version {quoted(stated_version)} of the {name} format and this quietarm "
            f"reads {kind.version}; find the {name} again, or install the quietarm that wrote it"
        )
    return content


def _no_json_number(path: str | Path) -> str:
    """The first entry of a file that is NaN or infinite, as Python writes them; empty if none."""
    no_numbers = ("NaN", "Infinity", "-Infinity")
    odd: list[str] = []

    def take(pairs: list[tuple[str, Any]]) -> None:
        odd.extend(f"{clipped(name)} is {entry}" for name, entry in pairs if entry in no_numbers)

    with suppress(ValueError, RecursionError):
        text = read_bytes(path).removeprefix(BOM_UTF8).decode()
        json.loads(text, parse_constant=str, object_pairs_hook=take)
    return odd[0] if odd else ""


def _checksum_of(document: Mapping[str, Any]) -> str:
    """A digest of all entries but the checksum, however numbers and spaces are written."""
    entries = {name: entry for name, entry in document.items() if name != CHECKSUM}
    return _digest(texts_of(entries).canonical)


def _digest(canonical: str) -> str:
    return hashlib.sha256(canonical.encode()).hexdigest()[:32]


@contextmanager
def refusals(path: str | Path, kind: str) -> Iterator[None]:
    """Turn what is wrong with the entries of a file into a FileFormatError that names it."""
    try:
        yield
    except (
        ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError,
    ) as error:  # fmt: skip
        # what is wrong and what to do about it are parted by a semicolon
        remedy = "" if ";" in str(error) else f"; write the {kind} again"
        raise FileFormatError(f"{path} is not a valid {kind}: {error}{remedy}") from None


class Answer:
    """An answer, with a file of its attributes: JSON, versioned, never executed.

    A subclass is a dataclass. A sealed file has a checksum of all other entries, and is refused
    without. It tells changes of what no evaluation tells: candidates, iterations, time, method.
    Whoever computes the checksum again can write what they like.
    """

    kind: ClassVar[str]
    """What it is, in a word; its format is named quietarm-<kind>."""
    version: ClassVar[int]
    """Version of its format, as it is written."""
    read_by_2_0: ClassVar[tuple[int, ...]] = ()
    """Versions of before 2.0.0 that 2.0.0 reads, and writes in the present one."""
    sealed: ClassVar[bool] = True
    """Whether its file has a checksum, and is refused without."""

    @interruptible
    def save(self, path: str | Path) -> None:
        """Write the answer as JSON, whole or not at all; ValueError where that cannot be."""
        write_whole(path, self._text() + "\n")

    def _text(self) -> str:
        """Return the text of the file."""
        texts = texts_of(self._document())
        if not self.sealed:
            return texts.indented
        entries = texts.indented.removesuffix("\n}")
        return f'{entries},\n  "{CHECKSUM}": "{_digest(texts.canonical)}"\n}}'

    def _document(self) -> dict[str, Any]:
        return {"format": f"quietarm-{self.kind}", "version": self.version, **self._content()}

    def _content(self) -> dict[str, Any]:
        """Return what the file holds beside format and version."""
        return plain(self)

    @classmethod
    @interruptible
    def load(cls, path: str | Path) -> Self:
        """Read an answer that `save` wrote, to a value equal to it.

        Raises
        ------
        FileFormatError
            When the file holds something else, is not whole, or of another version.
        """
        document = read_document(path, cls.kind)
        content = _content_of(document, path, cls)
        with refusals(path, cls.kind):
            kind: type[Self] = cls._class_of(content)
            answer = typed(kind._entries_of(content), kind)
            cls._check_document(document)
        return answer

    @classmethod
    def _check_document(cls, document: Mapping[str, Any]) -> None:
        """Refuse a document that was changed since it was written, where its format tells."""
        stated = document.get(CHECKSUM)
        if not cls.sealed or stated == _checksum_of(document):
            return
        why = "it has no checksum" if stated is None else "its checksum is of other entries"
        raise ValueError(
            f"it was changed since it was written, as {why}; find the {cls.kind} again, or "
            "evaluate its coefficients by quietarm evaluate"
        )

    @classmethod
    def _class_of(cls, content: Mapping[str, Any]) -> type[Any]:
        """The class that a file's content is of, which may be a special kind of this one."""
        del content
        return cls

    @classmethod
    def _entries_of(cls, content: Mapping[str, Any]) -> Mapping[str, Any]:
        """The entries of an answer among the content of its file."""
        return content
