"""Notes about gaps and errors of a robot's URDF and what was taken instead, one line each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from quietarm.models.dimensions import ACCELERATION, EFFORT, JERK, SPEED
from quietarm.models.notes import Note
from quietarm.models.number_checks import quoted
from quietarm.models.robot.dynamics.measured_fit import MeasuredFit
from quietarm.models.robot.dynamics.robot_parts import Limits, RobotParts
from quietarm.models.robot.urdf.following import (
    held_position,
    limits_with_followers,
    mimics_nothing,
)
from quietarm.models.robot.urdf.read_urdf import PRISMATIC, Urdf
from quietarm.models.robot.urdf.urdf_text import passed_over

_MOST_NAMES = 5
"""Of links or joints that a note names."""
_MOST_DAMPING = 0.1
"""A ratio beyond which it is in per cent, most likely: a bar of metal has less than 0.01."""
_STIFFEST = 2.0
"""So many times stiffer, or softer, may springs be than in a file without a word."""

_TIMES_THE_URDFS = 3.0
"""A limit that is so many times the URDF's own is in another unit, most likely."""
_OF_LIMIT = {
    "torque": ("effort", EFFORT),
    "speed": ("velocity", SPEED),
    "acceleration": ("acceleration", ACCELERATION),
    "jerk": ("jerk", JERK),
}
"""Entries of the URDF, and units, by quantity."""


def notes_of(robot: RobotParts) -> tuple[Note, ...]:
    """Return all notes that follow from what a robot is made of."""
    return (
        *_without_masses(robot),
        *_faulty_inertias(robot.description),
        *_millimetres(robot.description),
        *_own_friction(robot),
        *_damping_of_passive_joints(robot),
        *_held_followers(robot),
        *_without_leader(robot.description),
        *_without_ranges(robot),
        *_decelerations(robot),
        *_much_damping(robot),
        *_material(robot),
        *(Note(words) for words in far_above_urdf(robot, robot.limits)),
    )


def notes_of_fit(fit: MeasuredFit | None) -> tuple[Note, ...]:
    """Return the note on springs that measured frequencies make far stiffer, or far softer."""
    if fit is None or 1 / _STIFFEST <= fit.stiffness <= _STIFFEST:
        return ()
    return (
        Note(
            f"what was measured makes the springs {fit.stiffness:.4g} times as stiff as in the "
            "robot's file; check the frequency, its mode and its posture, or the springs"
        ),
    )


def notes_of_text(urdf: str) -> tuple[Note, ...]:
    """Return the note on what a URDF has and is not read; none of one that is filtered already."""
    names = passed_over(urdf)
    if not names:
        return ()
    return (Note(f"not read of the URDF: {first_of(names)}"),)


def first_of(names: Sequence[str]) -> str:
    """The first names, and how many more there are."""
    shown = ", ".join(names[:_MOST_NAMES])
    more = len(names) - _MOST_NAMES
    return f"{shown} and {more} more" if more > 0 else shown


def _without_masses(robot: RobotParts) -> Iterator[Note]:
    """Note that the motors of a robot move no mass of its URDF."""
    urdf = robot.description
    moved = set[str]()
    for joint in urdf.outwards():
        if joint.name in robot.joints or joint.parent in moved:
            moved.add(joint.child)
    if any(urdf.links[name].mass > 0 for name in moved):
        return
    if robot.base is None and not robot.elastic_joints and not robot.springs:
        yield Note(
            "the URDF has no masses of moving links: energy and torque are of the beam alone, and "
            "only the residual holds; give links their inertial elements",
            ("energy", "torque"),
        )
        return
    yield Note(
        "the URDF has no masses of moving links: energy, torque and residual leave them out; give "
        "links their inertial elements",
        ("energy", "torque", "residual"),
    )


def _faulty_inertias(urdf: Urdf) -> Iterator[Note]:
    faults = {name: link.fault for name, link in urdf.links.items() if link.fault}
    if faults:
        name, fault = next(iter(faults.items()))
        others = first_of([f"{other!r}" for other in list(faults)[1:]])
        also = f" (so have {others})" if others else ""
        yield Note(f"link {quoted(name)} of the URDF has {fault}, which no body has{also}; mend it")


def _millimetres(urdf: Urdf) -> Iterator[Note]:
    if urdf.hint_of_size:
        yield Note(urdf.hint_of_size)


def _own_friction(robot: RobotParts) -> Iterator[Note]:
    """Note joints in which the robot's friction stands in place of the URDF's."""
    joints = robot.description.joints
    for entry, of_urdf, unit, unit_of_sliding in (
        ("friction", "damping", "N m s/rad", "N s/m"),
        ("coulomb", "friction", "N m", "N"),
    ):
        given: Mapping[str, float] = getattr(robot, entry)
        differing = [
            f"{name} {value:.4g} (URDF {getattr(joints[name], of_urdf):.4g}) "
            f"{unit_of_sliding if joints[name].kind == PRISMATIC else unit}"
            for name, value in given.items()
            if 0 != getattr(joints[name], of_urdf) != value
        ]
        if differing:
            yield Note(f"{entry} as given in place of the URDF's {of_urdf}: {first_of(differing)}")


def _damping_of_passive_joints(robot: RobotParts) -> Iterator[Note]:
    joints = robot.description.joints
    left_out = [
        name
        for name, spring in robot.springs.items()
        if joints[name].friction > 0 or joints[name].damping not in (0.0, spring.damping)
    ]
    if left_out:
        yield Note(
            f"dynamics of {first_of(left_out)} in the URDF are not used: joints with springs have "
            "the damping that springs gives"
        )


def _held_followers(robot: RobotParts) -> Iterator[Note]:
    """Joints that are held elsewhere than where the URDF has them follow another."""
    for name, position in robot.held.items():
        mimic = robot.description.joints[name].mimics
        if mimic is None:
            continue
        others = {other: at for other, at in robot.held.items() if other != name}
        moves = mimic.joint in (*robot.joints, *robot.springs, *robot.followers)
        if moves or abs(held_position(robot.description, name, others) - position) > 1e-9:
            yield Note(
                f"{name} is held at {position:.4g}, where the URDF has it mimic {mimic.joint}; "
                "leave it out of held and it follows"
            )


def _without_leader(urdf: Urdf) -> Iterator[Note]:
    """Joints that mimic what the URDF does not have."""
    missing = [name for name in urdf.joints if mimics_nothing(urdf, name)]
    if missing:
        names = first_of([f"{name} {mimics_nothing(urdf, name)}" for name in missing])
        yield Note(f"joints of the URDF are held, as it does not have what they mimic: {names}")


def _without_ranges(robot: RobotParts) -> Iterator[Note]:
    """Driven joints that end nowhere, although the URDF does not call them continuous."""
    joints = robot.description.joints
    names = [name for name in robot.joints if not joints[name].continuous and joints[name].endless]
    if names:
        yield Note(f"the URDF has neither lower nor upper of {first_of(names)}: taken as endless")


def _decelerations(robot: RobotParts) -> Iterator[Note]:
    """Limits of the acceleration that are the URDF's smaller ones of the deceleration."""
    urdf = robot.description
    accelerations = limits_with_followers(urdf, "acceleration", robot.held)
    decelerations = limits_with_followers(urdf, "deceleration", robot.held)
    limits = robot.limits.get("acceleration", {})
    taken = [
        f"{name} {limit:.4g}"
        for name, limit in limits.items()
        if limit == decelerations.get(name) and limit < accelerations.get(name, np.inf)
    ]
    if taken:
        yield Note(
            "the URDF's limits of deceleration are smaller, and are kept while joints speed up as "
            f"well: {first_of(taken)}"
        )


def _much_damping(robot: RobotParts) -> Iterator[Note]:
    """Damping ratios that are in per cent, most likely."""
    ratios = {} if robot.beam is None else {"damping of the beam": robot.beam.damping}
    for number, one in enumerate(robot.measurements, 1):
        which = "measured" if len(robot.measurements) == 1 else f"{number} of measured"
        ratios[f"damping of {which}"] = one.damping or 0.0
    for what, ratio in ratios.items():
        if ratio > _MOST_DAMPING:
            yield Note(
                f"{what} is {100 * ratio:.4g} %, which is much; was {ratio:.4g} % meant? give "
                f"{ratio:.4g}%"
            )


def _material(robot: RobotParts) -> Iterator[Note]:
    if robot.beam is not None and robot.beam.hint_of_material:
        yield Note(robot.beam.hint_of_material)


def far_above_urdf(robot: RobotParts, limits: Limits) -> Iterator[str]:
    """Words on limits that are several times the URDF's own, in degrees most likely."""
    urdf = robot.description
    for quantity, (entry, unit) in _OF_LIMIT.items():
        of_urdf = limits_with_followers(urdf, entry, robot.held)
        if quantity == "torque":  # a follower has no motor of its own
            of_urdf = {name: joint.effort for name, joint in urdf.joints.items()}
        far = {
            name: size
            for name, size in limits.get(quantity, {}).items()
            if 0 < _TIMES_THE_URDFS * of_urdf.get(name, 0.0) < size
        }
        if not far:
            continue
        units = {name: unit.of(robot.kind_of(name)) for name in far}
        listed = [
            f"{name} {size:.4g} {units[name]} (URDF {of_urdf[name]:.4g})"
            for name, size in far.items()
        ]
        name, size = next(iter(far.items()))
        yield (
            f"{quantity} limit far above the URDF's: {first_of(listed)}; "
            f"{_unit_meant(quantity, size, units[name])}"
        )


def _unit_meant(quantity: str, size: float, unit: str) -> str:
    """Ask which unit was meant, with the limit in that of the URDF."""
    if quantity == "torque":
        return "is it right?"
    if unit.startswith("rad"):
        in_degrees = f"{size:.4g} {unit.replace('rad', 'deg', 1)}"
        return f"were degrees meant? {in_degrees} are {np.deg2rad(size):.4g} {unit}"
    return f"were millimetres meant? {size:.4g} m{unit} are {1e-3 * size:.4g} {unit}"
