"""Messages of MoveIt in, messages of MoveIt out: the same path, planned so that the tip is still.

A message is a dictionary of what ROS 2 has in it, as `message_to_ordereddict` of
rosidl_runtime_py makes one; nothing here needs ROS.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.models import GeometricPath, Robot, TimedMotion
from quietarm.models.number_checks import (
    finite,
    how_named,
    listed,
    not_negative,
    positive,
    quoted,
    whole,
)
from quietarm.models.robot.path.joint_table import JointTable, table_of_message
from quietarm.models.robot.path.not_driven import moves_undriven
from quietarm.models.robot.path.timed_motion import check_rates
from quietarm.models.robot.urdf.following import Following
from quietarm.ocp import (
    CycloidPolynomial,
    InfeasibleTaskError,
    Plan,
    PointToPoint,
    correct_in_full,
    evaluate_as_timed,
    plan_move,
)
from quietarm.ocp.planning.rigid_motion import rigid_duration
from quietarm.views.formats.trajectory_points import Points, points_of, ros_time
from quietarm.views.tips import tip_words

Array = NDArray[np.float64]
Message = Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class PlannedMessage:
    """A message that was planned anew.

    Attributes
    ----------
    message : dict
        A moveit_msgs/RobotTrajectory, of the joints of the message that was given, in its order.
    plan : Plan
        The plan whose points it has.
    report : str
        One line: what it leaves and takes, beside what the message left as it was timed.
    remarks : tuple of str
        What of the message was passed over, one line each.
    """

    message: dict[str, Any]
    plan: Plan
    report: str
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class MessagePlanner:
    """Plans trajectories of MoveIt anew along the same path, within the robot's limits.

    Parameters
    ----------
    robot : Robot
        What moves, and bends.
    duration : float
        Of the plan [s]; 0 stands for the message's own.
    slowest : float
        Up to so many times that it may take, where its limits leave no plan in less.
    path_tolerance : float
        How far a joint may be from the straight lines between the message's points [rad or m].
    rate : float
        Points of the answer in a second [Hz].
    thin : float
        Of these only as many as keep the joints within this, joined by quintics [rad or m]; 0
        keeps all.
    terms : int
        Coefficients of the plan; with more it takes longer, and fits tighter limits.
    payload : float
        Multiple of the mass at the end of the robot's beam.
    in_full : bool
        Correct the plan by the whole equations.
    judge : bool
        Judge message and answer by the whole equations, as a controller of ROS 2 joins points.

    Raises
    ------
    ValueError
        When a value is out of range.
    """

    robot: Robot
    duration: float = 0.0
    slowest: float = 2.0
    path_tolerance: float = 0.005
    rate: float = 100.0
    thin: float = 0.0
    terms: int = 12
    payload: float = 1.0
    in_full: bool = False
    judge: bool = True

    def __post_init__(self) -> None:
        not_negative("duration", self.duration, "s")
        if finite("slowest", self.slowest) < 1.0:
            raise ValueError(f"slowest is {self.slowest:g}; give 1 or more, such as 1.5")
        positive("path_tolerance", self.path_tolerance, "rad or m")
        positive("rate", self.rate, "Hz")
        not_negative("thin", self.thin, "rad or m")
        whole("terms", self.terms, 1)

    def plan(
        self, message: Message, *, speed_scale: float = 1.0, acceleration_scale: float = 1.0
    ) -> PlannedMessage:
        """Plan the trajectory in a message anew.

        Parameters
        ----------
        message : mapping
            A moveit_msgs/RobotTrajectory, or a message with one within: a MotionPlanResponse,
            whose start state is then checked, a DisplayTrajectory, or a JointTrajectory itself.
        speed_scale, acceleration_scale : float
            Shares of the robot's limits, as a MotionPlanRequest has them; what is not above 0 and
            at most 1 is 1, as in MoveIt.

        Raises
        ------
        ValueError
            When the message has no trajectory of the robot's joints that begins and ends at rest,
            or one of joints that the robot's file does not drive and that move.
        QuietarmError
            When there is no plan within the limits.
        """
        table = table_of_message(message, "the message", _USED).without_repeated
        if not table.joints:
            raise ValueError("the message has no joint_names; give those of its positions")
        _check_rest(table)
        if self.judge and _own_duration(table) is not None:
            check_rates(table)
        _check_no_base(message)
        others = _others(self.robot, table)
        start = _start_state(message)
        _check_start(table, start)
        remarks = [*table.remarks, *_held_elsewhere(self.robot, start | others)]
        duration = self._duration(table)
        path = GeometricPath.within(table.positions, self.path_tolerance, joints=table.joints)
        task = self._task(path, duration, speed_scale, acceleration_scale)
        plan = self._plan(task)
        points = points_of(plan, self.rate, self.thin or None)
        answer = _message_of(table, _all_joints(self.robot, table, points, others))
        words = [self._left(table, plan, points), f"{plan.energy:.4g} J"]
        if plan.task.duration > task.duration:
            words.append(f"in {task.duration:.4g} s no plan is within the limits")
        off = max(path.off_straight.max(), 0.0)
        words.append(f"the path is within {off:.2g} rad (or m) of the message's lines")
        report = f"{plan.task.duration:.4g} s, {len(points.times)} points: {'; '.join(words)}"
        return PlannedMessage(answer, plan, report, (*remarks, *path.remarks))

    def _duration(self, table: JointTable) -> float:
        """The time that was asked for [s], or the message's own."""
        duration = self.duration or _own_duration(table)
        if duration is None:
            raise ValueError(
                "the message has no times that increase, and no duration was given; give a "
                "duration, or have MoveIt parametrise its time before"
            )
        return duration

    def _task(
        self, path: GeometricPath, duration: float, speed_scale: float, acceleration_scale: float
    ) -> PointToPoint:
        """The move along a path within the limits."""
        plant = replace(self.robot.along(path), payload=self.payload)
        scaled = dict[str, dict[str, float]]()
        for quantity, scale in (("speed", speed_scale), ("acceleration", acceleration_scale)):
            limits = self.robot.limits.get(quantity)
            if limits and 0 < scale < 1:
                scaled[f"{quantity}_limit"] = {
                    joint: scale * size for joint, size in limits.items()
                }
        return plant.task(1.0, duration, **scaled)

    def _plan(self, task: PointToPoint) -> Plan:
        """The plan in the least of several durations that has one."""
        profile = CycloidPolynomial(self.terms)
        least = _SURE * rigid_duration(task) / task.duration  # in less not even a rigid joint can
        several = [factor for factor in _LONGER if least < factor < self.slowest]
        factors = [*several, self.slowest]
        for factor in factors:
            slower = replace(task, duration=factor * task.duration)
            try:
                plan = plan_move(slower, profile)
            except InfeasibleTaskError:
                if factor == factors[-1]:
                    raise
                continue
            return correct_in_full(plan) if self.in_full else plan
        raise AssertionError("the last factor returns or raises")

    def _left(self, table: JointTable, plan: Plan, points: Points) -> str:
        """Words on what the answer leaves after arrival, and what the message left."""
        if not self.judge:
            return f"{_words_of(plan.residual)} after arrival by its modes"
        left = self._left_by(points.table(self.robot.joints))
        words = f"{left} after arrival by the whole equations"
        if _own_duration(table) is None:
            return words
        return f"{words} (the message as it was timed: {self._left_by(table)})"

    def _left_by(self, table: JointTable) -> str:
        motion = TimedMotion.of_table(table)
        return _words_of(evaluate_as_timed(self.robot, motion, payload=self.payload).residual)


_USED = ("positions", "velocities", "accelerations", "time_from_start")
"""Entries of a message's points by which it is judged, and has its duration."""
_SURE = 0.99
_LONGER = (1.0, 1.1, 1.25, 1.5, 2.0, 3.0)
"""Multiples of a duration that are tried in turn."""
_REST = 1e-3
"""Speed [rad/s or m/s] that counts as rest at the ends of a message."""
_AT_START = 0.01
"""How far the first point may be from the start state, as MoveIt allows [rad or m]."""


def _words_of(residual: float) -> str:
    """Return what is left, a thousandth of a millimetre at least."""
    return tip_words(max(residual, 1e-6), "m")


def _own_duration(table: JointTable) -> float | None:
    """Return the duration of a message [s]; None for one whose times do not increase."""
    times = table.times
    if times is None or not bool(np.all(np.diff(times) > 0)):
        return None
    return float(times[-1] - times[0])


def _check_rest(table: JointTable) -> None:
    """Refuse a trajectory that begins or ends while it moves."""
    if table.velocities is None:
        return
    for place, speeds in (("begins", table.velocities[0]), ("ends", table.velocities[-1])):
        fastest = int(np.abs(speeds).argmax())
        if abs(speeds[fastest]) > _REST:
            raise ValueError(
                f"the trajectory {place} while joint {quoted(table.joints[fastest])} moves at "
                f"{speeds[fastest]:.3g} rad/s (or m/s); a plan goes from rest to rest: give a "
                "trajectory that does"
            )


def _check_no_base(message: object) -> None:
    """Refuse a message with points of joints of several degrees, such as a mobile base."""
    entries = [message]
    while entries:
        entry = entries.pop()
        if isinstance(entry, Mapping):
            base = entry.get("multi_dof_joint_trajectory")
            if isinstance(base, Mapping) and base.get("points"):
                raise ValueError(
                    f"the message moves {listed(base.get('joint_names') or ())} in several degrees "
                    "of freedom, which a robot's file cannot; plan for the arm's group alone"
                )
            entries += entry.values()
        elif isinstance(entry, list):
            entries += entry


def _others(robot: Robot, table: JointTable) -> dict[str, float | Following]:
    """The message's joints that the robot does not drive: where they stand, or whom they follow."""
    if missing := [name for name in robot.joints if name not in table.joints]:
        strangers = [name for name in table.joints if name not in robot.joints]
        raise ValueError(
            f"the message is of the joints {listed(table.joints)}, without {listed(missing)}, "
            "which the robot's file drives; plan for a group of these as well"
            f"{how_named(strangers, missing)}"
        )
    if moving := moves_undriven(robot, table.joints, table.positions):
        raise ValueError(moving[0])
    others = dict[str, float | Following]()
    followers = robot.followers
    for name, positions in zip(table.joints, table.positions.T):
        if name in robot.joints:
            continue
        if name in followers and followers[name].leader in robot.joints:
            others[name] = followers[name]
            continue
        others[name] = float(positions[0])
    return others


def _start_state(message: Message) -> dict[str, float]:
    """Positions by joint of the start state that a message has; none of one without."""
    state = message.get("trajectory_start")
    stated = state.get("joint_state") if isinstance(state, Mapping) else None
    if not isinstance(stated, Mapping):
        return {}
    return dict(zip(stated.get("name") or (), map(float, stated.get("position") or ())))


def _check_start(table: JointTable, start: Mapping[str, float]) -> None:
    """Refuse a trajectory that begins elsewhere than where the robot is."""
    for name, position in zip(table.joints, table.positions[0]):
        if name in start and abs(start[name] - position) > _AT_START:
            raise ValueError(
                f"joint {quoted(name)} is at {start[name]:.5g} in the start state and at "
                f"{position:.5g} in the first point; plan anew from where the robot is"
            )


def _held_elsewhere(robot: Robot, places: Mapping[str, float | Following]) -> list[str]:
    """Words on joints that stand elsewhere than where the robot's file holds them."""
    moving = {*robot.joints, *robot.followers, *robot.springs}
    words = list[str]()
    for name in robot.description.joints:
        place = places.get(name)
        if name in moving or place is None or isinstance(place, Following):
            continue
        held = robot.held_position(name)
        if abs(place - held) > _AT_START:
            words.append(
                f"joint {quoted(name)} is at {place:.4g}, and the robot's file holds it at "
                f"{held:.4g}"
            )
    return words


def _all_joints(
    robot: Robot,
    table: JointTable,
    points: Points,
    others: Mapping[str, float | Following],
) -> Points:
    """The points with all of the message's joints, in its order."""
    orders = list[Array]()
    for order, values in enumerate(points[1:]):
        columns = dict(zip(robot.joints, values.T))
        for name, other in others.items():
            if isinstance(other, Following):
                offset = 0.0 if order else other.offset
                columns[name] = other.multiplier * columns[other.leader] + offset
            else:
                columns[name] = np.full(len(values), 0.0 if order else other)
        orders.append(np.column_stack([columns[name] for name in table.joints]))
    return Points(points.times, *orders)


def _message_of(table: JointTable, points: Points) -> dict[str, Any]:
    """A RobotTrajectory with the points; its stamp is 0: it begins when it is executed."""
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": table.frame}
    rows = [
        {
            "positions": positions.tolist(),
            "velocities": speeds.tolist(),
            "accelerations": accelerations.tolist(),
            "effort": [],
            "time_from_start": _duration_message(time),
        }
        for time, positions, speeds, accelerations in zip(*points)
    ]
    return {
        "joint_trajectory": {
            "header": header,
            "joint_names": list(table.joints),
            "points": rows,
        },
        "multi_dof_joint_trajectory": {"header": header, "joint_names": [], "points": []},
    }


def _duration_message(time: float) -> dict[str, int]:
    """A builtin_interfaces/Duration."""
    seconds, nanoseconds = ros_time(time)
    return {"sec": seconds, "nanosec": nanoseconds}
