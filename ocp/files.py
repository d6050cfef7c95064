"""Check that a file can be written before the work begins; write it whole or not at all; read."""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

from quietarm.ocp.checks import name_of_file
from quietarm.ocp.errors import FileFormatError

MOST_BYTES = 100_000_000
"""Of a file that is read: two hours of four signals at 100 Hz as text are 40 MB."""


def read_bytes(path: str | Path) -> bytes:
    """The content of an ordinary file; FileFormatError where it cannot be read, or is too large."""
    name_of_file(path)
    place = Path(path)
    try:
        if place.exists() and not place.is_file():  # a pipe may never end, and does not come again
            raise FileFormatError(f"{path} is no ordinary file; save it as one and give its name")
        with open(place, "rb") as file:
            content = file.read(MOST_BYTES + 1)
        if len(content) > MOST_BYTES:
            raise FileFormatError(
                f"{path} has {place.stat().st_size / 1e6:.0f} MB; give at most "
                f"{MOST_BYTES / 1e6:.0f} MB, the part that matters"
            )
        return content
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise FileFormatError(f"{path} cannot be read: {reason}; give another file") from None


def check_writable(path: str | Path) -> Path:
    """Make sure that a file can be written, before a solve rather than after it."""
    name_of_file(path)
    target = Path(path)
    try:
        if target.is_symlink():
            with suppress(FileNotFoundError):  # to a file that is to be
                target.stat()  # of links that lead round the system says so
        # a link may lead to another folder
        folder = target.resolve().parent if target.is_symlink() else target.parent
        if target.is_dir():
            raise ValueError(f"{target} is a folder; give the name of a file in it")
        if target.exists() and not target.is_file():
            raise ValueError(f"{target} is no ordinary file; give the name of one")
        if not folder.exists():
            raise ValueError(f"folder {folder} does not exist; make it first")
        if target.exists() and not os.access(target, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        tempfile.TemporaryFile(dir=folder).close()  # else the system says what is wrong
    except OSError as error:
        raise unwritable(target, error) from None
    return target


def unwritable(target: Path, error: OSError) -> ValueError:
    """Return the error for a file that the system refuses to write."""
    reason = (error.strerror or str(error)).lower()
    return ValueError(f"{target} cannot be written: {reason}; choose another place")


def write_whole(path: str | Path, content: str | bytes) -> None:
    """Write a temporary file beside it, then rename: a file is never half-written.

    A file that was there keeps its permissions.
    """
    name_of_file(path)
    write_together({path: content})


def write_together(contents: Mapping[str | Path, str | bytes]) -> None:
    """Write files that need each other, all or none; ValueError names one that cannot be."""
    # a link stays a link, to the new content
    targets = {check_writable(path).resolve(): content for path, content in contents.items()}
    prepared = dict[Path, Path]()
    try:
        for target, content in targets.items():
            prepared[target] = _beside(target)
            with _named(target):
                _write_through(prepared[target], content)
                if target.exists():
                    shutil.copymode(target, prepared[target])
        _put_in_place(prepared)
    finally:
        for temporary in prepared.values():
            temporary.unlink(missing_ok=True)


def _beside(target: Path) -> Path:
    """A name that no other file has, in the folder of a file."""
    return target.parent / f".quietarm-{uuid4().hex}"


@contextmanager
def _named(target: Path) -> Iterator[None]:
    """Name a file in what the system says of it."""
    try:
        yield
    except OSError as error:
        raise unwritable(target, error) from error


def _write_through(path: Path, content: str | bytes) -> None:
    """Write a new file to the disk itself; letters that UTF-8 does not have are question marks."""
    with open(path, "xb") as file:
        file.write(content.encode(errors="replace") if isinstance(content, str) else content)
        file.flush()
        os.fsync(file.fileno())


def _put_in_place(prepared: Mapping[Path, Path]) -> None:
    """Rename files to their places; where one fails, those before are as they were."""
    alone = len(prepared) == 1  # there is nothing before it
    before = dict[Path, Path | None]()
    try:
        for target, temporary in prepared.items():
            with _named(target):
                if not alone:
                    before[target] = _kept(target)
                os.replace(temporary, target)
    except ValueError:
        for target, kept in before.items():
            with suppress(OSError):
                if kept is None:
                    target.unlink(missing_ok=True)
                else:
                    os.replace(kept, target)
        raise
    finally:
        for kept in filter(None, before.values()):
            kept.unlink(missing_ok=True)


def _kept(target: Path) -> Path | None:
    """Copy a file to another name, which is returned; None where there is no file."""
    if not target.exists():
        return None
    kept = _beside(target)
    shutil.copy2(target, kept)
    return kept
