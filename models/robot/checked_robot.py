"""Checks of a robot's parts, and their defaults."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

from quietarm.interrupts import interruptible
from quietarm.models import dimensions
from quietarm.models.joint_motion import ROTARY
from quietarm.models.number_checks import (
    finite,
    has_no,
    not_negative,
    positive,
    quoted,
    whole,
)
from quietarm.models.robot.dynamics.equations_of_motion import Dynamics
from quietarm.models.robot.dynamics.mechanism import BEAM_END, GROUND
from quietarm.models.robot.dynamics.moving_robot import MovingRobot
from quietarm.models.robot.elastic.beam import Beam
from quietarm.models.robot.elastic.flexibility import Base, Measured, Spring
from quietarm.models.robot.on_path.path_tables import (
    EXCITED,
    MOST_MODES,
)
from quietarm.models.robot.robot_notes import notes_of_text
from quietarm.models.robot.text_files import read_text
from quietarm.models.robot.urdf.following import (
    driven_joints,
    mimics_nothing,
)
from quietarm.models.robot.urdf.urdf_text import dynamics_of

_MOST_MOVING = 100
"""Joints, whose equations are written in two seconds."""
_SAME = 1e-3
"""Positions of one posture differ by less [rad or m]."""
_MOST_TURNS = 4
"""Of a joint without ends, beyond which its position is in degrees, most likely."""
_TIMES_ITS_END = 10.0
"""So far beyond its range is a joint that slides in millimetres, most likely."""
_USUAL_MODES = 2
"""That are followed where the file does not say how many."""


_LIMITS_WANTED = "limits by quantity and joint, such as {'speed': {'elbow_joint': 3.0}}"
_BY_JOINT = "by joint, such as {'elbow_joint': 0.5}"
_KINDS: Mapping[str, tuple[type[Any], str]] = {
    "joints": (Sequence, "a list of names, such as ['shoulder_joint', 'elbow_joint']"),
    "held": (Mapping, f"positions {_BY_JOINT}"),
    "beam": (Beam, "qa.models.Beam(at='tool0', length=0.8, ...)"),
    "elastic_joints": (Mapping, "springs by joint, such as {'elbow_joint': Spring(8000.0)}"),
    "springs": (Mapping, "springs by joint, such as {'finger_joint': Spring(80.0)}"),
    "base": (Base, "qa.models.Base(stiffness=(2e5, 2e5))"),
    "tip": (str, "the name of a link, such as 'tool0'"),
    "rotor_inertia": (Mapping, f"inertias {_BY_JOINT}"),
    "friction": (Mapping, f"friction {_BY_JOINT}"),
    "coulomb": (Mapping, f"friction {_BY_JOINT}"),
    "limits": (Mapping, _LIMITS_WANTED),
    "positions": (Mapping, "ranges by joint, such as {'elbow_joint': (-1.0, 1.0)}"),
    "remarks": (Sequence, "a list of notes"),
}
"""By an argument: its type, and what is given of it."""
_MAY_BE_NONE = ("beam", "base", "tip")


@dataclass(frozen=True, eq=False, repr=False)
class CheckedRobot(MovingRobot):
    """A robot whose parts fit its URDF: names, values and ranges; defaults are filled in."""

    @interruptible
    def __post_init__(self) -> None:
        self._check_kinds()
        text = _text_of(self.urdf)
        self._set("urdf", dynamics_of(text))
        self._set("remarks", (*notes_of_text(text), *self.remarks))
        self._set("springs", self._springs("springs", self.springs))
        self._set("elastic_joints", self._springs("elastic_joints", self.elastic_joints))
        self._set("held", self._numbers("held", self.held, finite))
        self._set("joints", self._driven())
        for name, position in self.held.items():
            self._check_unit("held", name, position)
        self._check_names()
        self._set("rotor_inertia", self._numbers("rotor_inertia", self.rotor_inertia, not_negative))
        self._set("friction", self._rubbing("friction", "damping"))
        self._set("coulomb", self._rubbing("coulomb", "friction"))
        self._set("gravity", _vector("gravity", self.gravity))
        self._set("positions", self._ranges_given())
        self._check_limits()
        if self.modes is not None and self.modes != EXCITED:
            self._set("modes", _number_of_modes(self.modes))
            if self.beam is not None:
                self._set("beam", self.beam.for_modes(self.modes))
        self._set("tip", self._tip())
        self._check_base()
        self._check_measured()
        self._check_inertias()
        _ = self.dynamics
        self._check_modes()

    def _check_kinds(self) -> None:
        """Refuse arguments of a wrong type before their parts are looked at."""
        for name, (kind, wanted) in _KINDS.items():
            value = getattr(self, name)
            if value is None and name in _MAY_BE_NONE:
                continue
            if not isinstance(value, kind) or (kind is Sequence and isinstance(value, str)):
                raise TypeError(f"{name} is {quoted(value)}; give {wanted}")
        for name in self.joints:
            if not isinstance(name, str):
                raise TypeError(f"joints has {quoted(name)}; give {_KINDS['joints'][1]}")

    def _check_limits(self) -> None:
        """Refuse limits that are not by quantity, and then by driven joint."""
        for quantity, limits in self.limits.items():
            if quantity in self.description.joints:
                raise ValueError(
                    f"limits has joint {quoted(quantity)} where a quantity belongs; give them as "
                    f"{{'speed': {{{quoted(quantity)}: 3.0}}}}"
                )
            if not isinstance(limits, Mapping):  # one for all, such as of the tip's displacement
                _check_sides(f"limit of {quantity}", limits)
                continue
            for name, size in limits.items():
                if name not in self.joints:
                    entry = f"driven joint, for limits of {quantity},"
                    raise ValueError(has_no("the robot", entry, name, self.joints))
                _check_sides(f"limit of {quantity} of {name}", size)

    def _check_modes(self) -> None:
        """Check that modes are no more than the springs; by default they are two, or one."""
        sprung = len(self.unscaled.sprung)
        if not sprung:
            raise ValueError(
                "the robot has nothing that bends; give a beam, elastic_joints, springs or a base"
            )
        if self.modes is None:
            self._set("modes", min(_USUAL_MODES, sprung))
        elif self.modes != EXCITED and self.modes > sprung:
            springs = "1 spring" if sprung == 1 else f"{sprung} springs"
            raise ValueError(f"modes is {self.modes}; the robot has {springs}, give at most that")

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def check_posture(self, what: str, posture: Sequence[float]) -> None:
        """Refuse a posture of the driven joints of which one is in degrees, or in millimetres.

        A little beyond the range of a joint is none of these: encoders are not those of the URDF.
        """
        for name, position in zip(self.joints, posture):
            self._check_unit(what, name, float(position))

    def _check_unit(self, what: str, joint: str, position: float) -> None:
        """Refuse a position beyond the URDF's range of a joint that is in another unit."""
        entry = self.description.joints[joint]
        words = self.unit_words(joint, position)
        if not words or (entry.lower <= position <= entry.upper and not entry.endless):
            return
        if entry.endless and abs(position) <= _MOST_TURNS * math.tau:
            return
        ends = f"its range is {entry.lower:g} to {entry.upper:g}"
        if entry.endless:
            ends = f"that is over {_MOST_TURNS} turns"
        unit = "deg" if self.kind_of(joint) == ROTARY else "mm"
        raise ValueError(
            f"{what} has joint {quoted(joint)} at {position:.5g}; {ends}{words} give "
            f"{position:.5g}{unit}"
        )

    def unit_words(self, joint: str, position: float) -> str:
        """Ask whether degrees were meant beyond a turn, or millimetres far beyond a range."""
        if self.kind_of(joint) == ROTARY:
            is_far = abs(position) > math.tau
            return "; positions are in rad, were degrees meant?" if is_far else ""
        entry = self.description.joints[joint]
        farthest = max(abs(entry.lower), abs(entry.upper))
        is_far = abs(position) > _TIMES_ITS_END * farthest
        return "; positions are in m, were millimetres meant?" if is_far else ""

    def _springs(self, entry: str, springs: Mapping[str, Any]) -> dict[str, Spring]:
        found = dict[str, Spring]()
        for name, spring in springs.items():
            self._check_joint(entry, name)
            what = f"of {name} in {entry}"
            values = spring if isinstance(spring, Spring) else Spring(*_two_of(spring, what))
            stiffness, damping = (
                unit.of(self.kind_of(name)) for unit in (dimensions.STIFFNESS, dimensions.DAMPING)
            )
            found[name] = Spring(
                positive(f"stiffness {what}", values.stiffness, stiffness),
                not_negative(f"damping {what}", values.damping, damping),
            )
        return found

    def _numbers(self, entry: str, values: Mapping[str, Any], check: Any) -> dict[str, float]:
        for name in values:
            self._check_joint(entry, name)
        return {name: check(f"{entry} of {name}", value) for name, value in values.items()}

    def _rubbing(self, entry: str, of_urdf: str) -> dict[str, float]:
        """Friction as given, and the URDF's of all other joints that motors move."""
        given = self._numbers(entry, getattr(self, entry), not_negative)
        sizes = {
            name: getattr(self.description.joints[name], of_urdf)
            for name in self._moved_by_motors()
        }
        return {name: size for name, size in sizes.items() if size > 0} | given

    def _moved_by_motors(self) -> list[str]:
        """The driven joints, and those that follow them."""
        followers = [name for name, led in self.followers.items() if led.leader in self.joints]
        return [*self.joints, *followers]

    def _ranges_given(self) -> dict[str, tuple[float, float]]:
        """Ranges of driven joints within the URDF's; ValueError where one is none."""
        ranges = dict[str, tuple[float, float]]()
        for name, ends in self.positions.items():
            if name not in self.joints:
                raise ValueError(
                    has_no("the robot", "driven joint, for positions,", name, self.joints)
                )
            joint = self.description.joints[name]
            try:
                lower, upper = (float(end) for end in ends)
            except (TypeError, ValueError):
                raise ValueError(
                    f"positions of {name} are {quoted(ends)}; give the least and the largest"
                ) from None
            if not joint.lower <= lower < upper <= joint.upper:
                raise ValueError(
                    f"positions of {name} are {lower:g} to {upper:g}; give a range within the "
                    f"URDF's, {joint.lower:g} to {joint.upper:g}"
                )
            ranges[name] = (lower, upper)
        return ranges

    def _check_joint(self, entry: str, name: str) -> None:
        if name not in self.description.moving:
            raise ValueError(
                has_no("the robot", f"moving joint, for {entry},", name, self.description.moving)
            )

    def _driven(self) -> tuple[str, ...]:
        """The driven joints; those that mimic others follow them."""
        joints = self.description.joints
        names = driven_joints(self.description, self.joints, {*self.springs, *self.held})
        for name in (*names, *self.springs):
            self._check_joint("joints", name)
            mimic = joints[name].mimics
            if mimic is not None:
                entry = "joints" if name in names else "springs"
                raise ValueError(
                    f"joint {quoted(name)} of the URDF mimics {quoted(mimic.joint)} and follows "
                    f"it; leave it out of {entry}, or <mimic> out of the URDF"
                )
        if not names:
            raise ValueError("no joint of the robot is driven; name those that are, as joints")
        if len(names) + len(self.springs) > _MOST_MOVING:
            raise ValueError(
                f"the robot has {len(names) + len(self.springs)} joints that move; give at most "
                f"{_MOST_MOVING}, others as fixed ones or in held"
            )
        return names

    def _check_names(self) -> None:
        driven = self.joints
        for name in {name for name in driven if driven.count(name) > 1}:
            raise ValueError(f"joint {quoted(name)} is driven twice; name it once in joints")
        for entry, names in (("held", self.held), ("springs", self.springs)):
            for name in names:
                if name in driven:
                    raise ValueError(
                        f"joint {quoted(name)} is driven and in {entry}; leave one of them out"
                    )
        for name in self.springs:
            if name in self.held:
                raise ValueError(
                    f"joint {quoted(name)} is held and in springs; leave one of them out"
                )
        for entry in ("elastic_joints", "rotor_inertia", "friction", "coulomb"):
            for name in getattr(self, entry):
                if name in self._moved_by_motors():
                    continue
                if why := mimics_nothing(self.description, name):
                    raise ValueError(
                        f"joint {quoted(name)}, which has an entry in {entry}, {why}, which the "
                        "URDF does not have; mend its mimic element"
                    )
                raise ValueError(has_no("the robot", f"driven joint, for {entry},", name, driven))
        if self.beam is not None and self.beam.at not in self.description.links:
            raise ValueError(
                has_no("the robot", "link, for the beam,", self.beam.at, self.description.links)
            )

    def _tip(self) -> str:
        links = self.description.links
        if self.tip is None:
            return BEAM_END if self.beam is not None else list(links)[-1]
        if self.tip != BEAM_END and self.tip not in links:
            raise ValueError(has_no("the robot", "link, for the tip,", self.tip, links))
        if self.tip == BEAM_END and self.beam is None:
            raise ValueError(f"tip is {BEAM_END!r}, and there is no beam; name a link")
        return self.tip

    def _check_base(self) -> None:
        if self.base is None:
            return
        given = _about_axes("stiffness", self.base.stiffness, 2)
        stiffness = tuple(positive("stiffness of the base", x, "N m/rad") for x in given)
        damps = self.base.damping if np.any(self.base.damping) else 0.0
        given = _about_axes("damping", damps, len(stiffness))
        if len(given) != len(stiffness):
            raise ValueError(
                f"damping of the base has {len(given)} numbers and its stiffness {len(stiffness)}; "
                "give one of each axis"
            )
        damping = tuple(not_negative("damping of the base", x, "N m s/rad") for x in given)
        height = not_negative("height of the base", self.base.height, "m")
        self._set("base", Base(stiffness, damping, height))

    def _check_measured(self) -> None:
        if self.measured is None:
            return
        if isinstance(self.measured, Measured):
            self._set("measured", self._measurement(self.measured, "measured"))
            return
        if not isinstance(self.measured, Sequence):
            raise TypeError(f"measured is {quoted(self.measured)}; give Measured(frequency, at)")
        if not self.measured:
            raise ValueError("measured is an empty list; give frequencies, or leave it out")
        checked = [
            self._measurement(one, f"{number} of measured")
            for number, one in enumerate(self.measured, 1)
        ]
        _refuse_contradictions(checked)
        self._set("measured", tuple(checked))

    def _measurement(self, one: Measured, what: str) -> Measured:
        """A measured frequency whose numbers are in range, at positions of all joints."""
        if not isinstance(one, Measured):
            raise TypeError(f"{what} is {quoted(one)}; give Measured(frequency, at)")
        frequency = positive(f"{what} frequency", one.frequency, "rad/s")
        if isinstance(one.at, str) or not isinstance(one.at, Iterable):
            raise TypeError(f"at of {what} is {quoted(one.at)}; give a position of each joint")
        at = tuple(finite(f"a position of {what}", x, "rad") for x in one.at)
        if len(at) != len(self.joints):
            raise ValueError(
                f"{what} has {len(at)} positions and the robot {len(self.joints)} joints; give "
                "one of each"
            )
        self.check_posture(what, at)
        count = len(self.unscaled.sprung)
        mode = whole(f"mode of {what}", one.mode, 1, max(count, 1))
        damping = one.damping
        if damping is not None:
            damping = positive(f"damping of {what}", damping)
            if damping >= 1:
                raise ValueError(
                    f"damping of {what} is {100 * damping:g} %; give a ratio below 1, as 0.5%"
                )
        within = positive(f"within of {what}", one.within)
        if within >= 1:
            raise ValueError(f"within of {what} is {100 * within:g} %; give a share, as 0.5%")
        return Measured(frequency, at, mode, damping, within)

    def _check_inertias(self) -> None:
        """Every driven joint and every spring moves a mass."""
        mechanism = self.unscaled
        links = self.description.links
        for name, (number, _) in mechanism.links.items():
            faulty = name in links and links[name].turns_backwards
            if faulty and number != GROUND and mechanism.bodies[number].inertia.turns_backwards:
                raise ValueError(
                    f"link {quoted(name)} of the URDF has {links[name].fault}; give what a body "
                    "can have"
                )
        dynamics = Dynamics(mechanism)
        x = np.random.default_rng(0).uniform(0.3, 1.0, dynamics.size)
        masses = dynamics.masses(x)
        names = [*self.joints, *mechanism.spring_names]
        scale = max(1e-12, float(np.abs(masses).max()))
        for name, inertia in zip(names, np.diag(masses)):
            if inertia <= 1e-12 * scale:
                raise ValueError(
                    f"joint {quoted(name)} moves no mass; give the links beyond it an <inertial> "
                    "in the URDF"
                )


def _refuse_contradictions(measured: Sequence[Measured]) -> None:
    """Refuse two frequencies of one mode at one posture that differ by more than both may."""
    for later, two in enumerate(measured):
        for one in measured[:later]:
            apart = abs(math.log(two.frequency / one.frequency))
            same = one.mode == two.mode and np.allclose(one.at, two.at, rtol=0.0, atol=_SAME)
            if same and apart > one.within + two.within:
                raise ValueError(
                    f"measured has mode {one.mode} at one posture with "
                    f"{one.frequency / math.tau:.5g} Hz and with {two.frequency / math.tau:.5g} "
                    "Hz; leave out the one that is wrong, or state how exact they are, as "
                    "within: 2%"
                )


def _text_of(urdf: object) -> str:
    """The text of a URDF that is given, or of its file."""
    text = read_text(urdf, "URDF") if isinstance(urdf, Path) else urdf
    if not isinstance(text, str):
        raise TypeError(f"urdf is {quoted(text)}; give the text of a URDF, or a file as a Path")
    if "<" not in text:
        raise ValueError(
            "urdf is no text of a URDF, which begins with <robot>; give that, or its file as a "
            "pathlib.Path"
        )
    return text


def _check_sides(what: str, size: Any) -> None:
    """Refuse what is no number, or a pair of them; a task checks their signs."""
    several = isinstance(size, Iterable) and not isinstance(size, str)
    for side in size if several else (size,):
        finite(what, side)


def _number_of_modes(modes: object) -> int:
    if isinstance(modes, str):
        raise ValueError(
            f"modes is {quoted(modes)}; give a whole number, or {EXCITED} for those that the path "
            "excites"
        )
    return whole("modes", modes, 1, MOST_MODES)


def _vector(name: str, value: Any) -> tuple[float, float, float]:
    if not isinstance(value, Iterable) or isinstance(value, str):
        raise TypeError(f"{name} is {quoted(value)}; give three numbers, such as 0, 0, -9.81")
    entries = [finite(name, entry, "m/s^2") for entry in value]
    if len(entries) != 3:
        raise ValueError(f"{name} has {len(entries)} numbers; give three, such as 0, 0, -9.81")
    return (entries[0], entries[1], entries[2])


def _about_axes(name: str, value: Any, count: int) -> tuple[Any, ...]:
    """Return two numbers about x and y, or three; one number counts for as many axes as asked."""
    if isinstance(value, str) or not isinstance(value, Iterable | Real):
        raise TypeError(f"{name} of the base is {quoted(value)}; give one number, or two")
    entries = (value,) * count if isinstance(value, Real) else tuple(value)
    if len(entries) not in (2, 3):
        raise ValueError(
            f"{name} of the base has {len(entries)} numbers; give one, or two, about x and about "
            "y, or three, about z as well"
        )
    return entries


def _two_of(spring: Any, what: str) -> tuple[Any, ...]:
    """Stiffness and damping of a number, a pair or a mapping."""
    if isinstance(spring, Mapping):
        names = [entry.name for entry in fields(Spring)]
        for name in spring:
            if name not in names:
                raise ValueError(has_no("a spring", "entry", name, names))
        return tuple(spring.get(name, 0.0) for name in names)
    if isinstance(spring, Real):
        return (spring,)
    if isinstance(spring, str) or not isinstance(spring, Sequence) or len(spring) not in (1, 2):
        raise TypeError(
            f"spring {what} is {quoted(spring)}; give qa.models.Spring(stiffness, damping), or the "
            "stiffness alone"
        )
    return tuple(spring)
