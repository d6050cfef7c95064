"""Check that a file can be written before the work begins; write it whole or not at all; read."""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Sequence
from pathlib import Path

written: list[Path] = []
"""The files that this process has written, in order: so that an interruption can say what is kept.
"""
MOST_BYTES = 100_000_000
"""Forty times a front of ten thousand points."""


def read_whole(path: str | Path) -> bytes:
    """The content of an ordinary file.

    A pipe or a device is not read: it may never end, and does not come again.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    bytes
        All of it.

    Raises
    ------
    ValueError
        When it cannot be read, is no ordinary file, or is larger than `MOST_BYTES`.
    """
    _refuse_no_name(path)
    try:
        with open(path, "rb", opener=_open_at_once) as file:
            if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                raise ValueError(f"{path} is no ordinary file; save it as one and give its name")
            content = file.read(MOST_BYTES + 1)
    except OSError as error:
        reason = error.strerror or str(error)
        raise ValueError(f"{path} cannot be read: {reason.lower()}; give another file") from None
    if len(content) > MOST_BYTES:
        raise ValueError(
            f"{path} is larger than {MOST_BYTES / 1e6:g} MB, as no file of quietarm is; give "
            "another"
        )
    return content


def _refuse_no_name(path: object) -> None:
    if not isinstance(path, str | Path):
        raise ValueError(f"the name of the file is {path!r}; give a text or a Path")
    if not str(path):
        raise ValueError("the name of the file is empty; give one")
    if "\0" in str(path):
        raise ValueError(f"the name {str(path)!r} has a null character; give another name")


def _open_at_once(path: str, flags: int) -> int:
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))  # waits for nobody to fill a pipe


def check_writable(path: str | Path) -> Path:
    """Make sure that a file can be written, before a solve rather than after it.

    Parameters
    ----------
    path : str or Path
        The file to be.

    Returns
    -------
    Path
        The same.

    Raises
    ------
    ValueError
        When its folder does not exist or cannot be written, or it is a folder itself.
    """
    _refuse_no_name(path)
    target = Path(path)
    folder = target.parent
    if os.path.islink(target):  # it may lead to another folder
        folder = Path(os.path.realpath(target)).parent
    try:
        mode = target.stat().st_mode
    except FileNotFoundError:
        mode = None
    except OSError as error:
        raise unwritable(target, error) from None
    if mode is not None and stat.S_ISDIR(mode):
        raise ValueError(f"{target} is a folder; give the name of a file in it")
    if mode is not None and not stat.S_ISREG(mode):
        raise ValueError(f"{target} is no ordinary file; give the name of one")
    if not folder.is_dir():
        raise ValueError(f"folder {folder} does not exist; make it first")
    if not os.access(folder, os.W_OK) or (mode is not None and not os.access(target, os.W_OK)):
        raise ValueError(f"{target} cannot be written; choose another place")
    try:  # even with permission it may fail, as in /proc
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        raise unwritable(target, error) from None
    return target


def check_folder(path: str | Path) -> Path:
    """Make sure that files can be written in a folder, or that it can be made.

    Parameters
    ----------
    path : str or Path
        The folder, there or not; the folder around it must be there.

    Returns
    -------
    Path
        The same.

    Raises
    ------
    ValueError
        When it cannot be written to or made, or something else has its name.
    """
    folder = Path(path)
    if folder.is_dir():
        check_writable(folder / "any")
    elif folder.exists():
        raise ValueError(f"{folder} is a file; give a folder")
    elif folder.is_symlink():
        raise ValueError(f"{folder} is a link that leads nowhere; remove it, or give a folder")
    else:
        check_writable(folder)
    return folder


def check_inside(folder: Path, places: Sequence[Path]) -> None:
    """Make sure that files can be written at several places inside a folder, deep ones too.

    Parameters
    ----------
    folder : Path
        A folder, there or not.
    places : sequence of Path
        The files to be; folders on the way to them may be missing.

    Raises
    ------
    ValueError
        As `check_folder` and `check_writable`.
    """
    on_the_way = dict.fromkeys(
        folder / part for place in places for part in reversed(place.relative_to(folder).parents)
    )
    for inner in (folder, *on_the_way):
        if os.path.lexists(inner):
            check_folder(inner)
    for place in places:
        if os.path.lexists(place):
            check_writable(place)


def unwritable(target: Path, error: OSError) -> ValueError:
    """What to say of a file that the system refuses to write.

    Parameters
    ----------
    target : Path
        The file.
    error : OSError
        What the system says.

    Returns
    -------
    ValueError
        With the name, the reason and the remedy.
    """
    reason = (error.strerror or str(error)).lower()
    return ValueError(f"{target} cannot be written: {reason}; choose another place")


def write_whole(path: str | Path, content: str | bytes) -> None:
    """Write a temporary file beside it, then rename: a file is never half-written.

    A file that was there keeps its permissions.

    Parameters
    ----------
    path : str or Path
        The file.
    content : str or bytes
        All of it; text is written as UTF-8.

    Raises
    ------
    ValueError
        When the file cannot be written.
    """
    target = check_writable(path).resolve()  # a link stays a link, to the new content
    data = content.encode() if isinstance(content, str) else content
    try:
        _replace(target, data)
    except OSError as error:
        raise unwritable(target, error) from error
    written.append(Path(path))


def _replace(target: Path, data: bytes) -> None:
    handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=".quietarm-")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(temporary, _permissions(target))
        os.replace(temporary, target)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise


def _permissions(target: Path) -> int:
    """Those of the file that is replaced, or of a new one."""
    if target.exists():
        return stat.S_IMODE(target.stat().st_mode)
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
