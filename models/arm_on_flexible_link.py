"""The robotic arm mounted on a flexible link of the paper, section 3.2."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np
from quietarm.models.drawing import TIP_SLOPE, Body, flexible_link, rigid_link
from quietarm.models.joint_motion import Expression, JointMotion, Modes
from quietarm.models.plant import Plant, parameter

_LENGTH = 0.55
"""Of the link [m], section 3.2."""
_ARM = 2 * 0.105
"""Length at which the arm is drawn [m]: it is not printed; the centre of gravity is at 105 mm."""
_CLAMP = 0.05
"""Half the width at which the clamp is drawn [m]."""


@dataclass(frozen=True)
class ArmOnFlexibleLink(Plant):
    """A rigid arm whose motor sits on a flexible beam, eqs (13), (14); defaults from eq (15)."""

    name: ClassVar[str] = "arm-on-flexible-link"
    modes: ClassVar[int] = 1
    small_deflection: ClassVar[float | None] = 0.1 * _LENGTH
    """A tenth of the link's length, where the linear stiffness of a cantilever is 1 %
    off (Bisshopp and Drucker, Quart. Appl. Math. 3, 1945)."""

    alpha1: float = parameter(
        -1.055e-1, "-", "eq (15)", "how the arm's angle changes the mode's mass"
    )
    alpha2: float = parameter(
        -9.949e-3, "m", "eq (15)", "push on the mode by the joint's acceleration"
    )
    alpha3: float = parameter(
        5.256e-2, "m", "eq (15)", "that push times the cosine of the joint's angle"
    )
    alpha4: float = parameter(7.634e-2, "-", "eq (15)", "drag on the mode by the turning arm")
    zeta: float = parameter(1.500e-3, "-", "eq (15)", "damping ratio of the mode")
    omega: float = parameter(
        7.320, "rad/s", "eq (15)", "frequency of the mode, arm across the link"
    )
    beta1: float = parameter(5.366e-3, "kg m^2", "eq (15)", "inertia of the arm")
    beta2: float = parameter(-4.944e-3, "kg m", "eq (15)", "torque by the mode's acceleration")
    beta3: float = parameter(
        2.399e-2, "kg m", "eq (15)", "that torque times the cosine of the joint's angle"
    )
    c: float = parameter(1.965e-2, "N m s", "eq (15)", "viscous friction of the joint")
    phi: float = parameter(
        0.508,
        "-",
        "mode shape at the tip, not printed: beta3 / (M lbar) with M = 0.450 kg and "
        "lbar = 0.105 m; see docs/physics.md",
        "displacement of the tip per modal amplitude",
    )

    def modal_accelerations(self, joint: JointMotion, W: Modes, dW: Modes) -> Modes:
        """W'' from eq (13) [m/s^2]."""
        sine, cosine = ca.sin(joint.angle), ca.cos(joint.angle)
        force = (
            2 * self.zeta * self.omega * dW[0]
            + self.omega**2 * W[0]
            + (self.alpha2 + self.alpha3 * cosine) * joint.acceleration
            + (self.alpha4 * dW[0] * joint.speed - self.alpha3 * joint.speed**2) * sine
        )
        return [-force / (1 + self.alpha1 * cosine)]

    def torque(self, joint: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Expression:
        """Joint torque from eq (14) [N m]."""
        coupling = self.beta2 + self.beta3 * ca.cos(joint.angle)
        return self.beta1 * joint.acceleration + self.c * joint.speed + coupling * ddW[0]

    def tip_displacements(self, W: Modes) -> Sequence[Expression]:
        """w(t, l) = phi W [m]."""
        return [self.phi * W[0]]

    def structure(self, angle: float, tips: Sequence[float]) -> Sequence[Body]:
        """The link from its clamp along the x axis, the motor at its tip, and the arm.

        At 0 rad the arm points back along the link: that is how eqs (13) and (14) have it, see
        docs/physics.md, 'How the structures are drawn'.
        """
        link = flexible_link(_LENGTH, 0.0, tips[0])
        slope = np.arctan(TIP_SLOPE * tips[0] / _LENGTH)
        arm = rigid_link(_ARM, np.pi - angle + slope, base=link[-1])
        clamp = [[0.0, -_CLAMP], [0.0, _CLAMP]]
        return [
            Body(np.array(clamp), rigid=True), Body(link, tip=True),
            Body(arm, rigid=True), Body(link[-1:], rigid=True),
        ]  # fmt: skip
