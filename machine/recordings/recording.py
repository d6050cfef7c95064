"""Measurements of a machine: the joint's angle, and what its tip and its torque did."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NoReturn, cast

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.recordings.clocks import holes, holes_in_words, running
from quietarm.machine.recordings.stamps import mended
from quietarm.models.number_checks import not_negative
from quietarm.ocp.checks import instance, several

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
        When [s], increasing. A counter of 16, 24 or 32 bits that wraps is unwrapped. Of rows with
        the same time the first is read; stamps that are rounded are those of an even rate.
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
        What was mended in the times, and where samples lack: sentences, by what was mended.
    tick : float, optional
        What the clock counts in [s], so that it is known where it wraps; found where it is 1 s,
        1 ms, 1 us, 0.1 us or 1 ns.

    Raises
    ------
    ValueError
        When a signal is no array of numbers or none is given, rows do not fit, the clock starts
        anew or goes back, or the angle cannot be one in radians.
    """

    example = "a recording, such as Recording(time, tip=tip)"

    time: Array
    angle: Array | None = None
    tip: Array | None = None
    acceleration: Array | None = None
    torque: Array | None = None
    name: str = "the recording"
    mended: Mapping[str, str] = field(default_factory=dict)
    tick: float = 0.0

    def __post_init__(self) -> None:
        self._refuse_wrong_options()
        arrays = {name: self._numbers(name, values) for name, values in self._arrays.items()}
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
        for name, values in self._on_a_clock(arrays, np.flatnonzero(whole)).items():
            object.__setattr__(self, name, values)
        object.__setattr__(self, "mended", {**_lost_in_words(whole), **self.mended})
        if self.angle is not None and (largest := np.abs(self.angle).max()) > MOST_ANGLE:
            self._refuse(
                f": its joint is at {largest:g} rad, or m where it slides; is it in degrees, or in "
                "mm? give rad or m, or a file's unit, such as --units angle:deg or angle:mm"
            )

    def _refuse_wrong_options(self) -> None:
        """Refuse a name that is no text, a tick that is no time, and no mapping of sentences."""
        if not isinstance(self.name, str):
            raise ValueError(f"name is {reprlib.repr(self.name)}; give a text")
        if not isinstance(self.mended, Mapping):
            self._refuse(f": mended is {reprlib.repr(self.mended)}; give sentences by names")
        if cast(object, self.time) is None:
            self._refuse(" has no time; give an array of seconds")
        object.__setattr__(self, "tick", not_negative("tick", self.tick))

    def _numbers(self, name: str, values: Any) -> Array:
        """A signal as an array of floats; ValueError where it is none."""
        shape = "(rows,) or (rows, tips)" if name in ("tip", "acceleration") else "(rows,)"
        shown = " ".join(reprlib.repr(values).split())  # numpy's has lines
        said = f": {name} is {shown}; give an array of numbers, of shape {shape}"
        if hasattr(values, "filled"):  # to name numpy's class would load numpy.ma
            self._refuse(
                f": {name} is a masked array; give plain numbers, as of its filled(np.nan)"
            )
        try:
            array = np.asarray(values)
            if array.dtype.kind not in "iufO":
                self._refuse(said)
            array = array.astype(float)
        except (TypeError, ValueError, OverflowError):
            self._refuse(said)
        if array.ndim != 1 and not (array.ndim == 2 and name in ("tip", "acceleration")):
            self._refuse(f": {name} has shape {array.shape}; give {shape}")
        if not array.size:
            self._refuse(f" has nothing in its {name}; give {LEAST_ROWS} rows or more")
        return array

    def _on_a_clock(self, arrays: Mapping[str, Array], rows: NDArray[np.intp]) -> dict[str, Array]:
        """Some rows of arrays, with a time that increases; what was mended is noted."""
        try:
            clock = running(arrays["time"][rows], self.tick, 1 + rows)
        except ValueError as error:
            self._refuse(f": {error}")
        rows = rows[clock.rows]
        ordered = {name: values[rows] for name, values in arrays.items()} | {"time": clock.time}
        increasing, changes = mended(ordered)
        time = increasing["time"]
        late = int(np.argmin(np.diff(time)))
        if time[late + 1] <= time[late]:
            self._refuse(
                f": the time stands still from row {1 + rows[late]} to the next; its clock is too "
                "coarse, give the samples per second in its place"
            )
        if len(time) < len(rows):  # rows that stand twice
            rows = rows[np.searchsorted(clock.time, time)]
        lacking = holes_in_words(time, 1 + rows)
        notes = {**clock.changes, **changes, **lacking, **self.mended}
        object.__setattr__(self, "mended", notes)
        return increasing

    def _refuse(self, why: str) -> NoReturn:
        raise ValueError(f"{self.name}{why}")

    @property
    def _arrays(self) -> dict[str, Array]:
        """Arrays that are given, by name."""
        names = ("time", "angle", "tip", "acceleration", "torque")
        return {name: v for name in names if (v := getattr(self, name)) is not None}

    @property
    def measured(self) -> dict[str, Array]:
        """Arrays that are given, but the time, by name."""
        return {name: values for name, values in self._arrays.items() if name != "time"}

    @property
    def signals(self) -> dict[str, Array]:
        """Signals that are compared with the plant, a column each, by name."""
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

    @property
    def stretches(self) -> list[slice]:
        """The rows between holes, where they are enough to be read."""
        runs = np.split(np.arange(len(self.time)), holes(self.time) + 1)
        return [slice(run[0], run[-1] + 1) for run in runs if len(run) >= LEAST_ROWS]

    def rows(self, begin: float, end: float) -> slice:
        """The rows from one time to another."""
        first, last = np.searchsorted(self.time, [begin, end], side="left")
        return slice(int(first), int(last) + 1)

    def part(self, rows: slice | NDArray[np.bool_]) -> Recording:
        """Some of its rows."""
        return replace(self, **{name: values[rows] for name, values in self._arrays.items()})

    def averaged(self, count: float) -> Recording:
        """Return means over so many rows each, in none of which samples lack for as long.

        It returns the recording itself where these are fewer than two.
        """
        size = max(1, int(min(count, len(self.time) / LEAST_ROWS)))
        rows = len(self.time) // size * size
        arrays = self._arrays.items()
        blocks = {name: v[:rows].reshape(-1, size, *v.shape[1:]) for name, v in arrays}
        dense = np.ptp(blocks["time"], axis=1) < 2 * size * self.step
        if np.count_nonzero(dense) < LEAST_ROWS:
            dense[:] = True
        return replace(self, **{name: v[dense].mean(axis=1) for name, v in blocks.items()})


def _lost_in_words(whole: NDArray[np.bool_]) -> dict[str, str]:
    """Say how many rows are not whole, and which is the first; nothing where all are."""
    lost = np.flatnonzero(~whole)
    if not len(lost):
        return {}
    rows = "1 row is" if len(lost) == 1 else f"{len(lost)} of {len(whole)} rows are"
    first = f"row {1 + lost[0]}" if len(lost) == 1 else f"the first row {1 + lost[0]}"
    return {"lost": f"{rows} left out, {first}: a value there is no number"}


def checked_recordings(recordings: Any) -> list[Recording]:
    """Recordings as a list, one or more."""
    if isinstance(recordings, Recording):
        raise TypeError(f"{recordings.name} is one recording; give a list, such as [recording]")
    checked = several("recordings", recordings, "recordings, such as [Recording(time, tip=tip)]")
    if not checked:
        raise ValueError("no recording is given; give one")
    for recording in checked:
        instance("a recording", recording, Recording)
    return checked


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
