"""A robot on its path as a plant: what moves is the place s on the path."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from quietarm.models.joint_motion import Array, Expression, JointMotion, Modes, is_zero
from quietarm.models.plant import Plant, content
from quietarm.models.robot.path import GeometricPath
from quietarm.models.robot.robot import Robot
from quietarm.models.robot.tables import Tables, reach, tables_of

_OVER = 1e-9
"""By which a path may pass the range of a joint [rad or m]."""


@dataclass(frozen=True)
class RobotOnPath(Plant):
    """A robot that follows a path; made by `Robot.along`.

    The joint's angle is the place s on the path, from 0 to 1. W are deviations of the modes from
    the equilibrium under gravity, which moves with the path.

    Raises
    ------
    ValueError
        When the path has other joints than the robot, leaves the range of one, or a spring cannot
        carry its load on it.
    """

    name: ClassVar[str] = "robot"
    path_range: ClassVar[tuple[float, float] | None] = reach()

    robot: Robot = content("what moves")  # noqa: RUF009
    path: GeometricPath = content("where its joints go")  # noqa: RUF009

    def __post_init__(self) -> None:
        path = self.path
        names = self.robot.joints
        if path.joints and set(path.joints) != set(names):
            raise ValueError(
                f"the path is of the joints {', '.join(path.joints)}, and the robot drives "
                f"{', '.join(names)}; give positions of these"
            )
        if path.count != len(names):
            raise ValueError(
                f"the path is of {path.count} joints, and the robot drives {len(names)}, "
                f"{', '.join(names)}; give positions of these, in this order"
            )
        if path.joints and path.joints != names:
            object.__setattr__(self, "path", path.of_joints(names))
        self._check_ranges()
        _ = self.tables

    @property
    def modes(self) -> int:  # pyright: ignore[reportIncompatibleVariableOverride]
        """How many modal amplitudes it has."""
        return self.robot.modes

    @property
    def label(self) -> str:
        """The robot's name, and what bends."""
        robot = self.robot
        bends = [
            *(["base"] if robot.base is not None else []),
            *(["gears"] if robot.elastic_joints else []),
            *(["springs"] if robot.springs else []),
            *([f"beam at {robot.beam.at}"] if robot.beam is not None else []),
        ]
        return f"{robot.description.name} ({len(robot.joints)} joints; {', '.join(bends)})"

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Of the driven joints."""
        return self.robot.joints

    @property
    def tables(self) -> Tables:
        """The coefficients of its equations."""
        return tables_of(self.robot, self.path)

    def modal_accelerations(self, joint: JointMotion, W: Modes, dW: Modes) -> Modes:
        """W'' by the motion on the path [m/s^2]."""
        of = self._coefficients(joint, self.tables.modes)
        square = joint.speed * joint.speed
        accelerations = list[Expression]()
        for i in range(self.modes):
            forces = [
                (of["a"][i], joint.acceleration),
                (of["b"][i], square),
                (of["e"][i], joint.speed),
            ]
            for j in range(self.modes):
                stiffness = _sum([
                    (of["K"][i, j], 1.0),
                    (of["A"][i, j], joint.acceleration),
                    (of["B"][i, j], square),
                ])  # fmt: skip
                damping = _sum([(of["D"][i, j], 1.0), (of["C"][i, j], joint.speed)])
                forces += [(stiffness, W[j]), (damping, dW[j])]
            accelerations.append(-_sum(forces))
        return accelerations

    def joints(self, path: JointMotion) -> Sequence[JointMotion]:
        """Motion of every driven joint [rad or m]."""
        positions = np.moveaxis(np.array(self.tables.path), 0, -1)
        by_joint = self.tables.at(path.angle).values(positions)
        square = path.speed * path.speed
        nothing = 0 * path.angle
        motions = list[JointMotion]()
        for at, slope, bend, third in by_joint:
            speed = _sum([(slope, path.speed)])
            acceleration = _sum([(slope, path.acceleration), (bend, square)])
            jerk = None
            if path.jerk is not None:
                jerk = nothing + _sum([
                    (slope, path.jerk),
                    (bend, 3 * path.speed * path.acceleration),
                    (third, square * path.speed),
                ])  # fmt: skip
            motion = JointMotion(at + nothing, speed + nothing, acceleration + nothing, jerk)
            motions.append(motion)
        return motions

    def torques(self, path: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Sequence[Expression]:
        """Torque of every driven joint [N m, or N of a sliding one]."""
        of = self._coefficients(path, self.tables.torques)
        square = path.speed * path.speed
        nothing = 0 * path.angle
        torques = list[Expression]()
        for i in range(len(self.joint_names)):
            terms = [
                (of["g"][i], 1.0),
                (of["a"][i], path.acceleration),
                (of["b"][i], square),
                (of["e"][i], path.speed),
            ]
            for j in range(self.modes):
                stiffness = _sum([
                    (of["K"][i, j], 1.0),
                    (of["A"][i, j], path.acceleration),
                    (of["B"][i, j], square),
                ])  # fmt: skip
                damping = _sum([(of["C"][i, j], path.speed)])
                terms += [(stiffness, W[j]), (damping, dW[j]), (of["N"][i, j], ddW[j])]
            torques.append(_sum(terms) + nothing)
        return torques

    def tips_at(self, path: JointMotion, W: Modes) -> Sequence[Expression]:
        """Displacements of the tip from its place at rest, in its own frame [m]."""
        rows = self.tables.at(path.angle).values(self.tables.tips)
        return [_sum(list(zip(row, W))) + 0 * path.angle for row in rows]

    def tip_speeds(self, path: JointMotion, W: Modes, dW: Modes) -> Sequence[Expression]:
        """Their rates [m/s]."""
        place = self.tables.at(path.angle)
        rows = place.values(self.tables.tips)
        slopes = place.values(self.tables.tip_rates)
        return [
            _sum(list(zip(slope, W))) * path.speed + _sum(list(zip(row, dW)))
            for row, slope in zip(rows, slopes)
        ]

    def _coefficients(self, path: JointMotion, tables: Mapping[str, Array]) -> dict[str, Array]:
        """All of a group at the place on the path, by one product."""
        place = self.tables.at(path.angle)
        return {name: place.values(table) for name, table in tables.items()}

    def _check_ranges(self) -> None:
        """Refuse a path beyond a joint's range."""
        places = np.linspace(0.0, 1.0, 1001)
        positions = self.path(places)
        for name, (least, most), column in zip(self.joint_names, self.robot.ranges(), positions.T):
            beyond = np.maximum(column - most, least - column)
            if beyond.max() > _OVER:
                at = int(beyond.argmax())
                raise ValueError(
                    f"joint {name!r} is at {column[at]:.5g} at s = {places[at]:.3g} of the path; "
                    f"its range is {least:g} to {most:g}, give a path within it"
                )


def _sum(products: Sequence[tuple[Expression, Expression]]) -> Expression:
    """Of products of two, without those that are nothing."""
    terms = [left * right for left, right in products if not (is_zero(left) or is_zero(right))]
    return sum(terms[1:], terms[0]) if terms else 0.0
