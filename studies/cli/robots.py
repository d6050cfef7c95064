"""A robot as the plant of a command: its path, and the limits of its joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from quietarm.models import GeometricPath, Robot
from quietarm.models.robot.urdf import PRISMATIC
from quietarm.models.units import parse_quantity
from quietarm.ocp import PointToPoint, Uncertainty
from quietarm.ocp.limits import QUANTITIES
from quietarm.studies.cli.quantities import once

if TYPE_CHECKING:
    from quietarm.studies.cli.given import Given

_OTHERS = ("residual_window", "initial", "final", "energy")


def read_robot_task(given: Given, robot: Robot, duration: float) -> PointToPoint:
    """The task of a robot along the path that was typed, within its own limits and those typed."""
    given.refuse(["parameters"], "is not for a robot; change its file")
    path = path_of(given, robot)
    if path is None:
        names = ", ".join(robot.joints)
        raise ValueError(
            f"the robot has no path; give --start and --target, a position of each of {names}, or "
            "--path waypoints.csv"
        )
    plant = robot.along(path)
    limits: dict[str, Any] = {
        QUANTITIES[name].limit: dict(bounds) for name, bounds in robot.limits.items() if bounds
    }
    for quantity in QUANTITIES.values():
        typed = given.read_of_plant(quantity.limit, plant)
        if typed is not None:
            limits[quantity.limit] = typed
    limits["torque_speed"] = given.read_of_plant("torque_speed", plant)
    ranges = once(given.errors, "--error ")
    return PointToPoint(
        plant,
        target=1.0,
        duration=duration,
        **limits,
        **given.pick(*_OTHERS),
        uncertainty=Uncertainty(ranges) if ranges else None,
    )


def path_of(given: Given, robot: Robot) -> GeometricPath | None:
    """Through the points of --path, or straight from --start to --target; None without either."""
    if given.path is not None:
        given.refuse(["start", "target"], "is in the file of --path")
        return GeometricPath.load(given.path)
    if not (given.typed("start") and given.typed("target")):
        return None
    ends = [_positions(given.start, "--start", robot), _positions(given.target, "--target", robot)]
    return GeometricPath.line(*ends, joints=robot.joints)


def _positions(text: str, option: str, robot: Robot) -> list[float]:
    """A position of every joint: ``0,-80deg,97deg``."""
    words = text.split(",")
    if len(words) != len(robot.joints):
        raise ValueError(
            f"{option} has {len(words)} positions, and the robot drives {len(robot.joints)} "
            f"joints, {', '.join(robot.joints)}; give one of each"
        )
    slides = [robot.description.joints[name].kind == PRISMATIC for name in robot.joints]
    return [
        parse_quantity(word, "m" if slide else "rad", f"a position of {name} in {option}")
        for word, slide, name in zip(words, slides, robot.joints)
    ]
