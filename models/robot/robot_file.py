"""A robot's file in YAML: every entry of `Robot`, its numbers in SI units or with a unit."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from quietarm.models.dimensions import DAMPING, EFFORT, INERTIA, STIFFNESS, Unit
from quietarm.models.joint_motion import LINEAR, ROTARY
from quietarm.models.notes import Note
from quietarm.models.number_checks import clipped, has_no, listed, quoted
from quietarm.models.robot.elastic.beam import Beam
from quietarm.models.robot.elastic.flexibility import Base, Measured, Spring
from quietarm.models.robot.text_files import read_text, read_yaml
from quietarm.models.robot.urdf.following import (
    Following,
    bounds_of_leaders,
    driven_joints,
    followers_of,
    ranges_of_leaders,
)
from quietarm.models.robot.urdf.joint_limits import ByQuantity, JointLimits, read_joint_limits
from quietarm.models.robot.urdf.read_urdf import PRISMATIC, UrdfJoint, read_urdf
from quietarm.models.units import parse_quantity

Read = Callable[[Any, str], Any]
"""(entry of the file, what it is in words) -> its value."""
ReadOfJoint = Callable[[Any, str, str], Any]
"""(entry of the file, what it is in words, the joint's kind) -> its value."""
OF_URDF = "urdf"
"""The entry that names the URDF; in place of a file of limits: those of the URDF."""


def read_robot(path: str | Path) -> dict[str, Any]:
    """The arguments of `Robot` in a file; ValueError with the entry that is wrong."""
    document = read_yaml(path, "robot file")
    if not isinstance(document, dict):
        raise ValueError(f"robot file {path} is no table; give entries as urdf: robot.urdf")
    try:
        return _arguments(document, Path(path).parent)
    except ValueError as error:
        raise ValueError(f"robot file {path}: {error}") from None


def is_robot_file(path: str | Path) -> bool:
    """Return whether a file in YAML is a robot's, by its entry `urdf`, if it can be read."""
    try:
        document = read_yaml(path, "robot file")
    except ValueError:
        return False
    return isinstance(document, dict) and OF_URDF in document


def _arguments(document: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    def of_joints(read: ReadOfJoint) -> Read:
        """Return the reader of values by joint, each in the units of the joint's kind."""
        return lambda entry, what: _by_joint(entry, what, read, _sliding(document, folder))

    readers: dict[str, Read] = {
        "urdf": lambda entry, _: read_text(_beside(entry, folder, "urdf"), "URDF"),
        "joints": _names,
        "held": lambda entry, _: entry,
        "beam": _beam,
        "elastic_joints": of_joints(_spring),
        "springs": of_joints(_spring),
        "base": _base,
        "tip": _name,
        "gravity": partial(_several, unit="m/s^2"),
        "rotor_inertia": of_joints(_quantity_of(INERTIA)),
        "friction": of_joints(_quantity_of(DAMPING)),
        "coulomb": of_joints(_quantity_of(EFFORT)),
        "modes": lambda entry, _: entry,
        "limits": lambda entry, _: entry,
        "measured": _measured,
    }
    for name in document:
        if name not in readers:
            raise ValueError(has_no("a robot", "entry", str(name), list(readers)))
    if "urdf" not in document:
        raise ValueError("it has no urdf; give the file of the robot's URDF")
    given = {
        name: readers[name](entry, name) for name, entry in document.items() if entry is not None
    }
    if "held" in given:
        given["held"] = _held(given["held"], given["urdf"])
    if "limits" in given:
        read = _limits(given, folder)
        given |= {"limits": read.limits, "positions": read.positions, "remarks": tuple(read.notes)}
    if "beam" in given:
        _refuse_heavy(given["beam"], given["urdf"])
    return given


def _refuse_heavy(beam: Beam, urdf: str) -> None:
    """Refuse a bar that is heavier than the robot that carries it, whose sizes are in mm."""
    mass = beam.line_mass * beam.length
    of_robot = sum(link.mass for link in read_urdf(urdf).links.values())
    if 0 < of_robot < mass:
        raise ValueError(
            f"the beam has {mass:.4g} kg, more than the robot's {of_robot:.4g} kg; are its sizes "
            "in mm, as width: 5mm, or is density in kg/m^3?"
        )


def _held(entry: Any, urdf: str) -> dict[str, float]:
    """Positions of joints that are not driven, of one that slides in metres."""
    if not isinstance(entry, dict):
        raise ValueError(
            f"held is {quoted(entry)}; give positions by joint, such as {{finger_joint: 20mm}}"
        )
    joints = read_urdf(urdf).joints
    slides = {name for name, joint in joints.items() if joint.kind == PRISMATIC}
    return {
        str(joint): _number(
            value, f"held position of {clipped(str(joint))}", "m" if joint in slides else "rad"
        )
        for joint, value in entry.items()
    }


def _stated(joints: Mapping[str, UrdfJoint]) -> ByQuantity:
    """The limits of a URDF by quantity and joint, each of the joint that has it.

    Accelerations are kept within the URDF's limits of deceleration as well.
    """
    by_quantity = {
        "torque": {name: joint.effort for name, joint in joints.items()},
        "speed": {name: joint.velocity for name, joint in joints.items()},
        "acceleration": {
            name: min(filter(None, (joint.acceleration, joint.deceleration)), default=0.0)
            for name, joint in joints.items()
        },
        "jerk": {name: joint.jerk for name, joint in joints.items()},
    }
    return {
        quantity: {name: size for name, size in sizes.items() if size > 0}
        for quantity, sizes in by_quantity.items()
    }


def _of_leaders(
    limits: Mapping[str, Mapping[str, float]], followers: Mapping[str, Following]
) -> ByQuantity:
    """Limits of the joints that lead, but of torques: a follower has no motor of its own."""
    bounds = {
        quantity: {name: size for name, size in sizes.items() if name not in followers}
        if quantity == "torque"
        else bounds_of_leaders(sizes, followers)
        for quantity, sizes in limits.items()
    }
    return {quantity: sizes for quantity, sizes in bounds.items() if sizes}


def _limits(given: Mapping[str, Any], folder: Path) -> JointLimits:
    """Limits of driven joints by quantity: the URDF's, or those and what MoveIt's file has."""
    entry = given["limits"]
    if not isinstance(entry, str):
        raise ValueError(
            f"limits is {quoted(entry)}; give a joint_limits.yaml of MoveIt, or {OF_URDF}"
        )
    description = read_urdf(given["urdf"])
    passive = {*given.get("springs", ()), *given.get("held", ())}
    driven = driven_joints(description, given.get("joints", ()), passive)
    followers = {
        name: how
        for name, how in followers_of(description, given.get("held", ())).items()
        if how.leader in driven
    }
    moved = [*driven, *followers]
    stated = {
        quantity: {name: size for name, size in sizes.items() if name in moved}
        for quantity, sizes in _stated(description.joints).items()
    }
    read = JointLimits(stated)
    if entry != OF_URDF:
        path = _beside(entry, folder, "limits")
        read = read_joint_limits(path, description.joints, moved, stated)
    joints = description.joints
    of_urdf = {
        how.leader: (joints[how.leader].lower, joints[how.leader].upper)
        for name, how in followers.items()
        if name in read.positions
    }
    given_ranges = {name: ends for name, ends in read.positions.items() if name not in followers}
    return JointLimits(
        _of_leaders(read.limits, followers),
        ranges_of_leaders(of_urdf | given_ranges, read.positions, followers),
        [*read.notes, *_without_limits(driven, read.limits)],
    )


def _without_limits(driven: Collection[str], limits: ByQuantity) -> Iterator[Note]:
    """Driven joints whose torque or speed nothing limits: a 0 in a URDF stands for no limit."""
    for quantity, entry in (("torque", "effort"), ("speed", "velocity")):
        names = [name for name in driven if name not in limits.get(quantity, {})]
        if names:
            yield Note(
                f"no limit of {quantity} for {listed(names)}: the URDF's {entry} is 0, or missing"
            )


def _beam(entry: Any, what: str) -> Beam:
    units = {
        "length": "m", "width": "m", "height": "m", "youngs_modulus": "Pa", "density": "kg/m^3",
        "tip_mass": "kg", "damping": "-", "mass_per_length": "kg/m", "roll": "rad",
    }  # fmt: skip
    readers: dict[str, Read] = {name: _quantity(unit) for name, unit in units.items()}
    readers |= {
        "at": _name,
        "pieces": lambda value, _: value,
        "bending_stiffness": partial(_several, unit="N m^2"),
        "direction": partial(_several, unit="-"),
        "offset": partial(_several, unit="m"),
    }
    given = _table(entry, what, readers)
    for name in ("at", "length"):
        if name not in given:
            raise ValueError(f"the beam has no {name}; give it, such as {_EXAMPLES[name]}")
    return Beam(**given)


_EXAMPLES = {"at": "at: tool0", "length": "length: 0.8"}


def _base(entry: Any, what: str) -> Base:
    readers: dict[str, Read] = {
        "stiffness": partial(_several, unit="N m/rad"),
        "damping": partial(_several, unit="N m s/rad"),
        "height": _quantity("m"),
    }
    given = _table(entry, what, readers)
    if "stiffness" not in given:
        raise ValueError("the base has no stiffness; give one about x and one about y, in N m/rad")
    return Base(**given)


def _measured(entry: Any, what: str) -> Measured | tuple[Measured, ...]:
    """A frequency that was measured, or a list of them."""
    if not isinstance(entry, list):
        return _measurement(entry, what)
    return tuple(_measurement(one, f"{number} of {what}") for number, one in enumerate(entry, 1))


def _measurement(entry: Any, what: str) -> Measured:
    readers: dict[str, Read] = {
        "frequency": _quantity("rad/s"),
        "at": partial(_several, unit="rad"),
        "mode": lambda value, _: value,
        "damping": _quantity("-"),
        "within": _quantity("-"),
    }
    given = _table(entry, what, readers)
    frequency = entry.get("frequency")
    if isinstance(frequency, int | float):
        raise ValueError(f"{what} frequency is {frequency}; say its unit, such as {frequency:g}Hz")
    if not given.keys() >= {"frequency", "at"} or not isinstance(given["at"], tuple):
        raise ValueError(f"{what} needs a frequency, such as 3.05Hz, and at, the joints' positions")
    return Measured(**given)


def _spring(entry: Any, what: str, kind: str) -> Spring:
    units = {
        "stiffness": STIFFNESS.of(kind),
        "damping": DAMPING.of(kind),
    }
    if not isinstance(entry, dict):
        return Spring(_number(entry, what, units["stiffness"]))
    given = _table(entry, what, {name: _quantity(unit) for name, unit in units.items()})
    if "stiffness" not in given:
        raise ValueError(f"{what} has no stiffness; give it in {units['stiffness']}")
    return Spring(**given)


def _table(entry: Any, what: str, readers: Mapping[str, Read]) -> dict[str, Any]:
    if not isinstance(entry, dict):
        raise ValueError(f"{what} is {quoted(entry)}; give a table of {', '.join(readers)}")
    for name in entry:
        if name not in readers:
            raise ValueError(has_no(what, "entry", str(name), list(readers)))
    return {
        name: readers[name](value, f"{name} of {what}")
        for name, value in entry.items()
        if value is not None
    }


def _sliding(document: Mapping[str, Any], folder: Path) -> set[str]:
    """Names of the joints of the URDF that slide."""
    urdf = read_text(_beside(document["urdf"], folder, "urdf"), "URDF")
    return {name for name, joint in read_urdf(urdf).joints.items() if joint.kind == PRISMATIC}


def _by_joint(entry: Any, what: str, read: ReadOfJoint, sliding: Collection[str]) -> dict[str, Any]:
    if not isinstance(entry, dict):
        raise ValueError(
            f"{what} is {quoted(entry)}; give values by joint, such as {{elbow_joint: 1.0}}"
        )
    return {
        str(joint): read(
            value, f"{what} of {clipped(str(joint))}", LINEAR if joint in sliding else ROTARY
        )
        for joint, value in entry.items()
    }


def _several(entry: Any, what: str, unit: str) -> Any:
    if isinstance(entry, list):
        return tuple(_number(value, what, unit) for value in entry)
    return _number(entry, what, unit)


def _names(entry: Any, what: str) -> tuple[str, ...]:
    if not isinstance(entry, list):
        raise ValueError(f"{what} is {quoted(entry)}; give a list of names")
    return tuple(_name(name, what) for name in entry)


def _name(entry: Any, what: str) -> str:
    if not isinstance(entry, str):
        raise ValueError(f"{what} is {quoted(entry)}; give a name")
    return entry


def _quantity(unit: str) -> Read:
    return lambda entry, what: _number(entry, what, unit)


def _quantity_of(unit: Unit) -> ReadOfJoint:
    """Return the reader of a joint's quantity in the unit of the joint's kind."""
    return lambda entry, what, kind: _number(entry, what, unit.of(kind))


def _number(entry: Any, what: str, unit: str) -> float:
    """A number in SI units, or with another unit."""
    if isinstance(entry, bool) or not isinstance(entry, int | float | str):
        raise ValueError(f"{what} is {quoted(entry)}; give a number in {unit}")
    number = parse_quantity(entry, unit, what) if isinstance(entry, str) else float(entry)
    if not math.isfinite(number):
        raise ValueError(f"{what} is {quoted(entry)}; give a finite number")
    return number


def _beside(entry: Any, folder: Path, what: str) -> Path:
    """A file that is named beside this one, or by its whole name."""
    return folder / _name(entry, what)
