"""A recording of a machine from a file, by the names of its columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from quietarm.ocp import FileFormatError
from quietarm.studies.identify import Recording
from quietarm.studies.reading.table import read_table


def read_recording(
    path: Path,
    columns: Mapping[str, Sequence[str]],
    units: Mapping[str, str],
    name: str,
    scales: Mapping[str, float] | None = None,
    rate: float | None = None,
) -> Recording:
    """Read a recording from the columns of a file, named by quantity of `UNITS`.

    The time's column is found where it is not named; with a rate [Hz] none is read. Units take the
    place of those in the columns' names; a scale is what one count is in SI units.
    """
    table = read_table(path)
    time = columns.get("time") or []
    if rate is None and not time:
        time = [table.first("time", "name it by --time, or give the samples per second by --rate")]
    named = {**columns, "time": time}
    of_scale = scales or {}
    used = [table.find(heading).name for names in named.values() for heading in names]
    for column in used:
        if used.count(column) > 1:
            raise FileFormatError(
                f"{path}: column {column} is given for two signals; give each a column of its own"
            )
    signals = {
        quantity: np.column_stack([
            table.in_si(
                heading, quantity, units.get(quantity, ""), of_scale.get(quantity), by_options=True
            )
            for heading in names
        ])
        for quantity, names in named.items()
        if names
    }  # fmt: skip
    if rate is not None:
        longest = max(len(values) for values in signals.values())
        signals["time"] = np.arange(longest)[:, None] / rate
    rows = {len(values) for values in signals.values()}
    if len(rows) > 1:
        raise FileFormatError(
            f"{path}: its columns have {' and '.join(map(str, sorted(rows)))} rows"
        )
    flat = {
        quantity: signals[quantity][:, 0]
        for quantity in ("time", "angle", "torque")
        if quantity in signals
    }
    arrays: dict[str, Any] = {**signals, **flat}
    try:
        return Recording(**arrays, name=name)
    except ValueError as error:
        raise FileFormatError(str(error)) from None
