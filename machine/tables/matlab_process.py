"""Read a MATLAB file in a process of its own: of a damaged one scipy may end the process.

A script that needs NumPy and SciPy alone. It takes the content on standard input, and answers on
standard output by an .npz file: its arrays, and as JSON how they make up the variables.
"""

from __future__ import annotations

import io
import json
import os
import sys
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import numpy as np
from scipy.io.matlab import loadmat

_ROOM = 1 << 30
"""Bytes beyond those in use at the start, of which scipy needs several times the content."""


def main() -> None:
    """Answer with the variables, or with the name of what went wrong."""
    most = int(sys.argv[1])
    simple = sys.argv[2] == "simple"
    _limit_memory()
    arrays: list[Any] = []
    try:
        values = loadmat(io.BytesIO(sys.stdin.buffer.read()), simplify_cells=simple)
        tree = {"entries": {name: _packed(values[name], arrays) for name in values}}
        if sum(array.nbytes for array in arrays) > most:
            tree = {"error": "MemoryError", "words": "it holds too much"}
    except Exception as error:  # whatever scipy makes of a damaged file
        tree = {"error": type(error).__name__, "words": str(error)}
        arrays = []
    answer = io.BytesIO()
    np.savez(answer, *arrays, tree=np.frombuffer(json.dumps(tree).encode(), np.uint8))
    sys.stdout.buffer.write(answer.getvalue())


def _packed(value: Any, arrays: list[Any]) -> Any:
    """Describe how a value is made up: fields, cells, a text or an array's number; else None."""
    # letters of a text, as of a signal's label
    longest = 1000
    if isinstance(value, Mapping):
        return {"entries": {name: _packed(entry, arrays) for name, entry in value.items()}}
    if isinstance(value, str):
        return {"text": value[:longest]}
    array = np.asarray(value)
    if array.dtype.names:
        fields = {name: _packed(array[name], arrays) for name in array.dtype.names}
        return {"fields": fields, "shape": array.shape}
    if array.dtype.kind == "O":
        return {"cells": [_packed(cell, arrays) for cell in array.flat], "shape": array.shape}
    if array.dtype.kind not in "biufc":
        return None
    arrays.append(array)
    return len(arrays) - 1


def _limit_memory() -> None:
    """Refuse this process more memory than it may need, where the system can."""
    with suppress(ImportError, OSError, ValueError, AttributeError):
        import resource

        with open("/proc/self/statm") as file:
            pages = int(file.read().split()[0])
        most = pages * os.sysconf("SC_PAGE_SIZE") + _ROOM
        resource.setrlimit(resource.RLIMIT_AS, (most, most))


if __name__ == "__main__":
    main()
