"""Check that what a recording of one joint shows is as large as its plan's move can make it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.learn.reading.find_start import Start, StartSearch, courses_of
from quietarm.machine.learn.refusals.check_move import is_cut
from quietarm.machine.recordings.recording import Recording
from quietarm.models.joint_motion import LINEAR
from quietarm.ocp.planning.plan import Plan

Array = NDArray[np.float64]
_TIMES = 200
"""At which the move is compared."""
_MOST_WAYS = 5.0
"""Times the way and the swing of a plan, beyond which no tip goes."""
_LEAST_SWING = 0.05
"""Share of the plan's swing during the move, below which a tip's way is in another unit."""
_MOST_SWINGS = 30.0
"""Times the plan's swing during the move, beyond which that of a tip on a turning joint is."""
_LONGEST = 100.0
"""Of an arm on a joint that turns [m]."""
_MOST_ACCELERATION = 20.0
_MOST_TORQUE = 30.0
"""Times the plan's, beyond which a torque or its inverse is in another unit: masses may be off."""


def check_size(plan: Plan, recording: Recording, start: Start) -> str:
    """Say what is doubted of a torque's unit; nothing where it is as large as the plan's.

    Parameters
    ----------
    plan, recording : Plan, Recording
        The plan, and the recording of its move.
    start : Start
        Where the move begins in it, by another signal than the tip's.

    Raises
    ------
    ValueError
        When a tip or an accelerometer shows far more or less than the plan's move makes.
    """
    task = plan.task
    times = np.linspace(0, task.duration, _TIMES)
    sampled = plan.sampled(times)
    rows = recording.rows(start.time, float(recording.time[-1]))
    moving = recording.rows(start.time, start.time + task.duration)
    if recording.tip is not None:
        went = float(np.ptp(recording.tip[rows], axis=0).max())
        if not is_cut(recording.tip.reshape(len(recording.time), -1)[moving, 0]):
            _check_tip(plan, recording, start, went, float(np.ptp(sampled.tips, axis=0).max()))
    if recording.acceleration is not None and task.plant.joint == LINEAR:
        tip = np.gradient(np.gradient(sampled.tips[:, 0], times), times)
        planned = float((sampled.joint[:, 2] + tip).std())
        seen = float(recording.acceleration[moving].std(axis=0).max()) / max(planned, 1e-300)
        if not 1 / _MOST_ACCELERATION < seen < _MOST_ACCELERATION:
            raise ValueError(
                f"{recording.name}: its accelerometer shows {seen:.3g} times the plan's; give its "
                "unit by --units, such as acceleration:g, or --scale"
            )
    if recording.torque is None:
        return ""
    planned = max(float(sampled.torque.std()), 1e-300)
    times_planned = float(recording.torque[moving].std()) / planned
    if 1 / _MOST_TORQUE < times_planned < _MOST_TORQUE:
        return ""
    return (
        f"warning: {recording.name}: its torque is {times_planned:.3g} times the plan's; what is "
        "learned does not depend on its size, but check its unit, --units or --scale"
    )


def _check_tip(plan: Plan, recording: Recording, start: Start, went: float, swing: float) -> None:
    """Refuse a tip that goes far more than the plan's, or far less than that swings."""
    unit = plan.task.plant.tip_unit
    too_small = went < _LEAST_SWING * swing
    if not too_small and not _is_too_far(plan, recording, start, went, swing):
        return
    way = f"the joint goes {abs(plan.task.span):.4g} m and " * _is_linear(plan)
    raise ValueError(
        f"{recording.name}: its tip goes {went:.4g} {unit}, and in the plan {way}the tip "
        f"swings by {swing:.4g} {unit}; give its unit by --units, such as "
        f"tip:{'m' if too_small else 'mm'}, or --scale"
    )


def _is_linear(plan: Plan) -> bool:
    return plan.task.plant.joint == LINEAR


def _is_too_far(plan: Plan, recording: Recording, start: Start, went: float, swing: float) -> bool:
    """Return whether a tip goes much farther than its joint, or than its lever, takes it."""
    span = abs(plan.task.span)
    if _is_linear(plan):
        return went > _MOST_WAYS * (span + 2 * swing)
    assert recording.tip is not None
    values = recording.tip.reshape(len(recording.time), -1)[:, 0]
    courses = courses_of(plan.candidate, "tip")
    search = StartSearch(recording.time, values, courses, plan.task.duration)
    lever, swings = search.sizes(start.time)
    mostly_swings = abs(swings) * swing > abs(lever) * span  # beside a path a swing is unsure
    return bool(abs(lever) > _LONGEST or (mostly_swings and abs(swings) > _MOST_SWINGS))
