"""The gradient as a method among others: fronts, random starts, and a search that is polished."""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from quietarm.metaheuristics.archive import search_versions
from quietarm.metaheuristics.methods.settings import MethodSetting, with_defaults
from quietarm.metaheuristics.named_method import NamedMethod
from quietarm.ocp import Front, JointProfile, Mark, PointToPoint, epsilon_front, weighted_front
from quietarm.ocp.checks import whole
from quietarm.ocp.cost import COST, Cost
from quietarm.ocp.front.points import LEVELS
from quietarm.ocp.front.polish import polish_front
from quietarm.ocp.front.tradeoff import RESIDUAL_LIMIT, Tradeoff
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY, refuse_more_objectives
from quietarm.ocp.planning.request import Request
from quietarm.ocp.record import number_of_points, number_of_starts
from quietarm.ocp.solvers.choice import SOLVERS, stated_solver
from quietarm.ocp.solvers.solver import NAME, Solver
from quietarm.ocp.solvers.sqp import Sqp


def multistart_front(
    task: PointToPoint,
    profile: JointProfile,
    *,
    bound: float,
    starts: int = 100,
    seed: int = 0,
    solver: Solver = Sqp(),
) -> Front:
    """Solve from random starts, one for each of as many residual limits, drawn at random.

    The first has no limit; the others are between zero and the residual of the first.
    """
    starts = whole("starts", starts, 2)
    began = time.perf_counter()
    tradeoff = Tradeoff.begin(Request(task, profile, solver, bound, 1, seed))
    random = np.random.default_rng(seed)
    guesses = random.uniform(*profile.box(bound), (starts, profile.size))
    (cheapest,) = tradeoff.solver.solve([tradeoff.problem()], [guesses[0]])
    limits = random.uniform(0.0, cheapest.residual, starts - 1)
    problems = [tradeoff.problem(float(limit)) for limit in limits]
    solutions = tradeoff.solver.solve(problems, list(guesses[1:]))
    solved = [
        (solution, {RESIDUAL_LIMIT: solution.residual})
        for solution in [cheapest, *solutions]
        if solution.status.solved
    ]
    front = tradeoff.to_front("multistart", tradeoff.certify(solved), starts)
    return front.restated(seconds=time.perf_counter() - began)


_FRONTS: Mapping[str, tuple[Callable[..., Front], str]] = {
    "epsilon": (partial(epsilon_front, at=LEVELS), "points"),
    "weighted": (weighted_front, "points"),
    "multistart": (multistart_front, "starts"),
}
"""By name of `BY_GRADIENT`, and what each may be set to."""


def gradient_front(
    task: PointToPoint,
    profile: JointProfile,
    method: NamedMethod,
    *,
    bound: float,
    seed: int,
    settings: Mapping[str, Any],
    objectives: Sequence[str] = RESIDUAL_AND_ENERGY,
) -> Front:
    """The front of a method by the gradient, with its cost as its only mark.

    ValueError where there are peaks among the objectives and it is not the epsilon-constraint.
    """
    check_settings(method, settings)
    options_of_problem: dict[str, Any] = {}
    if tuple(objectives) != RESIDUAL_AND_ENERGY:
        refuse_more_objectives(method.method, objectives)
        options_of_problem["objectives"] = objectives
    find, _ = _FRONTS[method.method]
    options, method_settings = split_solver_options(settings, method.solver)
    solver = solver_with(options, method.solver)
    before = COST.copy()
    began = time.thread_time()
    front = find(
        task,
        profile,
        bound=bound,
        seed=seed,
        solver=solver,
        **method_settings,
        **options_of_problem,
    )
    return _with_cost(front.restated(method=str(method)), before, began)


def check_settings(method: NamedMethod, settings: Mapping[str, Any]) -> None:
    """Refuse settings that a method by the gradient does not have, or that are out of range."""
    with_defaults(str(method), gradient_settings(method), settings)


def gradient_settings(method: NamedMethod) -> tuple[MethodSetting, ...]:
    """The settings of a method by the gradient: how many points or starts, and its solver's."""
    find, size = _FRONTS[method.method]
    sizes: Mapping[str, tuple[str, Callable[[object], int]]] = {
        "points": ("points of the front", number_of_points),
        "starts": ("random starts, one for each of as many residual limits", number_of_starts),
    }
    meaning, check = sizes[size]
    default = inspect.signature(find).parameters[size].default
    own = MethodSetting(size, size, default, meaning, lambda _, value: check(value))
    return own, *solver_settings(method.solver)


def solver_settings(solver: str = "") -> list[MethodSetting]:
    """Settings of a method that are options of its solver, by default of the own SQP."""
    return list(map(MethodSetting.of_solver, SOLVERS[solver or Sqp.name].stated_options()))


def split_solver_options(
    settings: Mapping[str, Any], solver: str = ""
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Options of a method's solver, as solver_tolerance, and the method's other settings."""
    names = {setting.name for setting in solver_settings(solver)}
    options = {name: value for name, value in settings.items() if name in names}
    method_settings = {name: value for name, value in settings.items() if name not in names}
    return options, method_settings


def split_for_polish(
    settings: Mapping[str, Any], known: Collection[str]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Options of the solver that polishes, and the settings of the search before it.

    Options that the search knows as well, since it takes steps of the gradient, are for both.
    """
    options, others = split_solver_options(settings)
    shared = {name: value for name, value in options.items() if name in known}
    return options, others | shared


def solver_with(options: Mapping[str, Any], name: str = "") -> Solver:
    """The solver of a name, by default the own SQP, with options as a record states them."""
    return stated_solver({NAME: name or Sqp.name, **options}) or Sqp()


def polished(front: Front, solver: Solver = Sqp()) -> Front:
    """The front of a search, each point improved at its own residual; one mark more."""
    before = COST.copy()
    began = time.thread_time()
    method = str(NamedMethod.read(front.record.method).polished())
    if not front.points:
        return front.restated(method=method)
    better = polish_front(front, solver=solver).front
    return _with_cost(
        better.restated(method=method),
        before,
        began,
        front.record.seconds,
    )


def _with_cost(front: Front, before: Cost, began: float, earlier: float = 0.0) -> Front:
    """The front with a mark of what its gradient cost, on top of its last one."""
    spent = COST.since(before)
    seconds = time.thread_time() - began
    last = front.history[-1] if front.history else Mark(0)
    mark = Mark(
        evaluations=last.evaluations + spent.candidates,
        seconds=last.seconds + max(seconds - spent.checks - spent.builds, 0.0),
        gradients=last.gradients + spent.gradients,
        hessians=last.hessians + spent.hessians,
    )
    return replace(front, history=(*front.history, mark)).restated(
        evaluations=mark.evaluations, versions=search_versions(), seconds=seconds + earlier
    )
