"""Run a metaheuristic on a task, for generations or evaluations, and return a front."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import inf, nan
from typing import TYPE_CHECKING, Any

import numpy as np

from quietarm.metaheuristics.methods.preset import Preset
from quietarm.metaheuristics.methods.presets import PAPER_BOX, PRESETS, preset_of
from quietarm.metaheuristics.methods.search_method import SearchMethod
from quietarm.ocp import Front, JointProfile, PointToPoint
from quietarm.ocp.checks import instance, takes, whole
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY, checked_objectives
from quietarm.ocp.planning.choose_profile import choose_profile

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from pymoo.core.algorithm import Algorithm

    from quietarm.metaheuristics.problems.recorded import RecordedFunction

MOST_EVALUATIONS = 1_000_000_000
SECONDS_OF_CANDIDATE = 5e-5
"""Of a core: 40,000 of the paper's first move take two seconds."""
SEARCH_RESIDUAL = 1e-3
"""Residual [m] at which the energies of searches are compared."""


@dataclass(frozen=True)
class SearchProgress:
    """Progress of a search after a generation.

    Attributes
    ----------
    generation, generations : int
        Generations done and asked for.
    residual, energy : float
        Least residual [m] and least energy [J] found, of different candidates as a rule.
    hypervolume : float
        Share of the reference box that is dominated.
    evaluations, failed, infeasible : int
        Candidates evaluated, and those among them that were not finite, and that violated a limit.
    seconds : float
        Processor time of the search.
    """

    generation: int
    generations: int
    residual: float
    energy: float
    hypervolume: float
    evaluations: int
    seconds: float
    failed: int = 0
    infeasible: int = 0
    tip_unit: str = "m"


@takes(task=PointToPoint, start=Front)
def search(
    task: PointToPoint,
    profile: JointProfile | None = None,
    *,
    algorithm: str | SearchMethod | Algorithm = "nsga2",
    bound: float | None = None,
    population: int | None = None,
    generations: int | None = None,
    evaluations: int | None = None,
    settings: Mapping[str, object] | None = None,
    seed: int = 0,
    threads: int = 1,
    start: Front | None = None,
    report: Callable[[SearchProgress], None] | None = None,
    objectives: Sequence[str] = RESIDUAL_AND_ENERGY,
    noise: float = 0.0,
    reevaluate: int = 1,
) -> Front:
    """Search the trade-off between residual, energy and peaks without derivatives.

    Parameters
    ----------
    task : PointToPoint
        The move; its limits become constraints.
    profile : JointProfile, optional
        How the joint moves; by default the polynomial that `plan_move` takes for the task: of six
        terms without limits, of 18 or 24 within.
    algorithm : str, SearchMethod or pymoo Algorithm
        A name of `PRESETS`: ``"nsga2-paper"`` and ``"vepso"`` have the paper's settings, the others
        pymoo's. Or an object of one's own `SearchMethod`. Or any multi-objective algorithm of pymoo
        that was not run yet; it is copied, so the one given stays as it is.
    bound : float
        Largest absolute coefficient; required, unless the profile has a `default_bound`.
    population, generations : int, optional
        Individuals (particles in a swarm) and generations; those of the preset by default. With
        an algorithm of your own its population counts.
    evaluations : int, optional
        Candidates in all, in place of generations: the search ends after exactly so many, in the
        middle of a generation if need be.
    settings : mapping, optional
        Other settings of a method known by name, as ``{"crossover": 0.7}``; see `Preset.settings`.
    seed : int
        Seed of the random numbers.
    threads : int
        Blocks of the population that are evaluated at the same time.
    start : Front, optional
        Its points are in the first population, as many as that holds.
    report : callable, optional
        Called with a `SearchProgress` after every generation.
    objectives : sequence of str
        Residual and energy, and peaks beside them, as ``"peak_torque"``.
    noise, reevaluate
        As of a `RecordedFunction`: noise of residual and energy, as a share, and how often a
        candidate that is kept is evaluated.

    Returns
    -------
    Front
        At most 100 of the non-dominated points found, with values by CVODES, without any noise.

    Raises
    ------
    ValueError
        When an argument is out of range or missing, or the front to start from is of another
        profile or beyond the bound.
    """
    most_generations = 1_000_000
    # Not at the top: pymoo takes longer to load than all of quietarm, and only a search needs it.
    from quietarm.metaheuristics.problems.recorded import BudgetSpentError, RecordedFunction

    profile = choose_profile(task) if profile is None else _profile_of(profile)
    names = checked_objectives(objectives)
    if generations is not None and evaluations is not None:
        raise ValueError("evaluations stand in place of generations; leave one of them out")
    if isinstance(algorithm, SearchMethod):
        settings = {name: getattr(algorithm, name) for name in algorithm.defaults()}
        algorithm = algorithm.name
    if isinstance(algorithm, str):
        method = algorithm
        preset = preset_of(algorithm)
        preset.refuse_unfit(len(names), noise)
        chosen, stated = _of_preset(preset, task, population, evaluations, settings, len(names))
        size = preset.evaluations(stated["population"], 1, len(names))
        usual = preset.generations
        if preset.is_function and start is not None:
            raise ValueError(
                f"{method} begins where its seed says; leave the front to start from out"
            )
        if preset.is_function and evaluations is None:  # it knows no generations
            evaluations = preset.generations if generations is None else generations
            generations = None
    else:
        chosen, stated = _of_user(algorithm, population, settings)
        method = type(chosen).__name__
        size = 1
        usual = None
    generations = usual if generations is None else generations
    if evaluations is None and generations is None:
        raise ValueError(f"give the number of generations or of evaluations for {method}")
    if evaluations is None:
        generations = whole("generations", generations, 1, most_generations)
        limits: dict[str, Any] = {"generations": generations}
    else:
        evaluations = whole("evaluations", evaluations, 1, MOST_EVALUATIONS)
        generations = -(-evaluations // size)
        limits = {"evaluations": evaluations}
    bound = profile.default_bound if bound is None else bound
    if bound is None:
        papers = ", ".join(f"{box:g} for {plant}" for plant, box in PAPER_BOX.items())
        raise ValueError(
            f"{method} searches a box: give a bound on the coefficients (the paper used {papers})"
        )
    seed = whole("seed", seed, 0)
    function = RecordedFunction(
        task,
        profile,
        bound=bound,
        objectives=names,
        threads=threads,
        budget=evaluations or inf,
        noise=noise,
        reevaluate=reevaluate,
        seed=seed,
    )
    first = _starts(start, function) if start is not None else np.empty((0, profile.size))
    # a division by a distance of zero is of no concern to a user; and pymoo's NSGA-III leaves all
    # warnings of the process switched off
    with warnings.catch_warnings(), np.errstate(all="ignore"), suppress(BudgetSpentError):
        for done in _run(chosen, function, seed, first, limits):
            if report is not None:
                report(_progress(function, done, generations))
    return function.front(method, seed, {**limits, **stated})


def _profile_of(profile: object) -> JointProfile:
    """A profile; TypeError that says where a method belongs, if one stands in its place."""
    if (isinstance(profile, str) and profile in PRESETS) or hasattr(profile, "infill"):
        raise TypeError(f"profile is {profile!r}; a method is given as algorithm=...")
    return instance("profile", profile, JointProfile)


def _run(
    method: Any,
    function: RecordedFunction,
    seed: int,
    first: NDArray[np.float64],
    limits: Mapping[str, int],
) -> Iterator[int]:
    """Run a method and yield the generations that are done; a function has one."""
    from pymoo.core.algorithm import Algorithm as PymooAlgorithm

    from quietarm.metaheuristics.problems.pymoo_problem import PymooProblem

    if not isinstance(method, PymooAlgorithm):
        method(function, seed, limits["evaluations"])
        yield 1
        return
    _set_up(method, PymooProblem(function), seed, **limits)
    yield from (done for done, _ in enumerate(_generations(method, first), start=1))


def _set_up(
    algorithm: Any, problem: Any, seed: int, generations: int = 0, evaluations: int = 0
) -> None:
    from pymoo.termination.max_eval import MaximumFunctionCallTermination
    from pymoo.termination.max_gen import MaximumGenerationTermination

    termination: Any = (
        MaximumFunctionCallTermination(evaluations)
        if evaluations
        else MaximumGenerationTermination(generations)
    )
    try:
        algorithm.setup(problem, termination=termination, seed=seed)
    except AssertionError as error:  # how pymoo's MOEA/D refuses constraints
        name = type(algorithm).__name__
        raise ValueError(f"{name} cannot search this task: {error}") from None


def _generations(algorithm: Any, first: NDArray[np.float64]) -> Iterator[None]:
    """The generations of a search: as `Algorithm.run`, with rows in the first population."""
    while algorithm.has_next():
        infills = algorithm.infill()
        if infills is None:
            algorithm.advance()
            continue
        if len(first):
            for individual, row in zip(infills, first):
                individual.X = row.copy()
            first = first[:0]
        algorithm.evaluator.eval(algorithm.problem, infills, algorithm=algorithm)
        algorithm.advance(infills=infills)
        yield


def _progress(function: RecordedFunction, done: int, generations: int) -> SearchProgress:
    archive = function.archive
    F = archive.non_dominated()[1]
    residual, energy = F.min(axis=0).tolist()[:2] if len(F) else (nan, nan)
    return SearchProgress(
        done,
        max(generations, done),
        residual,
        energy,
        archive.share_of_box(),
        archive.evaluations,
        archive.seconds,
        function.failed,
        function.infeasible,
        function.task.plant.tip_unit,
    )


def _starts(front: Front, function: RecordedFunction) -> NDArray[np.float64]:
    """Coefficients of a front within the box of a search."""
    if front.profile != function.profile:
        raise ValueError("the front to start from has another profile; give one of the search's")
    table = front.coefficients
    if ((table < function.lower) | (table > function.upper)).any():
        raise ValueError(
            f"the front to start from is beyond the bound of {function.bound:g}; give a wider one"
        )
    return table


def _of_preset(
    preset: Preset,
    task: PointToPoint,
    population: int | None,
    evaluations: int | None,
    settings: Mapping[str, object] | None,
    objectives: int,
) -> tuple[Any, dict[str, Any]]:
    """A method that is known by name, and what it is set to, for so many objectives."""
    most = 100_000
    if task.limits and not preset.keeps_limits:
        raise ValueError(
            f"{preset.name} cannot search a task with limits; choose another method, or leave "
            "the limits out"
        )
    size = whole(
        "population",
        preset.population if population is None else population,
        1 if preset.is_function else 2,
        most,
        f"{most} take 1.6 GB of memory",
    )
    stated = {"population": size, **preset.stated(preset.checked(size, settings))}
    if evaluations is not None:
        preset.refuse_less_than_one(evaluations, size, objectives)
    return preset.build(size, settings, objectives), stated


def _of_user(
    algorithm: Algorithm, population: int | None, settings: Mapping[str, object] | None
) -> tuple[Algorithm, dict[str, Any]]:
    """A copy of an algorithm that was given, and what it is set to."""
    from pymoo.core.algorithm import Algorithm as PymooAlgorithm

    from quietarm.metaheuristics.methods.algorithm_settings import settings_of
    from quietarm.metaheuristics.methods.user_algorithm import copy_of_algorithm

    value: Any = algorithm
    if inspect.isclass(value):
        raise ValueError(f"give an algorithm, as {value.__name__}(), not its class")
    if not isinstance(value, PymooAlgorithm):
        raise TypeError(
            f"algorithm is {value!r}; give a name, as 'nsga2', or an algorithm of pymoo"
        )
    chosen = copy_of_algorithm(algorithm)
    for name, value in (("population", population), ("settings", settings)):
        if value:
            raise ValueError(f"{name} is set in the algorithm that you give, not beside it")
    return chosen, settings_of(chosen)
