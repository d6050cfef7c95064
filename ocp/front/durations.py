"""What time is worth: plans of a move over its duration, beside the floor and the cycloid."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from quietarm.ocp.checks import positive
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.floor.search import energy_floor
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.plan.answer import Plan, evaluate_coefficients
from quietarm.ocp.plan.solver import plan_move
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.profiles.polynomial import CycloidPolynomial
from quietarm.ocp.task import PointToPoint

_FLOOR_TOLERANCE = 0.02


@dataclass(frozen=True)
class AtDuration:
    """A move in one duration.

    Attributes
    ----------
    duration : float
        Travelling time [s].
    plan : Plan or None
        The move of least energy; None where there is none.
    why : str
        Why there is none; empty where there is one.
    cycloid : Plan
        The plain cycloid, which keeps no limits.
    floor : float or None
        Least energy of any motion [J], within 2 %; None where none was found.
    """

    duration: float
    plan: Plan | None
    why: str
    cycloid: Plan
    floor: float | None


@dataclass(frozen=True)
class OverDuration:
    """A move over its duration: `points`, and whether Ctrl-C left them `complete`."""

    task: PointToPoint
    points: tuple[AtDuration, ...]
    complete: bool


@one_at_a_time
def plans_over_duration(
    task: PointToPoint,
    durations: Sequence[float],
    profile: JointProfile | None = None,
    *,
    report: Callable[[int, int], None] | None = None,
    **settings: Any,
) -> OverDuration:
    """Plan a move in several durations, each from the plan before it; settings as for `plan_move`.

    `report` is called with how many durations are done, and of how many; after Ctrl-C there are
    those that were done.
    """
    profile = CycloidPolynomial() if profile is None else profile
    durations = [positive("duration", one, "s") for one in durations]
    points: list[AtDuration] = []
    guess: tuple[float, ...] | None = None
    try:
        for duration in durations:
            at, why, plan = replace(task, duration=duration), "", None
            try:
                plan = plan_move(at, profile, guess=guess, **settings)
                if not plan.complete:
                    break
                guess = plan.coefficients
            except SolverFailedError as error:
                why = str(error)
            points.append(
                AtDuration(duration, plan, why, evaluate_coefficients(at, []), _floor(at))
            )
            if report is not None:
                report(len(points), len(durations))
    except KeyboardInterrupt:
        pass
    return OverDuration(task, tuple(points), len(points) == len(durations))


def _floor(task: PointToPoint) -> float | None:
    try:
        found = energy_floor(task, starts=1, tolerance=_FLOOR_TOLERANCE)
    except SolverFailedError:
        return None
    if not found.complete:
        raise KeyboardInterrupt
    return found.energy
