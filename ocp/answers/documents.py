"""JSON documents with a format name and a version; never pickle, never anything that runs."""

from __future__ import annotations

import json
import re
import reprlib
from codecs import BOM_UTF8
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

import msgspec
from quietarm.ocp.answers.encoding import typed
from quietarm.ocp.base.errors import FileFormatError
from quietarm.ocp.base.files import read_bytes, write_whole

Document = dict[str, Any]
T = TypeVar("T")


def write_document(path: str | Path, name: str, version: int, content: Document) -> None:
    """Write a document whole or not at all; ValueError when it cannot be written."""
    document = {"format": f"quietarm-{name}", "version": version, **content}
    write_whole(path, json.dumps(document, indent=2, allow_nan=False) + "\n")


def read_document(path: str | Path, name: str, version: int, kind: type[T]) -> T:
    """Read a document of one kind."""
    try:
        document = msgspec.json.decode(read_bytes(path).removeprefix(BOM_UTF8))
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise FileFormatError(
            f"{path} is not a {name}: it is not whole, valid JSON in UTF-8{_where(error)}; "
            f"write the {name} again, or save it so"
        ) from None
    content = content_of(path, document, name, version)
    with reading(path, name):
        return typed(content, kind)


def _where(error: Exception) -> str:
    """What a text that is no JSON stumbles over, where its decoder knows it."""
    if "truncated" in str(error):
        return ", for it ends too early"
    if "out of range" in str(error):
        return ", for one of its numbers is out of range"
    at = re.search(r"\(byte (\d+)\)", str(error))
    return f" at byte {at[1]}" if at else ""


def content_of(path: str | Path, document: Any, name: str, version: int) -> Document:
    """What a document holds beside its format and version, which are checked."""
    content = dict(document) if isinstance(document, dict) else {}
    found_name, found = content.pop("format", None), content.pop("version", None)
    if found_name != f"quietarm-{name}":
        its = f"its format is {reprlib.repr(found_name)}"
        says = its if found_name else "it has no quietarm format name"
        raise FileFormatError(f"{path} is not a {name}: {says}; give a {name} file")
    if not isinstance(found, int) or isinstance(found, bool) or found < 1:
        raise FileFormatError(
            f"{path} is not a {name}: its version is {reprlib.repr(found)}; give a {name} file"
        )
    if found > version:
        raise FileFormatError(
            f"{path} has version {reprlib.repr(found)} of the {name} format and this quietarm "
            f"reads up to {version}; install a newer quietarm"
        )
    if found < version:
        raise FileFormatError(
            f"{path} has version {found} of the {name} format and this quietarm reads {version}; "
            f"find the {name} again"
        )
    return content


@contextmanager
def reading(path: str | Path, name: str) -> Iterator[None]:
    """Turn a missing or wrong entry met while reading a document into one clear error."""
    try:
        yield
    except KeyError as error:
        raise FileFormatError(
            f"{path} is not a whole {name}: {error} is missing; write the {name} again"
        ) from None
    except ValueError as error:
        # what is wrong and what to do about it are parted by a semicolon
        remedy = "" if ";" in str(error) else f"; write the {name} again"
        raise FileFormatError(f"{path} is not a valid {name}: {error}{remedy}") from None
    except (TypeError, AttributeError, IndexError, OverflowError, RecursionError):
        # in Python's own words, which help nobody
        raise FileFormatError(
            f"{path} is not a valid {name}: an entry is not of the kind it should be; write the "
            f"{name} again"
        ) from None
