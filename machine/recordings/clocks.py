"""Clocks of recorders: counters that wrap, clocks that start anew, rows out of order, holes.

Sorting is right for rows that were swapped, and for these alone: it takes a counter that wraps for
one recording with a hole of an hour, and two recordings for one of twice the rate.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = NDArray[np.intp]
LONG = 100.0
"""Usual steps without a sample, from which on a step is a hole; a counter wraps in less."""
_SHORT = 20
"""Rows of which a run is too short to be a recording of its own."""
_TICKS = (1.0, 1e-3, 1e-6, 1e-7, 1e-9)
"""What counters of clocks count in [s], where nothing says it."""
_BITS = (16, 24, 32)
_DAY = 86400.0
"""Seconds from midnight to midnight."""


class Clock(NamedTuple):
    """Times that increase, or stay the same.

    Attributes
    ----------
    time : array, shape (rows,)
        [s], unwrapped and in order.
    rows : array of int, shape (rows,)
        The rows that they are of.
    changes : dict of str to str
        What was done: sentences, by what was mended.
    """

    time: Array
    rows: Rows
    changes: dict[str, str]


def running(time: Array, tick: float = 0.0, numbers: Rows | None = None) -> Clock:
    """The times of a clock that runs forward.

    A counter of 16, 24 or 32 bits that wraps is unwrapped, rows that were swapped are put in order,
    single stamps that are no times are left out.

    Parameters
    ----------
    time : array, shape (rows,)
        [s], finite.
    tick : float, optional
        What the counter counts in [s]; 0 where that is unknown.
    numbers : array of int, optional
        What messages call the rows; by default they count from 1.

    Raises
    ------
    ValueError
        When the clock starts anew, stands still, or goes back: the text says where, and what to do.
    """
    numbers = np.arange(1, len(time) + 1) if numbers is None else numbers
    rows = np.arange(len(time))
    changes = dict[str, str]()
    if len(time) < 2 or (np.diff(time) >= 0).all():
        return Clock(time, rows, changes)
    if not (np.diff(time) > 0).any():
        raise ValueError(
            f"the time falls from row {numbers[0]} to row {numbers[-1]}: the rows stand in reverse "
            "order; turn them round"
        )
    wraps = _wraps(time, tick)
    if wraps:
        time = wraps.unwrapped(time)
        changes["wraps"] = wraps.in_words(numbers)
    for mend in (_in_order, _without_strays):
        if (np.diff(time) < 0).any() and (mended := mend(time, numbers[rows])):
            time, kept, change = mended
            rows = rows[kept]
            changes |= change
    if (np.diff(time) < 0).any():
        raise ValueError(_why_back(time, numbers[rows]))
    return Clock(time, rows, changes)


class Wraps(NamedTuple):
    """Wraps of a counter: where, after how many bits (0: at midnight), and its period [s]."""

    after: Rows
    bits: int
    period: float

    def unwrapped(self, time: Array) -> Array:
        """The time with a period more after each wrap."""
        whole = np.zeros(len(time))
        whole[self.after + 1] = self.period
        return time + np.cumsum(whole)

    def in_words(self, numbers: Sequence[int] | Rows) -> str:
        """Say what was unwrapped, and where."""
        more = f" and {len(self.after) - 1} more" if len(self.after) > 1 else ""
        counter = f"a counter of {self.bits} bits, wraps" if self.bits else "a time of day, wraps"
        return (
            f"its clock, {counter} after row {numbers[self.after[0]]}{more}; the time is unwrapped"
        )


def _wraps(time: Array, tick: float) -> Wraps | None:
    """The wraps of a counter that explain the steps back, most of them and the nearest."""
    steps = np.diff(time)
    usual, jitter = _usual(steps)
    back = np.flatnonzero(steps < 0)
    best: tuple[float, Wraps] | None = None
    for bits, period, rounded in _periods(time, tick):
        if period < 4 * usual or np.ptp(time) > period + rounded:
            continue
        ahead = steps[back] + period
        count = np.maximum(np.round(ahead / usual), 1.0)
        off = np.abs(ahead - count * usual)
        near = np.where(count == 1, 0.5 * usual, np.clip(jitter, 0.02 * usual, 0.5 * usual))
        # one that comes back to its begin more likely started anew, but where no sample lacks
        to_begin = np.abs(time[back + 1] - time[0]) <= _SHORT * usual
        fits = (ahead > 0) & (off <= near + 2 * rounded) & (count <= np.where(to_begin, 1, LONG))
        if fits.any():
            miss = float((off[fits] / usual).max()) - int(fits.sum())
            if best is None or miss < best[0]:
                best = miss, Wraps(back[fits], bits, period)
    return best[1] if best else None


def _periods(time: Array, tick: float) -> Iterator[tuple[int, float, float]]:
    """Bits and period [s] of counters that the times may be of, and to what these are rounded.

    A time of day is of 0 bits.
    """
    if time.min() >= 0 and time.max() <= _DAY:
        yield 0, _DAY, 0.0
    if tick:
        yield from ((bits, tick * 2.0**bits, 0.0) for bits in _BITS)
        yield 32, 1e-3 * tick * 2.0**32, tick  # micros() / 1000 wraps with micros()
        return
    whole = [tick for tick in _TICKS if _are_whole(time, tick)]
    coarsest = max(whole, default=0.0)
    if coarsest:
        yield from ((bits, coarsest * 2.0**bits, 0.0) for bits in _BITS)
    if coarsest != 1e-6:
        yield 32, 1e-6 * 2.0**32, coarsest


def _are_whole(time: Array, tick: float) -> bool:
    """Return whether times are multiples of a tick."""
    ticks = time / tick
    unsure = 1e-3 + 4e-16 * np.abs(ticks).max()
    if unsure > 0.2 or np.ptp(ticks) < 1:
        return False
    return bool(np.abs(ticks - np.round(ticks)).max() <= unsure)


def _usual(steps: Array) -> tuple[float, float]:
    """The usual step forward, and how far such steps are from it."""
    forward = steps[steps > 0]
    usual = float(np.median(forward))
    return usual, 6 * float(np.median(np.abs(forward - usual)))


Mended = tuple[Array, Rows, dict[str, str]]


def _in_order(time: Array, numbers: Rows) -> Mended | None:
    """The rows in the order of time, where they were swapped: their steps are then the usual."""
    steps = np.diff(time)
    usual, _ = _usual(steps)
    back = np.flatnonzero(steps < 0)
    runs = np.diff(np.concatenate([[0], back + 1, [len(time)]]))
    are_near = (-steps[back] <= _SHORT * usual).all()
    if not are_near and np.median(runs) >= _SHORT:
        return None
    order = np.argsort(time, kind="stable")
    sorted_steps = np.diff(time[order])
    untouched = np.diff(order) == 1
    touched = sorted_steps[~untouched]
    least = 0.5 * float(np.quantile(sorted_steps, 0.05))
    if least <= 0 or touched.min(initial=np.inf) < least or touched.max() > LONG * usual:
        return None
    first = int(np.flatnonzero(order != np.arange(len(order)))[0])
    moved = int(np.count_nonzero(order != np.arange(len(order))))
    words = (
        f"{moved} rows are not in the order of time, the first row {numbers[first]}; they are "
        "taken in that order"
    )
    return time[order], order, {"order": words}


def _without_strays(time: Array, numbers: Rows) -> Mended | None:
    """The rows without single stamps that are no times: their neighbours follow each other."""
    most = 0.01  # share of the rows
    usual, _ = _usual(np.diff(time))
    before = time[:-2]
    after = time[2:]
    between = (time[1:-1] > before) & (time[1:-1] < after)
    stray = np.append(
        np.insert(~between & (after > before) & (after - before < 4 * usual), 0, 0), 0
    )
    stray = stray.astype(bool)
    count = int(np.count_nonzero(stray))
    kept = np.flatnonzero(~stray)
    if not 0 < count <= max(1.0, most * len(time)) or (np.diff(time[kept]) < 0).any():
        return None
    first = int(np.flatnonzero(stray)[0])
    rows = "1 row is" if count == 1 else f"{count} rows are"
    words = (
        f"{rows} left out, the first row {numbers[first]}, whose time of {time[first]:.6g} s is "
        "not between those beside it"
    )
    return time[kept], kept, {"stray": words}


def _why_back(time: Array, numbers: Rows) -> str:
    """Say why the time goes back: that it starts anew, or was set; and what to do."""
    steps = np.diff(time)
    usual, _ = _usual(steps)
    anew = np.flatnonzero(-steps > _SHORT * usual) + 1
    ends = [0, *anew.tolist(), len(time)]
    are_long = bool(len(anew)) and min(np.diff(ends)) >= _SHORT
    if are_long and len(anew) == 1:
        return f"two recordings, the second from row {numbers[anew[0]]}: give them as two files"
    if are_long:
        rows = ", ".join(str(numbers[row]) for row in anew[:5]) + ", ..." * (len(anew) > 5)
        return (
            f"{len(anew) + 1} recordings in one, as the clock starts anew at rows {rows}: give "
            "each as a file of its own"
        )
    row = int(np.argmin(steps))
    return (
        f"the time goes back by {-steps[row]:.3g} s after row {numbers[row]}: its clock was set; "
        "cut the file there, or give the samples per second in place of the time"
    )


def holes(time: Array) -> Rows:
    """The rows after which no sample is there for more than a hundred of the usual steps."""
    steps = np.diff(time)
    if not len(steps):
        return np.zeros(0, np.intp)
    return np.flatnonzero(steps > LONG * np.median(steps))


def holes_in_words(time: Array, numbers: Rows) -> Mapping[str, str]:
    """Say where samples lack, and for how long; empty where they do not."""
    after = holes(time)
    if not len(after):
        return {}
    row = int(after[np.diff(time)[after].argmax()])
    seconds = float(time[row + 1] - time[row])
    steps = seconds / float(np.median(np.diff(time)))
    several = f"{len(after)} holes, the largest" if len(after) > 1 else "a hole"
    return {
        "hole": f"{several} of {seconds:.4g} s after row {numbers[row]}, at {time[row]:.6g} s: "
        f"{steps:.0f} times the usual step without a sample; the fit does not interpolate it"
    }
