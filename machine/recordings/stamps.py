"""Times of samples as recorders write them: rows that stand twice, stamps that are rounded."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_SOME = 0.01
"""Share of the rows: where more have the stamp of the row before, the stamps are rounded."""
_COARSE = 0.02
"""Of a step, from which on rounding of stamps matters."""
_GAP = 4.0
"""Steps without a sample, after which the rate is told anew."""
_LEAST = 20
"""Rows between gaps that tell a rate."""


def mended(arrays: Mapping[str, Array]) -> tuple[dict[str, Array], dict[str, str]]:
    """The arrays of a recording with increasing times where these can be told, and what was done.

    Rounded stamps are those of an even rate; of rows with the same stamp the first stays.
    """
    time = arrays["time"]
    steps = np.diff(time)
    unchanged = dict(arrays)
    if len(time) < _LEAST or not (steps >= 0).all() or not (steps > 0).any():
        return unchanged, {}
    again = np.append(False, steps == 0)
    if again.any() and _stand_twice(arrays, again):
        return _without(arrays, again)
    even = _even(time, steps)
    if even is not None:
        times, tick = even
        step = float(np.median(np.diff(times)))
        rounded = (
            f"its times are rounded to {1e3 * tick:.3g} ms; an even rate is taken, a sample every "
            f"{1e3 * step:.6g} ms"
        )
        return unchanged | {"time": times}, {"rounded": rounded}
    if not again.any() or np.count_nonzero(again) > _SOME * len(time):
        return unchanged, {}
    return _without(arrays, again)


def _stand_twice(arrays: Mapping[str, Array], again: NDArray[np.bool_]) -> bool:
    """Return whether every row with the stamp of the row before is that row in all else, too."""
    places = np.flatnonzero(again)
    return all(
        np.array_equal(values[places], values[places - 1], equal_nan=True)
        for values in arrays.values()
    )


def _without(
    arrays: Mapping[str, Array], again: NDArray[np.bool_]
) -> tuple[dict[str, Array], dict[str, str]]:
    """The arrays without some rows, and how many these are."""
    count = int(np.count_nonzero(again))
    rows = "1 row has" if count == 1 else f"{count} rows have"
    twice = f"{rows} the time of the row before: it stands twice, and is read once"
    return {name: values[~again] for name, values in arrays.items()}, {"twice": twice}


def _even(time: Array, steps: Array) -> tuple[Array, float] | None:
    """The times of an even rate and what they were rounded to; None where they were not."""
    tick = _tick(steps[steps > 0])
    seconds = float(np.ptp(time))
    tick = seconds / round(seconds / tick)
    ties = np.count_nonzero(steps == 0)
    ticks = time / tick
    whole = np.abs(ticks - np.round(ticks)).max() < 1e-3
    if not whole or not (ties == 0 or ties > _SOME * len(time)):
        return None
    longest = _GAP * max(float(np.median(steps)), tick)
    if np.ptp(steps[steps <= longest]) < 0.5 * tick:
        return None
    longer = steps > 1.5 * np.median(steps)
    alike = np.ptp(steps[~longer]) < 0.5 * tick
    if alike and np.count_nonzero(longer) <= _SOME * len(steps):  # samples lack here and there
        return None
    runs = np.split(np.arange(len(time)), np.flatnonzero(steps > longest) + 1)
    even = time.astype(float).copy()
    for run in runs:
        if len(run) < _LEAST:
            return None
        slope, offset = np.polyfit(run - run[0], time[run] - time[run[0]], 1)
        even[run] = time[run[0]] + offset + slope * (run - run[0])
    step = float(np.median(np.diff(even)))
    rounded = np.abs(even - time).max() <= 1.05 * tick and tick > _COARSE * step
    return (even, tick) if rounded and (np.diff(even) > 0).all() else None


def _tick(steps: Array) -> float:
    """The least difference of steps, or the least step: what stamps are rounded to, if they are."""
    least = float(steps.min())
    lengths = np.unique(np.round(steps / least, 6)) * least
    return float(np.diff(lengths, prepend=0.0).min())
