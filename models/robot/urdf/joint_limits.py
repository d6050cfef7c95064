"""The limits of MoveIt's and ros2_control's joint_limits.yaml: what is used, and what is named."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from quietarm.models.dimensions import ACCELERATION, EFFORT, JERK, SPEED, Unit
from quietarm.models.joint_motion import LINEAR, ROTARY
from quietarm.models.notes import Note
from quietarm.models.number_checks import (
    clipped,
    finite,
    has_no,
    listed,
    nearest,
    nearest_name,
    quoted,
)
from quietarm.models.robot.text_files import read_yaml
from quietarm.models.robot.urdf.read_urdf import PRISMATIC, UrdfJoint

ByQuantity = dict[str, dict[str, float]]
"""Limits by quantity and joint."""
_KEPT = ("acceleration", "jerk")
"""Limits of the URDF that hold beside those of a file; MoveIt does not read them."""
_ROUNDING = 1e-3
"""By which a range may pass the URDF's [rad or m]: files of limits have fewer digits."""


@dataclass(frozen=True)
class _Bound:
    """Names of a quantity's bounds in files of limits, and in a task.

    `has` says whether `most` is in force; `least`, if it is there, is the bound the other way.
    """

    has: str
    most: str
    quantity: str
    unit: Unit
    least: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the entries."""
        return tuple(filter(None, (self.has, self.most, self.least)))


_BOUNDS = (
    _Bound("has_velocity_limits", "max_velocity", "speed", SPEED, "min_velocity"),
    _Bound("has_acceleration_limits", "max_acceleration", "acceleration", ACCELERATION,
           "min_acceleration"),
    _Bound("has_deceleration_limits", "max_deceleration", "acceleration", ACCELERATION),
    _Bound("has_jerk_limits", "max_jerk", "jerk", JERK, "min_jerk"),
    _Bound("has_effort_limits", "max_effort", "torque", EFFORT, "min_effort"),
)  # fmt: skip
_POSITION = ("has_position_limits", "min_position", "max_position")
_SOFT = ("has_soft_limits", "k_position", "k_velocity", "soft_lower_limit", "soft_upper_limit")
"""How a controller slows a joint down near the ends of its range."""
_OF_CONTROLLERS = (*_SOFT, "angle_wraparound")
"""Entries of a joint that are for the controller, and are named where they are not false."""
_KNOWN = (*(name for bound in _BOUNDS for name in bound.names), *_POSITION, *_OF_CONTROLLERS)
_LIMITS = "joint_limits"
_SCALES = ("default_velocity_scaling_factor", "default_acceleration_scaling_factor")
"""Shares of the limits that MoveIt plans with where a request gives none."""
_BESIDE = (*_SCALES, "cartesian_limits")
"""Entries beside the joints' limits, which are named."""


@dataclass
class JointLimits:
    """Limits by quantity and joint, narrower ranges by joint, and notes on what was passed over."""

    limits: ByQuantity = field(default_factory=dict)
    positions: dict[str, tuple[float, float]] = field(default_factory=dict)
    notes: list[Note] = field(default_factory=list)


def read_joint_limits(
    path: str | Path,
    joints: Mapping[str, UrdfJoint],
    driven: Collection[str],
    of_urdf: Mapping[str, Mapping[str, float]],
) -> JointLimits:
    """The limits of a URDF for the joints that are driven, and in their place those of a file.

    Of acceleration and deceleration the smaller one bounds both, and so with the bounds of two
    directions. Accelerations and jerks of the URDF are kept as well; its speeds and torques are
    replaced, as by MoveIt.

    Raises
    ------
    ValueError
        When an entry is unknown, no number, or a range wider than the URDF's.
    """
    entries, beside = _tables(path)
    read = _Reader({name: joints[name] for name in driven if name in joints})
    for joint, table in entries.items():
        if joint in joints:
            read.joint(joint, table)
    merged: ByQuantity = {quantity: dict(limits) for quantity, limits in of_urdf.items()}
    for quantity, limits in read.limits.items():
        before = merged.setdefault(quantity, {})
        for joint, limit in limits.items():
            kept = before.get(joint, limit) if quantity in _KEPT else limit
            before[joint] = min(limit, kept)
    without = [joint for joint in driven if joint not in entries]
    strangers = [f"{joint}{nearest(joint, without)}" for joint in entries if joint not in joints]
    return JointLimits(merged, read.positions, [*_notes(path, read, strangers, beside)])


def _tables(path: str | Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """The joints' entries, and what stands beside them: within names of nodes, or not."""
    document = read_yaml(path, "limits file")
    while isinstance(document, dict) and _LIMITS not in document and len(document) == 1:
        (inner,) = document.values()
        if (
            not isinstance(inner, dict)
            or _is_of_a_joint(inner)
            or nearest_name(str(next(iter(document))), [_LIMITS])
        ):
            break
        document = inner
    if isinstance(document, dict) and any(map(_is_of_a_joint, document.values())):
        raise ValueError(
            f"limits file {path} begins with {clipped(str(next(iter(document))))}; give "
            f"{_LIMITS}: as its first line, and the joints indented below it"
        )
    if not isinstance(document, dict) or not document:
        raise ValueError(f"limits file {path} has no {_LIMITS}; give a joint_limits.yaml of MoveIt")
    for name in document:
        if name not in (_LIMITS, *_BESIDE):
            raise ValueError(
                f"limits file {path}: "
                + has_no("a joint_limits.yaml", "entry", str(name), [_LIMITS, *_BESIDE])
            )
    by_joint = document.get(_LIMITS)
    if not isinstance(by_joint, dict):
        raise ValueError(
            f"limits file {path} has no {_LIMITS} by joint; give a joint_limits.yaml of MoveIt"
        )
    beside = {name: value for name, value in document.items() if name != _LIMITS}
    return {str(joint): table for joint, table in by_joint.items()}, beside


def _is_of_a_joint(table: Any) -> bool:
    """Return whether something is the table of a joint's limits."""
    return isinstance(table, dict) and not {*_KNOWN}.isdisjoint(map(str, table))


class _Reader:
    """Limits as they are read, joint by joint."""

    def __init__(self, joints: Mapping[str, UrdfJoint]) -> None:
        self._joints = joints
        self.limits: ByQuantity = {}
        self.positions = dict[str, tuple[float, float]]()
        self.unused = list[str]()
        self.of_controllers = list[str]()
        self.smaller = dict[str, list[str]]()

    def joint(self, joint: str, table: Any) -> None:
        """Read the entries of a joint."""
        if not isinstance(table, dict):
            raise ValueError(
                f"limits of {clipped(joint)} are {quoted(table)}; give has_velocity_limits and so "
                "on"
            )
        for name in table:
            if name not in _KNOWN:
                near = nearest_name(str(name), _KNOWN)
                remedy = f"did you mean {near}?" if near else f"give one of {', '.join(_KNOWN)}"
                raise ValueError(f"{clipped(str(name))} of {clipped(joint)} in limits: {remedy}")
        if joint not in self._joints:
            return
        entries = _Entries(joint, self._joints[joint].kind == PRISMATIC, table)
        self._bound(joint, entries)
        self._narrow(joint, entries)
        self.unused += [f"{name} of {joint}" for name in entries.switched_off()]
        self.of_controllers += [
            f"{name} of {joint}" for name in _OF_CONTROLLERS if table.get(name) not in (None, False)
        ]

    def _bound(self, joint: str, entries: _Entries) -> None:
        by_quantity = dict[str, dict[str, float]]()
        for bound in _BOUNDS:
            sizes = entries.sizes(bound)
            by_quantity.setdefault(bound.quantity, {}).update(sizes)
        for quantity, sizes in by_quantity.items():
            if sizes:
                least = min(sizes.values())
                self.limits.setdefault(quantity, {})[joint] = least
                if len(set(sizes.values())) > 1 or list(sizes) == ["max_deceleration"]:
                    names = " and ".join(sizes)
                    self.smaller.setdefault(names, []).append(f"{joint} {least:g}")

    def _narrow(self, joint: str, entries: _Entries) -> None:
        ends = entries.range()
        if ends is None:
            return
        of_urdf = self._joints[joint]
        for name, position, limit, side in (
            ("min_position", ends[0], of_urdf.lower, -1.0),
            ("max_position", ends[1], of_urdf.upper, 1.0),
        ):
            if math.isfinite(position) and side * (position - limit) > _ROUNDING:
                raise ValueError(
                    f"{name} of {joint} in limits is {position:g}, beyond the URDF's {limit:g}; "
                    "a file of limits can narrow a range: leave it out, or widen the URDF's"
                )
        lower = max(ends[0], of_urdf.lower)
        upper = min(ends[1], of_urdf.upper)
        if not lower < upper:
            raise ValueError(
                f"min_position of {joint} in limits is {lower:g} and max_position {upper:g}; give "
                "a range"
            )
        if lower > of_urdf.lower + _ROUNDING or upper < of_urdf.upper - _ROUNDING:
            self.positions[joint] = (lower, upper)


@dataclass(frozen=True)
class _Entries:
    """The entries of a joint in a file of limits."""

    joint: str
    slides: bool
    table: Mapping[str, Any]

    def sizes(self, bound: _Bound) -> dict[str, float]:
        """Sizes of a quantity's bounds that are in force, by their names."""
        if not self.applies(bound.has, bound.most):
            return {}
        unit = bound.unit.of(LINEAR if self.slides else ROTARY)
        most = self.number(bound.most, unit)
        if bound.most == "max_deceleration":  # MoveIt's are negative
            most = abs(most)
        if not most > 0:
            raise ValueError(
                f"{bound.most} of {self.joint} in limits is {most:g} {unit}; give a positive number"
            )
        sizes = {bound.most: most}
        if bound.least and self.table.get(bound.least) is not None:
            least = self.number(bound.least, unit)
            if not least < 0:
                raise ValueError(
                    f"{bound.least} of {self.joint} in limits is {least:g} {unit}; give a negative "
                    "number"
                )
            sizes[bound.least] = -least
        return sizes

    def range(self) -> tuple[float, float] | None:
        """Least and largest position that are in force, infinite where one is not there."""
        ends = [name for name in _POSITION[1:] if self.table.get(name) is not None]
        if not self.applies(_POSITION[0], *ends):
            return None
        unit = "m" if self.slides else "rad"
        if not ends:
            raise ValueError(
                f"has_position_limits of {self.joint} in limits is true; give min_position and "
                "max_position"
            )
        lower = self.number("min_position", unit) if "min_position" in ends else -math.inf
        upper = self.number("max_position", unit) if "max_position" in ends else math.inf
        return lower, upper

    def applies(self, has: str, *names: str) -> bool:
        """Return whether bounds are in force; if nothing says so, whether they are there."""
        stated = self.table.get(has)
        if stated is None:
            return any(self.table.get(name) is not None for name in names)
        if not isinstance(stated, bool):
            raise ValueError(
                f"{has} of {self.joint} in limits is {quoted(stated)}; give true or false"
            )
        return stated

    def switched_off(self) -> list[str]:
        """Bounds that are there and not in force; 0 is what MoveIt writes for none."""
        switches = {bound.has: bound.names[1:] for bound in _BOUNDS} | {_POSITION[0]: _POSITION[1:]}
        return [
            name
            for has, names in switches.items()
            if not self.applies(has, *names)
            for name in names
            if self.table.get(name)
        ]

    def number(self, name: str, unit: str) -> float:
        """A number of the table."""
        return finite(f"{name} of {self.joint} in limits", self.table.get(name), unit)


def _notes(
    path: str | Path, read: _Reader, strangers: list[str], beside: Mapping[str, Any]
) -> list[Note]:
    """Say in one line each which entries of a file are not used as they stand."""
    notes = list[str]()
    if strangers:
        notes.append(f"limits of joints that the URDF does not have: {listed(strangers)}")
    for names, joints in read.smaller.items():
        which = f"the smaller of {names}" if " and " in names else names
        notes.append(f"{which} bounds both directions: {listed(joints)}")
    if read.unused:
        notes.append(f"not used, as has_..._limits is false: {listed(read.unused)}")
    if read.of_controllers:
        notes.append(f"not used, as it is for controllers: {listed(read.of_controllers)}")
    scales = [f"{name} {quoted(beside[name])}" for name in _SCALES if beside.get(name, 1) != 1]
    others = [name for name in _BESIDE if name in beside and name not in _SCALES]
    if scales or others:
        notes.append(f"not used, limits are kept in full: {listed([*scales, *others])}")
    return [Note(f"limits file {Path(path).name}: {words}") for words in notes]
