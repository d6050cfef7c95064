"""Recordings of a robot: torques, positions, and the tip's acceleration or displacement.

A controller's log has gaps, a first row that is not of the move, and a coarse clock. Times are
mended as those of a `Recording`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.recordings.mending import without_glitches
from quietarm.machine.recordings.recording import Recording, noise_of

Array = NDArray[np.float64]
SIGNALS = ("torques", "acceleration", "positions", "tip")
"""What may be recorded, a column each joint or axis."""


@dataclass(frozen=True, eq=False)
class RobotRecording:
    """Signals of a robot over time, a column for each joint or for each axis of the tip.

    Parameters
    ----------
    time : array, shape (rows,)
        When [s].
    torques : array, shape (rows, joints), optional
        Of all driven joints, in their order [N m, of a sliding joint N]: what motors give. Those
        that act on the robot from outside have the other sign.
    acceleration : array, shape (rows, axes), optional
        Of the tip along its own axes, as an accelerometer there has it [m/s^2].
    positions : array, shape (rows, joints), optional
        Of all driven joints [rad or m]; with them the start of the move is exact.
    name : str, optional
        What messages call it.
    tick : float, optional
        What the clock counts in [s], as of `Recording`.
    tip : array, shape (rows, axes), optional
        Displacement of the tip along its own axes [m], of a robot whose joints are held.

    Raises
    ------
    ValueError
        When no torques, accelerations or displacements are given, rows do not fit, or the clock
        goes back.
    """

    example = "a recording of a robot, such as RobotRecording(time, torques=torques)"

    time: Array
    torques: Array | None = None
    acceleration: Array | None = None
    positions: Array | None = None
    name: str = "the recording"
    tick: float = 0.0
    tip: Array | None = None
    notes: tuple[str, ...] = field(default=(), init=False)

    def __post_init__(self) -> None:
        given = {name: v for name in SIGNALS if (v := getattr(self, name)) is not None}
        if not given.keys() - {"positions"}:
            raise ValueError(f"{self.name} has no torques, acceleration or tip; give one")
        columns = {name: _columns(self.name, name, values) for name, values in given.items()}
        lengths = {name: len(values) for name, values in columns.items()}
        rows = np.size(self.time)
        if set(lengths.values()) != {rows}:
            words = ", ".join(f"{count} of {name}" for name, count in lengths.items())
            raise ValueError(f"{self.name} has {rows} times and {words}; give as many of each")
        side_by_side = np.hstack([*columns.values()])
        time = np.asarray(self.time, float)
        first, doubt = _first_row(time, side_by_side)
        whole = Recording(
            time[first:],
            acceleration=side_by_side[first:],
            name=self.name,
            tick=self.tick,
        )
        (clean,), notes = without_glitches([whole])
        assert clean.acceleration is not None
        object.__setattr__(self, "time", clean.time)
        begin = 0
        for name, values in columns.items():
            end = begin + values.shape[1]
            object.__setattr__(self, name, clean.acceleration[:, begin:end])
            begin = end
        doubts = [f"{self.name}: {doubt}"] if doubt else []
        object.__setattr__(self, "notes", (*doubts, *notes))

    @property
    def swinging(self) -> tuple[str, Array]:
        """Signal by which the swing is read, and its columns: the tip's before torques."""
        if self.acceleration is not None:
            return "acceleration", self.acceleration
        if self.tip is not None:
            return "tip", self.tip
        assert self.torques is not None  # one of both is given
        return "torques", self.torques

    def part(self, begin: float, end: float) -> RobotRecording:
        """Return the rows of some time [s], as a recording."""
        rows = (self.time >= begin) & (self.time <= end)
        signals = {
            name: values[rows] for name in SIGNALS if (values := getattr(self, name)) is not None
        }
        return replace(self, time=self.time[rows], **signals)

    @property
    def step(self) -> float:
        """The usual time between samples [s]."""
        return float(np.median(np.diff(self.time)))


def _columns(recording: str, name: str, values: Any) -> Array:
    """A signal as columns; ValueError where it is none."""
    try:
        array = np.asarray(values, float)
    except (TypeError, ValueError):
        array = np.zeros(0)
    if array.ndim == 1 and array.size:
        array = array[:, None]
    if array.ndim != 2 or not array.size:
        raise ValueError(f"{recording}: {name} is no array of numbers; give a column for each")
    return array


def _first_row(time: Array, values: Array) -> tuple[int, str]:
    """Return the first row that is of the recording, and why one before it is none.

    Loggers begin with zeros, or with what was left of the last run.
    """
    few = 50
    far = 20.0  # times what changes from row to row thereafter
    has_numbers = np.isfinite(time) & np.isfinite(values).all(axis=1)
    time, values = time[has_numbers], values[has_numbers]
    if len(values) < few or not has_numbers[0]:
        return 0, ""
    beside = values[1:few]
    usual = np.maximum(np.abs(np.diff(beside, axis=0)).max(axis=0), noise_of(values))
    jumps = np.abs(values[1] - values[0]) > far * np.maximum(usual, 1e-12)
    steps = np.diff(time[:few])
    late = steps[0] < 0 or steps[0] > far * float(np.median(np.abs(steps[1:])))
    if jumps.any() or late:
        return 1, "its first row is left out: it is far from the next"
    return 0, ""
