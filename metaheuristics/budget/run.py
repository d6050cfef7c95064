"""Run a method until its evaluations are spent."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from metaheuristics.algorithms.presets import preset_of
from metaheuristics.budget.record import Mark, Scale, Visits
from metaheuristics.runs.settings import search_versions
from ocp import Front, JointProfile, PointToPoint, reference_corner
from ocp.base.checks import whole

if TYPE_CHECKING:
    from pymoo.core.algorithm import Algorithm

    from metaheuristics.budget.problem import BudgetProblem

MOST_EVALUATIONS = 10_000_000


@dataclass(frozen=True)
class BudgetRun:
    """What a method found with its evaluations.

    Attributes
    ----------
    front : Front
        All candidates that no other dominates, with figures of the finer rollout; its `evaluations`
        are those spent.
    marks : tuple of Mark
        What there was after so many evaluations, with the figures that the search had.
    visits : Visits
        Where its feasible candidates lie.
    """

    front: Front
    marks: tuple[Mark, ...]
    visits: Visits


def number_of_evaluations(value: object) -> int:
    """A budget of evaluations as an int; ValueError when it is out of range."""
    return whole("evaluations", value, 1, MOST_EVALUATIONS, "20000 show what a method can do")


def search_within(
    task: PointToPoint,
    method: str,
    evaluations: int,
    scale: Scale,
    *,
    profile: JointProfile,
    bound: float,
    population: int | None = None,
    seed: int = 0,
) -> BudgetRun:
    """Search with exactly so many evaluations.

    Parameters
    ----------
    task : PointToPoint
        The move; its limits become constraints.
    method : str
        A name of `PRESETS`.
    evaluations : int
        Candidates that are evaluated; of the last generation only as many as are left.
    scale : Scale
        Extent of the exact front, in which hypervolumes are measured.
    profile : JointProfile
        How the joint moves.
    bound : float
        Largest absolute coefficient.
    population : int, optional
        Individuals, or particles in a swarm; the method's own by default.
    seed : int
        Seed of the random numbers.

    Returns
    -------
    BudgetRun
        What it found, and when.

    Raises
    ------
    ValueError
        When an argument is out of range, or the method cannot search this task.
    """
    # Not at the top: pymoo takes longer to load than all of quietarm.
    from metaheuristics.algorithms.provenance import flat, settings_of
    from metaheuristics.budget.problem import BudgetProblem, BudgetSpentError
    from metaheuristics.objective.population import PopulationObjective
    from metaheuristics.runs.front import verified_points
    from metaheuristics.runs.settings import SearchSettings

    preset = preset_of(method)
    population = preset.population if population is None else population
    SearchSettings(bound, population, preset.generations)  # refuses what is out of range
    algorithm = preset.build(population)
    settings = {"bound": bound, **dict(flat(settings_of(algorithm)))}
    budget = number_of_evaluations(evaluations)
    problem = BudgetProblem(PopulationObjective(task, profile), bound, budget, scale)
    with suppress(BudgetSpentError):
        _run(algorithm, problem, seed)
    front = Front(
        task=task,
        profile=profile,
        points=verified_points(task, profile, problem.non_dominated()[0]),
        method=method,
        settings=settings,
        seed=seed,
        reference=reference_corner(task),
        evaluations=problem.spent,
        failed=problem.failed,
        infeasible=problem.infeasible,
        versions=search_versions(),
        seconds=problem.seconds,
    )
    return BudgetRun(front, tuple(problem.marks), problem.visits)


def _run(algorithm: Algorithm, problem: BudgetProblem, seed: int) -> None:
    from pymoo.termination.max_eval import MaximumFunctionCallTermination

    termination = MaximumFunctionCallTermination(problem.budget)
    try:
        algorithm.setup(problem, termination=termination, seed=seed)
    except AssertionError as error:  # how pymoo's MOEA/D refuses constraints
        raise ValueError(f"{type(algorithm).__name__} cannot search this task: {error}") from None
    while algorithm.has_next():
        algorithm.next()
