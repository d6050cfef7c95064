"""Moves to plan: the paper's six conditions, and some of our own."""

from __future__ import annotations

from math import pi

from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import PointToPoint


def conditions() -> dict[str, tuple[PointToPoint, float | None]]:
    """The paper's six, in its boxes, and four of our own, by name: task and bound."""
    link, arm = SingleLinkManipulator(), ArmOnFlexibleLink()
    return {
        "link, 0 to pi/6, 0.8 s": (PointToPoint(link, pi / 6, 0.8), 0.2),
        "link, 0 to pi/2, 1.0 s": (PointToPoint(link, pi / 2, 1.0), 0.2),
        "link, 0 to pi/2, 1.1 s": (PointToPoint(link, pi / 2, 1.1), 0.2),
        "arm, 0 to pi/2, 0.8 s": (PointToPoint(arm, pi / 2, 0.8), 0.5),
        "arm, -pi/2 to pi/4, 1.0 s": (PointToPoint(arm, pi / 4, 1.0, -pi / 2), 0.5),
        "arm, -pi/2 to pi/2, 1.2 s": (PointToPoint(arm, pi / 2, 1.2, -pi / 2), 0.5),
        "link, 0 to pi/4, 0.9 s, no box": (PointToPoint(link, pi / 4, 0.9), None),
        "link, 0 to 1, 1.0 s, no box": (PointToPoint(link, 1.0, 1.0), None),
        "arm, 0 to pi/2, 0.8 s, no box": (PointToPoint(arm, pi / 2, 0.8), None),
        "arm, 0 to 1, 0.7 s, 0.5 N m": (PointToPoint(arm, 1.0, 0.7, torque_limit=0.5), 0.5),
    }
