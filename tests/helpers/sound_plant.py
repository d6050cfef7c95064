"""A plant that keeps the contract, for tests to break."""

from dataclasses import dataclass
from typing import ClassVar

from quietarm.models import Plant, parameter


@dataclass(frozen=True)
class Sound(Plant):
    """A mode that the joint's acceleration excites."""

    name: ClassVar[str] = "sound-probe"
    modes: ClassVar[int] = 1
    omega: float = parameter(10.0, "rad/s", "a round number")

    def modal_accelerations(self, joint, W, dW):
        return [-(self.omega**2) * W[0] - joint.acceleration]

    def torque(self, joint, W, dW, ddW):
        return 2 * joint.acceleration + ddW[0]

    def tip_displacements(self, W):
        return [W[0]]
