"""Jobs: one method on one problem from one seed gives one front, and one file of a folder."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from quietarm.interrupts import interruptible
from quietarm.metaheuristics.evaluation.noise import noise_share, times_evaluated
from quietarm.metaheuristics.methods.gradient_methods import (
    check_settings,
    gradient_front,
    polished,
    solver_with,
    split_for_polish,
)
from quietarm.metaheuristics.methods.presets import PRESETS, preset_of
from quietarm.metaheuristics.methods.user_method import (
    Method,
    check_method,
    digest_of,
    is_of_pymoo,
    method_name,
    run_method,
    why_not_sent,
)
from quietarm.metaheuristics.named_method import NamedMethod
from quietarm.metaheuristics.parallel import MOST_WORKERS, LostWorkersError, side_by_side
from quietarm.metaheuristics.problems.catalogue import NamedProblem, problem_of, why_no_problem
from quietarm.metaheuristics.run_files import JOB, check_run, digest_of_job
from quietarm.metaheuristics.run_search import search
from quietarm.metaheuristics.search_run import MOST_EVALUATIONS
from quietarm.ocp import FileFormatError, Front, QuietarmError
from quietarm.ocp.checks import whole, words_of_error
from quietarm.ocp.objectives import refuse_more_objectives
from quietarm.ocp.record import Setting

DIED = "its worker died twice"
_rehearsed: set[tuple[NamedProblem, str]] = set()


@dataclass(frozen=True)
class Job:
    """One method on one problem from one seed.

    Attributes
    ----------
    problem : NamedProblem
        The problem, or the name of one of `PROBLEMS`; of your own function
        `NamedProblem.of_function`.
    method : str, pymoo Algorithm, AskTell or callable
        A search of `PRESETS`, alone or polished by the gradient (``"nsga2+polish"``); a method by
        the gradient, as ``"epsilon"`` or ``"weighted:ipopt"``; an algorithm of pymoo that was not
        run yet; your own object with ``setup(function, seed)``, ``ask()`` and ``tell(candidates,
        objectives, violations)``, which is copied for each job; or your own function, called with
        the problem's recorded function, seed and budget. Of their candidates the first `budget`
        count.
    seed : int
        Seed of the random numbers.
    budget : int, optional
        Evaluations of a search; those of its preset by default. Gradient methods stop when they
        have converged, and have none.
    settings : mapping, optional
        Of the method: what `search` takes, ``population`` too; ``points`` of a front by the
        gradient, ``starts`` of multistart; of a gradient method and of a polish also the options
        of its solver, as ``solver_tolerance``.
    noise, reevaluate : float, int
        Of a search or your own function, as of a `RecordedFunction`. The gradient is that of the
        model, which has none.

    Raises
    ------
    ValueError
        When a name is not known, a number is out of range, or settings do not fit the method.
    """

    problem: NamedProblem
    method: Method
    seed: int = 0
    budget: int | None = None
    settings: Mapping[str, Setting] = field(default_factory=dict, hash=False)
    noise: float = 0.0
    reevaluate: int = 1

    def __init__(
        self,
        problem: NamedProblem | str,
        method: Method,
        seed: int = 0,
        budget: int | None = None,
        settings: Mapping[str, Setting] | None = None,
        noise: float = 0.0,
        reevaluate: int = 1,
    ) -> None:
        if not isinstance(problem, str | NamedProblem):
            raise TypeError(why_no_problem("problem", problem))
        problem = problem_of(problem) if isinstance(problem, str) else problem
        share = noise_share(noise)
        named = NamedMethod.admitted(method, PRESETS) if isinstance(method, str) else None
        method = str(named) if named else method
        fields = {
            "problem": problem,
            "method": method,
            "seed": whole("seed", seed, 0),
            "budget": _budget(named or method, budget, settings or {}, len(problem.objectives)),
            "settings": dict(settings or {}),
            "noise": share,
            "reevaluate": times_evaluated(reevaluate, share),
        }
        if named and problem.given is not None and (named.by_gradient or named.polish):
            raise ValueError(
                f"{method} takes the gradient of a model, and {problem.name} is a function, which "
                "has none; give a search"
            )
        if named and named.by_gradient:
            refuse_more_objectives(named.method, problem.objectives)
            if share:
                raise ValueError(
                    f"{method} takes the gradient of the model, which has no noise; leave the "
                    "noise out"
                )
        elif named:
            preset = preset_of(named.method)
            preset.refuse_unfit(len(problem.objectives), share, of_model=problem.given is None)
        for name, value in fields.items():
            object.__setattr__(self, name, value)

    @property
    def label(self) -> str:
        """The method with its settings, as it stands in files and tables."""
        words = [f"{name}={value}" for name, value in sorted(self.settings.items())]
        if self.noise:
            words.append(f"noise={self.noise:g}")
        if self.reevaluate > 1:
            words.append(f"reevaluate={self.reevaluate}")
        return f"{method_name(self.method)}{'(' + ','.join(words) + ')' if words else ''}"

    @property
    def name(self) -> str:
        """Name of the job's file in a folder, without the ending."""
        spent = "" if self.budget is None else f"{self.budget}-evaluations-"
        method = re.sub(r"[/\\\0\n]|^\.+", "-", self.label.replace(":", "-by-"))  # one folder
        return f"{self.problem.name}/{method}/{spent}seed{self.seed}"

    def run(self) -> Front:
        """Find the front, with its effort during the run; points by CVODES.

        Its ``settings`` name the problem, and have a digest of the job, by which its file is known.
        A user's own function is called as often as the budget says: of it there is no rehearsal.
        """
        digest = digest_of(self.method)
        if self.problem.given is None and (self.problem, self.label) not in _rehearsed:
            self._find(rehearse=True)
            _rehearsed.add((self.problem, self.label))
        front = self._find()
        stated = {"problem": self.problem.name, **front.record.settings}
        if self.budget is not None:
            stated["budget"] = self.budget
        if digest:
            stated["digest"] = digest
        return front.restated(settings={**stated, JOB: digest_of_job(self)})

    def _find(self, rehearse: bool = False) -> Front:
        # generations, or points, that are found and forgotten before the first job of its kind in
        # a process: what is loaded then, and compiled by IPOPT and others, is no part of a
        # method's time
        rehearsal = 3
        problem = self.problem
        budget = self.budget
        settings = dict(self.settings)
        method: Any = self.method
        named = NamedMethod.read(method) if isinstance(method, str) else None
        common: Any = {"seed": self.seed}
        searched: Any = problem.given
        if problem.given is None:
            searched = problem.task
            common |= {
                "profile": problem.profile,
                "bound": problem.bound,
                "objectives": problem.objectives,
            }
        if named and named.by_gradient:
            if rehearse:
                settings["starts" if named.method == "multistart" else "points"] = rehearsal
            return gradient_front(
                problem.task,
                method=named,
                settings=settings,
                **common,
            )
        population: Any = settings.pop("population", None)
        size = 100
        options = dict[str, Any]()
        if named:
            method = named.method
            preset = PRESETS[method]
            if named.polish:
                options, settings = split_for_polish(settings, preset.setting_names)
            of_population = population or preset.population_for(budget)
            size = preset.evaluations(of_population, 1, len(problem.objectives))
        assert budget is not None  # only the gradient ends by itself
        budget = min(budget, rehearsal * size) if rehearse else budget
        if not (named or is_of_pymoo(method)):
            function = problem.recorded(
                budget, noise=self.noise, reevaluate=self.reevaluate, seed=self.seed
            )
            run_method(method, function, self.seed, budget)
            return function.front(self.label, self.seed)
        front = search(
            searched,
            algorithm=method,
            population=population,
            settings=settings,
            evaluations=budget,
            noise=self.noise,
            reevaluate=self.reevaluate,
            **common,
        )
        return polished(front, solver_with(options)) if named and named.polish else front


def _budget(
    method: NamedMethod | Method,
    budget: int | None,
    settings: Mapping[str, Setting],
    objectives: int,
) -> int | None:
    """The evaluations of a method for so many objectives.

    ValueError where method, settings and budget do not fit.
    """
    if isinstance(method, NamedMethod):
        if method.by_gradient:
            if budget is not None:
                raise ValueError(f"{method} ends by itself; leave its budget out")
            check_settings(method, settings)
            return None
        preset = preset_of(method.method)
        search_settings = dict(settings)
        if method.polish:
            options, search_settings = split_for_polish(settings, preset.setting_names)
            solver_with(options)  # refuses what is out of range
        population: Any = search_settings.pop("population", preset.population_for(budget))
        preset.checked(population, search_settings)
        if budget is None:
            return preset.evaluations(population, preset.generations, objectives)
        preset.refuse_less_than_one(budget, population, objectives)
        return whole("budget", budget, 1, MOST_EVALUATIONS)
    check_method(method)
    if budget is None:
        raise ValueError(f"give a budget for {method_name(method)}, in evaluations")
    if settings:
        raise ValueError(f"{method_name(method)} takes no settings here; set it before you give it")
    return whole("budget", budget, 1, MOST_EVALUATIONS)


class LostJobsError(QuietarmError):
    """Some jobs failed, or their workers died.

    Attributes
    ----------
    failures : mapping of str to str
        Why, by the name of the job.
    fronts : mapping of Job to Front
        Those that are done.
    """

    def __init__(self, failures: Mapping[str, str], fronts: Mapping[Job, Front]) -> None:
        self.failures = failures
        self.fronts = fronts
        name, why = next(iter(failures.items()))
        more = len(failures) - 1
        done = "1 job is" if len(fronts) == 1 else f"{len(fronts)} jobs are"
        died = DIED in failures.values()
        remedy = ", with fewer workers where memory ran short" if died else ""
        super().__init__(
            f"{name}: {why}{f'; and {more} more' if more else ''}; {done} done, run "
            f"the others again{remedy}"
        )


JobReport = Callable[[Job, Front, int, int], None]
"""Called with a job, its front, and how many of how many are done."""


@interruptible
def run_jobs(
    jobs: Sequence[Job],
    folder: str | Path,
    *,
    workers: int | str = 1,
    part: tuple[int, int] = (1, 1),
    report: JobReport = lambda job, front, done, total: None,
    finished: Mapping[Job, Front] | None = None,
) -> dict[Job, Front]:
    """Run the jobs that have no file yet.

    Each completed job is a file. After an interruption the same call continues; only the jobs that
    were in progress are lost.

    Parameters
    ----------
    jobs : sequence of Job
        No job twice.
    folder : path
        Where their files are.
    workers : int or str
        Processes of this machine, of one thread each; 1 runs in this one. Or the address of a dask
        scheduler whose workers run them, as ``tcp://host:8786``.
    part : (int, int)
        Which of how many equal parts of the jobs, as ``(2, 8)`` for every eighth from the second.
    report : callable, optional
        Called after each job that is run.
    finished : mapping of Job to Front, optional
        What `finished_jobs` gave for the same jobs and folder, where it is known already.

    Returns
    -------
    dict of Job to Front
        All jobs that are done, in the order given.

    Raises
    ------
    ValueError
        When there is no job, or one twice, a file is of another problem, of other versions or of
        a method that has changed, or is not what a bench wrote for its job, a number is out of
        range, or no scheduler answers.
    LostJobsError
        At the end, if jobs failed, or their workers died twice.
    """
    if not isinstance(workers, str):
        workers = whole("workers", workers, 1, MOST_WORKERS)
    index = whole("part", part[0], 1, part[1])
    parts = whole("parts", part[1], 1)
    _refuse_twice(jobs)
    done = finished_jobs(jobs, folder) if finished is None else dict(finished)
    failures = dict[str, str]()
    mine = [job for job in jobs[index - 1 :: parts] if job not in done]
    total = len(mine)
    count = 0
    if workers != 1:
        reasons = {job.name: why_not_sent(job.method) for job in mine}
        failures |= {name: reason for name, reason in reasons.items() if reason}

    def run(tried: Sequence[Job], apart: bool = False) -> None:
        nonlocal count
        for job, outcome in _outcomes(tried, Path(folder), workers, apart):
            if isinstance(outcome, Front):
                done[job] = outcome
                count += 1
                report(job, outcome, count, total)
            else:
                failures[job.name] = outcome

    def missing() -> list[Job]:
        return [job for job in mine if job not in done and job.name not in failures]

    run(missing())
    while remaining := missing():  # a worker was killed, and what it left is tried again
        if isinstance(workers, str):
            run(remaining)
            failures |= {job.name: DIED for job in missing()}
            break
        # whose worker died is among those that were handed out; alone it takes no other with it
        for job in remaining[: 2 * workers]:
            run([job], apart=True)
            failures |= {job.name: DIED} if job in missing() else {}
        run(missing())
    ordered = {job: done[job] for job in jobs if job in done}
    if failures:
        raise LostJobsError(failures, ordered)
    return ordered


@interruptible
def finished_jobs(jobs: Sequence[Job], folder: str | Path) -> dict[Job, Front]:
    """The fronts of those jobs whose files are in a folder, which may be missing.

    Errors are those of `run_jobs`.
    """
    paths = {job: Path(folder, f"{job.name}.json") for job in jobs}
    return {job: _load(job, path) for job, path in paths.items() if path.exists()}


def _load(job: Job, path: Path) -> Front:
    """A job's file; ValueError where it holds something else."""
    from quietarm.metaheuristics.archive import search_versions

    try:
        front = Front.load(path)
        problem = job.problem
    except FileFormatError as error:
        raise FileFormatError(f"{error}; delete that file, and its run is done again") from None
    same = (front.task, front.profile, front.record.bound, front.objectives)
    if same != (problem.task, problem.profile, problem.bound, problem.objectives):
        raise ValueError(f"{path} is of another problem than {problem.name}; give another folder")
    if front.record.settings.get("digest", "") != digest_of(job.method):
        raise ValueError(f"{path} is by {job.label} as it was before; give another folder")
    now = search_versions()
    for name in ("quietarm", "pymoo"):
        if front.record.versions.get(name) != now[name]:
            raise ValueError(
                f"{path} is by {name} {front.record.versions.get(name)}, and here is {now[name]}; "
                "give another folder"
            )
    check_run(front, job, path)
    return front


def _refuse_twice(jobs: Sequence[Job]) -> None:
    if not jobs:
        raise ValueError("there are no jobs; give at least one problem and one method")
    seen = set[str]()
    for job in jobs:
        if job.name in seen:
            raise ValueError(f"the job {job.name} is given twice; give it once")
        seen.add(job.name)


def _outcomes(jobs: Sequence[Job], folder: Path, workers: int | str, apart: bool = False) -> Any:
    """Each job with its front, or why there is none, as they end; fewer where a worker dies."""
    by_name = {job.name: job for job in jobs}  # a job from a worker has a copy of its function
    with suppress(LostWorkersError):
        for name, outcome in side_by_side(_run, jobs, workers, apart=apart):
            if isinstance(outcome, Front):
                path = folder / f"{name}.json"
                path.parent.mkdir(parents=True, exist_ok=True)
                outcome.save(path)
            yield by_name[name], outcome


def _run(job: Job) -> tuple[str, Front | str]:
    """A job in a worker; what is wrong with it is an outcome and ends no other job."""
    try:
        return job.name, job.run()
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # of any kind: a user's own lines, which may also exit
        return job.name, _reason(error)


def _reason(error: BaseException) -> str:
    """Say why there is no front, in one line."""
    text = " ".join(str(error).split())
    if isinstance(error, QuietarmError | ValueError) and text:
        return text
    return words_of_error(error)
