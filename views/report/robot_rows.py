"""A robot in rows of a name and a value: what was read, and how it swings along a path."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import tau

import numpy as np
from numpy.typing import NDArray

from quietarm.models import Beam, GeometricPath, Robot
from quietarm.models.dimensions import DAMPING, EFFORT, INERTIA, STIFFNESS, WAY, Unit, words_of
from quietarm.models.joint_motion import kind_of_joints
from quietarm.models.robot.dynamics.modes import modes_at, sag_at
from quietarm.models.robot.on_path.path_tables import modes_on, swings_of
from quietarm.models.robot.on_path.reduction import MIDDLE
from quietarm.models.robot.urdf.read_urdf import PRISMATIC
from quietarm.ocp.limits import QUANTITIES
from quietarm.views.report.words import counted

Row = tuple[str, str]
WARNING = "warning"
"""The name of a row with a note on the robot."""
_PLACES = (0.0, 0.5, 1.0)
"""Of a path, at which modes and sag are shown."""
_PLACE_NAMES = ("at the start", "halfway", "at the end")
_STRAIGHT = 1e-6
"""By which a spline leaves straight lines [rad or m]; less is rounding."""
_MORE = 2
"""Modes that are shown beyond those that are followed."""


def robot_rows(robot: Robot, path: GeometricPath) -> list[Row]:
    """Bodies, joints, what bends, limits; modes and sag at the ends and in the middle of a path."""
    return [
        *_mass_rows(robot),
        *_joint_rows(robot),
        *_spring_rows(robot),
        *_limit_rows(robot),
        *((WARNING, note.words) for note in robot.notes),
        *_path_rows(robot, path),
    ]


def robot_words(robot: Robot, path: GeometricPath, way: str = "the path") -> str:
    """Return the answer in a sentence: how a robot swings along a path, and how far it sags."""
    numbers = modes_on(robot, path)
    places = _places(robot, path)
    hertz = np.array([place.frequencies[list(numbers)] for place in places]) / tau
    sag = 1e3 * max(place.sag for place in places)
    return (
        f"{robot.description.name}, {counted(len(robot.joints), 'driven joint')}: along {way} it "
        f"swings at {hertz.min():.3g} to {hertz.max():.3g} Hz, and sags by up to "
        f"{sag:.3g} mm"
    )


def usual_path(robot: Robot) -> GeometricPath:
    """Return a straight path: all joints by a radian or as far as they go, from 0 or their end."""
    least, most = np.array(robot.ranges()).T
    start = np.clip(np.zeros(len(robot.joints)), least, most)
    up = np.minimum(start + 1.0, most)
    down = np.maximum(start - 1.0, least)
    end = np.where(up - start >= start - down, up, down)
    return GeometricPath.line(start, end, joints=robot.joints)


def _mass_rows(robot: Robot) -> list[Row]:
    links = {name: link.mass for name, link in robot.description.links.items() if link.mass > 0}
    words = ", ".join(f"{name} {mass:.4g}" for name, mass in links.items())
    listed = f"{sum(links.values()):.5g} of the URDF: {words}" if links else "none in the URDF"
    rows = [("masses [kg]", listed)]
    beam = robot.beam
    if beam is not None:
        mass = beam.line_mass * beam.length
        along_x, along_y = (beam.frequencies(along)[0] / tau for along in (0, 1))
        rows.append(
            (
                "beam",
                f"{beam.length:g} m at {beam.at}{_place_words(beam)}, {mass:.4g} kg and "
                f"{beam.tip_mass:.4g} kg at its end, {counted(beam.count, 'hinge')} in each "
                f"direction; clamped, without gravity, it swings "
                f"at {along_x:.4g} Hz along x and {along_y:.4g} Hz along y, with a damping of "
                f"{100 * beam.damping:.4g} %",
            )
        )
    return rows


def _place_words(beam: Beam) -> str:
    """Say where a beam is clamped and lies, unless along z from the link's origin."""
    words = ""
    if any(beam.offset):
        words += f" [{', '.join(f'{value:g}' for value in beam.offset)}] m"
    if beam.direction != (0.0, 0.0, 1.0):
        words += f" along [{', '.join(f'{value:g}' for value in beam.direction)}]"
    if beam.roll:
        words += f", turned by {beam.roll:.4g} rad about itself"
    return words


def _joint_rows(robot: Robot) -> list[Row]:
    rows = [("driven", ", ".join(robot.joints))]
    others = [
        name
        for name in robot.description.moving
        if name not in (*robot.joints, *robot.springs, *robot.followers)
    ]
    if robot.followers:
        following = (
            f"{name} = {entry.multiplier:.4g} {entry.leader}"
            f"{f' {entry.offset:+.4g}' if entry.offset else ''}"
            for name, entry in robot.followers.items()
        )
        rows.append(("following", ", ".join(following)))
    if others:
        positions = (f"{name} at {robot.held_position(name):.4g}" for name in others)
        rows.append(("held", ", ".join(positions)))
    for entry, unit, of_urdf in (
        ("rotor_inertia", INERTIA, ""),
        ("friction", DAMPING, "damping"),
        ("coulomb", EFFORT, "friction"),
    ):
        rows.append((entry.replace("_", " "), _by_joint(robot, entry, unit, of_urdf)))
    return rows


def _by_joint(robot: Robot, entry: str, unit: Unit, of_urdf: str) -> str:
    """Values by joint, and whether they are the URDF's."""
    values = getattr(robot, entry)
    if not values:
        return "none: give it, as the URDF has none"
    joints = robot.description.joints
    taken = [bool(of_urdf) and getattr(joints[name], of_urdf) == values[name] for name in values]
    origin = f" (the URDF's {of_urdf})" if all(taken) else ""
    return f"{_with_units(robot, values, unit)}{origin}"


def _spring_rows(robot: Robot) -> list[Row]:
    springs = {
        **{f"gear of {name}": spring for name, spring in robot.elastic_joints.items()},
        **robot.springs,
    }
    joints = [*robot.elastic_joints, *robot.springs]
    rows = [
        (
            name,
            f"{spring.stiffness:.5g} {STIFFNESS.of(robot.kind_of(joint))}, "
            f"{spring.damping:.4g} {DAMPING.of(robot.kind_of(joint))}",
        )
        for joint, (name, spring) in zip(joints, springs.items())
    ]
    if robot.base is not None:
        stiffness = " and ".join(f"{value:.5g}" for value in robot.base.stiffness)
        rows.append(
            ("base", f"{stiffness} N m/rad, {robot.base.height:g} m below {robot.description.root}")
        )
    return [*rows, *_measured_rows(robot)]


def _measured_rows(robot: Robot) -> list[Row]:
    """Springs, and the load, as measured frequencies tell them, and how far these are met."""
    measured, fit = robot.measurements, robot.fit
    if fit is None:
        return []
    springs = f"springs {fit.stiffness:.4g} times as stiff (+-{100 * fit.unsure[0]:.2g} %)"
    if len(measured) == 1:
        return [("measured", f"{springs}, scaled to {measured[0].frequency / tau:.5g} Hz")]
    load = "; the load as stated: these frequencies do not tell it from the springs"
    if fit.tells_payload:
        unsure = f"{100 * fit.unsure[1]:.2g} %"
        load = f", {robot.payload:.4g} kg at the end of the beam (+-{unsure})"
    elif not robot.payload:
        load = ""
    left = ", ".join(
        f"{one.frequency / tau:.4g} Hz {100 * misfit:+.2g} %"
        for one, misfit in zip(measured, fit.misfits)
    )
    return [("measured", f"{springs}{load}; misfit {left}")]


def _limit_rows(robot: Robot) -> list[Row]:
    ranges = [
        f"{name} {lower:.4g} to {upper:.4g} {WAY.of(robot.kind_of(name))}"
        for name, (lower, upper) in robot.positions.items()
    ]
    rows = [("narrower range", ", ".join(ranges))] if ranges else []
    if not robot.limits:
        return [*rows, ("limits", "none: give limits, urdf or a joint_limits.yaml")]
    for quantity, limits in robot.limits.items():
        kind = kind_of_joints([robot.kind_of(name) for name in limits])
        label = words_of(quantity).within("{} limit").of(kind)
        free = free_joints_words(robot.joints, limits)
        rows.append((label, f"{_with_units(robot, limits, QUANTITIES[quantity].unit)}{free}"))
    return rows


def free_joints_words(joints: Sequence[str], limited: Collection[str]) -> str:
    """Name the joints that limits of some joints leave free; nothing if they leave none."""
    free = [joint for joint in joints if limited and joint not in limited]
    return f" (none for {', '.join(free)})" if free else ""


def _with_units(robot: Robot, values: Mapping[str, float], unit: Unit) -> str:
    """Values of joints with their units: x 900 N, elbow 60 N m."""
    by_unit = dict[str, list[str]]()
    for name, value in values.items():
        own = unit.of(robot.kind_of(name))
        by_unit.setdefault(own, []).append(f"{name} {value:.4g}")
    return "; ".join(f"{', '.join(listed)} {own}" for own, listed in by_unit.items())


def _path_rows(robot: Robot, path: GeometricPath) -> list[Row]:
    """Modes and sag along a path, in the words of its ends."""
    slides = [robot.description.joints[name].kind == PRISMATIC for name in robot.joints]
    numbers = modes_on(robot, path)
    rows = list[Row]()
    for name, place in zip(_PLACE_NAMES, _places(robot, path)):
        seen = place.frequencies[: max(numbers) + 1 + _MORE]
        hertz = [f"{value / tau:.3g}" for value in seen]
        followed = ", ".join(hertz[number] for number in numbers)
        others = [value for number, value in enumerate(hertz) if number not in numbers]
        left = f" (left out: {', '.join(others)} ...)" if others else ""
        positions = ", ".join(
            f"{round(x, 9) + 0.0:.4g}m" if slide else f"{round(np.degrees(x), 6) + 0.0:.4g}deg"
            for x, slide in zip(place.positions, slides)
        )
        sag = 1e3 * place.sag
        rows.append((name, f"modes {followed} Hz{left}, sag {sag:.3g} mm, at {positions}"))
    return [*way_rows(robot, path), *rows, *_left_out_rows(robot, path, numbers)]


@dataclass(frozen=True)
class _Place:
    """A place of a path: positions of the joints, all frequencies [rad/s], and the sag [m]."""

    positions: NDArray[np.float64]
    frequencies: NDArray[np.float64]
    sag: float


def _places(robot: Robot, path: GeometricPath) -> list[_Place]:
    """Return the ends and the middle of a path."""
    places = list[_Place]()
    for at in _PLACES:
        q = path(at)
        frequencies, _ = modes_at(robot.dynamics, q, sag_at(robot.dynamics, q))
        places.append(_Place(q, frequencies, float(np.linalg.norm(robot.sag(q)))))
    return places


def way_rows(robot: Robot, path: GeometricPath) -> list[Row]:
    """Describe a robot's path: what else its file had, and how far its spline swings out."""
    words = [*path.remarks, *_off_straight_words(robot, path)]
    return [("path", "; ".join(words))] if words else []


def _off_straight_words(robot: Robot, path: GeometricPath) -> list[str]:
    """Say how far a path is from the straight lines between waypoints, if it is."""
    units = [WAY.of(robot.kind_of(name)) for name in robot.joints]
    off = sorted(zip(path.off_straight.tolist(), units, robot.joints), reverse=True)
    seen = [(size, unit, name) for size, unit, name in off if size > _STRAIGHT]
    if not seen:
        return []
    (size, unit, name), *others = seen
    less = ", ".join(f"{other} {smaller:.2g} {own}" for smaller, own, other in others)
    what = "path" if path.lines else "spline"
    return [
        f"the {what} is up to {size:.2g} {unit} from the straight lines between waypoints, at "
        f"{name}{f' ({less})' if less else ''}, and the tip "
        f"{1e3 * robot.off_straight(path):.2g} mm"
    ]


def _left_out_rows(robot: Robot, path: GeometricPath, numbers: Sequence[int]) -> list[Row]:
    """Say what modes that are not followed leave after a plain cycloid, the largest first."""
    swings = [swing for swing in swings_of(robot, path) if swing.number not in numbers]
    swings = sorted(swings, key=lambda swing: -swing.leaves)[:_MORE]
    if not swings:
        return []
    duration = 2 * tau / robot.frequencies(path(MIDDLE))[0]
    words = ", ".join(
        f"{swing.frequency / tau:.3g} Hz {1e3 * swing.leaves:.2g} mm" for swing in swings
    )
    return [
        (
            "left out",
            f"leave after a plain cycloid of {duration:.3g} s at most {words}; "
            "follow them by more modes, or by modes: excited",
        )
    ]
