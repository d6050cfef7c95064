"""Two flexible links on one hub, the kind of plant of the paper's ref. [25]."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from quietarm.models.drawing import Body, flexible_link
from quietarm.models.joint_motion import Expression, JointMotion, Modes
from quietarm.models.plant import DAMPING, TIP, Plant, parameter


def _identified(
    theory: float, factor: float, unit: str, meaning: str, kind: str | None = None
) -> Any:
    source = "theoretical value times identified factor, docs/physics.md"
    return parameter(theory * factor, unit, source, meaning, kind)


@dataclass(frozen=True)
class DualLinkManipulator(Plant):
    """Two flexible links of different frequency that one motor turns.

    The equations are derived in docs/physics.md, 'A third plant', which also has the source of the
    parameters. Index 1 or 2 is the link's.
    """

    name: ClassVar[str] = "dual-link"
    modes: ClassVar[int] = 2

    omega1: float = _identified(12.68, 0.993, "rad/s", "frequency of link 1, hub held")
    zeta1: float = _identified(15.49e-3, 1.214, "-", "damping ratio of link 1", DAMPING)
    a1: float = _identified(0.2266, 0.984, "m", "push on link 1 by the joint's acceleration")
    b1: float = _identified(
        2.004e-3, 1.020, "-", "stiffening of link 1 by the joint's speed squared"
    )
    omega2: float = _identified(10.71, 0.993, "rad/s", "frequency of link 2, hub held")
    zeta2: float = _identified(14.27e-3, 1.071, "-", "damping ratio of link 2", DAMPING)
    a2: float = _identified(0.2570, 1.003, "m", "push on link 2 by the joint's acceleration")
    b2: float = _identified(
        5.822e-3, 1.006, "-", "stiffening of link 2 by the joint's speed squared"
    )
    g1: float = _identified(2.996e-2, 1.016, "kg m^2", "inertia of hub and rigid links together")
    g2: float = _identified(6.652e-2, 1.018, "kg m", "torque by the acceleration of mode 1")
    g3: float = _identified(5.237e-2, 1.052, "kg m", "torque by the acceleration of mode 2")
    c: float = _identified(4.202e-2, 1.131, "N m s", "viscous friction of the joint")
    phi: float = parameter(
        2.7244, "-", "first mode of a clamped-free beam at its tip, docs/physics.md", TIP
    )

    def modal_accelerations(self, joint: JointMotion, W: Modes, dW: Modes) -> Modes:
        """W_1'' and W_2'' [m/s^2]: each link vibrates on its own, as the single link does."""
        links = (
            (self.omega1, self.zeta1, self.a1, self.b1),
            (self.omega2, self.zeta2, self.a2, self.b2),
        )
        return [
            -2 * zeta * omega * dW[i]
            - (omega**2 + b * joint.speed**2) * W[i]
            - a * joint.acceleration
            for i, (omega, zeta, a, b) in enumerate(links)
        ]

    def torque(self, joint: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Expression:
        """Joint torque [N m]: both links act on the one hub."""
        inertia = self.g1 * joint.acceleration + self.g2 * ddW[0] + self.g3 * ddW[1]
        return inertia + self.c * joint.speed

    def tip_displacements(self, W: Modes) -> Sequence[Expression]:
        """Displacement of either tip, phi W_i [m]."""
        return [self.phi * w for w in W]

    def structure(self, angle: float, tips: Sequence[float]) -> Sequence[Body]:
        """Two links on one hub, the second opposite the first: how they stand is not published."""
        # Length at which both links are drawn [m]: theirs are not published.
        length = 0.5
        first = flexible_link(length, angle, tips[0])
        second = flexible_link(length, angle + np.pi, tips[1])
        return [Body(first, tip=True), Body(second, tip=True), Body(first[:1], rigid=True)]
