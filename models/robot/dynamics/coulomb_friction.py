"""Coulomb friction of a robot's joints, smooth about rest."""

from __future__ import annotations

from collections.abc import Sequence

from quietarm.models.coulomb import dry_friction
from quietarm.models.joint_motion import Expression, JointMotion
from quietarm.models.robot.dynamics.robot_parts import RobotParts


def coulomb_torques(robot: RobotParts, joints: Sequence[JointMotion]) -> list[Expression]:
    """Coulomb friction of every driven joint by its speed [N m]; 0.0 where it has none.

    That of joints that follow it is felt by virtual work.
    """
    torques = list[Expression]()
    for name, joint in zip(robot.joints, joints):
        torque = dry_friction(robot.coulomb.get(name, 0.0), joint.speed)
        for follower, entry in robot.followers.items():
            friction = robot.coulomb.get(follower, 0.0)
            if entry.leader == name and friction and entry.multiplier:
                turning = dry_friction(friction, entry.multiplier * joint.speed)
                torque = torque + entry.multiplier * turning
        torques.append(torque)
    return torques
