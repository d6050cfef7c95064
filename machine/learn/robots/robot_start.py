"""Where in a robot's recording its move begins, and how sure that is.

By the positions of its joints, where they were recorded; else by the torques or accelerations
themselves, which follow speed, acceleration and swing along the path, each by an unknown size: a
millisecond is a degree of a swing of 3 Hz.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.learn.reading.find_start import Start, compared_at, refuse_unexplained
from quietarm.machine.recordings.robot_recording import RobotRecording
from quietarm.models import JointMotion, Plant
from quietarm.models.robot import RobotOnPath
from quietarm.models.robot.on_path.tip_way import way_of
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.planning.plan import Plan

Array = NDArray[np.float64]
_AT_ONCE = 2000
"""Places that are compared at once: a long recording has hundreds of thousands."""
_LEAST_MET = {"positions": 0.99, "torques": 0.7, "acceleration": 0.5}
"""Share of the power during the move that follows from the plan, or it is another move."""


def find_robot_start(plan: Plan, recording: RobotRecording, plant: Plant) -> Start:
    """The start of a plan's move in a recording of it.

    Parameters
    ----------
    plan : Plan
        That was executed.
    recording : RobotRecording
        Of it.
    plant : Plant
        The plan's, or one that swings as the recording does, by which the start is surer.

    Raises
    ------
    ValueError
        When the recording is of another move.
    """
    duration = plan.task.duration
    signal, values = recording.swinging
    if recording.positions is not None:
        signal, values = "positions", recording.positions
    search = _StartSearch(recording.time, values, _courses(plan, plant, signal), duration)
    place, explained = search.best()
    if explained < _LEAST_MET[signal]:
        refuse_unexplained(recording.name, signal, explained)
    time, deviation = search.refined(place)
    if signal == "positions":
        _check_way(plan, recording, time)
    return Start(time, signal, explained, deviation)


def _courses(plan: Plan, plant: Plant, signal: str) -> Array:
    """Return the signals' parts during the move, as a plant has it (points, courses)."""
    duration = plan.task.duration
    times = compared_at(duration)
    moving = times >= 0
    task = replace(plan.task.certain, plant=plant, final=None)
    motion = JudgedMotion.of_profile(task, plan.profile, plan.coefficients)
    sampled = motion.sample(times[moving])
    sample = sampled.sample
    if signal == "positions":
        courses = [joint.angle for joint in sample.joints]
    elif signal == "torques":
        courses = [*sample.torques, *sample.W, *sample.ddW]
    else:
        courses = [*felt_at_rest(plant, times[moving], sampled.motion), *sample.W, *sample.ddW]
    whole = np.stack(courses, axis=1)
    before = np.repeat(whole[:1], np.count_nonzero(~moving), axis=0)
    return np.concatenate([before, whole])


def felt_at_rest(plant: Plant, time: Array, motion: JointMotion) -> Sequence[Array]:
    """Return what an accelerometer at a tip that does not swing feels, along a robot's path too."""
    if not isinstance(plant, RobotOnPath):
        return [motion.speed**2, motion.acceleration]
    way = way_of(plant.robot, plant.path, plant.stiffness, plant.payload)
    return [*way.felt(time, np.asarray(motion.angle), np.asarray(plant.robot.gravity)).T]


class _StartSearch:
    """The places of a recording, and how much of its signals a plan explains there."""

    def __init__(self, time: Array, values: Array, courses: Array, duration: float) -> None:
        self._time = time
        self._values = values
        self._at = compared_at(duration)
        moved = courses[:, np.ptp(courses, axis=0) > 1e-9 * np.abs(courses).max()]
        centred = moved - moved.mean(axis=0)
        directions, sizes, _ = np.linalg.svd(centred / centred.std(axis=0), full_matrices=False)
        self._basis = directions[:, sizes > 1e-6 * sizes[0]]

    def best(self) -> tuple[float, float]:
        """The place that is met best [s], and the share that is explained there."""
        step = float(self._at[1] - self._at[0])
        least, most = float(self._time[0]), float(self._time[-1] - self._at[-1])
        places = np.arange(least, most + step, step)
        pieces = [self._shares(places[k : k + _AT_ONCE]) for k in range(0, len(places), _AT_ONCE)]
        shares = np.concatenate(pieces)
        k = int(shares.argmax())
        return float(places[k]), float(shares[k])

    def refined(self, place: float) -> tuple[float, float]:
        """The place between samples [s], and its standard deviation."""
        from scipy.optimize import minimize_scalar  # not at the top: it takes long to load

        step = float(self._at[1] - self._at[0])
        bounds = (place - 2 * step, place + 2 * step)
        options = {"xatol": 1e-3 * step}
        found: Any = minimize_scalar(self._left, bounds=bounds, method="bounded", options=options)
        time = float(found.x)
        least = self._left(time)
        bend = (self._left(time + step) + self._left(time - step) - 2 * least) / step**2
        independent = 20  # what is left changes slowly along the move
        return time, float(np.sqrt(2 * max(least, 1e-16) / max(bend, 1e-16) / independent))

    def _left(self, place: float) -> float:
        return 1 - float(self._shares(np.array([place]))[0])

    def _shares(self, places: Array) -> Array:
        """Shares of the power that follow from the courses, at places one step apart."""
        points = len(self._at)
        step = float(self._at[1] - self._at[0])
        at = places[0] + self._at[0] + step * np.arange(len(places) + points - 1)
        columns = [np.interp(at, self._time, column) for column in self._values.T]
        windows = np.lib.stride_tricks.sliding_window_view(np.stack(columns), points, axis=1)
        centred = windows - windows.mean(axis=-1, keepdims=True)  # (signals, places, points)
        power = np.maximum((centred**2).sum(axis=(0, -1)), self._least)
        shares: Array = ((centred @ self._basis) ** 2).sum(axis=(0, -1)) / power
        return shares

    @cached_property
    def _least(self) -> float:
        """Power below which a window rests."""
        spread = self._values - np.median(self._values, axis=0)
        return 1e-2 * len(self._at) * float((spread**2).mean(axis=0).sum()) + 1e-300


def _check_way(plan: Plan, recording: RobotRecording, start: float) -> None:
    """Refuse joints that went another way than the plan's."""
    same = 0.03
    assert recording.positions is not None
    duration = plan.task.duration
    sampled = plan.sampled(np.array([0.0, duration]))
    for column, (name, joint) in zip(
        recording.positions.T, zip(plan.task.plant.joint_names, sampled.sample.joints)
    ):
        way = float(np.ptp(joint.angle))
        ends = np.interp([start, start + duration], recording.time, column)
        went = float(np.ptp(ends))
        if way > 1e-3 and abs(went / way - 1) > same:
            raise ValueError(
                f"{recording.name}: it is of another move: {name} goes {went:.4g}, and that of the "
                f"plan {way:.4g}; give the recording of this plan's move, or its unit by --units"
            )
