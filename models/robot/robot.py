"""A robot: its URDF, which joints are driven, what of it bends; and its plant on a path."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from quietarm.interrupts import interruptible
from quietarm.models import dimensions
from quietarm.models.drawing import Body
from quietarm.models.joint_motion import (
    Array,
    Expression,
    JointMotion,
    Modes,
    is_zero,
    kind_of_joints,
)
from quietarm.models.notes import Note
from quietarm.models.number_checks import (
    finite,
    has_no,
    listed,
    nearest,
    not_negative,
    positive,
    quoted,
    whole,
)
from quietarm.models.plant import Plant, content, parameter
from quietarm.models.robot.dynamics.coulomb_friction import coulomb_torques
from quietarm.models.robot.dynamics.equations_of_motion import Dynamics
from quietarm.models.robot.dynamics.mechanism import BEAM_END, GROUND
from quietarm.models.robot.dynamics.moving_robot import MovingRobot
from quietarm.models.robot.dynamics.robot_parts import Limits
from quietarm.models.robot.elastic.flexibility import Base, Measured, Spring
from quietarm.models.robot.on_path.directions import lines_in
from quietarm.models.robot.on_path.full import FullRobot
from quietarm.models.robot.on_path.path_tables import (
    EXCITED,
    FARTHEST,
    MOST_MODES,
    PAYLOAD,
    STIFFNESS,
    VARIED,
    Tables,
    groups_at,
    modes_on,
    reach,
    tables_of,
    variations_of,
)
from quietarm.models.robot.on_path.stick_figure import stick_figure_of
from quietarm.models.robot.on_path.tip_way import way_of
from quietarm.models.robot.path.geometric_path import GeometricPath
from quietarm.models.robot.path.piecewise import Place
from quietarm.models.robot.robot_file import read_robot
from quietarm.models.robot.robot_notes import notes_of, notes_of_text
from quietarm.models.robot.text_files import read_text
from quietarm.models.robot.urdf.following import Following, mimics_nothing
from quietarm.models.robot.urdf.urdf_text import as_read_before, dynamics_of

if TYPE_CHECKING:
    from quietarm.ocp import PointToPoint

_MOST_MOVING = 100
"""Joints, whose equations are written in two seconds."""
USUAL_MODES = 2
"""That are followed where the file does not say how many."""
_OVER = 1e-9
"""By which a path may pass the range of a joint [rad or m]."""


@dataclass(frozen=True, eq=False, repr=False)
class Robot(MovingRobot):
    """A robot from its URDF, with the flexibilities that it does not have.

    Parameters
    ----------
    urdf : str or Path
        The text of a URDF, or a file as a Path: a text never names a file.
    joints : sequence of str, optional
        The driven joints, in the order of paths; by default all that move, have no spring and
        mimic none. Those that mimic one follow it, or the motor of it where its gear gives.
    held : mapping of str to float, optional
        Positions [rad or m] of joints that are not driven; 0 of those that are not named. One that
        mimics another and is named follows no more.
    beam : Beam, optional
        A beam at a link.
    elastic_joints : mapping of str to Spring, optional
        Gears between the motor and the link of driven joints.
    springs : mapping of str to Spring, optional
        Of passive joints of the URDF.
    base : Base, optional
        A pedestal that rocks.
    tip : str, optional
        The link that must come to rest; the end of the beam by default, or else the last link.
        Its displacements are measured in its own frame, against the robot at rest there.
    gravity : sequence of float
        [m/s^2], as seen from the root link.
    rotor_inertia, friction : mapping of str to float, optional
        Of driven joints and those that follow them [kg m^2, N m s/rad], at the joint's side of its
        gear; friction by default the URDF's <dynamics damping>.
    coulomb : mapping of str to float
        Coulomb friction of the same [N m], against the speed; below 0.01 rad/s it is less, so
        that it is smooth. By default the URDF's <dynamics friction>.
    modes : int or "excited", optional
        How many modes are followed, the slowest; by default two, or one where one spring is all
        there is. Or those of the slowest twelve that leave a thousandth at least of what the most
        excited one leaves on the path.
    limits : mapping, optional
        Limits by quantity and joint, as {"speed": {"elbow_joint": 3.0}}.
    measured : Measured, optional
        A measured frequency, to which all springs are scaled.
    positions : mapping of str to (float, float)
        Ranges of driven joints that are narrower than the URDF's [rad or m].
    remarks : sequence of Note
        What was passed over when its files were read; `notes` has these and more.

    Raises
    ------
    ValueError
        When the URDF cannot be followed, a name is not in it, or a value is out of range.
    """

    example: ClassVar[str] = "a robot, as Robot.load('robot.yaml')"

    @interruptible
    def __post_init__(self) -> None:
        urdf: object = self.urdf
        text = read_text(urdf, "URDF") if isinstance(urdf, Path) else urdf
        if not isinstance(text, str):
            raise TypeError(f"urdf is {quoted(text)}; give the text of a URDF, or a file as a Path")
        if "<" not in text:
            raise ValueError(
                "urdf is no text of a URDF, which begins with <robot>; give that, or its file as a "
                "pathlib.Path"
            )
        self._set("urdf", dynamics_of(text))
        self._set("remarks", (*notes_of_text(text), *self.remarks))
        self._set("springs", self._springs("springs", self.springs))
        self._set("elastic_joints", self._springs("elastic_joints", self.elastic_joints))
        self._set("held", self._numbers("held", self.held, finite))
        self._set("joints", self._driven())
        self._check_names()
        self._set("rotor_inertia", self._numbers("rotor_inertia", self.rotor_inertia, not_negative))
        self._set("friction", self._rubbing("friction", "damping"))
        self._set("coulomb", self._rubbing("coulomb", "friction"))
        self._set("gravity", _vector("gravity", self.gravity))
        self._set("positions", self._ranges_given())
        if self.modes is not None and self.modes != EXCITED:
            if isinstance(self.modes, str):
                raise ValueError(
                    f"modes is {quoted(self.modes)}; give a whole number, or {EXCITED} for those "
                    "that the path excites"
                )
            self._set("modes", whole("modes", self.modes, 1, MOST_MODES))
        self._set("tip", self._tip())
        self._check_base()
        self._check_measured()
        self._check_inertias()
        _ = self.dynamics
        sprung = len(self.unscaled.sprung)
        if not sprung:
            raise ValueError(
                "the robot has nothing that bends; give a beam, elastic_joints, springs or a base"
            )
        if self.modes is None:
            self._set("modes", min(USUAL_MODES, sprung))
        elif self.modes != EXCITED and self.modes > sprung:
            raise ValueError(
                f"modes is {self.modes}; the robot has {counted_springs(sprung)}, give at most that"
            )

    @classmethod
    @interruptible
    def load(cls, path: str | Path) -> Robot:
        """Read a robot's file, in YAML; docs/robots.md has its entries.

        Raises
        ------
        ValueError
            When an entry is unknown, or its value cannot be used.
        """
        return cls(**read_robot(path))

    @interruptible
    def along(self, path: GeometricPath) -> RobotOnPath:
        """The robot on a path, a plant of whose `target` 1.0 is the end of the path.

        Raises
        ------
        ValueError
            When the path has other joints, leaves their ranges, or a spring cannot carry its load.
        """
        return RobotOnPath(robot=self, path=path)

    @interruptible
    def task(self, path: GeometricPath, duration: float, **others: Any) -> PointToPoint:
        """The move along a path within the robot's limits; other keywords of `PointToPoint`.

        A limit that is given is in the place of the robot's own of that quantity.

        Raises
        ------
        ValueError
            As of `along` and of `PointToPoint`.
        """
        return self.along(path).task(1.0, duration, **others)

    @classmethod
    def of_saved(cls, entries: Any) -> Any:
        """The entries of a saved robot, such that they mean what they meant to who saved them."""
        if isinstance(entries, dict) and isinstance(entries.get("urdf"), str):
            return {**entries, "urdf": as_read_before(entries["urdf"])}
        return entries

    @cached_property
    def notes(self) -> tuple[Note, ...]:
        """What its files leave open, have wrong or have passed over, in one line each."""
        return (*self.remarks, *notes_of(self))

    def ranges(self) -> list[tuple[float, float]]:
        """Least and largest position of every driven joint, and of what follows it [rad or m]."""
        joints = self.description.joints
        ranges = {
            name: self.positions.get(name, (joints[name].lower, joints[name].upper))
            for name in self.joints
        }
        for name, follower in self.followers.items():
            if follower.leader in ranges:
                lower, upper = ranges[follower.leader]
                least, most = follower.range_of_leader(joints[name].lower, joints[name].upper)
                ranges[follower.leader] = (max(lower, least), min(upper, most))
        return list(ranges.values())

    def fitted(self, path: GeometricPath) -> GeometricPath:
        """A path with its positions in the order of the driven joints.

        Raises
        ------
        ValueError
            When it has other joints, or leaves the range of one.
        """
        names = self.joints
        if path.joints and not set(names) <= set(path.joints):
            missing = [name for name in names if name not in path.joints]
            others = [name for name in path.joints if name not in names]
            hints = "".join(nearest(name, missing) for name in others)
            raise ValueError(
                f"the path is of the joints {listed(path.joints)}, and the robot drives "
                f"{listed(names)}; give positions of {listed(missing)} as well{hints}"
            )
        if not path.joints and path.count != len(names):
            raise ValueError(
                f"the path is of {path.count} joints, and the robot drives {len(names)}, "
                f"{listed(names)}; give positions of these, in this order"
            )
        if path.joints and path.joints != names:
            path = path.of_joints(names)
        places = np.linspace(0.0, 1.0, 1001)
        for name, (least, most), column in zip(names, self.ranges(), path(places).T):
            beyond = np.maximum(column - most, least - column)
            if beyond.max() > _OVER:
                at = int(beyond.argmax())
                raise ValueError(
                    f"joint {quoted(name)} is at {column[at]:.5g} at s = {places[at]:.3g} of the "
                    f"path; its range is {least:g} to {most:g}{self._with_followers(name)}, give a "
                    "path within it"
                )
        return path

    def _with_followers(self, joint: str) -> str:
        """Words on the joints that follow one, whose ranges bind it as well."""
        names = [name for name, entry in self.followers.items() if entry.leader == joint]
        return f" (with {' and '.join(names)}, following it)" if names else ""

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _springs(self, entry: str, springs: Mapping[str, Any]) -> dict[str, Spring]:
        found = dict[str, Spring]()
        for name, spring in springs.items():
            self._check_joint(entry, name)
            values = spring if isinstance(spring, Spring) else Spring(*_two_of(spring))
            what = f"of {name} in {entry}"
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
                has_no("the URDF", f"moving joint, for {entry},", name, self.description.moving)
            )

    def _driven(self) -> tuple[str, ...]:
        """The driven joints; those that mimic others follow them."""
        joints = self.description.joints
        passive = {*self.springs, *self.held}
        names = tuple(self.joints) or tuple(
            name
            for name in self.description.moving
            if name not in passive and joints[name].mimics is None
        )
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
                has_no("the URDF", "link, for the beam,", self.beam.at, self.description.links)
            )

    def _tip(self) -> str:
        links = self.description.links
        if self.tip is None:
            return BEAM_END if self.beam is not None else list(links)[-1]
        if self.tip != BEAM_END and self.tip not in links:
            raise ValueError(has_no("the URDF", "link, for the tip,", self.tip, links))
        if self.tip == BEAM_END and self.beam is None:
            raise ValueError(f"tip is {BEAM_END!r}, and there is no beam; name a link")
        return self.tip

    def _check_base(self) -> None:
        if self.base is None:
            return
        stiffness = tuple(
            positive("stiffness of the base", x, "N m/rad")
            for x in _pair_of("stiffness", self.base.stiffness)
        )
        damping = tuple(
            not_negative("damping of the base", x, "N m s/rad")
            for x in _pair_of("damping", self.base.damping)
        )
        height = not_negative("height of the base", self.base.height, "m")
        self._set("base", Base((stiffness[0], stiffness[1]), (damping[0], damping[1]), height))

    def _check_measured(self) -> None:
        if self.measured is None:
            return
        frequency = positive("measured frequency", self.measured.frequency, "rad/s")
        at = tuple(finite("a position of measured", x, "rad") for x in self.measured.at)
        if len(at) != len(self.joints):
            raise ValueError(
                f"measured has {len(at)} positions and the robot {len(self.joints)} joints; give "
                "one of each"
            )
        self._set("measured", Measured(frequency, at))

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
        masses = dynamics.masses(x).full()
        names = [*self.joints, *mechanism.spring_names]
        scale = max(1e-12, float(np.abs(masses).max()))
        for name, inertia in zip(names, np.diag(masses)):
            if inertia <= 1e-12 * scale:
                raise ValueError(
                    f"joint {quoted(name)} moves no mass; give the links beyond it an <inertial> "
                    "in the URDF"
                )


@dataclass(frozen=True)
class RobotOnPath(Plant):
    """A robot that follows a path; made by `Robot.along`.

    The joint's angle is the place s on the path, from 0 to 1. W are deviations of the modes from
    the equilibrium under gravity, which moves with the path.

    `stiffness` and `payload` are multiples of the robot's: of all its springs, and of the mass at
    the end of its beam. The equilibrium changes with them. Between the multiples for which there
    are tables the coefficients are polynomials in them; a frequency changes by the stiffness.

    Raises
    ------
    ValueError
        When the path has other joints than the robot, leaves the range of one, or a spring cannot
        carry its load on it; when a multiple is beyond the tables.
    """

    name: ClassVar[str] = "robot"
    steps_at_once: ClassVar[int] = 16
    path_range: ClassVar[tuple[float, float] | None] = reach()
    in_space: ClassVar[bool] = True
    along_path: ClassVar[bool] = True

    robot: Robot = content("what moves")  # noqa: RUF009
    path: GeometricPath = content("where its joints go")  # noqa: RUF009
    stiffness: float = parameter(1.0, "-", "springs", "multiple of the robot's stiffness")
    payload: float = parameter(1.0, "-", "tip_mass", "multiple of the robot's mass at the tip")

    def __post_init__(self) -> None:
        super().__post_init__()
        self._check_multiples()
        object.__setattr__(self, "path", self.robot.fitted(self.path))
        _ = self.tables
        self._check_rotors()

    @property
    def modes(self) -> int:  # pyright: ignore[reportIncompatibleVariableOverride]
        """How many modal amplitudes it has."""
        return len(modes_on(self.robot, self.path))

    def _check_rotors(self) -> None:
        """Refuse motors without inertia where all that they move hangs on springs."""
        robot = self.robot
        without = [name for name in robot.elastic_joints if not robot.rotor_inertia.get(name)]
        if without and self.tables.least_inertia < _NO_INERTIA:
            raise ValueError(
                f"elastic_joints needs rotor_inertia of {', '.join(without)} (motor's inertia "
                "times the gear ratio squared)"
            )

    @property
    def notes(self) -> tuple[Note, ...]:
        """What the robot's files leave open or have wrong."""
        return self.robot.notes

    @property
    def limits(self) -> Limits:
        """The robot's, of its joints."""
        return self.robot.limits

    @property
    def followers(self) -> Mapping[str, tuple[int, Following]]:
        """The joints that follow driven ones: by name the number of that one, and how."""
        numbers = {name: number for number, name in enumerate(self.joint_names)}
        return {
            name: (numbers[entry.leader], entry)
            for name, entry in self.robot.followers.items()
            if entry.leader in numbers
        }

    @property
    def label(self) -> str:
        """The robot's name, and what bends."""
        robot = self.robot
        bends = [
            *(["base"] if robot.base is not None else []),
            *(["gears"] if robot.elastic_joints else []),
            *(["springs"] if robot.springs else []),
            *([f"beam at {robot.beam.at}"] if robot.beam is not None else []),
        ]
        joints = "1 joint" if len(robot.joints) == 1 else f"{len(robot.joints)} joints"
        return f"{robot.description.name} ({joints}; {', '.join(bends)})"

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Of the driven joints."""
        return self.robot.joints

    @property
    def joint(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The kind of its joints: rotary, linear or mixed."""
        return kind_of_joints(self.joint_kinds)

    @property
    def joint_kinds(self) -> tuple[str, ...]:
        """The kind of every driven joint."""
        return tuple(map(self.kind_of, self.joint_names))

    def kind_of(self, joint: str) -> str:
        """Return the kind of a joint of the URDF by its name."""
        return self.robot.kind_of(joint)

    @property
    def measured(self) -> dict[str, float]:
        """The parameters that may have relative errors; of the payload where there is one."""
        return {
            name: value
            for name, value in super().measured.items()
            if name != PAYLOAD or self.robot.payload > 0
        }

    @property
    def tables(self) -> Tables:
        """The coefficients of its equations, with the robot's own stiffness and payload."""
        return tables_of(self.robot, self.path)

    @property
    def in_full(self) -> FullRobot:
        """The equations with all springs, without tables and modes."""
        return FullRobot(self.robot, self.path, self.stiffness, self.payload)

    @property
    def tip_names(self) -> tuple[str, ...]:
        """The axes of its frame along which the tip moves: tip_x, tip_y."""
        return tuple(f"tip_{'xyz'[axis]}" for axis in self.tables.directions)

    @property
    def tip_lines(self) -> Array | None:
        """So many that a displacement of the tip is at most 5 % longer than along one of them."""
        return lines_in(self.tables.tips.shape[2])

    def with_frequency(self, factor: Expression) -> Plant:
        """Springs by which natural frequencies are so many times as high; the sag is another."""
        stiffness = self.stiffness * factor * factor
        if isinstance(factor, Real):
            return replace(self, stiffness=stiffness)
        changed = copy.copy(self)
        object.__setattr__(changed, STIFFNESS, stiffness)
        return changed

    def modal_accelerations(self, joint: JointMotion, W: Modes, dW: Modes) -> Modes:
        """W'' by the motion on the path [m/s^2]."""
        of = self._coefficients(joint, "modes")
        square = joint.speed * joint.speed
        accelerations = list[Expression]()
        for i in range(self.modes):
            forces = [
                (of["a"][i], joint.acceleration),
                (of["b"][i], square),
                (of["e"][i], joint.speed),
            ]
            for j in range(self.modes):
                stiffness = _sum([
                    (of["K"][i, j], 1.0),
                    (of["A"][i, j], joint.acceleration),
                    (of["B"][i, j], square),
                ])  # fmt: skip
                damping = _sum([(of["D"][i, j], 1.0), (of["C"][i, j], joint.speed)])
                forces += [(stiffness, W[j]), (damping, dW[j])]
            accelerations.append(-_sum(forces))
        return accelerations

    def joints(self, path: JointMotion) -> Sequence[JointMotion]:
        """Motion of every driven joint [rad or m]."""
        positions = np.moveaxis(np.array(self.tables.path), 0, -1)
        by_joint = self.tables.at(path.angle).values(positions)
        square = path.speed * path.speed
        nothing = 0 * path.angle
        motions = list[JointMotion]()
        for at, slope, bend, third in by_joint:
            speed = _sum([(slope, path.speed)])
            acceleration = _sum([(slope, path.acceleration), (bend, square)])
            jerk = None
            if path.jerk is not None:
                jerk = nothing + _sum([
                    (slope, path.jerk),
                    (bend, 3 * path.speed * path.acceleration),
                    (third, square * path.speed),
                ])  # fmt: skip
            motion = JointMotion(at + nothing, speed + nothing, acceleration + nothing, jerk)
            motions.append(motion)
        return motions

    def torques(self, path: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Sequence[Expression]:
        """Torque of every driven joint [N m, or N of a sliding one]."""
        of = self._coefficients(path, "torques")
        square = path.speed * path.speed
        nothing = 0 * path.angle
        torques = list[Expression]()
        for i in range(len(self.joint_names)):
            terms = [
                (of["g"][i], 1.0),
                (of["a"][i], path.acceleration),
                (of["b"][i], square),
                (of["e"][i], path.speed),
            ]
            for j in range(self.modes):
                stiffness = _sum([
                    (of["K"][i, j], 1.0),
                    (of["A"][i, j], path.acceleration),
                    (of["B"][i, j], square),
                ])  # fmt: skip
                damping = _sum([(of["C"][i, j], path.speed)])
                terms += [(stiffness, W[j]), (damping, dW[j]), (of["N"][i, j], ddW[j])]
            torques.append(_sum(terms) + nothing)
        rubbing = self.coulomb(self.joints(path))
        return [torque + friction for torque, friction in zip(torques, rubbing)]

    def coulomb(self, joints: Sequence[JointMotion]) -> list[Expression]:
        """Torque of Coulomb friction of every driven joint."""
        return coulomb_torques(self.robot, joints)

    def tips_at(self, path: JointMotion, W: Modes) -> Sequence[Expression]:
        """Displacements of the tip from its place at rest, in its own frame [m]."""
        rows = self._coefficients(path, "tips")["rows"]
        return [_sum(list(zip(row, W))) + 0 * path.angle for row in rows]

    def tip_deviations(self, places: Array, tips: Array, target: float) -> Array:
        """Where the tip is, as seen from where it rests at the target [m]: a row for each axis.

        At rest it hangs lower by the sag at its place, with the robot's own springs and payload or
        so many times these.
        """
        way = way_of(self.robot, self.path, self.stiffness, self.payload)
        return way.deviations(places, tips, target)

    def structure(self, angle: float, tips: Sequence[float]) -> Sequence[Body]:
        """The robot in space at a place of its path, as a stick figure."""
        return stick_figure_of(self.robot, self.path).bodies(angle, tips)

    def tip_speeds(self, path: JointMotion, W: Modes, dW: Modes) -> Sequence[Expression]:
        """Their rates [m/s]."""
        of = self._coefficients(path, "tips")
        rows = of["rows"]
        slopes = of["slopes"]
        return [
            _sum(list(zip(slope, W))) * path.speed + _sum(list(zip(row, dW)))
            for row, slope in zip(rows, slopes)
        ]

    def _coefficients(self, path: JointMotion, group: str) -> dict[str, Array]:
        """All of a group at the place on the path, by one product for each."""
        errors = self._errors
        if all(isinstance(error, Real) for error in errors.values()):
            numbers = {name: float(error) for name, error in errors.items()}
            tables = groups_at(self.robot, self.path, tuple(numbers.items()))[group]
            terms = max(table.shape[1] for table in tables.values())
            place = Place(self.tables.knots, path.angle, terms)
            return {name: place.values(table) for name, table in tables.items()}
        place = self.tables.at(path.angle)
        nominal = self.tables.groups[group]
        variations = variations_of(self.robot, self.path, tuple(errors))
        changes = [groups[group] for groups in variations.values()]
        factors = [_power(errors.values(), powers) for powers in variations]
        if all(map(place.takes_by_row, factors)):
            return {
                name: place.values_of_sum([table, *(entry[name] for entry in changes)], factors)
                for name, table in nominal.items()
            }
        coefficients = {name: place.values(table) for name, table in nominal.items()}
        for factor, entry in zip(factors, changes):
            for name, table in entry.items():
                change = place.values(table)
                coefficients[name] = _added(coefficients[name], factor, change)
        return coefficients

    @property
    def _errors(self) -> dict[str, Expression]:
        """By which multiples are not 1, of those that may be another."""
        multiples = {name: getattr(self, name) for name in VARIED}
        return {
            name: value - 1
            for name, value in multiples.items()
            if not (isinstance(value, Real) and value == 1)
        }

    def _check_multiples(self) -> None:
        for name in VARIED:
            multiple = getattr(self, name)
            if not abs(multiple - 1) <= FARTHEST:
                of_frequency = (
                    f", frequencies from {math.sqrt(1 - FARTHEST):.2g} to "
                    f"{math.sqrt(1 + FARTHEST):.3g} times"
                    if name == STIFFNESS
                    else ""
                )
                raise ValueError(
                    f"{name} is {multiple:.4g} times the robot's; its tables reach from "
                    f"{1 - FARTHEST:g} to {1 + FARTHEST:g} times{of_frequency}: give a smaller "
                    "error, or change the robot"
                )
        if self.payload != 1 and not self.robot.payload > 0:
            raise ValueError(
                "the robot has no mass at the end of a beam, so payload is 1; give the beam a "
                "tip_mass"
            )


def _sum(products: Sequence[tuple[Expression, Expression]]) -> Expression:
    """The sum of pairwise products; factors that are 0 are left out."""
    terms = [left * right for left, right in products if not (is_zero(left) or is_zero(right))]
    return sum(terms[1:], terms[0]) if terms else 0.0


_NO_INERTIA = 1e-6
"""Share of the inertia along the path that is left where the springs let all links go."""


def _power(errors: Iterable[Expression], powers: Sequence[int]) -> Expression:
    """The product of powers of errors."""
    factors = [error for error, power in zip(errors, powers) for _ in range(power)]
    product = factors[0]
    for factor in factors[1:]:
        product = product * factor
    return product


def _added(values: Array, factor: Expression, changes: Array) -> Array:
    """Values and so many times their changes, entry by entry."""
    added = values.copy()
    for place, change in np.ndenumerate(changes):
        if not is_zero(change):
            added[place] = added[place] + factor * change
    return added


def counted_springs(count: int) -> str:
    """So many springs, in words."""
    return "1 spring" if count == 1 else f"{count} springs"


def _vector(name: str, value: Any) -> tuple[float, float, float]:
    entries = [finite(name, entry, "m/s^2") for entry in value]
    if len(entries) != 3:
        raise ValueError(f"{name} has {len(entries)} numbers; give three, as 0, 0, -9.81")
    return (entries[0], entries[1], entries[2])


def _pair_of(name: str, value: Any) -> tuple[Any, Any]:
    entries = (value, value) if isinstance(value, int | float) else tuple(value)
    if len(entries) != 2:
        raise ValueError(
            f"{name} of the base has {len(entries)} numbers; give one, or two, about x and about y"
        )
    return entries


def _two_of(spring: Any) -> tuple[Any, ...]:
    """Stiffness and damping of a number, a pair or a mapping."""
    if isinstance(spring, Mapping):
        names = [entry.name for entry in fields(Spring)]
        for name in spring:
            if name not in names:
                raise ValueError(has_no("a spring", "entry", name, names))
        return tuple(spring.get(name, 0.0) for name in names)
    return (spring,) if isinstance(spring, int | float) else tuple(spring)
