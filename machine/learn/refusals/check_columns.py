"""Check that a recording's columns are what they were said to be: a joint rests after a move."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.learn.reading.read_swing import FAR, SETTLES
from quietarm.machine.learn.tip_modes import TipModes
from quietarm.machine.recordings.recording import Recording
from quietarm.models.joint_motion import LINEAR
from quietarm.ocp.planning.plan import Plan

Array = NDArray[np.float64]
_MOST = 5e-3
"""Share of the way by which a joint may swing after arrival."""
_LEAST = 1e-4
"""Share of the way, below which a joint that swings more than the tip tells nothing."""
_MOSTLY = 0.5
"""Share of what a joint does after arrival that is a swing, where it swings."""


def refuse_constant(name: str, columns: Mapping[str, Array | None]) -> None:
    """Refuse a recording with a column that never changes, as of an unconnected sensor."""
    for what, values in columns.items():
        if values is not None and np.ptp(np.asarray(values), axis=0).max() == 0:
            raise ValueError(
                f"{name}: its {what} never changes, and the plan moves; give the column of a "
                "sensor that was connected"
            )


def check_columns(plan: Plan, recording: Recording, arrival: float) -> None:
    """Refuse what was given as the joint if it swings after arrival, as a tip does."""
    if recording.angle is None:
        return
    task = plan.task
    slowest = float(TipModes(task.plant, task.target).frequencies[0])
    rows = recording.rows(arrival + SETTLES / slowest, float(recording.time[-1]))
    time = recording.time[rows]
    joint, hertz, explained = _swing(time, recording.angle[rows], slowest)
    tip = 0.0
    columns = [] if recording.tip is None else recording.tip.reshape(len(recording.time), -1).T
    for column in columns:
        tip = max(tip, _swing(time, column[rows], slowest)[0])
    way = abs(task.span)
    more = recording.tip is not None and joint > max(2 * tip, _LEAST * way)
    if explained < _MOSTLY or not (joint > _MOST * way or more):
        return
    joint_unit, tip_unit = ("m" if task.plant.joint == LINEAR else "rad"), task.plant.tip_unit
    said = f"{recording.name}: its joint still swings by {_words(joint, joint_unit)}"
    said = f"{said} at {hertz:.3g} Hz after arrival"
    if recording.tip is None:
        raise ValueError(f"{said}; does --angle name the column of the tip?")
    raise ValueError(
        f"{said}, and its tip by {_words(tip, tip_unit)}; were --tip and --angle exchanged?"
    )


def _words(size: float, unit: str) -> str:
    """A length in mm, an angle in degrees."""
    value = 1e3 * size if unit == "m" else float(np.degrees(size))
    return f"{round(value, 4):.2g} {'mm' if unit == 'm' else 'deg'}"


def _swing(time: Array, values: Array, slowest: float) -> tuple[float, float, float]:
    """Amplitude, frequency [Hz] and share of the power of a signal's swing near a frequency.

    Beside a line, which a joint that creeps follows.
    """
    count = 41
    since = time - time.mean()
    line = np.column_stack([np.ones_like(since), since])
    values = values - line @ np.linalg.lstsq(line, values, rcond=None)[0]
    power = float((values**2).sum())
    best = (0.0, slowest, 0.0)
    if power == 0:
        return best
    for hertz in slowest * np.linspace(1 - FAR, 1 + FAR, count):
        turns = 2 * np.pi * hertz * since
        basis = np.column_stack([line, np.cos(turns), np.sin(turns)])
        sizes = np.linalg.lstsq(basis, values, rcond=None)[0]
        explained = 1 - float(((values - basis @ sizes) ** 2).sum()) / power
        if explained > best[2]:
            best = (float(np.hypot(sizes[-2], sizes[-1])), float(hertz), explained)
    return best
