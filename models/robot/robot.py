"""A robot: its URDF, which joints are driven, what of it bends; and its plant on a path."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from quietarm.interrupts import interruptible
from quietarm.models.drawing import Body
from quietarm.models.joint_motion import (
    ROTARY,
    Array,
    Expression,
    JointMotion,
    Modes,
    is_zero,
    kind_of_joints,
)
from quietarm.models.notes import Note
from quietarm.models.number_checks import (
    how_named,
    listed,
    quoted,
)
from quietarm.models.plant import Plant, content, parameter
from quietarm.models.robot.checked_robot import CheckedRobot
from quietarm.models.robot.dynamics.coulomb_friction import coulomb_torques
from quietarm.models.robot.dynamics.robot_parts import Limits
from quietarm.models.robot.elastic.beam import Beam
from quietarm.models.robot.mujoco_model import entries_of_mujoco
from quietarm.models.robot.on_path.directions import lines_in
from quietarm.models.robot.on_path.full import FullRobot
from quietarm.models.robot.on_path.here import Here, Latest
from quietarm.models.robot.on_path.path_tables import (
    FARTHEST,
    PAYLOAD,
    STIFFNESS,
    VARIED,
    Tables,
    groups_at,
    modes_on,
    range_of_tables,
    tables_of,
    variations_of,
)
from quietarm.models.robot.on_path.robot_figure import robot_figure_of
from quietarm.models.robot.on_path.tip_way import way_of
from quietarm.models.robot.path.geometric_path import GeometricPath
from quietarm.models.robot.path.not_driven import moves_undriven
from quietarm.models.robot.path.straight_line import tip_beside_lines
from quietarm.models.robot.robot_file import read_robot
from quietarm.models.robot.robot_notes import notes_of, notes_of_fit
from quietarm.models.robot.urdf.following import (
    Following,
    ranges_of_leaders,
)
from quietarm.models.robot.urdf.urdf_text import as_read_before

if TYPE_CHECKING:
    from quietarm.ocp import PointToPoint

_OVER = 1e-9
"""By which a path may pass the range of a joint [rad or m]."""


@dataclass(frozen=True, eq=False, repr=False)
class Robot(CheckedRobot):
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
        Limits by quantity and joint, such as {"speed": {"elbow_joint": 3.0}}.
    measured : Measured or sequence of Measured, optional
        Measured frequencies, to which all springs are scaled; several that tell the mass at the end
        of the beam from the springs change it as well.
    positions : mapping of str to (float, float)
        Ranges of driven joints that are narrower than the URDF's [rad or m].
    remarks : sequence of Note
        What was passed over when its files were read; `notes` has these and more.

    Raises
    ------
    ValueError
        When the URDF cannot be followed, a name is not in it, or a value is out of range.
    """

    example: ClassVar[str] = "a robot, such as Robot.load('robot.yaml')"

    @classmethod
    @interruptible
    def load(cls, path: str | Path) -> Robot:
        """Read a robot's file, in YAML; docs/robots_reference.md has its entries.

        Raises
        ------
        ValueError
            When an entry is unknown, or its value cannot be used.
        """
        return cls(**read_robot(path))

    @classmethod
    @interruptible
    def from_mujoco(cls, model: Any, **others: Any) -> Robot:
        """Read a model of MuJoCo, mujoco.MjModel.from_xml_path("robot.xml"): its tree of bodies.

        Its joints with `stiffness` are springs, its `armature` is inertia of rotors, `damping` and
        `frictionloss` are friction; a joint that an equality ties to another follows it. Actuators,
        geometry and contacts are not used.

        Parameters
        ----------
        model : mujoco.MjModel
            As MuJoCo has compiled it, of MJCF or of URDF.
        **others : Any
            Further arguments of `Robot`, such as joints, beam and tip; one that the model has as
            well is in its place.

        Raises
        ------
        ValueError
            When it has a free or a ball joint, a loop, or tendons with springs; as of `Robot`.
        """
        return cls(**(entries_of_mujoco(model) | others))

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
        One that is given by joint is in the place of those joints' own: all others keep theirs.

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
            entries = {**entries, "urdf": as_read_before(entries["urdf"])}
            if "beam" in entries:
                entries["beam"] = Beam.of_saved(entries["beam"])
        return entries

    @cached_property
    def notes(self) -> tuple[Note, ...]:
        """Notes on the robot, one line each, about gaps, errors and unused entries of its files."""
        return (*self.remarks, *notes_of(self), *notes_of_fit(self.fit))

    @cached_property
    def finer(self) -> Robot:
        """Robot with its beam on other hinges, by which a plan is judged."""
        if self.beam is None:
            return self
        finer = copy.copy(self)
        for name in _OF_ALL_PARTS:
            vars(finer).pop(name, None)
        finer._set("beam", self.beam.finer)
        return finer

    def ranges(self) -> list[tuple[float, float]]:
        """Least and largest position of every driven joint, and of what follows it [rad or m]."""
        of_urdf = {
            name: (joint.lower, joint.upper) for name, joint in self.description.joints.items()
        }
        own = {name: self.positions.get(name, of_urdf[name]) for name in self.joints}
        return list(ranges_of_leaders(own, of_urdf, self.followers).values())

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
            hints = how_named(others, missing)
            raise ValueError(
                f"the path is of the joints {listed(path.joints)}, and the robot drives "
                f"{listed(names)}; give positions of {listed(missing)} as well{hints}"
            )
        if not path.joints and path.count != len(names):
            raise ValueError(
                f"the path is of {path.count} joints, and the robot drives {len(names)}, "
                f"{listed(names)}; give positions of these, in this order"
            )
        places = np.linspace(0.0, 1.0, 1001)
        if path.joints and path.joints != names:
            moving = tuple(
                f"warning: {words}" for words in moves_undriven(self, path.joints, path(places))
            )
            path = path.of_joints(names)
            path = replace(path, remarks=(*path.remarks, *moving))
        for name, (least, most), column in zip(names, self.ranges(), path(places).T):
            beyond = np.maximum(column - most, least - column)
            if beyond.max() > _OVER:
                at = int(beyond.argmax())
                value = round(float(column[at]), 9) + 0.0  # without the spline's rounding
                raise ValueError(
                    f"joint {quoted(name)} is at {value:.5g} at s = {places[at]:.3g} of the "
                    f"path; its range is {least:g} to {most:g}{self._with_followers(name)}, give a "
                    f"path within it{self.unit_words(name, column[at])}"
                )
        words = tuple(words for words in self._long_turns(path) if words not in path.remarks)
        return replace(path, remarks=(*path.remarks, *words)) if words else path

    def _long_turns(self, path: GeometricPath) -> Iterable[str]:
        """Words on joints without ends that go the long way round between two waypoints."""
        for name, column in zip(self.joints, path.waypoints.T):
            if not self.description.joints[name].endless or self.kind_of(name) != ROTARY:
                continue
            steps = np.diff(column)
            at = int(np.abs(steps).argmax()) if len(steps) else 0
            if len(steps) and abs(steps[at]) > math.pi:
                short = steps[at] - math.copysign(math.tau, steps[at])
                yield (
                    f"joint {quoted(name)}, which has no ends, turns by {steps[at]:.4g} rad "
                    f"between waypoints {at + 1} and {at + 2}; for the short way of {short:.4g} "
                    f"rad give {column[at] + short:.5g} in place of {column[at + 1]:.5g}"
                    f"{self.unit_words(name, steps[at])}"
                )

    def check_positions(self, points: Array) -> None:
        """Refuse positions of the driven joints, a row a point, beyond the range of one."""
        for name, (least, most), column in zip(self.joints, self.ranges(), points.T):
            beyond = np.maximum(column - most, least - column)
            if beyond.max() > _OVER:
                at = int(beyond.argmax())
                raise ValueError(
                    f"joint {quoted(name)} is at {column[at]:.5g} at point {at + 1} of "
                    f"{len(points)}; its range is {least:g} to {most:g}"
                    f"{self._with_followers(name)}, give positions within it"
                    f"{self.unit_words(name, column[at])}"
                )

    @interruptible
    def off_straight(self, path: GeometricPath) -> float:
        """Return the tip's largest distance from the way by straight lines of the joints [m].

        These are the lines between the path's waypoints; 0 of a path without.
        """
        return tip_beside_lines(self.kinematics(self.tip), *path.beside_lines)

    def _with_followers(self, joint: str) -> str:
        """Words on the joints that follow one, whose ranges bind it as well."""
        names = [name for name, entry in self.followers.items() if entry.leader == joint]
        return f" (with {' and '.join(names)}, following it)" if names else ""


_OF_ALL_PARTS = ("unscaled", "mechanism", "dynamics", "fit", "of_one_kilogram", "digest")
"""What a robot has computed from its beam as well."""


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
    path_range: ClassVar[tuple[float, float] | None] = range_of_tables()
    in_space: ClassVar[bool] = True
    along_path: ClassVar[bool] = True
    is_kept: ClassVar[bool] = True

    robot: Robot = content("what moves")  # noqa: RUF009
    path: GeometricPath = content("where its joints go")  # noqa: RUF009
    stiffness: float = parameter(1.0, "-", "springs", "multiple of the robot's stiffness")
    payload: float = parameter(1.0, "-", "tip_mass", "multiple of the robot's mass at the tip")

    def __post_init__(self) -> None:
        super().__post_init__()
        self._check_multiples()
        object.__setattr__(self, "path", self.robot.fitted(self.path))
        _ = groups_at(self.robot, self.path, tuple(self._errors.items()))
        self._check_rotors()

    @property
    def modes(self) -> int:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Number of modal amplitudes of the robot on its path."""
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
        """Notes on the robot, one line each, about gaps, errors and unused entries of its files."""
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
        """Names of the driven joints."""
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
    def as_checked(self) -> RobotOnPath:
        """The robot with its own stiffness and payload, whose tables all others are made of."""
        return RobotOnPath(self.robot, self.path) if self._errors else self

    @property
    def tables(self) -> Tables:
        """The coefficients of its equations, with the robot's own stiffness and payload."""
        return tables_of(self.robot, self.path)

    @property
    def in_full(self) -> FullRobot:
        """The equations with all springs, a beam's on other hinges, without tables and modes."""
        return FullRobot(self.robot, self.robot.finer, self.path, self.stiffness, self.payload)

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
        by_joint = self._at(path.angle).basis(self.tables.terms).values(positions)
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
        """Return where the tip is, seen from where it rests at the target [m]: a row for each axis.

        At rest it hangs lower by the sag at its place, with the robot's own springs and payload or
        so many times these.
        """
        way = way_of(self.robot, self.path, self.stiffness, self.payload)
        return way.deviations(places, tips, target)

    def structure(self, angle: float, tips: Sequence[float]) -> Sequence[Body]:
        """The robot in space at a place of its path: capsules between its joints, and the beam."""
        return robot_figure_of(self.robot, self.path).bodies(angle, tips)

    @property
    def seen_from(self) -> float:
        """Direction of the ground from which it is seen, that of most of the tip's way [rad]."""
        return robot_figure_of(self.robot, self.path).seen_from

    def tip_speeds(self, path: JointMotion, W: Modes, dW: Modes) -> Sequence[Expression]:
        """Speeds of the tips [m/s]."""
        of = self._coefficients(path, "tips")
        rows = of["rows"]
        slopes = of["slopes"]
        return [
            _sum(list(zip(slope, W))) * path.speed + _sum(list(zip(row, dW)))
            for row, slope in zip(rows, slopes)
        ]

    def _coefficients(self, path: JointMotion, group: str) -> dict[str, Array]:
        """All of a group at the place on the path, by one product for each."""
        return self._at(path.angle).once(group, self._coefficients_at)

    def _at(self, angle: Expression) -> Here:
        """The place on the path, with what was computed there: the latest one is remembered.

        Who wants a step or a sample asks several times at the same one. Coefficients of symbols
        are so built once, and stand once in a function.
        """
        parts = (self.robot, self.path, self.stiffness, self.payload, angle)
        here = _LATEST.here
        if here is None or not here.is_of(parts):
            here = _LATEST.here = Here(parts, self.tables.knots)
        return here

    def _coefficients_at(self, here: Here, group: str) -> dict[str, Array]:
        errors = self._errors
        if all(isinstance(error, Real) for error in errors.values()):
            numbers = {name: float(error) for name, error in errors.items()}
            tables = groups_at(self.robot, self.path, tuple(numbers.items()))[group]
            place = here.basis(max(table.shape[1] for table in tables.values()))
            return {name: place.values(table) for name, table in tables.items()}
        place = here.basis(self.tables.terms)
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
        """Multiples that are not 1, of those that may be another number."""
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


_LATEST = Latest()


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
