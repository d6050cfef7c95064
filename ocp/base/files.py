"""Check that a file can be written before the work begins; write it whole or not at all."""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path


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
    target = Path(path)
    folder = target.parent
    try:
        mode = target.stat().st_mode
    except FileNotFoundError:
        mode = None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise ValueError(f"{target} cannot be written: {reason}") from None
    if mode is not None and stat.S_ISDIR(mode):
        raise ValueError(f"{target} is a folder; give the name of a file in it")
    if mode is not None and not stat.S_ISREG(mode):
        raise ValueError(f"{target} is no ordinary file; give the name of one")
    if not folder.is_dir():
        raise ValueError(f"folder {folder} does not exist; make it first")
    if not os.access(folder, os.W_OK) or (mode is not None and not os.access(target, os.W_OK)):
        raise ValueError(f"{target} cannot be written; choose another place")
    return target


def write_whole(path: str | Path, content: str | bytes) -> None:
    """Write a temporary file beside it, then rename: a file is never half-written.

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
        reason = (error.strerror or str(error)).lower()
        raise ValueError(f"{target} cannot be written: {reason}") from error


def _replace(target: Path, data: bytes) -> None:
    handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=".quietarm-")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(temporary, 0o666 & ~_umask())
        os.replace(temporary, target)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
