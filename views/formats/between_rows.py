"""What a controller leaves that interpolates between the rows or points of an exported move."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from quietarm.models import Expression, JointMotion
from quietarm.models.dimensions import ANGLE
from quietarm.ocp import JudgedMotion, Plan
from quietarm.ocp.profiles.free_motion import PiecewiseMotion
from quietarm.ocp.solvers.problem import MOST_SOLVER_STEPS
from quietarm.views.formats.move_tables import columns_of, times_of
from quietarm.views.tips import tip_words

Array = NDArray[np.float64]
OF_POINTS = ("angle", "speed", "acceleration")
"""What a point of ROS 2 has; its controller then takes a quintic between two of them."""
_BETWEEN = {
    1: "a cubic spline of the {}",
    2: "cubics of {} and speed",
    3: "quintics of {}, speed and acceleration",
}
"""How it is interpolated, by how many of `OF_POINTS` there are."""
_TOLD = 1e-3
"""Share of the largest deflection on the way: so much more than the plan's residual is told."""


def note_of_rows(plan: Plan, columns: str, rate: float) -> str:
    """`interpolation_note` of the columns of a table, as typed."""
    return interpolation_note(plan, rate, tuple(columns_of(columns, plan.task.plant)))


def interpolation_note(plan: Plan, rate: float, columns: Sequence[str] = OF_POINTS) -> str:
    """What is left at a rate [Hz] that is too coarse, and a rate that does; else nothing.

    Points as close as the solver's smallest steps are never too coarse, and not looked at.

    Parameters
    ----------
    plan : Plan
        The move.
    rate : float
        Rows or points in a second [Hz].
    columns : sequence of str
        What a row has, by the names of a table.
    """
    derivatives = 0
    while derivatives < len(OF_POINTS) and OF_POINTS[derivatives] in columns:
        derivatives += 1
    if derivatives == 0:
        return ""
    wanted = max(plan.residual, plan.residual_limit or 0.0)
    most = wanted + _TOLD * plan.motion.peak_deflection
    note = ""
    plant = plan.task.plant
    while rate * plan.task.duration < MOST_SOLVER_STEPS:
        residual = residual_between(plan, rate, derivatives)
        words = tip_words(residual, plant.tip_unit)
        if residual <= most:
            return note and f"{note}; --rate {rate:g} leaves {words}"
        between = _BETWEEN[derivatives].format(ANGLE.of(plant.joint))
        coarse = f"{rate:g} Hz is coarse: a controller that interpolates by {between} leaves"
        note = note or f"{coarse} {words}"
        rate *= 2
    return note and f"{note}; export .c, which is exact at any time"


def residual_between(plan: Plan, rate: float, derivatives: int) -> float:
    """The residual of a motion interpolated between points of a plan, by CVODES [m].

    Of several joints the place on their path is interpolated: on a straight path as the joints are.

    Parameters
    ----------
    plan : Plan
        The move.
    rate : float
        Points in a second [Hz]; the last is the first at or after arrival.
    derivatives : int
        How many of angle, speed and acceleration the points have: a clamped cubic spline goes
        through angles alone; else the pieces are Hermite's, of third and fifth degree.
    """
    return residual_at(plan, times_of(plan, rate), derivatives)


def residual_at(plan: Plan, times: Array, derivatives: int) -> float:
    """The same between points at these times, from 0 to the end of the move or later."""
    from scipy.interpolate import BPoly, CubicSpline, PPoly  # slow to load

    along = plan.sampled(times).sample.path
    joint = np.column_stack(along[:derivatives])
    if derivatives == 1:
        pieces = CubicSpline(times, joint[:, 0], bc_type="clamped")
    else:
        pieces = PPoly.from_bernstein_basis(BPoly.from_derivatives(times, joint))
    table = np.vstack([pieces.c, np.diff(times)])
    remedy = "; give a higher --rate"
    path = PiecewiseMotion(_polynomial, table, derivatives == len(OF_POINTS), False, remedy)
    task = replace(plan.task, duration=float(times[-1]))
    return JudgedMotion(task, path).residual


def _polynomial(given: Sequence[Expression], fraction: Expression, *, jerk: bool) -> JointMotion:
    """The law of a piece: a polynomial of the time, its highest power first, then its length."""
    del jerk  # it costs nothing
    *coefficients, length = given
    time = fraction * length
    motion: list[Expression] = []
    while len(motion) < len(JointMotion._fields):
        value = 0 * time
        for coefficient in coefficients:  # Horner's rule
            value = value * time + coefficient
        motion.append(value)
        degree = len(coefficients) - 1
        coefficients = [
            (degree - place) * coefficient for place, coefficient in enumerate(coefficients[:-1])
        ]
    return JointMotion(*motion)
