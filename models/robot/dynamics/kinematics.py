"""Positions of a robot's links by the positions of its driven joints, if nothing bends."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from quietarm.models.compiled import Compiled
from quietarm.models.joint_motion import Array
from quietarm.models.robot.dynamics.equations_of_motion import Dynamics
from quietarm.models.robot.frames import rotation_of


@dataclass(frozen=True, eq=False)
class Pose:
    """The pose of a link, seen from the ground: its rotation, shape (3, 3), and its origin [m]."""

    rotation: Array
    origin: Array

    @classmethod
    def of(cls, numbers: Array, before: Pose) -> Pose:
        """Make a pose by x, y, z [m], with the present rotation or roll, pitch, yaw [rad]."""
        rotation = rotation_of(*numbers[3:]) if len(numbers) == 6 else before.rotation
        return cls(rotation, numbers[:3])

    def moved(self, way: Array) -> Pose:
        """Return the pose moved by a way in the frame of the ground [m], with the same rotation."""
        return Pose(self.rotation, self.origin + way)


@dataclass(frozen=True, eq=False)
class Kinematics:
    """The pose of a link by the positions of the driven joints.

    Attributes
    ----------
    dynamics : Dynamics
        Of the robot.
    link : str
        A link of the URDF, or the end of the beam.
    """

    dynamics: Dynamics
    link: str

    def pose(self, q: Array) -> Pose:
        """Return the pose of the link."""
        rotation, origin = self._place(q)
        return Pose(rotation, origin.ravel())

    def offset(self, q: Array, pose: Pose) -> tuple[Array, Array]:
        """Return how far the link is from a pose, six numbers [m, rad], and slopes by q."""
        offset, slopes = self._offset(q, pose.rotation, pose.origin)
        return offset.ravel(), slopes

    @cached_property
    def _place(self) -> Compiled:
        q = ca.SX.sym("q", self.dynamics.driven)
        outputs = [*self._symbols(q)]
        return Compiled(lambda: ca.Function("place", [q], outputs, {"cse": True}))

    @cached_property
    def _offset(self) -> Compiled:
        q = ca.SX.sym("q", self.dynamics.driven)
        wanted = ca.SX.sym("rotation", 3, 3)
        target = ca.SX.sym("origin", 3)
        rotation, origin = self._symbols(q)
        turned = wanted.T @ rotation
        turns = ca.vertcat(
            turned[2, 1] - turned[1, 2],
            turned[0, 2] - turned[2, 0],
            turned[1, 0] - turned[0, 1],
        )
        offset = ca.vertcat(origin - target, turns / 2)
        inputs = [q, wanted, target]
        outputs = [ca.densify(offset), ca.densify(ca.jacobian(offset, q))]
        return Compiled(lambda: ca.Function("offset", inputs, outputs, {"cse": True}))

    def _symbols(self, q: ca.SX) -> tuple[ca.SX, ca.SX]:
        place = self.dynamics.mechanism.links[self.link]
        x = ca.vertcat(q, ca.SX(self.dynamics.sprung, 1))
        rotation, origin = self.dynamics.place(place, x)
        return ca.densify(rotation), ca.densify(origin)
