"""Run a method until its evaluations are spent."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.algorithms.presets import PRESETS
from quietarm.metaheuristics.budget.record import Mark, Scale, Visits
from quietarm.ocp import Front, JointProfile, PointToPoint
from quietarm.ocp.checks import unknown, whole

if TYPE_CHECKING:
    from pymoo.core.algorithm import Algorithm
    from quietarm.metaheuristics.budget.gradient import Gradient
    from quietarm.metaheuristics.budget.problem import BudgetProblem

MOST_EVALUATIONS = 10_000_000
_OF_THE_SEARCH = 0.5
"""Share of the evaluations that the search has before its front is polished."""
_NO_SEEDS = np.empty((0, 0))
_REHEARSAL = 3
"""Generations that are searched and forgotten before the first run of its kind in a process: what
is compiled and loaded then is no part of a method's time."""
_rehearsed: set[tuple[PointToPoint, JointProfile, str]] = set()


class Help(Enum):
    """What the gradient does in a search."""

    NONE = ""
    POLISH = "polish"
    SEEDS = "seeds"


MULTISTART = "multistart"
"""The gradient alone, from random starts."""


def parts_of(method: str) -> tuple[str, Help]:
    """The search and the gradient's part of a method's name, as ``"nsga2+polish"``."""
    if method == MULTISTART:
        return method, Help.NONE
    search, plus, part = method.partition("+")
    helps = [one.value for one in Help if one.value]
    if plus and part not in helps:
        raise ValueError(f"unknown method {method!r}; give {search}+{f' or {search}+'.join(helps)}")
    if search not in PRESETS:
        also = f", and with +{' or +'.join(helps)} behind it"
        raise ValueError(unknown("method", method, [*PRESETS, MULTISTART], also))
    return search, Help(part)


@dataclass(frozen=True)
class BudgetRun:
    """What a method found with its evaluations."""

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
    settings: Mapping[str, object] | None = None,
    seed: int = 0,
) -> BudgetRun:
    """Search with exactly so many evaluations."""
    # Not at the top: pymoo takes longer to load than all of quietarm.
    from quietarm.metaheuristics.budget.gradient import Gradient
    from quietarm.metaheuristics.budget.problem import BudgetProblem, BudgetSpentError
    from quietarm.metaheuristics.objective.population import PopulationObjective
    from quietarm.metaheuristics.runs.front import front_through

    search, helped = parts_of(method)
    budget = number_of_evaluations(evaluations)
    _, stated = _built(search, population, bound, settings)

    def attempt(budget: int) -> tuple[BudgetProblem, Gradient]:
        algorithm, _ = _built(search, population, bound, settings)
        problem = BudgetProblem(PopulationObjective(task, profile), bound, budget, scale)
        gradient = Gradient(problem, bound, seed)
        with suppress(BudgetSpentError):
            if algorithm is None:
                gradient.multistart()
            else:
                first = gradient.seeds() if helped is Help.SEEDS else _NO_SEEDS
                until = round(_OF_THE_SEARCH * budget) if helped is Help.POLISH else budget
                _run(algorithm, problem, seed, until, first)
            if helped is Help.POLISH:
                gradient.polish()
        return problem, gradient

    if (task, profile, method) not in _rehearsed:
        attempt(min(budget, _REHEARSAL * stated.get("population", 100)))
        _rehearsed.add((task, profile, method))
    problem, gradient = attempt(budget)
    seconds, record = problem.seconds, problem.record
    front = front_through(
        record.non_dominated()[0], task, profile,
        method=method, settings=stated, seed=seed, seconds=seconds, evaluations=record.spent,
        iterations=gradient.iterations, failed=problem.failed, infeasible=problem.infeasible,
    )  # fmt: skip
    return BudgetRun(front, tuple(record.marks), record.visits)


def check_method(
    method: str, population: int | None = None, settings: Mapping[str, object] | None = None
) -> None:
    """Build what `search_within` would run, so that nothing of it is refused later."""
    _built(parts_of(method)[0], population, 1.0, settings)


def _built(
    search: str, population: int | None, bound: float, given: Mapping[str, object] | None
) -> tuple[Algorithm | None, dict[str, Any]]:
    """The algorithm of a search, none where the gradient is alone, and its settings."""
    from quietarm.metaheuristics.runs.settings import SearchSettings

    if search == MULTISTART:
        if given:
            raise ValueError(f"{MULTISTART} has no settings; leave {', '.join(given)} out")
        return None, {"bound": bound}
    preset = PRESETS[search]
    population = preset.population if population is None else population
    SearchSettings(bound, population, preset.generations)  # refuses what is out of range
    asked = {"bound": bound, "population": population, **preset.checked(population, given)}
    return preset.build(population, given), asked


def _run(
    algorithm: Algorithm, problem: BudgetProblem, seed: int, until: int, first: NDArray[np.float64]
) -> None:
    """Search until so many evaluations are spent, with these rows in the first population."""
    from pymoo.termination.max_eval import MaximumFunctionCallTermination
    from quietarm.metaheuristics.runs.loop import set_up

    set_up(algorithm, problem, MaximumFunctionCallTermination(until), seed)
    machinery: Any = algorithm  # for the type checker: pymoo declares much as optional
    # as `Algorithm.next`, with the rows
    while problem.record.spent < until and algorithm.has_next():
        infills: Any = algorithm.infill()
        if infills is None:
            algorithm.advance()
            continue
        for individual, row in zip(infills, first, strict=False):
            individual.X = row.copy()
        first = first[:0]
        machinery.evaluator.eval(problem, infills, algorithm=algorithm)
        algorithm.advance(infills=infills)
