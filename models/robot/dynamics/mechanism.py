"""A robot as a tree of bodies, each on a joint of one degree of freedom, driven or sprung.

Links that do not move against each other are one body. Every flexibility is a sprung joint: those
of the URDF, of a gear between motor and link, of a beam's hinges, of a base that rocks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from quietarm.models.joint_motion import Array
from quietarm.models.robot.dynamics.robot_parts import RobotParts
from quietarm.models.robot.elastic.beam import Beam
from quietarm.models.robot.frames import Frame, rotation_about
from quietarm.models.robot.urdf.following import Following
from quietarm.models.robot.urdf.read_urdf import FIXED, PRISMATIC, Inertia, Urdf, UrdfJoint

GROUND = -1
"""In the place of a body's number."""
BEAM_END = "beam end"
"""The name by which the end of the beam is known among the links."""
_X = np.array([1.0, 0.0, 0.0])
_Y = np.array([0.0, 1.0, 0.0])
_ALONG = np.array([0.0, 0.0, 1.0])
"""The beam in its own frame."""


@dataclass(frozen=True, eq=False)
class RigidBody:
    """A body and the joint before it, in whose frame its inertia is.

    The frame of the joint stands in that of the parent; the joint turns about its axis, or slides
    along it. Some are `of_beam`: its pieces, and what is between two hinges at one place.
    """

    joint: str
    parent: int
    frame: Frame
    axis: Array
    slides: bool
    inertia: Inertia
    of_beam: bool = False


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Bodies in an order in which each comes after its parent.

    Attributes
    ----------
    bodies : sequence of RigidBody
    driven, sprung : sequence of int
        Numbers of the bodies whose joints are driven, in the order of the robot's joints, and of
        those whose joints have springs.
    stiffness, damping : ndarray
        Of the springs [N m/rad, N m s/rad; N/m, N s/m of sliding ones].
    rotor_inertia, friction : ndarray
        Of the driven joints [kg m^2, N m s/rad].
    links : mapping of str to (int, Frame)
        Where every link of the URDF is: on which body, and where in its frame.
    gravity : ndarray
        [m/s^2].
    following : mapping of int to (int, Following)
        By the number of a body whose joint follows another: the body of that one, and how.
    hint : str
        What an error about loads asks besides, such as whether lengths are in millimetres.
    """

    bodies: Sequence[RigidBody]
    driven: Sequence[int]
    sprung: Sequence[int]
    stiffness: Array
    damping: Array
    rotor_inertia: Array
    friction: Array
    links: Mapping[str, tuple[int, Frame]]
    gravity: Array
    following: Mapping[int, tuple[int, Following]] = field(default_factory=dict)
    hint: str = ""

    @property
    def spring_names(self) -> list[str]:
        """Names of the sprung joints."""
        return [self.bodies[number].joint for number in self.sprung]

    @property
    def springs_of_beam(self) -> NDArray[np.bool_]:
        """Places of the springs that are hinges of the beam."""
        return np.array([self.bodies[number].of_beam for number in self.sprung], bool)

    def stiffened(self, factor: float) -> Mechanism:
        """Return the mechanism with a multiple of its stiffness and the same damping ratios."""
        return replace(
            self,
            stiffness=factor * self.stiffness,
            damping=np.sqrt(factor) * self.damping,
        )

    @property
    def of_one_kilogram(self) -> Mechanism:
        """The mechanism without masses, but for 1 kg at the end of the beam."""
        number, frame = self.links[BEAM_END]
        bodies = [replace(body, inertia=Inertia()) for body in self.bodies]
        bodies[number] = replace(bodies[number], inertia=Inertia(1.0).seen_from(frame))
        nothing = np.zeros(len(self.driven))
        return replace(self, bodies=bodies, rotor_inertia=nothing, friction=nothing)


class _Tree:
    """Bodies as they grow from the ground."""

    def __init__(self) -> None:
        self.bodies = list[RigidBody]()
        self.springs = dict[int, tuple[float, float]]()
        self.joints = dict[str, int]()
        self.links = dict[str, tuple[int, Frame]]()

    def add(
        self,
        joint: str,
        place: tuple[int, Frame],
        axis: Array,
        inertia: Inertia | None = None,
        slides: bool = False,
        spring: tuple[float, float] | None = None,
        of_beam: bool = False,
    ) -> int:
        """A body at a place; its number."""
        parent, frame = place
        body = RigidBody(joint, parent, frame, axis, slides, inertia or Inertia(), of_beam)
        self.bodies.append(body)
        number = len(self.bodies) - 1
        if spring is not None:
            self.springs[number] = spring
        return number

    def load(self, place: tuple[int, Frame], inertia: Inertia) -> None:
        """Fasten a mass at a place."""
        number, frame = place
        if number != GROUND:
            body = self.bodies[number]
            loaded = body.inertia + inertia.seen_from(frame)
            self.bodies[number] = replace(body, inertia=loaded)


def build_mechanism(robot: RobotParts) -> Mechanism:
    """The bodies of a robot."""
    urdf = robot.description
    tree = _Tree()
    _add_link(tree, urdf, urdf.root, _base(tree, robot))
    for joint in urdf.outwards():
        place = _place(tree, joint)
        _add_link(tree, urdf, joint.child, _joined(tree, robot, joint, place))
    if robot.beam is not None:
        _add_beam(tree, robot.beam)
    springs = [tree.springs[number] for number in sorted(tree.springs)]
    return Mechanism(
        bodies=tree.bodies,
        driven=[tree.joints[name] for name in robot.joints],
        sprung=sorted(tree.springs),
        stiffness=np.array([stiffness for stiffness, _ in springs]),
        damping=np.array([damping for _, damping in springs]),
        rotor_inertia=_at_the_motors(robot, robot.rotor_inertia),
        friction=_at_the_motors(robot, robot.friction),
        links=tree.links,
        gravity=np.array(robot.gravity),
        following={
            tree.joints[name]: (tree.joints[entry.leader], entry)
            for name, entry in robot.followers.items()
        },
        hint=(robot.beam and robot.beam.hint_of_material) or urdf.hint_of_size,
    )


def _at_the_motors(robot: RobotParts, values: Mapping[str, float]) -> Array:
    """Rotors or viscous friction that each driven joint feels, those of its followers as well."""
    felt = {name: values.get(name, 0.0) for name in robot.joints}
    for name, entry in robot.followers.items():
        if entry.leader in felt:
            felt[entry.leader] += entry.multiplier**2 * values.get(name, 0.0)
    return np.array(list(felt.values()))


def _base(tree: _Tree, robot: RobotParts) -> tuple[int, Frame]:
    """Frame of the root link: on the ground, or on a pedestal that rocks, and maybe twists."""
    if robot.base is None:
        return GROUND, Frame()
    pivot = Frame(origin=np.array([0.0, 0.0, -robot.base.height]))
    place = (GROUND, pivot)
    for name, axis, *spring in zip(
        "xyz", (_X, _Y, _ALONG), robot.base.stiffness, robot.base.damping
    ):
        pair = (spring[0], spring[1])
        place = (tree.add(f"base about {name}", place, axis, spring=pair), Frame())
    return place[0], Frame(origin=-pivot.origin)


def _add_link(tree: _Tree, urdf: Urdf, link: str, place: tuple[int, Frame]) -> None:
    tree.links[link] = place
    tree.load(place, urdf.links[link])


def _place(tree: _Tree, joint: UrdfJoint) -> tuple[int, Frame]:
    """Return the place of a joint's frame."""
    number, frame = tree.links[joint.parent]
    return number, frame @ joint.frame


def _joined(
    tree: _Tree, robot: RobotParts, joint: UrdfJoint, place: tuple[int, Frame]
) -> tuple[int, Frame]:
    """Return the place of the link after a joint, and the bodies that the joint takes."""
    if joint.kind == FIXED:
        return place
    slides = joint.kind == PRISMATIC
    spring = robot.springs.get(joint.name)
    if spring is not None:
        pair = (spring.stiffness, spring.damping)
        passive = tree.add(joint.name, place, joint.axis, slides=slides, spring=pair)
        tree.joints[joint.name] = passive
        return passive, Frame()
    if joint.name not in robot.joints and joint.name not in robot.followers:
        number, frame = place
        return number, frame @ _moved(joint, robot.held_position(joint.name))
    motor = tree.add(joint.name, place, joint.axis, slides=slides)
    tree.joints[joint.name] = motor
    gear = robot.elastic_joints.get(joint.name)
    if gear is None:
        return motor, Frame()
    pair = (gear.stiffness, gear.damping)
    name = f"gear of {joint.name}"
    return tree.add(name, (motor, Frame()), joint.axis, slides=slides, spring=pair), Frame()


def _moved(joint: UrdfJoint, position: float) -> Frame:
    """Return the frame to which a joint moves what it carries, at a position [rad or m]."""
    if joint.kind == PRISMATIC:
        return Frame(origin=position * joint.axis)
    return Frame(rotation_about(joint.axis, position))


def _add_beam(tree: _Tree, beam: Beam) -> None:
    """The pieces of a beam, on two hinges each."""
    link, at_link = tree.links[beam.at]
    place = (link, at_link @ beam.frame)
    pieces = beam.bodies
    damping_time = beam.damping_time
    tree.load(place, pieces[0])
    before = 0.0
    for count, (at, stiffness) in enumerate(zip(beam.places, beam.springs), start=1):
        number, frame = place
        hinge = (number, frame @ Frame(origin=(at - before) * _ALONG))
        about_x, about_y = ((value, damping_time * value) for value in stiffness)
        middle = tree.add(f"beam {count} about x", hinge, _X, spring=about_x, of_beam=True)
        piece = tree.add(
            f"beam {count} about y",
            (middle, Frame()),
            _Y,
            pieces[count],
            spring=about_y,
            of_beam=True,
        )
        place = (piece, Frame())
        before = at
    number, frame = place
    tree.links[BEAM_END] = (number, Frame(origin=(beam.length - before) * _ALONG))
