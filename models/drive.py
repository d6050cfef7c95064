"""A drive: servo loops, belt or gear, dry friction and motor, as far as a user knows them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, Literal, get_args

from quietarm.models.coulomb import dry_friction
from quietarm.models.dimensions import EFFORT, INERTIA, SECOND, WAY, Unit
from quietarm.models.joint_motion import Expression
from quietarm.models.number_checks import not_negative, positive, quoted

HERTZ = Unit.named("Hz")
FeedForward = Literal["acceleration", "speed", "none"]
Recorded = Literal["held", "moving"]
LONGEST_DEAD_TIME = 0.02
"""Largest dead time [s]: with more no servo of a machine is stable."""


def _quantity(unit: Unit, meaning: str) -> Any:
    """Declare a number of the drive, which may be unknown."""
    return field(default=None, metadata={"unit": unit, "meaning": meaning})


@dataclass(frozen=True)
class Drive:
    """The drive of a joint: cascaded position and speed loops, transmission, friction, motor.

    A number that is None is unknown. Forces are those at a linear joint [N]; of a rotary joint
    they are torques [N m], and ways are angles [rad].

    Parameters
    ----------
    position_loop : float, optional
        Gain of the position loop [1/s].
    speed_loop : float, optional
        Bandwidth of the speed loop [Hz].
    reset_time : float, optional
        Reset time of the speed loop's integral [s]. Where it is unknown, `assumed_reset_time`
        is taken.
    compliance : float, optional
        Compliance of belt or gear between motor and load [m/N]; 0 is a rigid one.
    rotor : float, optional
        Part of the plant's inertia that is before belt or gear [kg], as felt at the joint.
    friction_motor, friction_load : float, optional
        Coulomb friction before and after belt or gear [N].
    dead_time : float, optional
        From measuring to the force [s].
    motor_constant : float, optional
        Force over the square root of the copper loss [N/W^0.5].
    feedforward : str
        What the controller takes beside the position: "acceleration" (with the speed), "speed"
        or "none".
    recorded : str, optional
        How the plant's frequencies were recorded: "held", with a brake, with friction that sticks
        or with the joint's motion as an input of the fit, or "moving", on the servo while the axis
        moves. With both loops it has to be stated: their servo shifts a frequency that was recorded
        held.

    Raises
    ------
    ValueError
        When a number is out of range, a word unknown, or `recorded` not stated beside both loops.
    """

    example: ClassVar[str] = "a drive, such as Drive(position_loop=60, speed_loop=40)"

    position_loop: float | None = _quantity(SECOND**-1, "gain of the position loop")
    speed_loop: float | None = _quantity(HERTZ, "bandwidth of the speed loop")
    reset_time: float | None = _quantity(SECOND, "reset time of the speed loop")
    compliance: float | None = _quantity(WAY / EFFORT, "compliance of belt or gear")
    rotor: float | None = _quantity(INERTIA, "inertia before belt or gear")
    friction_motor: float | None = _quantity(EFFORT, "Coulomb friction of the motor side")
    friction_load: float | None = _quantity(EFFORT, "Coulomb friction of the load side")
    dead_time: float | None = _quantity(SECOND, "dead time")
    motor_constant: float | None = _quantity(EFFORT, "motor constant, over the root of the loss")
    feedforward: FeedForward = "acceleration"
    recorded: Recorded | None = None

    def __post_init__(self) -> None:
        for name in NUMBERS:
            value = getattr(self, name)
            if value is None:
                continue
            words = name.replace("_", " ")
            check = not_negative if name in _MAY_BE_ZERO else positive
            object.__setattr__(self, name, check(words, value))
        if (self.dead_time or 0.0) > LONGEST_DEAD_TIME:
            raise ValueError(
                f"dead time is {self.dead_time:g} s; give at most {LONGEST_DEAD_TIME:g} s"
            )
        for name, kind in WORDS.items():
            if name == "recorded" and self.recorded is None:
                continue
            if getattr(self, name) not in get_args(kind):
                raise ValueError(
                    f"{name} is {quoted(getattr(self, name))}; give {' or '.join(get_args(kind))}"
                )

        if self.has_loops and self.recorded is None:
            raise ValueError(
                "the servo shifts frequencies, and how they were recorded is not stated; give "
                "recorded=held (a brake, or --angle in the fit) or recorded=moving (on the servo)"
            )

    @property
    def unknown(self) -> tuple[str, ...]:
        """Names of the numbers that are unknown."""
        return tuple(name for name in NUMBERS if getattr(self, name) is None)

    @property
    def has_loops(self) -> bool:
        """True if both loops are known, so that the servo can be simulated."""
        return self.position_loop is not None and self.speed_loop is not None

    @property
    def assumed_reset_time(self) -> float:
        """Reset time of the speed loop [s]; unknown, eight of the loop's time constants."""
        if self.reset_time is not None:
            return self.reset_time
        assert self.speed_loop is not None
        return 8 / (math.tau * self.speed_loop)

    @property
    def coulomb(self) -> float:
        """Coulomb friction of both sides [N]; what is unknown counts as 0."""
        return (self.friction_motor or 0.0) + (self.friction_load or 0.0)

    def friction(self, speed: Expression) -> Expression:
        """Return the Coulomb friction that the motor overcomes at a speed [N]."""
        return dry_friction(self.coulomb, speed)


NUMBERS = tuple(entry.name for entry in fields(Drive) if entry.metadata)
"""Names of the numbers of a drive."""
WORDS = {"feedforward": FeedForward, "recorded": Recorded}
"""What of a drive is a word, with those that it may be."""
_MAY_BE_ZERO = ("compliance", "rotor", "friction_motor", "friction_load", "dead_time")


def unit_of(name: str, joint: str) -> str:
    """Return the SI unit of a number of the drive for a kind of joint."""
    if name == "motor_constant":
        return f"{EFFORT.of(joint)}/W^0.5"
    (unit,) = (entry.metadata["unit"] for entry in fields(Drive) if entry.name == name)
    return unit.of(joint)
