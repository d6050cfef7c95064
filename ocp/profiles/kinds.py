"""Whether a task and a profile are what they should be: asked where every answer begins."""

from __future__ import annotations

from quietarm.ocp.base.checks import of_kind
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.profiles.polynomial import CycloidPolynomial
from quietarm.ocp.task.point_to_point import PointToPoint

_SIX_TERMS = CycloidPolynomial()


def refuse_other_kinds(task: object, profile: object = _SIX_TERMS) -> None:
    """Make sure that these are a task and a profile; ValueError says what to give."""
    of_kind("task", task, PointToPoint, "a PointToPoint")
    of_kind("profile", profile, JointProfile, "a JointProfile, such as CycloidPolynomial(6)")
