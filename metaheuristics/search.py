"""Run a metaheuristic on a task: report, checkpoint, resume, and return a front."""

from __future__ import annotations

import copy
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import moocore
import numpy as np
import pymoo
from numpy.typing import NDArray
from pymoo.core.algorithm import Algorithm
from pymoo.core.problem import Problem
from pymoo.termination.max_gen import MaximumGenerationTermination

from metaheuristics.checkpoint import load_checkpoint, save_checkpoint
from metaheuristics.nsga2 import PaperNSGA2
from metaheuristics.population import PopulationObjective
from metaheuristics.presets import PAPER_BOX, PRESETS
from metaheuristics.vepso import VEPSO
from ocp import CycloidPolynomial, JointProfile, PointToPoint, rollout
from ocp.checks import positive, whole
from ocp.documents import profile_to_document, task_to_document, versions
from ocp.files import check_writable
from ocp.front import Front, FrontPoint, Generation, non_dominated
from ocp.interrupts import defer_interrupts
from ocp.rollout import default_steps

CHECKPOINT_SECONDS = 2.0
_UNUSABLE = 1e30
"""Objectives of a candidate that is not finite: finite itself, so that pymoo sorts it last."""


class MoveProblem(Problem):
    """A task as a pymoo problem: coefficients in a box, residual [m] and energy [J] to be small.

    Parameters
    ----------
    objective : PopulationObjective
        What is minimised; the task's limits become inequality constraints.
    bound : float
        Largest absolute coefficient.
    """

    def __init__(self, objective: PopulationObjective, bound: float) -> None:
        size = objective.profile.size
        super().__init__(
            n_var=size,
            n_obj=2,
            n_ieq_constr=len(objective.task.limits),
            xl=np.full(size, -bound),
            xu=np.full(size, bound),
        )
        self.objective, self.failed = objective, 0

    def _evaluate(self, x: NDArray[np.float64], out: dict[str, Any], *args: Any, **kwargs: Any):
        values = self.objective(x)
        table = np.column_stack([values.residual, values.energy, values.violations])
        bad = ~np.isfinite(table).all(axis=1)
        self.failed += int(bad.sum())
        table[bad] = _UNUSABLE
        out["F"] = table[:, :2]
        if table.shape[1] > 2:
            out["G"] = table[:, 2:]


@dataclass(frozen=True)
class SearchProgress:
    """Where a search is, after a generation.

    Attributes
    ----------
    generation, generations : int
        Generations done and asked for.
    residual, energy : float
        Least residual [m] and least energy [J] found, of different candidates as a rule.
    hypervolume : float
        Share of the reference box that is dominated.
    evaluations : int
        Candidates evaluated.
    seconds : float
        Time since the start of the run.
    """

    generation: int
    generations: int
    residual: float
    energy: float
    hypervolume: float
    evaluations: int
    seconds: float


def search(
    task: PointToPoint,
    algorithm: str | Algorithm = "nsga2",
    *,
    profile: JointProfile | None = None,
    bound: float | None = None,
    population: int | None = None,
    generations: int | None = None,
    seed: int = 0,
    threads: int = 1,
    checkpoint: str | Path | None = None,
    resume: str | Path | None = None,
    report: Callable[[SearchProgress], None] = lambda progress: None,
) -> Front:
    """Search the trade-off between residual and energy without derivatives.

    Parameters
    ----------
    task : PointToPoint
        The move; its limits become constraints.
    algorithm : str or pymoo Algorithm
        ``"nsga2"`` or ``"vepso"`` with the paper's settings, or any multi-objective algorithm of
        pymoo.
    profile : JointProfile, optional
        How the joint moves; the cycloid of a polynomial of six terms by default.
    bound : float
        Largest absolute coefficient; required.
    population, generations : int, optional
        Individuals (particles a swarm) and generations; those of the paper by default. With an
        algorithm of your own its population counts, and generations are required.
    seed : int
        Seed of the random numbers.
    threads : int
        Blocks of the population that are evaluated at the same time.
    checkpoint : path, optional
        File to write the state to every few seconds; for ``"nsga2"`` and ``"vepso"``.
    resume : path, optional
        Checkpoint to go on from, of the same search.
    report : callable, optional
        Called with a `SearchProgress` after every generation.

    Returns
    -------
    Front
        The points found, with figures of a finer rollout. After Ctrl-C what was found until then,
        with ``complete`` false.

    Raises
    ------
    ValueError
        When an argument is out of range or missing, or the checkpoint is of another search.
    FileFormatError
        When the file to resume from is not a whole checkpoint.
    """
    profile = CycloidPolynomial() if profile is None else profile
    run = _Run.prepare(task, algorithm, profile, bound, population, generations, seed, threads)
    if (checkpoint or resume) and not run.resumable:
        raise ValueError(f"checkpoints are for nsga2 and vepso, not for {run.method}")
    if checkpoint is not None:
        check_writable(checkpoint)
    if resume is not None:
        run.resume(resume)
    complete = True
    try:
        run.go(checkpoint, report)
    except KeyboardInterrupt:
        complete = False
    return replace(run.front(), complete=complete)


class _Run:
    """One run: the algorithm, its problem, and what is recorded on the way."""

    def __init__(
        self,
        task: PointToPoint,
        profile: JointProfile,
        algorithm: Algorithm,
        method: str,
        settings: Mapping[str, Any],
        seed: int,
        threads: int,
    ) -> None:
        self.task, self.profile, self.method, self.seed = task, profile, method, seed
        self.settings, self.threads = dict(settings), threads
        self.algorithm: Any = algorithm
        self.problem = MoveProblem(
            PopulationObjective(task, profile, threads=threads), settings["bound"]
        )
        self.history: list[Generation] = []
        self.before = 0.0  # seconds of the runs that this one resumes
        self.began = time.perf_counter()
        cycloid = rollout(task, CycloidPolynomial(0), []).motion
        self.reference = (cycloid.residual, 2 * cycloid.energy)
        termination = MaximumGenerationTermination(settings["generations"])
        try:
            algorithm.setup(self.problem, termination=termination, seed=seed)
        except AssertionError as error:  # how pymoo's MOEA/D refuses constraints
            raise ValueError(f"{method} cannot search this task: {error}") from None

    @classmethod
    def prepare(
        cls,
        task: PointToPoint,
        algorithm: str | Algorithm,
        profile: JointProfile,
        bound: float | None,
        population: int | None,
        generations: int | None,
        seed: int,
        threads: int,
    ) -> _Run:
        named = isinstance(algorithm, str)
        if not (named or isinstance(algorithm, Algorithm)):
            raise ValueError(
                f"algorithm is {algorithm!r}; give {', '.join(PRESETS)} or an instance of one of "
                "pymoo's algorithms"
            )
        method = algorithm if isinstance(algorithm, str) else type(algorithm).__name__
        if named and method not in PRESETS:
            raise ValueError(f"unknown method {method!r}; give one of {', '.join(PRESETS)}")
        if bound is None:
            papers = ", ".join(f"{box:g} for {plant}" for plant, box in PAPER_BOX.items())
            raise ValueError(
                f"{method} searches a box: give a bound on the coefficients (the paper used "
                f"{papers})"
            )
        bound = positive("bound on the coefficients", bound)
        if named:
            population = PRESETS[method].population if population is None else population
            generations = PRESETS[method].generations if generations is None else generations
        elif population is not None:
            raise ValueError("population is set in the algorithm that you give, not beside it")
        elif generations is None:
            raise ValueError(f"give the number of generations for {method}")
        population = None if population is None else whole("population", population, 1)
        generations, seed = whole("generations", generations, 1), whole("seed", seed, 0)
        if profile.size == 0:
            raise ValueError("a profile of 0 terms has nothing to choose; give 1 term or more")
        settings = {"bound": bound, "population": population, "generations": generations}
        if isinstance(algorithm, Algorithm):
            chosen = copy.deepcopy(algorithm)  # as it was given, to be given again
        elif method == "vepso":
            chosen = VEPSO(particles=population or 0)
        else:
            chosen = PaperNSGA2(population or 0)
        return cls(task, profile, chosen, method, settings, seed, threads)

    @property
    def resumable(self) -> bool:
        return isinstance(self.algorithm, VEPSO | PaperNSGA2)

    @property
    def seconds(self) -> float:
        return self.before + time.perf_counter() - self.began

    def go(self, checkpoint: str | Path | None, report: Callable[[SearchProgress], None]) -> None:
        try:
            self._generations(checkpoint, report)
        except KeyboardInterrupt:
            if checkpoint and self.history:
                self.save(checkpoint)
            raise
        if checkpoint:
            self.save(checkpoint)

    def _generations(
        self, checkpoint: str | Path | None, report: Callable[[SearchProgress], None]
    ) -> None:
        saved = time.perf_counter()
        while self.algorithm.has_next():
            with defer_interrupts():  # so that what is kept is a whole generation
                progress = self._next()
            if progress is not None:
                report(progress)
            if checkpoint and time.perf_counter() - saved > CHECKPOINT_SECONDS:
                self.save(checkpoint)
                saved = time.perf_counter()

    def _next(self) -> SearchProgress | None:
        self.algorithm.next()
        # some algorithms, as MOEA/D, take many steps a generation
        return self._record() if self.algorithm.n_iter - 1 > len(self.history) else None

    def _record(self) -> SearchProgress:
        _, F = self._found()
        share = float(moocore.hypervolume(F / self.reference, ref=[1.0, 1.0])) if len(F) else 0.0
        evaluations = int(self.algorithm.evaluator.n_eval)
        self.history.append(Generation(evaluations, share))
        least = F.min(axis=0) if len(F) else np.full(2, np.nan)
        return SearchProgress(
            generation=len(self.history),
            generations=self.settings["generations"],
            residual=float(least[0]),
            energy=float(least[1]),
            hypervolume=share,
            evaluations=evaluations,
            seconds=self.seconds,
        )

    def _found(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Coefficients and objectives of the feasible, finite points of the front so far."""
        if self.algorithm.opt is None:
            return np.empty((0, self.profile.size)), np.empty((0, 2))
        X, F, CV = (self.algorithm.opt.get(name) for name in ("X", "F", "CV"))
        usable = (F < _UNUSABLE).all(axis=1) & (CV.ravel() <= 0)
        return X[usable], F[usable]

    def front(self) -> Front:
        X, _ = self._found()
        fine = PopulationObjective(
            self.task, self.profile, steps=default_steps(self.task), threads=self.threads
        )
        values = fine(X.reshape(-1, self.profile.size))
        feasible: NDArray[np.bool_] = np.all(values.violations <= 1e-6, axis=1)
        points = non_dominated(
            FrontPoint(tuple(row.tolist()), float(residual), float(energy))
            for row, residual, energy, kept in zip(
                X, values.residual, values.energy, feasible, strict=True
            )
            if kept
        )
        return Front(
            task=self.task,
            profile=self.profile,
            points=points,
            method=self.method,
            settings=self.settings,
            seed=self.seed,
            reference=self.reference,
            evaluations=int(self.algorithm.evaluator.n_eval),
            failed=self.problem.failed,
            history=tuple(self.history),
            versions={**versions(), "pymoo": pymoo.__version__},
            seconds=self.seconds,
        )

    # -- checkpoints --

    def _header(self) -> dict[str, Any]:
        return {
            "method": self.method,
            "seed": self.seed,
            "settings": self.settings,
            "algorithm": self.algorithm.settings,
            "profile": profile_to_document(self.profile),
            **task_to_document(self.task),
        }

    def save(self, path: str | Path) -> None:
        state = {
            "algorithm": self.algorithm.state(),
            "evaluations": np.array([g.evaluations for g in self.history]),
            "hypervolume": np.array([g.hypervolume for g in self.history]),
            "failed": self.problem.failed,
            "seconds": self.seconds,
        }
        save_checkpoint(path, self._header(), state)

    def resume(self, path: str | Path) -> None:
        header, state = load_checkpoint(path)
        difference = _difference(header, self._header())
        if difference:
            raise ValueError(f"{path} is of another search: its {difference}")
        self.algorithm.restore(state["algorithm"])
        pairs = zip(state["evaluations"].tolist(), state["hypervolume"].tolist(), strict=True)
        self.history = [Generation(evaluations, share) for evaluations, share in pairs]
        self.problem.failed = state["failed"]
        self.before = state["seconds"]


def _difference(theirs: Mapping[str, Any], mine: Mapping[str, Any]) -> str:
    """The first entry in which two nested tables differ, in words; empty where none does."""
    for name, value in mine.items():
        other = theirs.get(name)
        if isinstance(value, Mapping) and isinstance(other, Mapping):
            inner = _difference(other, value) or _difference(value, other)
            if inner:
                return f"{name} {inner}"
        elif other != value:
            return f"{name} is {other!r}, not {value!r}"
    return ""
