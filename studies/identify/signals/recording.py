"""What was measured of a machine: the joint's angle, and what its tip and its torque did."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from quietarm.studies.identify.signals.stamps import mended

Array = NDArray[np.float64]

MOST_ANGLE = 100.0
"""Angles beyond this [rad] are in degrees, most likely."""
LEAST_ROWS = 20
_MOST_ROWS = 1_000_000
_ORDER = 4
"""Of the differences that leave noise and no swing."""


@dataclass(frozen=True, eq=False)
class Recording:
    """Signals over time.

    Parameters
    ----------
    time : array, shape (rows,)
        When [s], increasing. Of rows with the same time the first is read; stamps that are rounded
        are those of an even rate.
    angle : array, shape (rows,), optional
        Of the joint [rad]; without it the joint is held.
    tip : array, shape (rows,) or (rows, tips), optional
        Displacement of the tips; not a number where a sample is missing. A frequency and a damping
        need no scale, so that any unit and sensor serves where nothing else is sought.
    acceleration : array, likewise, optional
        Of the tips across the link, as an accelerometer at the tip has it.
    torque : array, shape (rows,), optional
        Of the joint [N m].
    name : str, optional
        What messages call it.
    mended : mapping, optional
        What was mended in the times: sentences, by what was mended.

    Raises
    ------
    ValueError
        When no signal is given, rows do not fit, the time does not increase, or the angle cannot be
        one in radians.
    """

    time: Array
    angle: Array | None = None
    tip: Array | None = None
    acceleration: Array | None = None
    torque: Array | None = None
    name: str = "the recording"
    mended: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        arrays = {name: np.asarray(values, float) for name, values in self._arrays.items()}
        if not arrays.keys() - {"time", "angle"}:
            self._refuse(" has no tip, acceleration or torque; give one")
        rows = len(arrays["time"])
        whole = np.ones(rows, bool)
        for name, values in arrays.items():
            if len(values) != rows:
                self._refuse(f" has {rows} times and {len(values)} of {name}")
            whole = whole & np.isfinite(values.reshape(rows, -1)).all(axis=1)
        whole_count = np.count_nonzero(whole)
        if not LEAST_ROWS <= whole_count <= _MOST_ROWS:
            self._refuse(f" has {whole_count} rows; give {LEAST_ROWS} to {_MOST_ROWS}")
        whole_rows, changes = mended({name: values[whole] for name, values in arrays.items()})
        object.__setattr__(self, "mended", {**self.mended, **changes})
        for name, values in whole_rows.items():
            object.__setattr__(self, name, values)
        late = int(np.argmin(np.diff(self.time)))
        if self.time[late + 1] <= self.time[late]:
            self._refuse(
                f": the time does not increase from row {late + 1} to the next; sort the rows, or "
                "mend it"
            )
        if self.angle is not None and (largest := np.abs(self.angle).max()) > MOST_ANGLE:
            self._refuse(
                f": an angle of {largest:g} rad; is it in degrees? say so by its unit, or rename a "
                "column whose name says rad"
            )

    def _refuse(self, why: str) -> NoReturn:
        raise ValueError(f"{self.name}{why}")

    @property
    def _arrays(self) -> dict[str, Array]:
        """What is given, by name."""
        names = ("time", "angle", "tip", "acceleration", "torque")
        return {name: v for name in names if (v := getattr(self, name)) is not None}

    @property
    def measured(self) -> dict[str, Array]:
        """All that is given but the time, by name."""
        return {name: values for name, values in self._arrays.items() if name != "time"}

    @property
    def signals(self) -> dict[str, Array]:
        """What is compared with the plant, a column each, by name."""
        arrays = {k: v for k, v in self._arrays.items() if k not in ("time", "angle")}
        return {name: values.reshape(len(values), -1) for name, values in arrays.items()}

    @cached_property
    def values(self) -> Array:
        """The signals side by side."""
        return np.hstack(list(self.signals.values()))

    @property
    def step(self) -> float:
        """The usual time between samples [s]."""
        return float(np.median(np.diff(self.time)))

    def rows(self, begin: float, end: float) -> slice:
        """The rows from one time to another."""
        first, last = np.searchsorted(self.time, [begin, end], side="left")
        return slice(int(first), int(last) + 1)

    def part(self, rows: slice | NDArray[np.bool_]) -> Recording:
        """Some of its rows."""
        return replace(self, **{name: values[rows] for name, values in self._arrays.items()})

    def averaged(self, count: float) -> Recording:
        """Its means over so many rows each; itself where these are fewer than two."""
        size = max(1, int(min(count, len(self.time) / LEAST_ROWS)))
        rows = len(self.time) // size * size
        arrays = self._arrays.items()
        blocks = {name: v[:rows].reshape(-1, size, *v.shape[1:]) for name, v in arrays}
        return replace(self, **{name: v.mean(axis=1) for name, v in blocks.items()})


def noise_of(values: Array) -> Array:
    """Standard deviation of the noise of every column, by what changes from sample to sample.

    Differences of the fourth order have 70 times the variance of white noise. Steps of a sensor's
    resolution are noise as well.
    """
    values = values.reshape(len(values), -1)
    differences = np.diff(values, _ORDER, axis=0)
    robust = 1.4826 * np.median(np.abs(differences), axis=0)
    deviation = np.where(robust > 0, robust, differences.std(axis=0)) / 70**0.5
    return np.maximum(deviation, [resolution_of(column) / 12**0.5 for column in values.T])


def resolution_of(column: Array) -> float:
    """The least step of a column, where it has many values twice; else 0."""
    levels = np.unique(column)
    return float(np.diff(levels).min()) if 1 < len(levels) < len(column) / 4 else 0.0
