"""What was measured of a machine: the joint's angle, and what its tip and its torque did."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOST_ANGLE = 100.0
"""Angles beyond this [rad] are in degrees, most likely."""
LEAST_ROWS = 20
_MOST_ROWS = 200_000
_GAP = 5.5
"""A step in time so many times the usual one is a gap."""


@dataclass(frozen=True, eq=False)
class Recording:
    """Signals over time, evenly sampled or nearly so.

    Parameters
    ----------
    time : array, shape (rows,)
        When [s], increasing.
    angle : array, shape (rows,), optional
        Of the joint [rad]; without it the joint is held.
    tip : array, shape (rows,) or (rows, tips), optional
        Displacement of the tips. Where neither a torque is recorded nor a gain sought, of any unit
        and sensor: a frequency and a damping need no scale.
    acceleration : array, likewise, optional
        Of the tips across the link, as an accelerometer at the tip has it.
    torque : array, shape (rows,), optional
        Of the joint [N m].
    name : str, optional
        What messages call it.

    Raises
    ------
    ValueError
        When no signal is given, rows do not fit, numbers are not finite, the time does not increase
        or has gaps, or the angle cannot be one in radians.
    """

    time: Array
    angle: Array | None = None
    tip: Array | None = None
    acceleration: Array | None = None
    torque: Array | None = None
    name: str = "the recording"

    def __post_init__(self) -> None:
        time = np.asarray(self.time, float)
        rows = len(time)
        object.__setattr__(self, "time", time)
        if not LEAST_ROWS <= rows <= _MOST_ROWS:
            raise ValueError(f"{self.name} has {rows} rows; give {LEAST_ROWS} to {_MOST_ROWS}")
        for signal in ("time", "angle", "tip", "acceleration", "torque"):
            values = getattr(self, signal)
            if values is None:
                continue
            values = np.asarray(values, float)
            if len(values) != rows:
                raise ValueError(f"{self.name} has {rows} times and {len(values)} of {signal}")
            if not np.isfinite(values).all():
                row = int(np.argmin(np.isfinite(values).reshape(rows, -1).all(axis=1)))
                raise ValueError(
                    f"{self.name}: {signal} in row {row + 1} is no number; mend or leave it out"
                )
            object.__setattr__(self, signal, values)
        if not self.signals:
            raise ValueError(f"{self.name} has no tip, acceleration or torque; give one")
        steps = np.diff(time)
        late, usual = int(np.argmin(steps)), float(np.median(steps))
        if steps[late] <= 0:
            raise ValueError(
                f"{self.name}: the time does not increase from row {late + 1} to the next; sort "
                "the rows, or mend it"
            )
        gap = int(np.argmax(steps))
        if steps[gap] > _GAP * usual:
            raise ValueError(
                f"{self.name}: nothing was recorded from {time[gap]:g} to {time[gap + 1]:g} s, "
                f"otherwise every {usual:.3g} s; cut it there into two recordings"
            )
        if self.angle is not None and np.abs(self.angle).max() > MOST_ANGLE:
            raise ValueError(
                f"{self.name}: an angle of {np.abs(self.angle).max():g} rad; is it in degrees? say "
                "so by its unit"
            )

    @property
    def signals(self) -> dict[str, Array]:
        """What is compared with the plant, a column each, by name."""
        found = {name: getattr(self, name) for name in ("tip", "acceleration", "torque")}
        return {
            name: values.reshape(len(self.time), -1)
            for name, values in found.items()
            if values is not None
        }

    def periods(self, frequency: float) -> float:
        """How many periods of a frequency [Hz] it lasts."""
        return float(self.time[-1] - self.time[0]) * frequency

    def part(self, first: int, last: int) -> Recording:
        """Rows from first up to last."""
        cut: dict[str, Any] = {
            name: getattr(self, name)[first:last] for name in ("time", *self.signals)
        }
        if self.angle is not None:
            cut["angle"] = self.angle[first:last]
        return Recording(**cut, name=self.name)
