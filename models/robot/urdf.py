"""A robot as its URDF has it: links with their masses, and the joints between them.

What quietarm does not follow is refused: loops, joints of several degrees of freedom, entities.
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ElementTree
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from quietarm.models.checks import clipped, listed, quoted
from quietarm.models.joint_motion import Array
from quietarm.models.robot.frames import Frame, rotation_of

REVOLUTE = "revolute"
PRISMATIC = "prismatic"
FIXED = "fixed"
_KINDS = {
    "revolute": REVOLUTE, "continuous": REVOLUTE, "prismatic": PRISMATIC, "fixed": FIXED,
}  # fmt: skip
_READ = ("link", "joint", "inertial", "origin", "mass", "inertia", "parent", "child", "axis",
         "limit", "mimic")  # fmt: skip
"""Elements that the dynamics need; all others, as shapes for pictures, are left out."""
_MOST_LINKS = 1000
"""Humanoids with their hands have some two hundred."""
_MOST_MOVING = 100
"""Joints, whose equations are written in two seconds."""
_LARGEST = 1e9
"""Of a mass, a moment or a place, in SI units: squares and products stay numbers."""
_COMMENT = re.compile("<!--.*?-->", re.DOTALL)
_XACRO = re.compile(r"<xacro:|\$\{")


@dataclass(frozen=True, eq=False)
class Inertia:
    """Mass [kg], its centre in the frame of the body [m], moments about the centre [kg m^2]."""

    mass: float = 0.0
    centre: Array = field(default_factory=lambda: np.zeros(3))
    moments: Array = field(default_factory=lambda: np.zeros((3, 3)))

    def seen_from(self, frame: Frame) -> Inertia:
        """The same in a frame in which this body's frame stands."""
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


@dataclass(frozen=True, eq=False)
class UrdfJoint:
    """A joint: which links it joins, where it stands in the parent's frame, what it allows.

    Positions are in rad or m, the effort in N m or N, the velocity in rad/s or m/s; infinite, or
    0 for effort and velocity, where the URDF has none.
    """

    name: str
    kind: str
    parent: str
    child: str
    frame: Frame
    axis: Array
    lower: float
    upper: float
    effort: float
    velocity: float
    mimics: str | None


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


def dynamics_of(text: str) -> str:
    """The URDF without what the dynamics do not need: pictures, collisions, transmissions.

    ValueError where it is no URDF.
    """
    root = _parsed(text)
    for element in list(root.iter()):
        for child in list(element):
            if child.tag not in _READ:
                element.remove(child)
    for element in root.iter():
        element.text = None
        element.tail = None
    try:
        return ElementTree.tostring(root, encoding="unicode")
    except RecursionError:
        raise ValueError(
            "the URDF is nested too deeply; give links and joints beside each other"
        ) from None


@lru_cache(maxsize=32)
def read_urdf(text: str) -> Urdf:
    """Read a URDF.

    Raises
    ------
    ValueError
        When it is no URDF, has XML entities, or what quietarm cannot follow.
    """
    root = _parsed(text)
    links = {_name(element): _inertia(element) for element in root.findall("link")}
    if not links:
        raise ValueError("the URDF has no links; give one of a robot, with its links' inertias")
    if len(links) > _MOST_LINKS:
        raise ValueError(f"the URDF has {len(links)} links; give at most {_MOST_LINKS}")
    joints = {_name(element): _joint(element) for element in root.findall("joint")}
    for joint in joints.values():
        for link in (joint.parent, joint.child):
            if link not in links:
                raise ValueError(
                    f"joint {quoted(joint.name)} of the URDF joins {quoted(link)}, which is no "
                    "link of it; add the link, or mend its name"
                )
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
    if len(urdf.moving) > _MOST_MOVING:
        raise ValueError(
            f"the URDF has {len(urdf.moving)} joints that move; give at most {_MOST_MOVING}, "
            "others as fixed ones"
        )
    return urdf


def _parsed(text: str) -> ElementTree.Element:
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise ValueError(
            "the URDF has a document type or XML entities, which are not read; write out what they "
            "stand for"
        )
    try:
        root = ElementTree.fromstring(text.removeprefix("\ufeff").encode())
    except ElementTree.ParseError as error:
        raise ValueError(
            f"the URDF is no valid XML ({clipped(str(error))}); export it again"
        ) from None
    if root.tag != "robot":
        raise ValueError(f"the URDF begins with <{clipped(root.tag)}>; give one of <robot>")
    if _XACRO.search(_COMMENT.sub("", text)):
        raise ValueError("the URDF has xacro's macros; run xacro on it first, and give its output")
    return root


def _name(element: ElementTree.Element) -> str:
    name = element.get("name")
    if not name:
        raise ValueError(f"a <{element.tag}> of the URDF has no name; give it one")
    return name


def _inertia(link: ElementTree.Element) -> Inertia:
    """Of a link, in its frame; of none without <inertial>."""
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
    least = float(np.linalg.eigvalsh(moments).min())
    if mass < 0 or least < -1e-9 * max(1.0, float(np.abs(moments).max())):
        raise ValueError(
            f"{what} has a mass of {mass:g} kg and a least moment of inertia of {least:.3g} kg m^2;"
            " give what a body can have"
        )
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
    axis = _numbers(element.find("axis"), "xyz", f"axis of {what}", "1 0 0")
    length = float(np.linalg.norm(axis))
    if length == 0:
        raise ValueError(f"axis of {what} is 0 0 0; give a direction, as 0 0 1")
    limit = element.find("limit")
    turns = kind == "continuous"
    mimic = element.find("mimic")
    ends = {
        end: otherwise if turns else _number(limit, end, f"{end} limit of {what}", otherwise)
        for end, otherwise in (("lower", -math.inf), ("upper", math.inf))
    }
    return UrdfJoint(
        name=name,
        kind=_KINDS[kind],
        parent=_link(element, "parent", what),
        child=_link(element, "child", what),
        frame=_origin(element, what),
        axis=axis / length,
        lower=ends["lower"],
        upper=ends["upper"],
        effort=_number(limit, "effort", f"effort of {what}", 0.0),
        velocity=_number(limit, "velocity", f"velocity of {what}", 0.0),
        mimics=None if mimic is None else mimic.get("joint"),
    )


def _link(joint: ElementTree.Element, end: str, what: str) -> str:
    element = joint.find(end)
    link = None if element is None else element.get("link")
    if not link:
        raise ValueError(f"{what} has no {end} link; give it one")
    return link


def _origin(element: ElementTree.Element, what: str) -> Frame:
    origin = element.find("origin")
    place = _numbers(origin, "xyz", f"origin of {what}", "0 0 0")
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


def _numbers(element: ElementTree.Element | None, entry: str, what: str, otherwise: str) -> Array:
    text = otherwise if element is None else element.get(entry, otherwise)
    try:
        numbers = np.array([float(word) for word in text.split()])
    except ValueError:
        numbers = np.zeros(0)
    if len(numbers) != 3 or not np.all(np.isfinite(numbers)):
        raise ValueError(f"{what} is {quoted(text)}; give three numbers")
    if np.abs(numbers).max() > _LARGEST:
        raise ValueError(f"{what} is {quoted(text)}; give numbers of at most {_LARGEST:g}")
    return numbers
