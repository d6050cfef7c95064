"""Coulomb friction of a robot's joints, smooth about rest."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from quietarm.models.joint_motion import Expression, JointMotion
from quietarm.models.robot.dynamics.robot_parts import RobotParts

_CREEP = 0.01
"""Speed [rad/s or m/s] at which Coulomb friction is 1 / sqrt(2) of itself."""


def coulomb_torques(robot: RobotParts, joints: Sequence[JointMotion]) -> list[Expression]:
    """Coulomb friction of every driven joint by its speed [N m]; 0.0 where it has none.

    That of joints that follow it is felt by virtual work.
    """
    torques = list[Expression]()
    for name, joint in zip(robot.joints, joints):
        torque = _coulomb(robot.coulomb.get(name, 0.0), joint.speed)
        for follower, entry in robot.followers.items():
            friction = robot.coulomb.get(follower, 0.0)
            if entry.leader == name and friction and entry.multiplier:
                turning = _coulomb(friction, entry.multiplier * joint.speed)
                torque = torque + entry.multiplier * turning
        torques.append(torque)
    return torques


def _coulomb(friction: float, speed: Expression) -> Expression:
    turning = 0.0 if friction == 0 else speed / ca.sqrt(speed * speed + _CREEP**2)
    return friction * turning
