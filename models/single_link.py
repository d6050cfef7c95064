"""The single-link flexible manipulator of the paper, section 3.1."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from quietarm.models.drawing import Body, flexible_link
from quietarm.models.joint_motion import Expression, JointMotion, Modes
from quietarm.models.plant import DAMPING, TIP, Plant, parameter

_LENGTH = 0.475
"""Of the plate [m], section 3.1."""


def _printed(value: float, unit: str, meaning: str, kind: str | None = None) -> Any:
    return parameter(value, unit, "eq (10)", meaning, kind)


@dataclass(frozen=True)
class SingleLinkManipulator(Plant):
    """A flexible plate with a tip mass on a rigid hub, eqs (8) and (9); defaults from eq (10)."""

    name: ClassVar[str] = "single-link"
    modes: ClassVar[int] = 1
    small_deflection: ClassVar[float | None] = 0.1 * _LENGTH
    """A tenth of the plate's length, where the linear stiffness of a cantilever is 1 %
    off (Bisshopp and Drucker, Quart. Appl. Math. 3, 1945)."""

    alpha1: float = _printed(2.383e-2, "kg m^2", "inertia of hub and rigid link together")
    alpha2: float = _printed(9.261e-2, "kg m", "torque by the mode's acceleration")
    c: float = _printed(3.091e-2, "N m s", "viscous friction of the joint")
    beta1: float = _printed(2.555e-1, "m", "push on the mode by the joint's acceleration")
    beta2: float = _printed(2.614e-1, "-", "stiffening by the joint's speed squared")
    zeta: float = _printed(9.636e-3, "-", "damping ratio of the mode", DAMPING)
    omega: float = _printed(10.43, "rad/s", "frequency of the mode, hub held")
    phi: float = parameter(
        2.28, "-", "not printed: by the cycloid's residual of 'about 7.7 cm', docs/physics.md", TIP
    )

    def modal_accelerations(self, joint: JointMotion, W: Modes, dW: Modes) -> Modes:
        """W'' from eq (9) [m/s^2]."""
        (w,) = W
        (dw,) = dW
        stiffness = self.omega**2 + self.beta2 * joint.speed**2
        damping = 2 * self.zeta * self.omega
        return [-damping * dw - stiffness * w - self.beta1 * joint.acceleration]

    def torque(self, joint: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Expression:
        """Joint torque from eq (8) [N m]."""
        return self.alpha1 * joint.acceleration + self.alpha2 * ddW[0] + self.c * joint.speed

    def tip_displacements(self, W: Modes) -> Sequence[Expression]:
        """w(t, l) = phi W [m]."""
        return [self.phi * w for w in W]

    @property
    def tip_reach(self) -> float:
        """The plate's length; it begins on the axis, since the hub's radius is not printed."""
        return _LENGTH

    def structure(self, angle: float, tips: Sequence[float]) -> Sequence[Body]:
        """The plate on its hub; it begins on the axis, since the hub's radius is not printed."""
        plate = flexible_link(_LENGTH, angle, tips[0])
        return [Body(plate, tip=True), Body(plate[:1], rigid=True)]
