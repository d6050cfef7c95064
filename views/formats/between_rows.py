"""Residuals if a controller interpolates between the rows or points of an exported move."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from quietarm.models import Expression, JointMotion
from quietarm.models.dimensions import ANGLE
from quietarm.ocp import JudgedMotion, Plan
from quietarm.ocp.planning.move_table import columns_of, times_of
from quietarm.ocp.profiles.free_motion import FreeMotion, PiecewiseMotion
from quietarm.ocp.solvers.problem import MOST_SOLVER_STEPS
from quietarm.views.formats.deviation import (
    LINEAR,
    MOST_POINTS,
    deviation_of,
    deviation_words,
    motion_at,
    pieces_through,
)
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
THROUGH_DRIVE = "set points through the drive, whose load follows the planned path"
"""What is said of rows that are not the planned path itself."""
_TOLD = 1e-3
"""Share of the largest deflection on the way: so much more than the plan's residual is told."""


def note_of_rows(plan: Plan, columns: str, rate: float) -> str:
    """Return the note on a table's columns, as typed."""
    return note_of_points(plan, rate, tuple(columns_of(columns, plan.task.plant)))


def note_of_points(plan: Plan, rate: float, columns: Sequence[str] = OF_POINTS) -> str:
    """`interpolation_note`, and how far such a controller is from the plan between the points."""
    if plan.candidate.inverts_drive:
        return THROUGH_DRIVE
    derivatives = _derivatives_in(columns)
    times = times_of(plan, rate)
    if derivatives == 0 or len(times) > MOST_POINTS:
        return interpolation_note(plan, rate, columns)
    joints = plan.sampled(times).sample.joints
    given = [np.column_stack([joint[order] for joint in joints]) for order in range(derivatives)]
    deviation = deviation_of(plan, pieces_through(times, given, derivatives))
    between = _BETWEEN[derivatives].format(ANGLE.of(plan.task.plant.joint))
    words = f"between the points, by {between}, {deviation_words(plan, deviation)} off the plan"
    return "; ".join(filter(None, [interpolation_note(plan, rate, columns), words]))


def note_of_calls(plan: Plan, cycle: float) -> str:
    """Say how far straight lines between calls are from the plan, which is exact at each call."""
    times = times_of(plan, 1 / cycle)
    if len(times) > MOST_POINTS:
        return "exact at any time"
    deviation = deviation_of(plan, pieces_through(times, motion_at(plan, times), LINEAR))
    words = deviation_words(plan, deviation)
    return (
        f"exact at any time; straight lines between calls {1e3 * cycle:g} ms apart are {words} off"
    )


def _derivatives_in(columns: Sequence[str]) -> int:
    """Count the names of `OF_POINTS` among the columns, each only with those before it."""
    held = [name in columns for name in OF_POINTS]
    return held.index(False) if False in held else len(held)


def interpolation_note(plan: Plan, rate: float, columns: Sequence[str] = OF_POINTS) -> str:
    """Say what a rate [Hz] that is too coarse leaves, and name one that does; else say nothing.

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
    derivatives = _derivatives_in(columns)
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
    """Return the residual between points at these times, from 0 to the end of the move or later."""
    along = plan.sampled(times).sample.path
    return residual_through(plan, times, [np.asarray(values) for values in along[:3]], derivatives)


def residual_through(plan: Plan, times: Array, along: Sequence[Array], interpolation: int) -> float:
    """The residual of a motion interpolated between set points along the path, by CVODES [m].

    Parameters
    ----------
    plan : Plan
        The move.
    times : ndarray
        When the set points hold [s].
    along : sequence of ndarray, shape (times,)
        Their places on the path, then speeds and accelerations as far as they are needed.
    interpolation : int
        One of those of `pieces_through`. Between straight lines the speed turns within an eighth
        of the time between two set points.
    """
    task = replace(plan.task, start=float(along[0][0]), target=float(along[0][-1]))
    if interpolation == LINEAR:
        free = _with_corners(times, along[0])
        task = replace(task, duration=float(free.times[-1]))
        return JudgedMotion(task, PiecewiseMotion.of_free_motion(task, free)).residual
    pieces = pieces_through(times, [values[:, None] for values in along], interpolation)
    table = np.vstack([pieces.c[:, :, 0], np.diff(times)])
    remedy = "; give a higher --rate"
    path = PiecewiseMotion(_polynomial, table, interpolation == len(OF_POINTS), False, remedy)
    task = replace(task, duration=float(times[-1]))
    return JudgedMotion(task, path).residual


def _with_corners(times: Array, places: Array) -> FreeMotion:
    """Return straight lines between set points, whose speed turns shortly at each of them."""
    lengths = np.diff(times)
    speeds = np.concatenate([[0.0], np.diff(places) / lengths, [0.0]])
    turn = lengths.min() / 8
    accelerations = np.diff(speeds) / turn
    # a turn around every set point, which makes the whole longer by one turn
    spans = np.empty(2 * len(lengths) + 1)
    spans[0::2] = turn
    spans[1::2] = lengths - turn
    acceleration = np.zeros_like(spans)
    acceleration[0::2] = accelerations
    return FreeMotion(np.append(0.0, np.cumsum(spans)), acceleration, np.zeros_like(spans))


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
