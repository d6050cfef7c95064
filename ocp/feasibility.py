"""When a task cannot be met: find out which limit is in the way, and what would do."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ocp.errors import InfeasibleTaskError, SolverFailedError
from ocp.plan import SolveSettings
from ocp.profile import JointProfile
from ocp.program import Solution, TaskProgram
from ocp.rollout import default_steps
from ocp.status import SolveStatus
from ocp.task import LIMITS, PointToPoint
from ocp.transcription import RESIDUAL

_UNITS = {RESIDUAL: "m", **{name.removesuffix("_limit"): unit for name, unit in LIMITS.items()}}
_STEPS = 100
_ROOM = 1.001
"""A found least value is quoted with this room, so that asking for it is feasible."""


def what_would_be_feasible(
    task: PointToPoint,
    profile: JointProfile,
    settings: SolveSettings,
    solutions: Sequence[Solution],
    guesses: Sequence[NDArray[np.float64]],
) -> SolverFailedError:
    """The error for a task that no start solved.

    Each limit in turn is made as small as it can be while the others are kept. A least value above
    the limit says that the task is infeasible, and what would be feasible.

    Parameters
    ----------
    task : PointToPoint
        The move and its limits.
    profile : JointProfile
        How the joint moves.
    settings : SolveSettings
        What was asked of the solver.
    solutions : sequence of Solution
        The runs that failed.
    guesses : sequence of ndarray
        Their start values, used again.

    Returns
    -------
    SolverFailedError
        An InfeasibleTaskError where a remedy was found; to be raised by the caller.
    """
    limits = {RESIDUAL: settings.residual_limit, **task.limits}
    steps = settings.steps or default_steps(task, least=_STEPS)
    remedies: list[str] = []
    for name, limit in limits.items():
        with_residual = name == RESIDUAL or limits[RESIDUAL] > 0
        program = TaskProgram(task, profile, steps, with_residual=with_residual)
        others = {key: value for key, value in limits.items() if key != name}
        found = [program.solve(guess, others, settings.bound, minimise=name) for guess in guesses]
        least = [solution.peaks[name] for solution in found if solution.status.solved]
        if least and min(least) > limit:
            remedies.append(f"a {name} limit of {_quoted(min(least))} {_UNITS[name]}")
    asked = ", ".join(f"{name} <= {limit:g} {_UNITS[name]}" for name, limit in limits.items())
    box = "" if settings.bound is None else f", coefficients within +-{settings.bound:g}"
    terms = f"{profile.size} term{'s' if profile.size > 1 else ''}"
    if remedies:
        return InfeasibleTaskError(
            f"no motion of {terms} meets {asked}{box}. Feasible with the rest kept: "
            f"{' or '.join(remedies)}. Or give more terms or a longer duration."
        )
    statuses = {solution.status for solution in solutions}
    if statuses == {SolveStatus.INFEASIBLE}:
        return InfeasibleTaskError(
            f"no motion of {terms} meets {asked}{box}, nor with any one of these limits taken "
            "away; widen several, or give more terms or a longer duration."
        )
    text = next(iter(statuses - {SolveStatus.INFEASIBLE})).text
    return SolverFailedError(f"none of {len(solutions)} starts was solved: {text}")


def _quoted(value: float) -> str:
    return f"{value * _ROOM:.4g}"
