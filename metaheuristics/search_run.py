"""One run of a metaheuristic on a move or a function, for generations or evaluations."""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from math import inf, nan
from typing import TYPE_CHECKING, Any

import numpy as np

from quietarm.metaheuristics.methods.preset import Preset
from quietarm.metaheuristics.methods.presets import PAPER_BOX, PRESETS, preset_of
from quietarm.metaheuristics.methods.search_method import SearchMethod
from quietarm.metaheuristics.search_state import SearchState
from quietarm.ocp import Front, JointProfile, PointToPoint
from quietarm.ocp.checks import instance, whole
from quietarm.ocp.objectives import checked_objectives
from quietarm.ocp.planning.choose_profile import choose_profile
from quietarm.ocp.saved import as_loaded

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from pymoo.core.algorithm import Algorithm

    from quietarm.metaheuristics.problems.problem_function import ProblemFunction
    from quietarm.metaheuristics.problems.recorded import RecordedFunction

MOST_EVALUATIONS = 1_000_000_000
SECONDS_OF_CANDIDATE = 5e-5
"""Of a core: 40,000 of the paper's first move take two seconds."""
DEFAULT = "nsga2"
"""The method of a search of a move where none is named."""
DEFAULT_OF_FUNCTIONS = {1_000: "gp", MOST_EVALUATIONS: "moead-de"}
"""Methods of a search of a function where none is named, by the most candidates they are for."""


@dataclass(frozen=True)
class SearchProgress:
    """Progress of a search after a generation, or after a candidate.

    Attributes
    ----------
    generation, generations : int
        Generations done and asked for; of a method that has none, such as gp, es and slsqp,
        candidates.
    residual, energy : float
        Least residual [m] and least energy [J] found, of different candidates as a rule.
    hypervolume : float
        Share of the reference area that is dominated.
    evaluations, failed, infeasible : int
        Candidates evaluated, and those among them that were not finite, and that violated a limit.
    seconds : float
        Processor time of the search.
    tip_unit, energy_unit : str
        Units of the first two objectives.
    names : (str, str)
        Their names; a user's own function has others than residual and energy.
    step : str
        What is counted: generation or candidate.
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
    energy_unit: str = "J"
    names: tuple[str, str] = ("residual", "energy")
    step: str = "generation"


@dataclass(frozen=True)
class SearchedMove:
    """A task to search, before its function is built: what is wrong with the rest comes first."""

    task: PointToPoint
    profile: JointProfile | None
    bound: float | None
    objectives: Sequence[str]
    threads: int

    def function(self, method: str) -> ProblemFunction:
        """Build its function; ValueError where there are no bounds."""
        # not at the top: pymoo and all that it takes is loaded for a search alone
        from quietarm.metaheuristics.problems.function import MoveFunction

        profile = self.profile
        profile = choose_profile(self.task) if profile is None else profile
        if self.bound is None and profile.default_bound is None:
            papers = ", ".join(f"{box:g} for {plant}" for plant, box in PAPER_BOX.items())
            raise ValueError(
                f"{method} searches within bounds: give one of the coefficients (the paper used "
                f"{papers})"
            )
        return MoveFunction(
            self.task,
            profile,
            bound=self.bound,
            objectives=self.objectives,
            threads=self.threads,
        )


@dataclass(frozen=True, eq=False)
class SearchRun:
    """One run of one method on one function: prepared by `begin`, run by `finish`.

    Attributes
    ----------
    function : RecordedFunction
        What is asked, and what it keeps.
    method : str
        The method's name.
    chosen : Algorithm or callable
        The method itself.
    limits, stated : mapping
        The budget, and what the method is set to, for the record.
    generations, seed : int
        For the display, and of the random numbers.
    first : ndarray
        Rows for the first population.
    """

    function: RecordedFunction
    method: str
    chosen: Any
    limits: Mapping[str, Any]
    stated: Mapping[str, Any]
    generations: int
    seed: int
    first: NDArray[np.float64]

    @classmethod
    def begin(
        cls,
        problem: ProblemFunction | SearchedMove,
        algorithm: str | SearchMethod | Algorithm | None,
        *,
        population: int | None = None,
        generations: int | None = None,
        evaluations: int | None = None,
        settings: Mapping[str, object] | None = None,
        seed: int = 0,
        start: Front | None = None,
        noise: float = 0.0,
        reevaluate: int = 1,
    ) -> SearchRun:
        """Prepare a run; arguments and errors as of `search`."""
        most_generations = 1_000_000
        # Not at the top: pymoo takes longer to load than all of quietarm; only a search needs it.
        from quietarm.metaheuristics.problems.recorded import RecordedFunction

        of_move = isinstance(problem, SearchedMove)
        if of_move:
            problem = replace(
                problem,
                profile=None if problem.profile is None else profile_to_search(problem.profile),
                objectives=checked_objectives(problem.objectives),
            )
            limited = bool(problem.task.limits)
        else:
            limited = bool(problem.constraints)
        objectives = len(problem.objectives)
        if generations is not None and evaluations is not None:
            raise ValueError("evaluations stand in place of generations; leave one of them out")
        if not of_move and generations is None and evaluations is None:
            raise ValueError(
                "evaluations is missing; give the number of candidates, such as 1000: a function "
                "may take long"
            )
        if algorithm is None:
            algorithm = (
                DEFAULT
                if of_move
                else default_of_function(evaluations, population or generations or start)
            )
        if isinstance(algorithm, SearchMethod):
            settings = {name: getattr(algorithm, name) for name in algorithm.defaults()}
            algorithm = algorithm.name
        if isinstance(algorithm, str):
            method = algorithm
            preset = preset_of(algorithm)
            preset.refuse_unfit(objectives, noise, of_model=of_move)
            if limited and not preset.keeps_limits:
                name = "limits" if of_move else "constraints"
                raise ValueError(
                    f"{method} cannot search a {'task' if of_move else 'function'} with {name}; "
                    f"choose another method, such as moead-de, or leave the {name} out"
                )
            chosen, stated = _of_preset(preset, population, evaluations, settings, objectives)
            size = preset.evaluations(stated["population"], 1, objectives)
            usual = preset.generations
            if preset.is_function and start is not None:
                raise ValueError(
                    f"{method} cannot start from a front; leave start (--from) out, or choose a "
                    "method with a population"
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
        seed = whole("seed", seed, 0)
        function = RecordedFunction(
            problem.function(method) if isinstance(problem, SearchedMove) else problem,
            budget=evaluations or inf,
            noise=noise,
            reevaluate=reevaluate,
            seed=seed,
        )
        first = np.empty((0, len(function.variables)))
        if start is not None:
            first = _starts(start, function)
            function.archive.measure_from(start.reference)  # as the hypervolume of the start
        return cls(function, method, chosen, limits, stated, generations, seed, first)

    def finish(self, report: Callable[[SearchProgress], None] | None = None) -> None:
        """Run it to its end."""
        from quietarm.metaheuristics.problems.recorded import BudgetSpentError

        reports = None if report is None else _Reports(self, report)
        # a division by a distance of zero is of no concern to a user
        with np.errstate(all="ignore"), suppress(BudgetSpentError):
            self._finish(reports)
        if reports is not None:
            reports.end()

    def _finish(self, reports: _Reports | None) -> None:
        from quietarm.metaheuristics.problems.pymoo_problem import PymooProblem

        if not self.has_generations:
            if reports is not None:
                self.function.after_call = reports.candidates_done
            self.chosen(self.function, self.seed, self.limits["evaluations"])
            return
        _set_up(self.chosen, PymooProblem(self.function), self.seed, **self.limits)
        for done, _ in enumerate(_generations(self.chosen, self.first), start=1):
            if reports is not None:
                reports.generation_done(done)

    @property
    def has_generations(self) -> bool:
        """Return whether the method goes on by generations; others know candidates alone."""
        from pymoo.core.algorithm import Algorithm as PymooAlgorithm

        return isinstance(self.chosen, PymooAlgorithm)

    def state(self, population: int | None, settings: Mapping[str, object] | None) -> SearchState:
        """Return the state of a search of a function that begins so, with nothing told."""
        problem: Any = self.function.asked
        stated: Any = dict(settings or {})
        state = SearchState(
            problem.searched,
            self.method,
            self.limits["evaluations"],
            self.seed,
            self.function.reevaluate,
            population,
            stated,
            problem.reference or (),
        )
        return as_loaded(state)

    def front(self) -> Front:
        """Make the front of what was found until now."""
        return self.function.front(self.method, self.seed, {**self.limits, **self.stated})


def default_of_function(evaluations: int | None, needs_population: object = None) -> str:
    """The method of a search of a function for so many candidates, where none is named.

    One with a population where that, or generations, or a front to start from are given.
    """
    count = MOST_EVALUATIONS if evaluations is None or needs_population else evaluations
    fits = (name for most, name in DEFAULT_OF_FUNCTIONS.items() if count <= most)
    return next(fits, DEFAULT)


def profile_to_search(profile: object) -> JointProfile:
    """A profile; TypeError that says where a method belongs, if one stands in its place."""
    if (isinstance(profile, str) and profile in PRESETS) or hasattr(profile, "infill"):
        raise TypeError(f"profile is {profile!r}; a method is given as algorithm=...")
    return instance("profile", profile, JointProfile)


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
        raise ValueError(
            f"{name} cannot search this: {error}; choose another method, such as moead-de"
        ) from None
    if evaluations and isinstance(algorithm.termination, MaximumGenerationTermination):
        # pymoo's RVEA makes generations of evaluations, one too few
        generations = -(-evaluations // algorithm.n_offsprings)
        algorithm.termination = MaximumGenerationTermination(generations)


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


class _Reports:
    """Reports of the progress of a run."""

    def __init__(self, run: SearchRun, report: Callable[[SearchProgress], None]) -> None:
        self._run = run
        self._report = report
        self._generations_done = 0
        self._evaluations = 0
        self._at = time.monotonic()

    def generation_done(self, done: int) -> None:
        """Report a generation."""
        self._generations_done = done
        self._say(done)

    def candidates_done(self) -> None:
        """Report candidates, unless it would be too often."""
        most = 200  # a report compares all that was found
        rarest = 1.0  # s
        done = self._run.function.archive.evaluations
        is_some = done - self._evaluations >= self._run.generations / most
        if done > self._evaluations and (is_some or time.monotonic() - self._at >= rarest):
            self._say(done)

    def end(self) -> None:
        """Report what the last candidates have changed, if they were no whole generation."""
        evaluations = self._run.function.archive.evaluations
        if evaluations > self._evaluations:
            self._say(self._generations_done + 1 if self._run.has_generations else evaluations)

    def _say(self, done: int) -> None:
        self._evaluations = self._run.function.archive.evaluations
        self._report(_progress(self._run, done))
        self._at = time.monotonic()


def _progress(run: SearchRun, done: int) -> SearchProgress:
    function = run.function
    archive = function.archive
    F = archive.non_dominated()[1]
    residual, energy = F.min(axis=0).tolist()[:2] if len(F) else (nan, nan)
    return SearchProgress(
        done,
        max(run.generations, done),
        residual,
        energy,
        archive.share_of_box(),
        archive.evaluations,
        archive.seconds,
        function.failed,
        function.infeasible,
        *function.units[:2],
        names=(function.objectives[0], function.objectives[1]),
        step="generation" if run.has_generations else "candidate",
    )


def _starts(front: Front, function: RecordedFunction) -> NDArray[np.float64]:
    """Coefficients of a front within the bounds of a search."""
    same = front.profile == function.profile
    if not function.of_model:  # of a function the bounds may be others
        same = front.coefficients.shape[1] == len(function.variables)
    if not same:
        raise ValueError("the front to start from has another profile; give one of the search's")
    table = front.coefficients
    if ((table < function.lower) | (table > function.upper)).any():
        bounds = "bounds" if function.bound is None else f"bound of {function.bound:g}"
        raise ValueError(f"the front to start from is beyond the {bounds}; give a wider one")
    return table


def _of_preset(
    preset: Preset,
    population: int | None,
    evaluations: int | None,
    settings: Mapping[str, object] | None,
    objectives: int,
) -> tuple[Any, dict[str, Any]]:
    """A method that is known by name, and what it is set to, for so many objectives."""
    most = 100_000
    size = whole(
        "population",
        preset.population_for(evaluations) if population is None else population,
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
        raise ValueError(f"give an algorithm, such as {value.__name__}(), not its class")
    if not isinstance(value, PymooAlgorithm):
        raise TypeError(
            f"algorithm is {value!r}; give a name, such as 'nsga2', or an algorithm of pymoo"
        )
    chosen = copy_of_algorithm(algorithm)
    for name, value in (("population", population), ("settings", settings)):
        if value:
            raise ValueError(f"{name} is set in the algorithm that you give, not beside it")
    return chosen, settings_of(chosen)
