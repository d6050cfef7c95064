"""A robot as its URDF has it: links with their masses, and the joints between them.

What quietarm does not follow is refused: loops, joints of several degrees of freedom, entities.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from quietarm.models.joint_motion import Array
from quietarm.models.number_checks import listed, quoted
from quietarm.models.robot.frames import Frame, rotation_of, rotation_of_quaternion
from quietarm.models.robot.urdf.urdf_text import parse

REVOLUTE = "revolute"
PRISMATIC = "prismatic"
FIXED = "fixed"
_KINDS = {
    "revolute": REVOLUTE, "continuous": REVOLUTE, "prismatic": PRISMATIC, "fixed": FIXED,
}  # fmt: skip
_LARGEST = 1e9
"""Of a mass, a moment or a place, in SI units: squares and products stay numbers."""
_LONG = 20.0
"""From one joint to the next [m]: longer links are those of a URDF in millimetres."""
_ROUNDED = 1e-9
"""Share by which a moment of inertia may be below 0 for rounding."""
_NO_MOMENT = 1e-12
"""Moment of inertia [kg m^2] that rounding may leave or take."""
_UNEVEN = 0.01
"""Share by which a moment of inertia may be above the sum of the two others: URDFs have few digits
of a plate's."""


@dataclass(frozen=True, eq=False)
class Inertia:
    """Mass [kg], its centre in the frame of the body [m], moments about the centre [kg m^2]."""

    mass: float = 0.0
    centre: Array = field(default_factory=lambda: np.zeros(3))
    moments: Array = field(default_factory=lambda: np.zeros((3, 3)))

    def seen_from(self, frame: Frame) -> Inertia:
        """Return this inertia in a frame in which the body's frame stands."""
        turned = frame.rotation @ self.moments @ frame.rotation.T
        return Inertia(self.mass, frame.point(self.centre), turned)

    def __add__(self, other: Inertia) -> Inertia:
        mass = self.mass + other.mass
        if mass == 0:
            return Inertia(0.0, self.centre, self.moments + other.moments)
        centre = (self.mass * self.centre + other.mass * other.centre) / mass
        moments = self.about(centre) + other.about(centre)
        return Inertia(mass, centre, moments)

    def about(self, point: Array) -> Array:
        """Moments about another point [kg m^2]."""
        arm = self.centre - point
        return self.moments + self.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))

    @property
    def principal(self) -> Array:
        """Principal moments about the centre of mass, from the least [kg m^2]."""
        return np.asarray(np.linalg.eigvalsh(self.moments), float)

    @property
    def turns_backwards(self) -> bool:
        """Return whether a moment is negative: a torque would turn the body backwards."""
        least, _, most = self.principal
        return least < -_ROUNDED * max(1.0, most)

    @property
    def fault(self) -> str:
        """Reason why no body has such an inertia; an empty text where one may."""
        least, middle, most = self.principal
        if least < -max(_ROUNDED * most, _NO_MOMENT):
            return f"a moment of inertia of {least:.3g} kg m^2, below 0"
        others = max(least + middle, 0.0)
        if most > (1 + _UNEVEN) * others + _NO_MOMENT:
            return (
                f"a moment of inertia of {most:.3g} kg m^2, above the sum of the two others, "
                f"{round(others, 15):.3g}"
            )
        return ""


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another: its position is multiplier times that one's, plus offset."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True, eq=False)
class UrdfJoint:
    """A joint: which links it joins, where it stands in the parent's frame, what it allows.

    Positions are in rad or m, the effort in N m or N, the velocity in rad/s or m/s, and so on;
    infinite, or 0 for all but the positions, where the URDF has none. Damping is viscous
    [N m s/rad or N s/m], friction Coulomb's [N m or N].
    """

    name: str
    kind: str
    parent: str
    child: str
    frame: Frame
    axis: Array
    lower: float = -math.inf
    upper: float = math.inf
    effort: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0
    deceleration: float = 0.0
    jerk: float = 0.0
    damping: float = 0.0
    friction: float = 0.0
    mimics: Mimic | None = None
    continuous: bool = False

    @property
    def endless(self) -> bool:
        """Return whether the joint has no range."""
        return self.lower == -math.inf and self.upper == math.inf


@dataclass(frozen=True, eq=False)
class Urdf:
    """Links and joints by name, from the root outwards."""

    name: str
    links: Mapping[str, Inertia]
    joints: Mapping[str, UrdfJoint]
    root: str

    @property
    def moving(self) -> tuple[str, ...]:
        """Names of the joints that can move, in the order of the file."""
        return tuple(name for name, joint in self.joints.items() if joint.kind != FIXED)

    @property
    def hint_of_size(self) -> str:
        """A question where links are as long as their millimetres; else an empty text."""
        lengths = {
            joint.child: np.linalg.norm(joint.frame.origin) for joint in self.joints.values()
        }
        longest = max(lengths.values(), default=0.0)
        return f"links are {longest:.4g} m long; are origins in mm?" if longest > _LONG else ""

    def outwards(self) -> Iterator[UrdfJoint]:
        """Every joint after that of its parent."""
        by_parent = dict[str, list[UrdfJoint]]()
        for joint in self.joints.values():
            by_parent.setdefault(joint.parent, []).append(joint)
        waiting = [self.root]
        while waiting:
            for joint in by_parent.get(waiting.pop(0), []):
                yield joint
                waiting.append(joint.child)


@lru_cache(maxsize=32)
def read_urdf(text: str) -> Urdf:
    """Read a URDF.

    Raises
    ------
    ValueError
        When it is no URDF, has XML entities, or what quietarm cannot follow.
    """
    root = parse(text)
    links = {_name(element): _inertia(element) for element in root.findall("link")}
    if not links:
        raise ValueError("the URDF has no links; give one of a robot, with its links' inertias")
    joints = {_name(element): _joint(element) for element in root.findall("joint")}
    for joint in joints.values():
        for link in (joint.parent, joint.child):
            if link not in links:
                raise ValueError(
                    f"joint {quoted(joint.name)} of the URDF joins {quoted(link)}, which is no "
                    "link of it; add the link, or mend its name"
                )
        _check_mimic(joint, joints)
    children = Counter(joint.child for joint in joints.values())
    for child, count in children.items():
        if count > 1:
            raise ValueError(
                f"link {quoted(child)} of the URDF hangs on {count} joints, a closed loop; give a "
                "tree, with the loop cut open"
            )
    roots = [link for link in links if link not in children]
    if len(roots) != 1:
        number = f"{len(roots)} roots ({listed(roots)})" if roots else "no root, a closed loop"
        raise ValueError(f"the URDF has {number}; give one tree, joined by fixed joints")
    urdf = Urdf(root.get("name") or "robot", links, joints, roots[0])
    if len(list(urdf.outwards())) != len(joints):
        raise ValueError("the URDF has a closed loop beside its tree; give a tree alone")
    return urdf


def _check_mimic(joint: UrdfJoint, joints: Mapping[str, UrdfJoint]) -> None:
    """Refuse a joint that follows itself in the end."""
    chain = [joint.name]
    while (mimic := joints[chain[-1]].mimics) is not None:
        if mimic.joint not in joints:
            return  # which is held, with a note
        chain.append(mimic.joint)
        if mimic.joint in chain[:-1]:
            raise ValueError(
                f"joints of the URDF mimic each other in a circle, {' and '.join(chain)}; let one "
                "of them move by itself"
            )


def _name(element: ElementTree.Element) -> str:
    name = element.get("name")
    if not name:
        raise ValueError(f"a <{element.tag}> of the URDF has no name; give it one")
    return name


def _inertia(link: ElementTree.Element) -> Inertia:
    """Read the inertia of a link in its frame; zero if it has no <inertial>."""
    inertial = link.find("inertial")
    if inertial is None:
        return Inertia()
    what = f"link {quoted(_name(link))} of the URDF"
    frame = _origin(inertial, what)
    mass = _number(inertial.find("mass"), "value", f"mass of {what}", None, _LARGEST)
    entries = {
        entry: _number(inertial.find("inertia"), entry, f"{entry} of {what}", 0.0, _LARGEST)
        for entry in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    }
    moments = np.array([
        [entries["ixx"], entries["ixy"], entries["ixz"]],
        [entries["ixy"], entries["iyy"], entries["iyz"]],
        [entries["ixz"], entries["iyz"], entries["izz"]],
    ])  # fmt: skip
    if mass < 0:
        raise ValueError(f"{what} has a mass of {mass:g} kg; give what a body can have")
    return Inertia(mass, np.zeros(3), moments).seen_from(frame)


def _joint(element: ElementTree.Element) -> UrdfJoint:
    name = _name(element)
    what = f"joint {quoted(name)} of the URDF"
    kind = element.get("type") or ""
    if kind not in _KINDS:
        raise ValueError(
            f"{what} is {quoted(kind)}; give revolute, continuous, prismatic or fixed joints "
            "alone, as a fixed one to the ground"
        )
    parent = _link(element, "parent", what)
    child = _link(element, "child", what)
    frame = _origin(element, what)
    if kind == FIXED:
        return UrdfJoint(name, FIXED, parent, child, frame, axis=np.array([1.0, 0.0, 0.0]))
    axis = _numbers(element.find("axis"), "xyz", f"axis of {what}", "1 0 0")
    length = float(np.linalg.norm(axis))
    if length == 0:
        raise ValueError(f"axis of {what} is 0 0 0; give a direction, such as 0 0 1")
    lower, upper = _range(element.find("limit"), what) if kind != "continuous" else _UNLIMITED
    mimic = element.find("mimic")
    deceleration = f"deceleration of {what}"
    return UrdfJoint(
        name=name,
        kind=_KINDS[kind],
        parent=parent,
        child=child,
        frame=frame,
        axis=axis / length,
        lower=lower,
        upper=upper,
        effort=_size(element, "limit", "effort", what),
        velocity=_size(element, "limit", "velocity", what),
        acceleration=_size(element, "limit", "acceleration", what),
        deceleration=abs(_number(element.find("limit"), "deceleration", deceleration, 0.0)),
        jerk=_size(element, "limit", "jerk", what),
        damping=_size(element, "dynamics", "damping", what),
        friction=_size(element, "dynamics", "friction", what),
        mimics=None if mimic is None else _mimic(mimic, what),
        continuous=kind == "continuous",
    )


_UNLIMITED = (-math.inf, math.inf)


def _range(limit: ElementTree.Element | None, what: str) -> tuple[float, float]:
    """Least and largest position; 0 where only the other is given, and none without both."""
    if limit is None or not {"lower", "upper"} & set(limit.attrib):
        return _UNLIMITED
    lower, upper = (
        _number(limit, end, f"{end} limit of {what}", 0.0) for end in ("lower", "upper")
    )
    if lower > upper:
        raise ValueError(
            f"limit of {what}: lower {lower:g} is above upper {upper:g}; swap or mend them"
        )
    return lower, upper


def _size(joint: ElementTree.Element, tag: str, entry: str, what: str) -> float:
    """A number of 0 or more; 0 where the URDF has none."""
    size = _number(joint.find(tag), entry, f"{entry} of {what}", 0.0)
    if size < 0:
        raise ValueError(f"{entry} of {what} is {size:g}; give 0 or more")
    return size


def _mimic(element: ElementTree.Element, what: str) -> Mimic:
    leader = element.get("joint")
    if not leader:
        raise ValueError(f"{what} mimics no joint; name one, such as <mimic joint='...'/>")
    multiplier = _number(element, "multiplier", f"multiplier of {what}", 1.0, _LARGEST)
    offset = _number(element, "offset", f"offset of {what}", 0.0, _LARGEST)
    return Mimic(leader, multiplier, offset)


def _link(joint: ElementTree.Element, end: str, what: str) -> str:
    element = joint.find(end)
    link = None if element is None else element.get("link")
    if not link:
        raise ValueError(f"{what} has no {end} link; give it one")
    return link


def _origin(element: ElementTree.Element, what: str) -> Frame:
    origin = element.find("origin")
    place = _numbers(origin, "xyz", f"origin of {what}", "0 0 0")
    if origin is not None and "quat_xyzw" in origin.attrib:
        if "rpy" in origin.attrib:
            raise ValueError(f"origin of {what} has rpy and quat_xyzw; give one of them")
        quaternion = _numbers(origin, "quat_xyzw", f"quat_xyzw of {what}", "0 0 0 1", count=4)
        if not np.any(quaternion):
            raise ValueError(f"quat_xyzw of {what} is 0 0 0 0; give a rotation, such as 0 0 0 1")
        return Frame(rotation_of_quaternion(quaternion), place)
    angles = _numbers(origin, "rpy", f"rpy of {what}", "0 0 0")
    return Frame(rotation_of(*angles), place)


def _number(
    element: ElementTree.Element | None,
    entry: str,
    what: str,
    otherwise: float | None,
    largest: float = math.inf,
) -> float:
    text = None if element is None else element.get(entry)
    if text is None and otherwise is not None:
        return otherwise
    try:
        number = float(text or "")
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"{what} is {quoted(text)}; give a number")
    if abs(number) > largest:
        raise ValueError(f"{what} is {number:g}; give at most {largest:g}")
    return number


def _numbers(
    element: ElementTree.Element | None, entry: str, what: str, otherwise: str, count: int = 3
) -> Array:
    text = otherwise if element is None else element.get(entry, otherwise)
    try:
        numbers = np.array([float(word) for word in text.split()])
    except ValueError:
        numbers = np.zeros(0)
    if len(numbers) != count or not np.all(np.isfinite(numbers)):
        raise ValueError(f"{what} is {quoted(text)}; give {_COUNTS[count]} numbers")
    if np.abs(numbers).max() > _LARGEST:
        raise ValueError(f"{what} is {quoted(text)}; give numbers of at most {_LARGEST:g}")
    return numbers


_COUNTS = {3: "three", 4: "four"}
