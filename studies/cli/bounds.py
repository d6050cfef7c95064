"""Limits as they are typed: of one size, of a direction each, and of a drive at each speed."""

from __future__ import annotations

import math
from collections.abc import Callable

from quietarm.ocp.limits import Bounds
from quietarm.studies.cli.quantities import parse_rate, parse_torque

_RPM = "rpm"


def parse_bounds(text: str, parse: Callable[[str], float]) -> Bounds:
    """Read the largest absolute value, ``40``, or the least and the largest one, ``-30:40``."""
    lower, colon, upper = text.partition(":")
    return (parse(lower), parse(upper)) if colon else parse(text)


def parse_torque_speed(text: str) -> tuple[tuple[float, float], ...]:
    """Read what a drive gives, torques at speeds: ``1.5Nm@0,0.8Nm@20`` or ``0.8Nm@190rpm``."""
    points = list[tuple[float, float]]()
    for point in text.split(","):
        torque, at, speed = point.partition("@")
        if not at:
            raise ValueError(
                f"{point!r} is no torque at a speed; give two or more, as 1.5Nm@0,0.8Nm@20 with "
                "speeds in rad/s, or as 190rpm"
            )
        points.append((parse_torque(torque), _speed(speed.strip())))
    return tuple(points)


def _speed(text: str) -> float:
    if text.endswith(_RPM):
        return parse_rate(text.removesuffix(_RPM), order=1) * 2 * math.pi / 60
    return parse_rate(text, order=1)
