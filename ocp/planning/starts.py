"""Where the gradient starts, on how many steps, and the best of what it finds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.planning.feasibility import explain, least_peaks_of
from quietarm.ocp.planning.verification import MOST_SOLVER_STEPS
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import SolveSettings
from quietarm.ocp.simulation.grid import default_steps
from quietarm.ocp.solvers.program import Program
from quietarm.ocp.solvers.solution import Scalarization, Solution
from quietarm.ocp.solvers.solving import STOPPED, Row, Solver, solve
from quietarm.ocp.task import PointToPoint

PLAN_STEPS, FINER_STEPS, STEPS_A_TERM = 48, 80, 8
"""Steps that resolve a profile: more with more terms, since the power changes sign more often, but
within the first two; with limits the second, since limits hold only at the nodes."""


def first_steps(task: PointToPoint, profile: JointProfile, settings: SolveSettings) -> int:
    """Steps of the solver's discretisation to begin with."""
    fewest = FINER_STEPS if task.limits else PLAN_STEPS
    least = min(max(fewest, STEPS_A_TERM * (profile.size - 2)), FINER_STEPS)
    steps = settings.steps or default_steps(task, least=least)
    if steps > MOST_SOLVER_STEPS and settings.steps is None:
        raise ValueError(
            f"duration is {task.duration:g} s, {steps / 2:.0f} radians of the plant's fastest "
            f"mode; the solver resolves up to {MOST_SOLVER_STEPS // 2}: give a shorter duration"
        )
    return steps


def start_coefficients(profile: JointProfile, settings: SolveSettings) -> list[NDArray[np.float64]]:
    """Coefficients to start from: the guess or the plain cycloid, then random ones of the seed."""
    random = np.random.default_rng(settings.seed)
    within = profile.start_box(settings.bound)
    count = (settings.starts - 1) * profile.random_starts
    others = [random.uniform(*within) for _ in range(count)]
    first = profile.plain if settings.guess is None else np.array(settings.guess)
    return [first, *others]


class Best(NamedTuple):
    """The best of several starts."""

    solution: Solution
    solved: list[Solution]
    stopped: str | None


def from_starts(
    program: Program,
    ask: Scalarization,
    starts: Sequence[NDArray[np.float64]],
    solver: Solver = "sqp",
) -> Best:
    """Solve from several starts, and help where none of them leads to a solution.

    Help are motions of least peaks as further starts, then IPOPT.
    """
    tried, least = list[Solution](), dict[str, Solution]()
    begun, stopped, complete = 0, None, True

    def attempts() -> Iterator[tuple[Solver, Sequence[NDArray[np.float64]]]]:
        yield solver, starts
        if ask.limits:
            least.update(least_peaks_of(program, ask, starts[:2]))
            yield solver, [one.coefficients for one in least.values()]
        if solver != "ipopt":
            yield "ipopt", starts[:2]

    for by, guesses in attempts():
        rows = [Row(program, ask, guess) for guess in guesses]
        if not rows:
            continue
        found, complete = solve(rows, by, groups=[0] * len(rows))
        tried += found
        begun += len(rows)
        if any(one.status.solved for one in tried) or not complete:
            break
    solved = sorted((one for one in tried if one.status.solved), key=lambda one: one.energy)
    if not complete:
        if not solved:
            raise KeyboardInterrupt
        stopped = f"{begun - sum(one.reason == STOPPED for one in tried)} of {begun} starts"
    if not solved:
        raise explain(program, ask, tried, least)
    total = sum(one.iterations for one in tried)
    return Best(replace(solved[0], iterations=total), solved, stopped)
