"""Functions of CasADi and tables that processes leave to the next, in a folder of the user's own.

A function is kept as the text that CasADi makes of it, which says what it computes: data that
CasADi's virtual machine evaluates, no machine code and no pickle. Yet such a text may name a
library to be loaded, so none is read that a process of this user has not written: the folder and
its files belong to the user and to nobody else, and every file has a digest that takes a secret key
to make. Whatever is amiss, the function is built anew.
"""

from __future__ import annotations

import dataclasses
import hashlib
import hmac
import json
import math
import os
import platform
import secrets
import stat
import sys
import time
import zlib
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import cache, partial
from pathlib import Path
from types import FunctionType, MethodType
from typing import Any

import casadi as ca
import numpy as np

from quietarm.models.joint_motion import Array

VARIABLE = "QUIETARM_CACHE"
"""Of the environment: the folder, or "off"."""
_HEAD = b"quietarm keeps 1\n"
_DIGEST = 32
LEAST_SECONDS = 0.02
"""Building that takes less is not kept: to read a function takes as long."""
MOST_BYTES = 300_000_000
"""Of all files; of those that were not used for longest so many go that a tenth is free."""
_MOST_OF_A_FILE = 100_000_000
LOADED = time.time_ns()
"""When this process read its sources."""
_OURS = "quietarm."
"""Beginning of the modules whose classes say by their fields all that they are."""


def kept_function(parts: Sequence[Any], build: Callable[[], ca.Function]) -> ca.Function:
    """Return a function from the user's folder, or build it and leave it there.

    Parameters
    ----------
    parts : sequence
        All that the function follows from. What of these does not say by its fields all that it is,
        as a class of the user's own, is never kept.
    build : callable
        Builds the function.
    """
    folder = folder_of_user()
    name = None if folder is None else name_of(parts)
    if folder is None or name is None:
        return build()
    text = folder.read(name)
    if text is not None:
        with suppress(RuntimeError):  # CasADi no longer has a plugin that it had
            return ca.Function.deserialize(text.decode("ascii"))
    began = time.process_time()
    function = build()
    if time.process_time() - began > LEAST_SECONDS:
        with suppress(RuntimeError):  # a function that calls back to Python has no text
            folder.write(name, function.serialize().encode("ascii"))
    return function


def kept_arrays(
    parts: Sequence[Any], build: Callable[[], Mapping[str, Array]]
) -> Mapping[str, Array]:
    """Return arrays by name from the user's folder, or build them and leave them there."""
    folder = folder_of_user()
    name = None if folder is None else name_of(parts)
    if folder is None or name is None:
        return build()
    content = folder.read(name)
    if content is not None:
        return _unpacked(content)
    built = build()
    folder.write(name, _packed(built))
    return built


def _packed(arrays: Mapping[str, Array]) -> bytes:
    """Return a line that says what arrays there are, and their numbers one after another."""
    head = [[name, array.dtype.str, array.shape] for name, array in arrays.items()]
    numbers = (np.ascontiguousarray(array).tobytes() for array in arrays.values())
    return b"".join([json.dumps(head).encode(), b"\n", *numbers])


def _unpacked(content: bytes) -> dict[str, Array]:
    arrays = dict[str, Array]()
    head, _, _ = content.partition(b"\n")
    begin = len(head) + 1
    for name, kind, shape in json.loads(head):
        count = math.prod(shape)
        array = np.frombuffer(content, kind, count, begin)
        arrays[name] = array.reshape(shape).copy()
        begin += array.nbytes
    return arrays


class Folder:
    """Files by name that only this user writes and reads.

    Parameters
    ----------
    path : Path
        The folder, which is made where it is missing.

    Raises
    ------
    OSError
        When it cannot be made, is another user's, or others may read or write it.
    """

    def __init__(self, path: Path) -> None:
        path.mkdir(mode=0o700, parents=True, exist_ok=True)
        about = path.lstat()
        if not stat.S_ISDIR(about.st_mode) or not _is_private(about):
            raise PermissionError(f"{path} is not this user's alone")
        self._path = path
        self._key = self._read_key() or self._make_key()

    def read(self, name: str) -> bytes | None:
        """Return what was written by this name; None where it is missing, or not as it was."""
        content = _read_own(self._path / name)
        if content is None or not content.startswith(_HEAD):
            return None
        digest = content[len(_HEAD) : len(_HEAD) + _DIGEST]
        packed = content[len(_HEAD) + _DIGEST :]
        if not hmac.compare_digest(digest, self._digest(name, packed)):
            return None
        with suppress(OSError):
            os.utime(self._path / name)  # it was used
        return zlib.decompress(packed)

    def write(self, name: str, content: bytes) -> None:
        """Write content by a name; nothing where that fails."""
        packed = zlib.compress(content, 1)
        whole = _HEAD + self._digest(name, packed) + packed
        if len(whole) > _MOST_OF_A_FILE:
            return
        with suppress(OSError):
            self._make_room(len(whole))
            self._place(name, whole, os.replace)

    def _digest(self, name: str, packed: bytes) -> bytes:
        made = hashlib.blake2b(key=self._key, digest_size=_DIGEST)
        made.update(name.encode() + b"\n")
        made.update(packed)
        return made.digest()

    def _read_key(self) -> bytes | None:
        key = _read_own(self._path / _KEY)
        return key if key is not None and len(key) == _DIGEST else None

    def _make_key(self) -> bytes:
        """Write a key, unless another process is first: its key is the one of both.

        One that is no key makes room only after that, so that none is lost that is good.
        """
        with suppress(FileExistsError):
            self._place(_KEY, secrets.token_bytes(_DIGEST), os.link)
        key = self._read_key()
        if key is None:
            with suppress(FileNotFoundError):
                (self._path / _KEY).unlink()
            with suppress(FileExistsError):
                self._place(_KEY, secrets.token_bytes(_DIGEST), os.link)
            key = self._read_key()
        if key is None:
            raise PermissionError(f"{self._path} keeps no key")
        return key

    def _place(self, name: str, content: bytes, move: Callable[[Path, Path], None]) -> None:
        """Write a file whole: who reads meanwhile has the one of before, or this one."""
        unfinished = self._path / f"{name}.{os.getpid()}.{secrets.token_hex(4)}"
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
        try:
            with os.fdopen(os.open(unfinished, flags, 0o600), "wb") as file:
                file.write(content)
            move(unfinished, self._path / name)
        finally:
            with suppress(FileNotFoundError):
                unfinished.unlink()

    def _make_room(self, size: int) -> None:
        """Remove the files that were not used for longest, if all take too much."""
        files = list[tuple[float, int, Path]]()
        for path in self._path.iterdir():
            with suppress(FileNotFoundError):
                about = path.stat()
                if path.name != _KEY:
                    files.append((about.st_mtime, about.st_size, path))
        excess = sum(entry[1] for entry in files) + size - MOST_BYTES
        if excess <= 0:
            return
        excess += MOST_BYTES // 10
        for _, freed, path in sorted(files):
            if excess <= 0:
                break
            with suppress(FileNotFoundError):
                path.unlink()
            excess -= freed


_KEY = "key"


def _is_private(about: os.stat_result) -> bool:
    """Return whether a file is this user's, and no other may read or write it."""
    if not hasattr(os, "geteuid"):  # Windows: a user's folder of caches is the user's alone
        return True
    return about.st_uid == os.geteuid() and not about.st_mode & 0o077


def _read_own(path: Path) -> bytes | None:
    """Return a file's content; None where it is missing, a link, or not this user's alone."""
    flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
    flags |= getattr(os, "O_NONBLOCK", 0)  # a pipe would wait for who writes
    try:
        with os.fdopen(os.open(path, flags), "rb") as file:
            about = os.fstat(file.fileno())
            if not stat.S_ISREG(about.st_mode) or not _is_private(about):
                return None
            return None if about.st_size > _MOST_OF_A_FILE else file.read()
    except OSError:
        return None


def folder_of_user() -> Folder | None:
    """Return the user's folder; None where there is to be none, or it cannot be used."""
    return _folder_at(os.environ.get(VARIABLE))


def forget_folders() -> None:
    """Look at the user's folder again when it is next wanted."""
    _folder_at.cache_clear()


@cache
def _folder_at(stated: str | None) -> Folder | None:
    if stated is not None and stated.strip().lower() in ("", "off", "0"):
        return None
    try:
        folder = _usual_folder() if stated is None else Path(stated).absolute()
        return Folder(folder / "functions")
    except (OSError, RuntimeError):  # RuntimeError: there is no home
        return None


def _usual_folder() -> Path:
    """Return where programs of this system keep what they can make again."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData/Local") / "quietarm"
    if sys.platform == "darwin":
        return Path.home() / "Library/Caches/quietarm"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "quietarm"


def name_of(parts: Sequence[Any]) -> str | None:
    """Return the name of what follows from these parts; None where they do not say all."""
    made = hashlib.sha256(origin().encode())
    try:
        for part in parts:
            made.update(_said(part).encode() + b"\n")
    except _UnsaidError:
        return None
    return made.hexdigest()


class _UnsaidError(Exception):
    """Error for a part that does not say by its fields all that it is."""


@cache
def origin() -> str:
    """Versions of what builds: what another version left is not used, nor that of other sources.

    Of sources that were edited after this process read them nobody knows which it runs: what it
    keeps is for itself alone.
    """
    from quietarm import __version__  # the name over all packages, which is loaded by now

    sources = Path(__file__).parent.parent
    files = [path for room in ("models", "ocp") for path in (sources / room).rglob("*.py")]
    about = {str(path.relative_to(sources)): path.stat() for path in files}
    stamps = sorted((name, one.st_size, one.st_mtime_ns) for name, one in about.items())
    is_edited = max(one.st_mtime_ns for one in about.values()) > LOADED
    process = secrets.token_hex() if is_edited else ""
    machine = (platform.machine(), platform.system(), platform.python_version())
    return repr((__version__, ca.CasadiMeta.version(), np.__version__, machine, stamps, process))


def _said(value: Any) -> str:
    """Say all that a value is, in a text that no other has."""
    match value:
        case None | bool() | int() | str():
            return repr(value)
        case float():
            return float(value).hex()
        case np.ndarray() if value.dtype.kind in "bif":
            digest = hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()
            return f"array{value.shape}{value.dtype}{digest}"
        case Mapping():
            entries = [f"{_said(name)}:{_said(entry)}" for name, entry in value.items()]
            return f"{{{','.join(entries)}}}"
        case MethodType():
            return f"{_said(value.__self__)}.{_said(value.__func__)}"
        case partial():
            return f"partial({_said(value.func)},{_said(value.args)},{_said(value.keywords)})"
        case FunctionType():
            return _said_of_function(value)
        case type() if value.__module__.startswith(_OURS):
            return f"{value.__module__}.{value.__qualname__}"
        case _:
            return _said_of_object(value)


def _said_of_function(function: FunctionType) -> str:
    if not function.__module__.startswith(_OURS) or function.__closure__ or function.__defaults__:
        raise _UnsaidError
    line = function.__code__.co_firstlineno
    code = hashlib.sha256(function.__code__.co_code).hexdigest()
    return f"{function.__module__}.{function.__qualname__}@{line}-{code}"


def _said_of_object(value: Any) -> str:
    kind = type(value)
    if isinstance(value, tuple | list | frozenset):
        parts = list(map(_said, value))
        if isinstance(value, frozenset):
            parts.sort()
        name = "" if kind in (tuple, list, frozenset) else _said(kind)
        return f"{name}({','.join(parts)})"
    if not kind.__module__.startswith(_OURS):
        raise _UnsaidError
    made_of = getattr(value, "made_of", None)
    if made_of is not None:
        return f"{_said(kind)}{_said(made_of)}"
    if not dataclasses.is_dataclass(value):
        raise _UnsaidError
    entries = [f"{entry.name}={_said(getattr(value, entry.name))}" for entry in _fields(value)]
    return f"{_said(kind)}({','.join(entries)})"


def _fields(value: Any) -> list[dataclasses.Field[Any]]:
    return [entry for entry in dataclasses.fields(value) if entry.compare]
