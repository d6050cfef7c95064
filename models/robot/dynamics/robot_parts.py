"""The parts of a robot: its URDF, the joints that are driven, and what bends."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from functools import cached_property
from typing import Any, Literal

from quietarm.models.joint_motion import LINEAR, ROTARY
from quietarm.models.notes import Note
from quietarm.models.robot.elastic.beam import Beam
from quietarm.models.robot.elastic.flexibility import Base, Measured, Spring
from quietarm.models.robot.urdf.following import Following, followers_of, held_position
from quietarm.models.robot.urdf.read_urdf import PRISMATIC, Urdf, read_urdf

STANDARD_GRAVITY = 9.80665
"""[m/s^2], of the SI."""
Limits = Mapping[str, Mapping[str, float]]
"""By quantity, as speed, and joint; SI units."""


@dataclass(frozen=True, eq=False, repr=False)
class RobotParts:
    """A robot by its parts; `Robot` says what they are and checks them.

    Robots with equal parts are equal. Remarks are not compared.
    """

    urdf: str
    joints: tuple[str, ...] = ()
    held: Mapping[str, float] = field(default_factory=dict)
    beam: Beam | None = None
    elastic_joints: Mapping[str, Spring] = field(default_factory=dict)
    springs: Mapping[str, Spring] = field(default_factory=dict)
    base: Base | None = None
    tip: str | None = None
    gravity: tuple[float, float, float] = (0.0, 0.0, -STANDARD_GRAVITY)
    rotor_inertia: Mapping[str, float] = field(default_factory=dict)
    friction: Mapping[str, float] = field(default_factory=dict)
    coulomb: Mapping[str, float] = field(default_factory=dict)
    modes: int | Literal["excited"] | None = None
    limits: Limits = field(default_factory=dict)
    measured: Measured | tuple[Measured, ...] | None = None
    positions: Mapping[str, tuple[float, float]] = field(
        default_factory=dict, metadata={"if_stated": True}
    )
    remarks: tuple[Note, ...] = field(default=(), metadata={"if_stated": True})

    @cached_property
    def description(self) -> Urdf:
        """The links and joints of the URDF."""
        return read_urdf(self.urdf)

    @cached_property
    def followers(self) -> dict[str, Following]:
        """The joints that follow others which move, by name."""
        moving = (*self.joints, *self.springs)
        followers = followers_of(self.description, self.held)
        return {name: entry for name, entry in followers.items() if entry.leader in moving}

    def held_position(self, joint: str) -> float:
        """Return the position of a joint that is neither driven nor led [rad or m]."""
        return held_position(self.description, joint, self.held)

    def kind_of(self, joint: str) -> str:
        """Return the kind of a joint of the URDF by its name: rotary, or linear if it slides."""
        return LINEAR if self.description.joints[joint].kind == PRISMATIC else ROTARY

    @property
    def measurements(self) -> tuple[Measured, ...]:
        """The frequencies that were measured, none, one or several."""
        if self.measured is None:
            return ()
        return (self.measured,) if isinstance(self.measured, Measured) else self.measured

    @property
    def stated_payload(self) -> float:
        """Mass at the end of the beam as it was given [kg]."""
        return 0.0 if self.beam is None else self.beam.tip_mass

    @cached_property
    def digest(self) -> str:
        """SHA-256 of all that it is made of."""
        content = asdict(self)
        del content["remarks"]
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()

    @property
    def made_of(self) -> tuple[str]:
        """Parts that say all that it is, for `kept_functions`."""
        return (self.digest,)

    def __hash__(self) -> int:
        return hash(self.digest)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, RobotParts) and self.digest == other.digest

    def __reduce__(self) -> tuple[Any, ...]:  # what is computed from them is not sent along
        return type(self), tuple(getattr(self, entry.name) for entry in fields(self))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.description.name!r}, {self.digest[:12]!r})"
