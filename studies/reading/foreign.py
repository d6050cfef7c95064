"""Read coefficients that another program found, and what it claims of them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import FileFormatError
from quietarm.studies.reading.numbers import read_numbers, real

Array = NDArray[np.float64]

_COEFFICIENT = re.compile(r"(?:a|x|coefficient)?[ _]?\(?\[?(\d+)\]?\)?", re.IGNORECASE)
_CLAIMS: Mapping[str, tuple[int, float]] = {
    "residual": (0, 1.0), "residual_m": (0, 1.0), "residual_mm": (0, 1e-3), "f1": (0, 1.0),
    "energy": (1, 1.0), "energy_j": (1, 1.0), "energy_mj": (1, 1e-3), "f2": (1, 1.0),
}  # fmt: skip
"""Columns that state a figure: which of residual [m] and energy [J], and its unit in these."""
_MATRICES = ("coefficients", "x", "a", "pareto_set")
_FIGURES = ("f", "objectives", "pareto_front")


@dataclass(frozen=True)
class Found:
    """What a file holds: coefficients, what it claims of each motion, columns of no use."""

    coefficients: Array
    claims: Array
    ignored: tuple[str, ...] = ()


def read_found(path: Path) -> Found:
    """Read a file, as `read_numbers` does, with a row for each motion.

    Of named columns ``a_1``, ``a_2``, ... are coefficients, ``residual_m`` and ``energy_J`` what is
    claimed; without names all are coefficients. Arrays are a matrix of coefficients, or several
    named ones.
    """
    found = read_numbers(path, _by_columns, _by_variables)
    if not found.coefficients.size:
        raise FileFormatError(f"{path} holds no coefficients; give a row for each motion")
    return found


def _by_columns(names: Sequence[str] | None, table: Array) -> Found:
    """What the columns of a table are."""
    claims = np.full((len(table), 2), np.nan)
    if names is None:
        table = _matrix(table, "the array")
        if min(table.shape) > 1 and np.array_equal(table[:, 0], np.arange(len(table))):
            raise FileFormatError(
                "its first column counts the rows; leave it out, in pandas by index=False"
            )
        return Found(table, claims)
    numbered, ignored = dict[int, int](), list[str]()
    for column, name in enumerate(names):
        match, claim = _COEFFICIENT.fullmatch(name), _CLAIMS.get(name.lower().replace(" ", "_"))
        if match:
            if int(match[1]) in numbered:
                raise FileFormatError(f"coefficient {match[1]} has two columns; leave one")
            numbered[int(match[1])] = column
        elif claim:
            claims[:, claim[0]] = table[:, column] * claim[1]
        else:
            ignored.append(name[:30] or "a column without a name")
    order = sorted(numbered)
    if not order:
        raise FileFormatError(
            "no column is a coefficient; name them a_1, a_2, ..., or leave the names out"
        )
    missing = set(range(min(1, order[0]), order[-1] + 1)) - numbered.keys()
    if missing:
        raise FileFormatError(f"there is no column for coefficient {min(missing)}; give all")
    return Found(table[:, [numbered[i] for i in order]], claims, tuple(ignored))


def _by_variables(values: Mapping[str, Any]) -> Found:
    """What named arrays are."""
    small = {name.lower(): name for name in values}
    matrix = next((small[name] for name in _MATRICES if name in small), None)
    if matrix is None:
        tables = [n for n, v in values.items() if np.ndim(v) == 2 and min(np.shape(v)) > 1]
        if len(tables) != 1:
            listed = ", ".join(values)[:200] or "none"
            raise FileFormatError(f"name the matrix of coefficients X (its variables: {listed})")
        (matrix,) = tables
    coefficients, ignored = _matrix(values[matrix], matrix), list[str]()
    claims = np.full((len(coefficients), 2), np.nan)
    for name, value in values.items():
        claim = _CLAIMS.get(name.lower())
        if name.lower() in _FIGURES and np.shape(value) == claims.shape:
            claims[:] = real(value, name)
        elif claim and np.size(value) == len(coefficients):
            claims[:, claim[0]] = real(value, name).ravel() * claim[1]
        elif name != matrix:
            ignored.append(name[:30])
    return Found(coefficients, claims, tuple(ignored))


def _matrix(values: Any, name: str) -> Array:
    table = real(values, name)
    if table.ndim != 2:
        raise FileFormatError(f"{name[:30]} has shape {table.shape}; give (motions, coefficients)")
    return table
