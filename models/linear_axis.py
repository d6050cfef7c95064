"""A carriage on a belt or screw with a load that swings: gantries, cranes, printers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from quietarm.models.drawing import Body
from quietarm.models.joint_motion import Expression, JointMotion, Modes
from quietarm.models.plant import COUNT, DAMPING, Plant, parameter

_MADE_UP = "made up: a gantry of 8 kg"


@dataclass(frozen=True)
class LinearAxis(Plant):
    """A carriage with a swinging load, in metres and newtons.

    W is how far each mode displaces the load along the axis, as seen from the carriage.
    docs/linear_axis.md has the equations.

    Raises
    ------
    ValueError
        When a mass or a share is out of range, or the number of modes is none.
    """

    name: ClassVar[str] = "linear-axis"
    joint: ClassVar[str] = "linear"

    omega1: float = parameter(75.4, "rad/s", _MADE_UP, "frequency of mode 1, carriage held")
    zeta1: float = parameter(0.02, "-", _MADE_UP, "damping ratio of mode 1", DAMPING)
    share1: float = parameter(
        1.0, "-", _MADE_UP, "swing of the load by mode 1, as a share of a point mass's on a spring"
    )
    omega2: float = parameter(150.0, "rad/s", _MADE_UP, "frequency of mode 2, carriage held")
    zeta2: float = parameter(0.02, "-", _MADE_UP, "damping ratio of mode 2", DAMPING)
    share2: float = parameter(
        0.0, "-", _MADE_UP, "swing of the load by mode 2, as a share of a point mass's on a spring"
    )
    mass: float = parameter(8.0, "kg", _MADE_UP, "of all that moves, the load and the motor's part")
    load: float = parameter(2.0, "kg", _MADE_UP, "of that, what swings")
    friction: float = parameter(5.0, "N s/m", _MADE_UP, "viscous; dry friction by --drive")
    mode_count: float = parameter(1.0, COUNT, _MADE_UP, "how many modes, 1 or 2")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.mode_count not in (1, 2):
            raise ValueError(f"mode_count is {self.mode_count:g}; give 1 or 2")
        if not 0 < self.load < self.mass:
            raise ValueError(
                f"load is {self.load:g} kg of a mass of {self.mass:g} kg; give more than 0 and less"
            )
        shares = (self.share1, self.share2)[: self.modes]
        if min(shares) <= 0 or sum(shares) > 1 + 1e-9:
            raise ValueError(
                f"the modes' shares of the swing are {' and '.join(f'{s:g}' for s in shares)}; "
                "give each more than 0, and 1 or less together"
            )

    @property
    def modes(self) -> int:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Number of modal amplitudes of the axis."""
        return int(self.mode_count)

    @property
    def measured(self) -> dict[str, float]:
        """The parameters that may have relative errors; with one mode, without those of mode 2."""
        unused = () if self.modes == 2 else ("omega2", "zeta2", "share2")
        return {name: v for name, v in super().measured.items() if name not in unused}

    def modal_accelerations(self, joint: JointMotion, W: Modes, dW: Modes) -> Modes:
        """Accelerations of the load by each mode, seen from the carriage [m/s^2]."""
        modes = (
            (self.omega1, self.zeta1, self.share1),
            (self.omega2, self.zeta2, self.share2),
        )[: self.modes]
        return [
            -2 * zeta * omega * dW[i] - omega**2 * W[i] - share * joint.acceleration
            for i, (omega, zeta, share) in enumerate(modes)
        ]

    def torque(self, joint: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Expression:
        """Force of the drive [N]: what accelerates carriage and load, and friction."""
        swinging = self.load * sum(ddW[1:], ddW[0])
        return self.mass * joint.acceleration + swinging + self.friction * joint.speed

    def tip_displacements(self, W: Modes) -> Sequence[Expression]:
        """Displacement of the load [m]."""
        return [sum(W[1:], W[0])]

    @property
    def tip_reach(self) -> float:
        """The load goes as far as the carriage."""
        return 1.0

    def structure(self, angle: float, tips: Sequence[float]) -> Sequence[Body]:
        """The load below its carriage, along the axis."""
        carriage = np.array([[angle - 0.05, 0.0], [angle + 0.05, 0.0]])
        # At which the load is drawn below the carriage [m].
        length = 0.3
        return [
            Body(carriage, rigid=True),
            Body(np.array([[angle, 0.0], [angle + tips[0], -length]]), tip=True),
        ]
