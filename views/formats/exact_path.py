"""The joints' path as a function, for formats that give it at any time, and words on the plan."""

from __future__ import annotations

import casadi as ca

from quietarm.models import Plant
from quietarm.models.joint_motion import JointMotion
from quietarm.ocp import Plan
from quietarm.ocp.joint_words import further_words
from quietarm.ocp.limits import EXPORT
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.views.report.words import limit_words, move_of, moved, window_words
from quietarm.views.tips import tip_words


def path_function(profile: JointProfile, plant: Plant) -> ca.Function:
    """Return the joints' positions, then speeds, then accelerations, as a function of scalars.

    Its arguments are the share of the duration, the coefficients, and start, target and duration.
    """
    fraction = ca.SX.sym("t")
    a = ca.SX.sym("a", profile.size)
    move = ca.SX.sym("move", 3)
    path = profile.motion(ca.vertsplit(a), fraction, *ca.vertsplit(move), jerk=False)
    motions = plant.joints(path)
    orders = zip(*((joint.angle, joint.speed, joint.acceleration) for joint in motions))
    results = ca.densify(ca.vertcat(*(value for order in orders for value in order)))
    return ca.Function("path", [fraction, a, move], [results], {"cse": True})


def positions_at(plant: Plant, place: float) -> list[float]:
    """Return where the joints rest at a place of the path."""
    return [float(joint.angle) for joint in plant.joints(JointMotion(place, 0.0, 0.0))]


def title_of(plan: Plan) -> str:
    """Say what moves and where, for the first line of a source."""
    return f"{moved(plan.task)}, {move_of(plan.task)}"


def figures_of(plan: Plan, through_drive: bool = False) -> str:
    """Energy, residual, further figures and limits of a plan, in a line of a source."""
    task = plan.task
    residual = tip_words(plan.residual, task.plant.tip_unit)
    figures = f"Energy {plan.energy:.4g} J, residual {residual} "
    figures += window_words(task.residual_window)
    words = [figures, *further_words(plan.candidate, EXPORT), *limit_words(task)]
    if plan.candidate.inverts_drive and not through_drive:
        words.append("the path of the load, without the drive")
    return ", ".join(words)
