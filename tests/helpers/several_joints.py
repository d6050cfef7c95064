"""Plants of several joints, written by hand: two links with elastic joints, and a gantry."""

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

import quietarm as qa
from quietarm.models import JointMotion


def along(path, start, way):
    """A joint that goes `way` from `start` while the path goes from 0 to 1."""
    jerk = None if path.jerk is None else way * path.jerk
    return JointMotion(start + way * path.angle, way * path.speed, way * path.acceleration, jerk)


@dataclass(frozen=True)
class TwoLinks(qa.Plant):
    """A horizontal arm of two links; the modes are what the joints' springs give way [rad].

    The motors move on a straight line in their angles. The equations are linear in the springs.
    """

    name: ClassVar[str] = "two-links"
    modes: ClassVar[int] = 2
    path_range: ClassVar[tuple[float, float]] = (0.0, 1.0)

    start1: float = qa.parameter(0.2, "rad", "chosen")
    start2: float = qa.parameter(0.3, "rad", "chosen")
    way1: float = qa.parameter(1.2, "rad", "chosen")
    way2: float = qa.parameter(-0.8, "rad", "chosen")
    stiffness1: float = qa.parameter(800.0, "N m/rad", "chosen")
    stiffness2: float = qa.parameter(300.0, "N m/rad", "chosen")
    damping_time: float = qa.parameter(0.001, "s", "damping over stiffness, chosen")
    length1: float = qa.parameter(0.5, "m", "chosen")
    length2: float = qa.parameter(0.4, "m", "chosen")
    mass1: float = qa.parameter(3.0, "kg", "chosen")
    mass2: float = qa.parameter(2.0, "kg", "chosen")
    rotor: float = qa.parameter(0.2, "kg m^2", "of each motor, chosen")

    @property
    def joint_names(self):
        return ("shoulder", "elbow")

    def joints(self, path):
        return [along(path, self.start1, self.way1), along(path, self.start2, self.way2)]

    def inertias(self, elbow):
        """M11, M12, M22, and the derivative of -M12 by the elbow's angle, and that of this."""
        first = (self.mass1 / 3 + self.mass2) * self.length1**2
        coupling = self.mass2 * self.length1 * self.length2 / 2
        second = self.mass2 * self.length2**2 / 3
        cosine, sine = ca.cos(elbow), ca.sin(elbow)
        return (
            first + second + 2 * coupling * cosine,
            second + coupling * cosine,
            second,
            coupling * sine,
            coupling * cosine,
        )

    def springs(self, W, dW):
        stiffness = self.stiffness1, self.stiffness2
        return [k * (w + self.damping_time * rate) for k, w, rate in zip(stiffness, W, dW)]

    def modal_accelerations(self, joint, W, dW):
        shoulder, elbow = self.joints(joint)
        M11, M12, M22, h, dh = self.inertias(elbow.angle)
        v1, v2 = shoulder.speed, elbow.speed
        a1, a2 = shoulder.acceleration, elbow.acceleration
        spring1, spring2 = self.springs(W, dW)
        forces1 = (
            M11 * a1 + M12 * a2 - h * v2 * (2 * v1 + v2)
            - (h * (2 * a1 + a2) + dh * v2 * (2 * v1 + v2)) * W[1]
            - 2 * h * (v2 * dW[0] + (v1 + v2) * dW[1])
            + spring1
        )  # fmt: skip
        forces2 = (
            M12 * a1 + M22 * a2 + h * v1 * v1
            - (h * a1 - dh * v1 * v1) * W[1] + 2 * h * v1 * dW[0] + spring2
        )  # fmt: skip
        determinant = M11 * M22 - M12 * M12
        return [
            (M12 * forces2 - M22 * forces1) / determinant,
            (M12 * forces1 - M11 * forces2) / determinant,
        ]

    def torques(self, path, W, dW, ddW):
        motors = zip(self.joints(path), self.springs(W, dW))
        return [self.rotor * joint.acceleration - spring for joint, spring in motors]

    def tips_at(self, path, W):
        """Across the first link, and along and across the hand's own direction."""
        elbow = self.start2 + self.way2 * path.angle
        return [
            self.length1 * ca.sin(elbow) * W[0],
            self.length1 * ca.cos(elbow) * W[0] + self.length2 * (W[0] + W[1]),
        ]

    def tip_speeds(self, path, W, dW):
        elbow = self.start2 + self.way2 * path.angle
        turned = self.length1 * self.way2 * path.speed * W[0]
        along_hand, across = self.tips_at(path, dW)
        return [along_hand + ca.cos(elbow) * turned, across - ca.sin(elbow) * turned]


@dataclass(frozen=True)
class Gantry(qa.Plant):
    """Two carriages at right angles and a mast that swings in both directions."""

    name: ClassVar[str] = "gantry"
    modes: ClassVar[int] = 2
    joint: ClassVar[str] = "linear"

    omega_x: float = qa.parameter(15.0, "rad/s", "chosen")
    omega_y: float = qa.parameter(19.0, "rad/s", "chosen")
    zeta: float = qa.parameter(0.01, "-", "chosen", kind="damping")
    share_x: float = qa.parameter(0.8, "-", "of the way, along x")
    share_y: float = qa.parameter(0.6, "-", "of the way, along y")
    mass_x: float = qa.parameter(30.0, "kg", "that moves along x")
    mass_y: float = qa.parameter(18.0, "kg", "that moves along y")
    load: float = qa.parameter(5.0, "kg", "of them, the mast")

    @property
    def shares(self):
        return self.share_x, self.share_y

    def joints(self, path):
        return [along(path, 0.0, share) for share in self.shares]

    def modal_accelerations(self, joint, W, dW):
        axes = zip((self.omega_x, self.omega_y), self.shares, W, dW)
        return [
            -omega * (omega * w + 2 * self.zeta * rate) - share * joint.acceleration
            for omega, share, w, rate in axes
        ]

    def torques(self, path, W, dW, ddW):
        axes = zip((self.mass_x, self.mass_y), self.joints(path), ddW)
        return [mass * axis.acceleration + self.load * swing for mass, axis, swing in axes]

    def tip_displacements(self, W):
        return list(W)
