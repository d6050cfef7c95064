"""Joints of a path that the robot's file does not drive, and that move along it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from quietarm.models.joint_motion import LINEAR, Array
from quietarm.models.number_checks import listed, quoted
from quietarm.models.robot.dynamics.robot_parts import RobotParts

_STILL = 1e-5
"""How far a joint that is not driven may move [rad or m]."""


def moves_undriven(robot: RobotParts, joints: Sequence[str], positions: Array) -> list[str]:
    """Words on each joint that moves, is not driven and follows none that is, with the remedy.

    Positions are a column for each of the joints [rad or m].
    """
    driven = {name for name, how in robot.followers.items() if how.leader in robot.joints}
    driven |= {*robot.joints}
    ways = {name: float(np.ptp(column)) for name, column in zip(joints, positions.T)}
    return [
        f"joint {quoted(name)} moves by {way:.3g} {_unit(robot, name)}, and the robot's file does "
        f"not drive it{_held(robot, name)}; add it to joints, beside {listed(robot.joints)}"
        for name, way in ways.items()
        if name not in driven and way > _STILL
    ]


def _unit(robot: RobotParts, joint: str) -> str:
    if joint not in robot.description.moving:
        return "rad (or m)"
    return "m" if robot.kind_of(joint) == LINEAR else "rad"


def _held(robot: RobotParts, joint: str) -> str:
    """Say where the file holds a joint."""
    if joint not in robot.description.moving or joint in robot.springs:
        return ""
    return f", but holds it at {robot.held_position(joint):.4g}"
