"""A user's plant in one file: two flexible links of different frequency on one hub.

Not in the package. Equations and identified coefficients (theoretical value times an identified
factor) from docs/physics.md, 'A third plant', the kind of the paper's ref. [25].
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from models import Expression, JointMotion, Plant, parameter


@dataclass(frozen=True)
class TwoLinksOnOneHub(Plant):
    """W_i'' + 2 zeta_i omega_i W_i' + omega_i^2 W_i + a_i theta'' + b_i theta'^2 W_i = 0."""

    name: ClassVar[str] = "two-links-on-one-hub"
    modes: ClassVar[int] = 2

    omega1: float = parameter(12.68 * 0.993, "rad/s", "docs/physics.md")
    zeta1: float = parameter(15.49e-3 * 1.214, "-", "docs/physics.md")
    a1: float = parameter(0.2266 * 0.984, "m", "docs/physics.md")
    b1: float = parameter(2.004e-3 * 1.020, "-", "docs/physics.md")
    omega2: float = parameter(10.71 * 0.993, "rad/s", "docs/physics.md")
    zeta2: float = parameter(14.27e-3 * 1.071, "-", "docs/physics.md")
    a2: float = parameter(0.2570 * 1.003, "m", "docs/physics.md")
    b2: float = parameter(5.822e-3 * 1.006, "-", "docs/physics.md")
    g1: float = parameter(2.996e-2 * 1.016, "kg m^2", "docs/physics.md")
    g2: float = parameter(6.652e-2 * 1.018, "kg m", "docs/physics.md")
    g3: float = parameter(5.237e-2 * 1.052, "kg m", "docs/physics.md")
    c: float = parameter(4.202e-2 * 1.131, "N m s", "docs/physics.md")
    phi: float = parameter(2.7244, "-", "clamped-free mode shape at the tip, docs/physics.md")

    def modal_accelerations(
        self, joint: JointMotion, W: Sequence[Expression], dW: Sequence[Expression]
    ) -> Sequence[Expression]:
        links = (
            (self.omega1, self.zeta1, self.a1, self.b1),
            (self.omega2, self.zeta2, self.a2, self.b2),
        )
        return [
            -2 * zeta * omega * dW[i]
            - omega**2 * W[i]
            - a * joint.acceleration
            - b * joint.speed**2 * W[i]
            for i, (omega, zeta, a, b) in enumerate(links)
        ]

    def torque(
        self,
        joint: JointMotion,
        W: Sequence[Expression],
        dW: Sequence[Expression],
        ddW: Sequence[Expression],
    ) -> Expression:
        inertia = self.g1 * joint.acceleration + self.g2 * ddW[0] + self.g3 * ddW[1]
        return inertia + self.c * joint.speed

    def tip_displacements(self, W: Sequence[Expression]) -> Sequence[Expression]:
        return [self.phi * W[0], self.phi * W[1]]
