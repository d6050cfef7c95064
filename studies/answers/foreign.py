"""Read coefficients that another program found, and what it claims of them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.tables.table import ARRAYS, Column, read_table, reading
from quietarm.ocp import FileFormatError

Array = NDArray[np.float64]

_COEFFICIENT = re.compile(
    r"(?:a|x|coefficients?|pareto_set)?[ _:]?\(?\[?(\d{1,9})\]?\)?", re.IGNORECASE
)
_MATRICES = ("coefficients", "x", "a", "pareto_set")
"""What a matrix of coefficients is called; the first of them that a file has."""
_CLAIMS = {
    **{f"{name}1": (0, 1.0) for name in ("f", "f:", "objectives:", "pareto_front:")},
    **{f"{name}2": (1, 1.0) for name in ("f", "f:", "objectives:", "pareto_front:")},
    "residual": (0, 1.0), "residual_m": (0, 1.0), "residual_mm": (0, 1e-3),
    "residual_rad": (0, 1.0),
    "energy": (1, 1.0), "energy_j": (1, 1.0), "energy_mj": (1, 1e-3),
}  # fmt: skip
"""Columns that state a figure: which of residual [m] and energy [J], and its unit in these."""
_WINDOW = "residual_window_s"
"""A column of `Front.save_csv`: the window [s] of the residuals that the file states."""


@dataclass(frozen=True)
class Found:
    """Content of a file: coefficients, what it claims of each motion, columns of no use.

    And the residual window [s] of what it claims, where it says so.
    """

    coefficients: Array
    claims: Array
    ignored: tuple[str, ...] = ()
    window: float | None = None


def read_found(path: Path) -> Found:
    """Read a file of any kind that `read_table` reads, with a row for each motion.

    Of named columns ``a_1``, ``a_2``, ... are coefficients, ``residual_m`` and ``energy_J`` what is
    claimed; without names all are coefficients. Arrays are a matrix of coefficients, or several
    named ones.
    """
    table = read_table(path, strict=True)
    empty = f"{path} holds no coefficients; give a row for each motion"
    if not any(column.values.size for column in table.columns):
        raise FileFormatError(empty)
    with reading(path):
        columns = _uncounted(table.columns, text=path.suffix.lower() not in ARRAYS)
        chosen = _coefficients(columns)
        coefficients = np.column_stack([columns[k].values for k in chosen])
    if not coefficients.size:
        raise FileFormatError(empty)
    claims = np.full((len(coefficients), 2), np.nan)
    ignored = dict[str, None]()
    of_motions = set(chosen)
    window = None
    for k, column in enumerate(columns):
        name = column.name.lower().replace(" ", "_")
        claim = _CLAIMS.get(name) or _CLAIMS.get(name.removesuffix(":1"))
        if claim and len(column.values) == len(claims):
            claims[:, claim[0]] = column.values * claim[1]
        elif name == _WINDOW and len(set(column.values)) == 1:
            window = float(column.values[0])
        elif k not in of_motions:
            ignored[column.name.partition(":")[0][:30] or "a column without a name"] = None
    return Found(coefficients, claims, tuple(ignored), window)


def _uncounted(columns: Sequence[Column], text: bool) -> Sequence[Column]:
    """Columns without the row in which pandas counts them; its count of rows is refused.

    Only a text has that row. It is no heading, for all in it are numbers, and its first cell is
    empty, above the count of rows.
    """
    unnamed = len(columns) > 1 and all(column.name.isdecimal() for column in columns)
    if not unnamed or not len(columns[0].values):
        return columns
    table = np.column_stack([column.values for column in columns])
    first = table[0]
    rows = table[:, 0]
    if text and np.isnan(first[0]) and np.array_equal(first[1:], np.arange(len(first) - 1)):
        names = ["", *(str(k) for k in range(len(first) - 1))]
        return [Column(name, "", values[1:]) for name, values in zip(names, table.T)]
    if len(rows) > 1 and np.array_equal(rows, np.arange(len(rows))):
        raise FileFormatError(
            "its first column counts the rows; leave it out, in pandas by index=False"
        )
    return columns


def _coefficients(columns: Sequence[Column]) -> list[int]:
    """Return which columns are coefficients, in order: by their names, or those of one matrix."""
    numbered = dict[int, int]()
    matrices = dict[str, list[int]]()
    names = [column.name.lower() for column in columns]
    matrix = next((name for name in _MATRICES if f"{name}:1" in names), "")
    for k, column in enumerate(columns):
        name, colon, _ = column.name.partition(":")
        if matrix and name.lower() != matrix:
            continue
        if match := _COEFFICIENT.fullmatch(column.name):
            if int(match[1]) in numbered:
                raise FileFormatError(f"coefficient {match[1]} has two columns; leave one")
            numbered[int(match[1])] = k
        elif colon:
            matrices.setdefault(name, []).append(k)
    large = [places for places in matrices.values() if len(places) > 1]
    if not numbered and len(large) == 1:
        return large[0]
    if not numbered:
        raise FileFormatError(
            "no column is a coefficient; name them a_1, a_2, ..., or a matrix X, or leave the "
            "names out"
        )
    # from 0 or 1 on; how many there would have to be is of no account, it may be a milliard
    for wanted, number in enumerate(sorted(numbered), start=min(1, *numbered)):
        if number != wanted:
            raise FileFormatError(f"there is no column for coefficient {wanted}; give all")
    return [numbered[i] for i in sorted(numbered)]
