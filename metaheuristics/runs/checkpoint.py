"""The file format of checkpoints: the state of a search, written whole or not at all, no pickle."""

from __future__ import annotations

import io
import json
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from quietarm.ocp import FileFormatError
from quietarm.ocp.answers.documents import content_of, read_bytes
from quietarm.ocp.base.files import write_whole

KIND, VERSION = "checkpoint", 2
_HEADER, _STATE = "header", "state."
_DAMAGE = (
    OSError, ValueError, KeyError, TypeError, AttributeError, EOFError, RuntimeError, MemoryError,
    zipfile.BadZipFile, zlib.error,
)  # fmt: skip
"""What numpy, zipfile and json raise over a file that is damaged or of another kind."""


def save_checkpoint(path: str | Path, header: Mapping[str, Any], state: Mapping[str, Any]) -> None:
    """Write a checkpoint."""
    arrays: dict[str, np.ndarray] = {}
    rest = _split(state, _STATE, arrays)
    document = {"format": f"quietarm-{KIND}", "version": VERSION, **header, "state": rest}
    document["arrays"] = sorted(arrays)
    content = io.BytesIO()
    text = np.frombuffer(json.dumps(document).encode(), dtype=np.uint8)
    np.savez(content, allow_pickle=False, **{_HEADER: text}, **arrays)
    write_whole(path, content.getvalue())


def load_checkpoint(path: str | Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Read a checkpoint; the file is left as it was."""
    content = read_bytes(path)
    broken = FileFormatError(
        f"{path} is not a checkpoint, or not a whole one; give a file that --checkpoint wrote"
    )
    try:
        _refuse_compressed(content)
        with np.load(io.BytesIO(content), allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
        document = json.loads(bytes(arrays.pop(_HEADER)))
    except _DAMAGE:
        raise broken from None
    header = content_of(path, document, KIND, VERSION)
    try:
        rest, names = header.pop("state"), header.pop("arrays")
        state = _join(rest, _STATE, arrays)
    except _DAMAGE:
        raise broken from None
    if names != sorted(arrays):
        raise broken
    return header, state


def _refuse_compressed(content: bytes) -> None:
    """ValueError where the arrays would be larger than the file, as no checkpoint's are."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        if sum(entry.file_size for entry in archive.infolist()) > len(content):
            raise ValueError("it is compressed")


def _split(state: Mapping[str, Any], prefix: str, arrays: dict[str, np.ndarray]) -> dict[str, Any]:
    rest: dict[str, Any] = {}
    for name, value in state.items():
        if isinstance(value, Mapping):
            rest[name] = _split(value, f"{prefix}{name}.", arrays)
        elif isinstance(value, np.ndarray):
            arrays[f"{prefix}{name}"] = value
            rest[name] = None
        else:
            rest[name] = value
    return rest


def _join(rest: Mapping[str, Any], prefix: str, arrays: Mapping[str, np.ndarray]) -> dict[str, Any]:
    state: dict[str, Any] = {}
    for name, value in rest.items():
        if isinstance(value, Mapping):
            state[name] = _join(value, f"{prefix}{name}.", arrays)
        else:
            state[name] = arrays.get(f"{prefix}{name}", value)
    return state
