"""The plan by a profile without coefficients: its only motion, evaluated."""

from __future__ import annotations

from quietarm.ocp.answers.provenance import SolveSettings
from quietarm.ocp.base.errors import InfeasibleTaskError
from quietarm.ocp.plan.answer import Plan, evaluate_coefficients
from quietarm.ocp.plan.feasibility import UNITS
from quietarm.ocp.plan.verification import OVERRUN
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.program.solution import STILL
from quietarm.ocp.task.point_to_point import PointToPoint


def only_motion(
    task: PointToPoint, profile: JointProfile, residual_limit: float | None = None
) -> Plan:
    """The figures of the only motion that a profile has, within the task's limits."""
    asked = 0.0 if residual_limit is None else residual_limit
    SolveSettings(residual_limit=asked)  # refused before the integration, not after
    plan = evaluate_coefficients(
        task, [], profile=profile, method="evaluated", settings={"residual_limit": asked}
    )
    residual = {} if residual_limit is None else {"residual": max(residual_limit, STILL)}
    limits = {**residual, **task.limits}
    broken = [
        f"its {name} reaches {plan.motion.peak(name):.4g} {UNITS[name]}, above {limits[name]:g}"
        for name in plan.motion.passed(limits, OVERRUN)
    ]
    if broken:
        raise InfeasibleTaskError(
            f"the {profile.label} has one motion for this move, and {'; '.join(broken)}: "
            "widen what is broken, or give a longer duration or another profile"
        )
    return plan
