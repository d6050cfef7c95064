"""Frames of bodies, in numbers: rotations and places in another body's frame."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from quietarm.models.joint_motion import Array


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame that stands in another: its rotation, shape (3, 3), and its origin [m]."""

    rotation: Array = field(default_factory=lambda: np.eye(3))
    origin: Array = field(default_factory=lambda: np.zeros(3))

    def point(self, point: Array) -> Array:
        """A point of this frame, in the other."""
        return self.rotation @ point + self.origin

    def __matmul__(self, inner: Frame) -> Frame:
        """Return the place of a frame of this one in the other."""
        return Frame(self.rotation @ inner.rotation, self.point(inner.origin))


def rotation_of(roll: float, pitch: float, yaw: float) -> Array:
    """About x, then y, then z of the fixed frame, as a URDF's rpy [rad]."""
    about_z = rotation_about(np.array([0.0, 0.0, 1.0]), yaw)
    about_y = rotation_about(np.array([0.0, 1.0, 0.0]), pitch)
    about_x = rotation_about(np.array([1.0, 0.0, 0.0]), roll)
    return about_z @ about_y @ about_x


def rotation_of_quaternion(quaternion: Array) -> Array:
    """Return the rotation by a quaternion x, y, z, w of any length but 0."""
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    skew = skew_of(np.array([x, y, z]))
    return np.eye(3) + 2 * w * skew + 2 * skew @ skew


def rotation_about(axis: Array, angle: float) -> Array:
    """Return the rotation by an angle [rad] about a unit vector, by Rodrigues' formula."""
    skew = skew_of(axis)
    return np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew


def shortest_turn(direction: Array) -> Array:
    """Return the rotation that turns z into a direction; of -z about x."""
    x, y, z = direction / np.linalg.norm(direction)
    across = np.hypot(x, y)
    axis = np.array([-y, x, 0.0]) / across if across > 0 else np.array([1.0, 0.0, 0.0])
    return rotation_about(axis, np.arctan2(across, z))


def skew_of(vector: Array) -> Array:
    """The matrix by which a vector is multiplied crosswise from the left."""
    x = vector[0]
    y = vector[1]
    z = vector[2]
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
