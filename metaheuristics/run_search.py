"""Search the trade-off of a move, or of any function, by a metaheuristic."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from typing import TYPE_CHECKING, Any

from quietarm.metaheuristics.methods.search_method import SearchMethod
from quietarm.metaheuristics.search_run import (
    SearchedMove,
    SearchProgress,
    SearchRun,
    profile_to_search,
)
from quietarm.metaheuristics.search_state import KeptValues, StateFile
from quietarm.ocp import Front, JointProfile, PointToPoint
from quietarm.ocp.checks import instance, takes
from quietarm.ocp.files import check_writable
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import ArrayLike
    from pymoo.core.algorithm import Algorithm

    from quietarm.metaheuristics.problems.own_energy import MoveSamples
    from quietarm.metaheuristics.problems.problem_function import ProblemFunction


@takes(start=Front)
def search(
    task: PointToPoint | Callable[..., Any],
    profile: JointProfile | None = None,
    *,
    algorithm: str | SearchMethod | Algorithm | None = None,
    bound: float | None = None,
    lower: ArrayLike | None = None,
    upper: ArrayLike | None = None,
    population: int | None = None,
    generations: int | None = None,
    evaluations: int | None = None,
    settings: Mapping[str, object] | None = None,
    seed: int = 0,
    threads: int = 1,
    start: Front | None = None,
    report: Callable[[SearchProgress], None] | None = None,
    begun: Callable[[SearchRun], None] | None = None,
    objectives: Sequence[str] = RESIDUAL_AND_ENERGY,
    units: Sequence[str] | None = None,
    constraints: Sequence[str] | None = None,
    reference: Sequence[float] | None = None,
    vectorized: bool | None = None,
    energy: Callable[[MoveSamples], ArrayLike] | None = None,
    noise: float = 0.0,
    reevaluate: int = 1,
    state: str | Path | None = None,
) -> Front:
    """Search the trade-off between residual, energy and peaks, or of any function, by values alone.

    Parameters
    ----------
    task : PointToPoint or callable
        The move; its limits become constraints. Or a function of candidates to objectives, any
        simulator: see `GivenFunction`. It runs in this process, as its author wrote it.
    profile : JointProfile, optional
        How the joint moves; by default the polynomial that `plan_move` takes for the task: of six
        terms without limits, of 18 or 24 within.
    algorithm : str, SearchMethod or pymoo Algorithm, optional
        A name of `PRESETS`: ``"nsga2-paper"`` and ``"vepso"`` have the paper's settings, the others
        pymoo's. Or an object of one's own `SearchMethod`. Or any multi-objective algorithm of pymoo
        that was not run yet; it is copied, so the one given stays as it is. By default
        ``"nsga2"``; of a function that of `DEFAULT_OF_FUNCTIONS` for the number of candidates.
    bound : float
        Largest absolute coefficient; required, unless the profile has a `default_bound`.
    lower, upper, units, constraints, reference, vectorized
        Of a function, as of a `GivenFunction`, or its attributes.
    population, generations : int, optional
        Individuals (particles in a swarm) and generations; by default those of the preset, or a
        population that fits the `evaluations` where these are few (`Preset.population_for`). With
        an algorithm of your own its population counts.
    evaluations : int, optional
        Candidates in all, in place of generations: the search ends after exactly so many, in the
        middle of a generation if need be. Required of a function, unless generations are given.
    settings : mapping, optional
        Other settings of a method known by name, as ``{"crossover": 0.7}``; see `Preset.settings`.
    seed : int
        Seed of the random numbers.
    threads : int
        Blocks of the population that are evaluated at the same time; of a function of one
        candidate, so many candidates.
    start : Front, optional
        Its points are in the first population, as many as that holds.
    report : callable, optional
        Called with a `SearchProgress` after every generation. Of a method without generations,
        such as gp, after each call of the function; where it has more than 200, after each half per
        cent of the candidates, or a second.
    begun : callable, optional
        Called with the run before its first candidate: after Ctrl-C, or an error of a function, the
        `front` of that run has what was found until then.
    objectives : sequence of str
        Residual and energy, and peaks beside them, as ``"peak_torque"``; of a function any names.
    energy : callable, optional
        Of a task, an energy of one's own in the place of the task's: a function of `MoveSamples`,
        which has torque, speed, tips and modes of many candidates at once as NumPy arrays, to an
        energy for each. The front is then a `FunctionFront`.
    noise, reevaluate
        As of a `RecordedFunction`: noise of residual and energy, as a share, and how often a
        candidate that is kept is evaluated.
    state : path, optional
        Of a function with `evaluations`: a file to which each of its results is written. After a
        kill the same search takes them from there. It does not know the function's code: give
        another file if that changes.

    Returns
    -------
    Front
        At most 100 of the non-dominated points found: of a move with values by CVODES, without any
        noise; of a function a `FunctionFront` with the values that it gave.

    Raises
    ------
    ValueError
        When an argument is out of range or missing, the front to start from is of another
        profile or beyond the bound, or the function fails.
    """
    names_of_function: dict[str, Any] = {
        "lower": lower, "upper": upper, "units": units, "constraints": constraints,
        "reference": reference, "vectorized": vectorized,
    }  # fmt: skip
    # not at the top: it takes pymoo's problems and the archive with it, for a search alone
    from quietarm.metaheuristics.problems.problem_function import ProblemFunction

    if isinstance(task, ProblemFunction):
        problem: ProblemFunction | SearchedMove = task
    elif isinstance(task, PointToPoint) or not callable(task):
        move = instance("task", task, PointToPoint)
        for name, value in names_of_function.items():
            if value is not None:
                raise ValueError(f"{name} is for a function, and this is a task; leave it out")
        problem = SearchedMove(move, profile, bound, objectives, threads)
        if energy is not None:
            from quietarm.metaheuristics.problems.own_energy import OwnEnergyFunction

            problem = OwnEnergyFunction(
                move,
                None if profile is None else profile_to_search(profile),
                energy=energy,
                bound=bound,
                objectives=objectives,
                threads=threads,
            )
    else:
        for name, value in {"profile": profile, "bound": bound, "energy": energy}.items():
            if value is not None:
                raise ValueError(
                    f"{name} is for a task, and this is a function, which has lower and upper; "
                    "leave it out"
                )
        from quietarm.metaheuristics.problems.given_function import GivenFunction

        problem = GivenFunction(task, objectives=objectives, threads=threads, **names_of_function)
    if state is not None:
        if isinstance(task, PointToPoint):
            raise ValueError("state is for a function; a search of a move is soon done again")
        _refuse_with_state({"generations": generations, "start": start, "noise": noise})
    run = SearchRun.begin(
        problem,
        algorithm,
        population=population,
        generations=generations,
        evaluations=evaluations,
        settings=settings,
        seed=seed,
        start=start,
        noise=noise,
        reevaluate=reevaluate,
    )
    if state is not None:
        _keep(run, check_writable(state), population, settings)
    if begun is not None:
        begun(run)
    # pymoo's NSGA-III leaves all warnings of the process switched off
    with warnings.catch_warnings():
        run.finish(report)
    return run.front()


def _keep(
    run: SearchRun, path: Path, population: int | None, settings: Mapping[str, object] | None
) -> None:
    """Keep what a user's function returns in a file, with what that has from before."""
    from quietarm.metaheuristics.problems.given_function import GivenFunction

    if not isinstance(run.function.asked, GivenFunction):
        raise ValueError("state is for a function of your own; leave it out")
    function = copy(run.function.asked)  # the one that is given may be searched again
    function.kept = KeptValues(StateFile(path, run.state(population, settings)))
    run.function.asked = function


def _refuse_with_state(options: Mapping[str, object]) -> None:
    """Refuse what a search with a state file does not have."""
    for name, value in options.items():
        if value:
            raise ValueError(f"{name} is not for a search with a state file; leave it out")
