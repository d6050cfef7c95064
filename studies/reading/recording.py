"""A recording of a machine from a file, by the names of its columns."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from math import pi
from pathlib import Path

import numpy as np
from quietarm.ocp import FileFormatError
from quietarm.ocp.checks import unknown
from quietarm.studies.identify import Recording
from quietarm.studies.reading.table import read_table
from quietarm.studies.reading.units import UNITS, normal

_FACTOR = re.compile(
    r"\s*([+-]?[\d.]*(?:e[+-]?\d+)?)\s*\*?\s*(pi)?\s*(?:/\s*([\d.]+(?:e[+-]?\d+)?))?\s*"
)


def units_of(text: str) -> dict[str, str]:
    """Read units of quantities, ``time:ms,angle:deg``; ValueError when one is unknown."""
    units: dict[str, str] = {}
    for one in text.split(","):
        quantity, _, unit = (part.strip() for part in one.partition(":"))
        if quantity not in UNITS:
            raise ValueError(unknown("quantity", quantity, UNITS))
        if normal(unit) not in UNITS[quantity]:
            raise ValueError(unknown(f"unit of {quantity}", unit, UNITS[quantity]))
        units[quantity] = unit
    return units


def scale_of(text: str) -> tuple[str, float]:
    """Read what a count is in SI units, ``angle=2pi/4096``; ValueError where it is no number."""
    quantity, _, factor = (part.strip() for part in text.partition("="))
    if quantity not in UNITS:
        raise ValueError(unknown("quantity", quantity, UNITS))
    match = _FACTOR.fullmatch(factor.lower())
    if match and (match[1] or match[2]):
        number = {"": 1.0, "-": -1.0, "+": 1.0}.get(match[1]) or _float(match[1])
        divisor = _float(match[3] or "1")
        if number and divisor:
            return quantity, number * (pi if match[2] else 1.0) / divisor
    raise ValueError(f"{factor!r} is no scale; give a number other than 0, as {quantity}=2pi/4096")


def part_of(text: str) -> tuple[float, float]:
    """Read begin and end of a part [s], ``3.2:7.3``; ValueError where they are none."""
    begin, _, end = text.partition(":")
    try:
        ends = float(begin), float(end)
    except ValueError:
        ends = 0.0, 0.0
    if not 0 <= ends[1] - ends[0] > 0:
        raise ValueError(f"{text!r} is no part; give its begin and end in seconds, as 3.2:7.3")
    return ends


def _float(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0


def read_recording(
    path: Path,
    columns: Mapping[str, Sequence[str]],
    units: Mapping[str, str],
    name: str,
    scales: Mapping[str, float] | None = None,
) -> Recording:
    """Read a recording from the columns of a file, named by quantity of `UNITS`.

    The time's column is found where it is not named. Units are those where the columns' names do
    not end in one; a scale is what one count is in SI units.
    """
    table = read_table(path)
    named = {**columns, "time": columns.get("time") or [table.first("time")]}
    of_scale = scales or {}
    signals = {
        quantity: np.column_stack([
            table.in_si(one, quantity, units.get(quantity, ""), of_scale.get(quantity))
            for one in names
        ])
        for quantity, names in named.items()
        if names
    }  # fmt: skip
    rows = {len(values) for values in signals.values()}
    if len(rows) > 1:
        raise FileFormatError(
            f"{path}: its columns have {' and '.join(map(str, sorted(rows)))} rows"
        )
    flat = {one: signals[one][:, 0] for one in ("time", "angle", "torque") if one in signals}
    try:
        return Recording(**{**signals, **flat}, name=name)
    except ValueError as error:
        raise FileFormatError(str(error)) from None
