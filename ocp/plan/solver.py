"""IPOPT: the plan of least energy."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ocp.answers.provenance import Provenance, SolveSettings, Verification
from ocp.base.errors import SolverFailedError
from ocp.base.interrupts import note_interrupts
from ocp.base.status import SolveStatus
from ocp.base.threads import one_at_a_time
from ocp.plan.answer import Plan
from ocp.plan.feasibility import explain, rescued
from ocp.plan.only_motion import only_motion
from ocp.plan.robust import limit_of, robust_plan
from ocp.plan.verification import HURRIED, MOST_SOLVER_STEPS, verified
from ocp.profiles.joint_profile import JointProfile
from ocp.profiles.kinds import refuse_other_kinds
from ocp.profiles.polynomial import CycloidPolynomial
from ocp.program.problem import Problem
from ocp.program.solution import Solution, same_minimum
from ocp.program.task_program import TaskProgram
from ocp.program.transcription import RESIDUAL
from ocp.robustness.uncertain import UncertainPlant
from ocp.simulation.resimulation import Resimulation
from ocp.simulation.rollout import default_steps
from ocp.task.point_to_point import PointToPoint

PLAN_STEPS, FINER_STEPS, STEPS_A_TERM = 48, 80, 8
"""Steps that resolve a profile: more with more terms, since the power changes sign more often, but
within the first two; with limits the second, since limits hold only at the nodes."""
_HIDDEN = 5e-3
"""A sampled minimum can lie above the resolved one beside it by this share of the energy."""
_AGREE = 1e-5
"""Starts whose energies differ by no more than this share agree: the tolerance of a cold run."""
_ALIKE = 0.01
"""Motions that break a limit are the same where their peaks differ by no more than this share."""
_FREEDOM = 4
"""With so many coefficients beyond those that rest takes, still motions hang together, and starts
that agree are right, in all of 227 random moves. With fewer, still motions lie apart: in 6 of 521
moves two starts agreed on one that was not the cheapest."""


@one_at_a_time
def plan_move(
    task: PointToPoint,
    profile: JointProfile | None = None,
    *,
    residual_limit: float | None = None,
    bound: float | None = None,
    starts: int = 4,
    seed: int = 0,
    steps: int | None = None,
    guess: ArrayLike | None = None,
) -> Plan:
    """Find the motion of least energy whose residual vibration is within a limit.

    Parameters
    ----------
    task : PointToPoint
        The move and its limits.
    profile : JointProfile, optional
        How the joint moves; by default the cycloid of a polynomial of six terms. The only motion
        of a profile without coefficients, such as `shaped_cycloid`, is evaluated, not optimised.
    residual_limit : float, optional
        Largest F1 [m]; 0 asks for rest on arrival, where there are coefficients to choose. By
        default 0; of an `UncertainPlant`, which hardly ever arrives at rest whatever its errors,
        5 % of what the plain cycloid of the same duration leaves on the assumed plant.
    bound : float, optional
        Largest absolute coefficient; none by default.
    starts : int
        How many starts: the guess or the plain cycloid first, then random ones. With four
        coefficients or more beyond those that rest takes, no more of them are solved once half
        have ended at the least energy found.
    seed : int
        Seed of the random starts.
    steps : int, optional
        Steps of the solver's discretisation, chosen from the task by default; they are doubled
        while the verification disagrees.
    guess : array_like, shape (profile.size,), optional
        Coefficients to start from first, such as a metaheuristic's, to be improved.

    Returns
    -------
    Plan
        The coefficients, with the figures of an independent integrator. After Ctrl-C the best of
        the starts that were solved until then, and not ``complete``. Of an uncertain plant the
        residual limit holds between the samples as well, as its ``worst`` states; its task has the
        samples that this took.

    Raises
    ------
    ValueError
        When an argument is out of range.
    InfeasibleTaskError
        When no motion of this profile meets the task; the text says what would be feasible.
    SolverFailedError
        When no start ended at an optimum for another reason.
    KeyboardInterrupt
        After Ctrl-C before a start was solved.
    """
    profile = CycloidPolynomial() if profile is None else profile
    refuse_other_kinds(task, profile)
    if guess is not None:
        guess = profile.checked(guess)
    least = 0.0 if residual_limit is None else residual_limit
    settings = SolveSettings(least, bound, starts, seed, steps, guess)
    if profile.size == 0:
        return only_motion(task, profile, residual_limit)
    settings = replace(settings, residual_limit=limit_of(task, residual_limit))
    if isinstance(task.plant, UncertainPlant):
        return robust_plan(task, profile, settings, plan_at_samples)
    return plan_at_samples(task, profile, settings)


def plan_at_samples(task: PointToPoint, profile: JointProfile, settings: SolveSettings) -> Plan:
    """The plan of a task whose residual limit holds at the plant's samples, if it has any.

    Parameters
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    settings : SolveSettings
        What is asked of the solver.

    Returns
    -------
    Plan
        The plan; between the samples of an uncertain plant its residual may be larger.

    Raises
    ------
    SolverFailedError
        When no start ended at an optimum.
    """
    began = time.perf_counter()
    program = TaskProgram(task, profile, first_steps(task, profile, settings))
    guesses = start_coefficients(profile, settings)
    limits = {RESIDUAL: settings.residual_limit, **task.limits}
    problem = Problem(program, limits, settings.bound, guesses)
    solved, stopped = list[Solution](), None
    try:
        best, simulated, steps_used = verified(problem, least_energy(problem, solved))
    except KeyboardInterrupt:
        best, simulated, steps_used = _best_until_now(problem, solved)
        stopped = f"{len(solved)} of {len(guesses)} starts"
    return Plan(
        task=task,
        profile=profile,
        coefficients=profile.checked(best.coefficients),
        motion=simulated.motion,
        status=best.status,
        verification=Verification.between(steps_used, best.energy, best.residual, simulated.motion),
        provenance=Provenance(
            "ipopt", settings, seconds=time.perf_counter() - began, stopped=stopped
        ),
    )


def _best_until_now(
    problem: Problem, solved: Sequence[Solution]
) -> tuple[Solution, Resimulation, int]:
    """What `verified` gives for the best of the starts until Ctrl-C, in a short time."""
    if not solved:
        raise KeyboardInterrupt
    with note_interrupts():
        try:
            return verified(problem, problem.finished(min(solved, key=_energy)), care=HURRIED)
        except SolverFailedError:
            raise KeyboardInterrupt from None


def first_steps(task: PointToPoint, profile: JointProfile, settings: SolveSettings) -> int:
    """Steps of the solver's discretisation to begin with.

    Parameters
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    settings : SolveSettings
        Its steps count where they are given.

    Returns
    -------
    int
        Number of steps.

    Raises
    ------
    ValueError
        When the move takes too many periods of the plant's fastest mode.
    """
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
    others = [random.uniform(*within) for _ in range(settings.starts - 1)]
    first = profile.plain if settings.guess is None else np.array(settings.guess)
    return [first, *others]


def least_energy(problem: Problem, kept: list[Solution] | None = None) -> Solution:
    """The best of the solutions from several starts.

    Parameters
    ----------
    problem : Problem
        What is asked.
    kept : list of Solution, optional
        Takes every start that was solved, at once, for whoever goes on with these after Ctrl-C.

    Returns
    -------
    Solution
        The solution of least energy.

    Raises
    ------
    InfeasibleTaskError
        When no motion of this profile meets the limits.
    SolverFailedError
        When no start ended at an optimum for another reason.
    """
    solutions = list[Solution]()
    for guess in problem.guesses:
        solutions.append(problem.solve(guess, finish=False))
        if kept is not None and solutions[-1].status.solved:
            kept.append(solutions[-1])
        if _agree(problem, solutions):
            break
    solutions, least = rescued(
        solutions,
        problem.limits,
        problem.guesses[:2],
        problem.least,
        lambda found: problem.solve(found.coefficients, finish=False),
    )
    solved = [solution for solution in solutions if solution.status.solved]
    if not solved:
        raise explain(problem, solutions, least)
    before = sum(solution.iterations for solution in solutions)
    lowest, finished = min(map(_energy, solved)), list[Solution]()
    for found in sorted(solved, key=_energy):
        near = found.energy <= lowest * (1 + _HIDDEN)
        if near and not any(same_minimum(found, other) for other in finished):
            finished.append(problem.finished(replace(found, iterations=0)))
    best = min(finished, key=_energy)
    return replace(best, iterations=before + sum(found.iterations for found in finished))


def _agree(problem: Problem, solutions: Sequence[Solution]) -> bool:
    """Whether half of the starts, and more than one, ended at the least energy found.

    Where none was solved: whether as many ended at the same motion, which breaks a limit. Where the
    joint's path is no linear function of the coefficients, agreement says too little.
    """
    motion, enough = problem.program.motion, max(2, len(problem.guesses) / 2)
    if not motion.basis_size or motion.size < motion.states + _FREEDOM:
        return False
    energies = np.array([found.energy for found in solutions if found.status.solved])
    if energies.size:
        return bool(np.count_nonzero(energies <= energies.min() * (1 + _AGREE)) >= enough)
    broken = [found for found in solutions if found.status is SolveStatus.INFEASIBLE]
    peaks = [list(found.peaks.values()) for found in broken]
    return sum(np.allclose(one, peaks[-1], rtol=_ALIKE) for one in peaks) >= enough


def _energy(found: Solution) -> float:
    return found.energy
