"""The variables of a MATLAB file (up to version 7), read in a process of its own."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from quietarm.ocp import FileFormatError
from quietarm.ocp.files import MOST_BYTES

_PROCESS = Path(__file__).with_name("matlab_process.py")

LONGEST_READ = 60.0
"""Seconds after which a reader that says nothing is given up."""


def read_matlab(content: bytes, *, simple: bool) -> dict[str, Any]:
    """Variables by name, as scipy's `loadmat` gives them; `simple` structures are dictionaries.

    ValueError where the file is damaged, be it that the process ends, takes too long or too much.
    """
    # of the process; a file of the largest size takes a few
    line = [sys.executable, "-P", str(_PROCESS), str(MOST_BYTES), "simple" if simple else "whole"]
    try:
        process = subprocess.run(
            line, input=content, capture_output=True, timeout=LONGEST_READ, check=True
        )
    except subprocess.TimeoutExpired:
        raise ValueError(f"reading it takes more than {LONGEST_READ:g} s") from None
    except subprocess.CalledProcessError as error:
        raise ValueError(f"what reads it ended with status {error.returncode}") from None
    with np.load(io.BytesIO(process.stdout), allow_pickle=False) as answer:
        tree = json.loads(answer["tree"].tobytes())
        match tree.get("error"):
            case None:
                return _unpacked(tree, answer)
            case "NotImplementedError":
                raise FileFormatError("it is of MATLAB's version 7.3; save it by save(..., '-v7')")
            case "MemoryError":
                raise FileFormatError(
                    f"its variables take more than {MOST_BYTES // 10**6} MB; save what "
                    "is needed alone"
                )
        raise ValueError(tree["words"])


def _unpacked(part: Any, arrays: Mapping[str, Any]) -> Any:
    """Rebuild the value that `matlab_process` has packed."""
    match part:
        case {"entries": entries}:
            return {name: _unpacked(entry, arrays) for name, entry in entries.items()}
        case {"fields": fields, "shape": shape}:
            values = np.empty(shape, [(name, object) for name in fields])
            for name, entry in fields.items():
                values[name] = _unpacked(entry, arrays)
            return values
        case {"cells": cells, "shape": shape}:
            values = np.empty(len(cells), object)
            for place, cell in enumerate(cells):
                values[place] = _unpacked(cell, arrays)
            return values.reshape(shape)
        case {"text": text}:
            return text
        case int():
            return arrays[f"arr_{part}"]
    return part
