"""The robotic arm mounted on a flexible link of the paper, section 3.2."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from quietarm.models.drawing import TIP_SLOPE, Body, flexible_link, rigid_link
from quietarm.models.joint_motion import Expression, JointMotion, Modes
from quietarm.models.plant import DAMPING, TIP, Plant, parameter

_LENGTH = 0.55
"""Of the link [m], section 3.2."""


def _printed(value: float, unit: str, meaning: str, kind: str | None = None) -> Any:
    return parameter(value, unit, "eq (15)", meaning, kind)


@dataclass(frozen=True)
class ArmOnFlexibleLink(Plant):
    """A rigid arm whose motor sits on a flexible beam, eqs (13), (14); defaults from eq (15)."""

    name: ClassVar[str] = "arm-on-flexible-link"
    modes: ClassVar[int] = 1
    small_deflection: ClassVar[float | None] = 0.1 * _LENGTH
    """A tenth of the link's length, where the linear stiffness of a cantilever is 1 %
    off (Bisshopp and Drucker, Quart. Appl. Math. 3, 1945)."""

    alpha1: float = _printed(-1.055e-1, "-", "how the arm's angle changes the mode's mass")
    alpha2: float = _printed(-9.949e-3, "m", "push on the mode by the joint's acceleration")
    alpha3: float = _printed(5.256e-2, "m", "that push times the cosine of the joint's angle")
    alpha4: float = _printed(7.634e-2, "-", "drag on the mode by the turning arm")
    zeta: float = _printed(1.500e-3, "-", "damping ratio of the mode", DAMPING)
    omega: float = _printed(7.320, "rad/s", "frequency of the mode, arm across the link")
    beta1: float = _printed(5.366e-3, "kg m^2", "inertia of the arm")
    beta2: float = _printed(-4.944e-3, "kg m", "torque by the mode's acceleration")
    beta3: float = _printed(2.399e-2, "kg m", "that torque times the cosine of the joint's angle")
    c: float = _printed(1.965e-2, "N m s", "viscous friction of the joint")
    phi: float = parameter(0.508, "-", "not printed: beta3 / (M lbar), docs/physics.md", TIP)

    def modal_accelerations(self, joint: JointMotion, W: Modes, dW: Modes) -> Modes:
        """W'' from eq (13) [m/s^2]."""
        (w,) = W
        (dw,) = dW
        sine = ca.sin(joint.angle)
        cosine = ca.cos(joint.angle)
        force = (
            2 * self.zeta * self.omega * dw
            + self.omega**2 * w
            + (self.alpha2 + self.alpha3 * cosine) * joint.acceleration
            + (self.alpha4 * dw * joint.speed - self.alpha3 * joint.speed**2) * sine
        )
        return [-force / (1 + self.alpha1 * cosine)]

    def torque(self, joint: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Expression:
        """Joint torque from eq (14) [N m]."""
        coupling = self.beta2 + self.beta3 * ca.cos(joint.angle)
        return self.beta1 * joint.acceleration + self.c * joint.speed + coupling * ddW[0]

    def tip_displacements(self, W: Modes) -> Sequence[Expression]:
        """w(t, l) = phi W [m]."""
        return [self.phi * w for w in W]

    def structure(self, angle: float, tips: Sequence[float]) -> Sequence[Body]:
        """The link from its clamp along the x axis, the motor at its tip, and the arm.

        At 0 rad the arm points back along the link: that is how eqs (13) and (14) have it, see
        docs/physics.md, 'How the structures are drawn'.
        """
        link = flexible_link(_LENGTH, 0.0, tips[0])
        slope = np.arctan(TIP_SLOPE * tips[0] / _LENGTH)
        # It is not printed; the centre of gravity is at 105 mm.
        arm_length = 2 * 0.105
        arm = rigid_link(arm_length, np.pi - angle + slope, base=link[-1])
        half_width = 0.05  # of the clamp, as drawn [m]
        return [
            Body(np.array([[0.0, -half_width], [0.0, half_width]]), rigid=True),
            Body(link, tip=True),
            Body(arm, rigid=True),
            Body(link[-1:], rigid=True),
        ]
