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
    named, of_scale = {**columns, "time": time}, scales or {}
    used = [table.find(one).name for names in named.values() for one in names]
    for one in used:
        if used.count(one) > 1:
            raise FileFormatError(
                f"{path}: column {one} is given for two signals; give each a column of its own"
            )
    signals = {
        quantity: np.column_stack([
            table.in_si(
                one, quantity, units.get(quantity, ""), of_scale.get(quantity), by_options=True
            )
            for one in names
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
    flat = {one: signals[one][:, 0] for one in ("time", "angle", "torque") if one in signals}
    arrays: dict[str, Any] = {**signals, **flat}
    try:
        return Recording(**arrays, name=name)
    except ValueError as error:
        raise FileFormatError(str(error)) from None
