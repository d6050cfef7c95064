"""The path of a robot, as a command's line has it."""

from __future__ import annotations

from dataclasses import replace
from math import tau
from typing import TYPE_CHECKING

import numpy as np

from quietarm.models import GeometricPath, Robot, RobotOnPath
from quietarm.models.joint_motion import LINEAR, MIXED, kind_of_joints
from quietarm.models.robot.path.joint_table import read_joint_table
from quietarm.models.robot.path.straight_line import off_straight
from quietarm.models.robot.urdf.read_urdf import PRISMATIC
from quietarm.models.units import is_number, parse_quantity
from quietarm.ocp.checks import listed, positive, quoted
from quietarm.views.report.words import counted

if TYPE_CHECKING:
    from quietarm.studies.cli.given import Given

LINE_NAMES = ("line_to", "line_by", "free_orientation", "link")
"""Options of a straight line in space."""
PATH_NAMES = (*LINE_NAMES, "path_tolerance", "waypoints", "blend")
"""Options of a robot's path alone."""
OF_ROBOT = "is for a robot, whose file is PLANT, such as ur5.yaml"


def needed_path(given: Given, robot: Robot) -> GeometricPath:
    """The path that was typed; ValueError where none was."""
    path = path_of(given, robot)
    if path is None:
        names = listed(robot.joints)
        raise ValueError(
            f"the robot has no path; give --start and --target, a position of each of {names}, or "
            "--path waypoints.csv, or --start and --line-by"
        )
    return path


def path_of(given: Given, robot: Robot) -> GeometricPath | None:
    """Make the path through the points of --path, or from --start straight in joints or space.

    None without any.
    """
    if given.path is not None:
        given.refuse(["start", "target"], "is in the file of --path")
        given.refuse([*LINE_NAMES], "is for a straight line from --start, without --path")
        if given.blend is not None:
            return _blended(given, robot)
        tolerance = _tolerance(given, robot)
        return GeometricPath.load(given.path, within=tolerance, waypoints=_waypoints(given))
    given.refuse(["path_tolerance", "waypoints", "blend"], "is for the waypoints of --path")
    if given.line_to is not None or given.line_by is not None:
        return _line_in_space(given, robot)
    given.refuse(["free_orientation", "link"], "is for --line-to and --line-by")
    if not (given.typed("start") and given.typed("target")):
        return None
    start = positions_typed(given.start, "--start", robot)
    target = positions_typed(given.target, "--target", robot)
    return GeometricPath.line(start, target, joints=robot.joints)


def _waypoints(given: Given) -> tuple[int, int] | None:
    """The first and the last point of --path that were typed."""
    text: str | None = given.waypoints
    if text is None:
        return None
    words = text.split(":")
    if len(words) != 2 or not all(word.strip().isdecimal() for word in words):
        raise ValueError(f"--waypoints is {quoted(text)}; give two numbers, such as 2:4")
    return int(words[0]), int(words[1])


def _blended(given: Given, robot: Robot) -> GeometricPath:
    """Make the path straight between the points of --path, with round corners."""
    given.refuse(["path_tolerance"], "is for a spline, and --blend states how round corners are")
    words = given.blend.split(",")
    radii = [parse_quantity(word, "m", "a radius of --blend") for word in words]
    table = read_joint_table(given.path)
    some = _waypoints(given)
    radius = radii[0] if len(radii) == 1 else radii
    try:
        table = table.between(some)
        first = 1 if some is None else some[0]
        path = GeometricPath.blended(
            robot, table.positions, radius, joints=table.joints, first=first
        )
    except ValueError as error:
        raise ValueError(f"path {given.path}: {error}") from None
    _check_radii(words, radii, robot, path)
    return replace(path, remarks=(*table.remarks, *path.remarks))


def _check_radii(words: list[str], radii: list[float], robot: Robot, path: GeometricPath) -> None:
    """Refuse a radius beyond all of the tip's places: it was meant in another unit."""
    kinematics = robot.kinematics(robot.tip)
    places = np.array([kinematics.pose(q).origin for q in np.array(path.lines)])
    widest = max(float(np.linalg.norm(places - place, axis=1).max()) for place in places)
    for word, radius in zip(words, radii):
        if radius > widest:
            meant = (
                f"were millimetres meant? give {word.strip()}mm" if is_number(word) else "give less"
            )
            raise ValueError(
                f"a radius of --blend is {radius:g} m, and the tip's places at the waypoints are "
                f"at most {widest:.3g} m apart; {meant}"
            )


def _tolerance(given: Given, robot: Robot) -> float | None:
    """Read how far a path may be from the lines between its points [rad or m], if it was typed."""
    text: str | None = given.path_tolerance
    if text is None:
        return None
    kind = kind_of_joints([robot.kind_of(name) for name in robot.joints])
    if kind == MIXED and not is_number(text):
        raise ValueError(
            f"--path-tolerance is {quoted(text)}, and the robot has joints that turn and others "
            "that slide; give a number, in rad for the first and in m for the others"
        )
    unit = "m" if kind == LINEAR else "rad"
    what = "a length" if unit == "m" else "an angle"
    return positive("--path-tolerance", parse_quantity(text, unit, what), unit)


def _line_in_space(given: Given, robot: Robot) -> GeometricPath:
    """Make the line by inverse kinematics from --start to --line-to, or by --line-by."""
    given.refuse(["target"], "is where joints go; a line ends at --line-to or by --line-by")
    if given.line_to is not None:
        given.refuse(["line_by"], "is in place of --line-to")
    if not given.typed("start"):
        raise ValueError(
            f"a line begins somewhere; give --start, a position of each of {listed(robot.joints)}"
        )
    return GeometricPath.cartesian_line(
        robot,
        positions_typed(given.start, "--start", robot),
        to=_numbers(given.line_to, "--line-to", (3, 6), "x,y,z or x,y,z,roll,pitch,yaw"),
        by=_numbers(given.line_by, "--line-by", (3,), "x,y,z"),
        link=given.link,
        turns=not given.free_orientation,
    )


def line_note(given: Given, plant: RobotOnPath) -> str | None:
    """Say how straight the link goes for which a line was typed."""
    if given.line_to is None and given.line_by is None:
        return None
    kinematics = plant.robot.kinematics(given.link)
    off = off_straight(kinematics, plant.path)
    return f"line: {kinematics.link} goes straight within {max(1e3 * off, 1e-9):.1g} mm"


def _numbers(
    text: str | None, option: str, counts: tuple[int, ...], wanted: str
) -> list[float] | None:
    """A place and angles: ``400mm,200mm,0.5,0,pi,0``."""
    if text is None:
        return None
    units = ["m"] * 3 + ["rad"] * 3
    words = text.split(",")
    if len(words) not in counts:
        raise ValueError(f"{option} has {len(words)} numbers; give {wanted}")
    values = [
        parse_quantity(word, unit, f"a number of {option}") for word, unit in zip(words, units)
    ]
    for word, value in list(zip(words, values))[3:]:
        if abs(value) > tau and is_number(word):
            raise ValueError(
                f"{option} turns by {word} rad, more than a turn; were degrees meant? give "
                f"{word.strip()}deg"
            )
    return values


def _following_words(robot: Robot) -> str:
    """Say which joints have no position of their own."""
    names = [f"{name} follows {entry.leader}" for name, entry in robot.followers.items()]
    return f" ({', '.join(names)})" if names else ""


def positions_typed(text: str, option: str, robot: Robot) -> list[float]:
    """A position of every joint: ``0,-80deg,97deg``."""
    words = text.split(",")
    if len(words) != len(robot.joints):
        raise ValueError(
            f"{option} has {len(words)} positions, and the robot drives "
            f"{counted(len(robot.joints), 'joint')}, {listed(robot.joints)}"
            f"{_following_words(robot)}; give one of each"
        )
    slides = [robot.description.joints[name].kind == PRISMATIC for name in robot.joints]
    return [
        parse_quantity(word, "m" if slide else "rad", f"a position of {name} in {option}")
        for word, slide, name in zip(words, slides, robot.joints)
    ]
