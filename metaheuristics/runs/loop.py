"""The generations of a search, and its record."""

from __future__ import annotations

import signal
import time
import warnings
from typing import Any

import moocore
import numpy as np
from numpy.typing import NDArray
from pymoo.core.algorithm import Algorithm
from pymoo.core.termination import Termination
from pymoo.termination.max_gen import MaximumGenerationTermination
from quietarm.metaheuristics.objective.population import UNUSABLE
from quietarm.metaheuristics.objective.problem import MoveProblem
from quietarm.metaheuristics.runs.progress import Report, SearchProgress
from quietarm.metaheuristics.runs.settings import SearchSpec
from quietarm.ocp import Generation, reference_corner


def set_up(algorithm: Algorithm, problem: MoveProblem, termination: Termination, seed: int) -> None:
    """Have an algorithm ready for its first generation; ValueError where it is for other tasks."""
    try:
        algorithm.setup(problem, termination=termination, seed=seed)
    except AssertionError as error:  # how pymoo's MOEA/D refuses constraints
        raise ValueError(f"{type(algorithm).__name__} cannot search this task: {error}") from None


class Loop:
    """An algorithm at work on a move."""

    def __init__(
        self, spec: SearchSpec, algorithm: Algorithm, problem: MoveProblem, earlier: float = 0.0
    ) -> None:
        self.spec, self.problem = spec, problem
        self.history: list[Generation] = []
        self.reference = reference_corner(spec.task)
        self._algorithm: Any = algorithm  # for the type checker: pymoo declares much as optional
        self._earlier, self._began = earlier, time.perf_counter()
        termination = MaximumGenerationTermination(spec.settings.generations)
        set_up(algorithm, problem, termination, spec.seed)

    @property
    def evaluations(self) -> int:
        """Candidates evaluated so far."""
        return int(self._algorithm.evaluator.n_eval)

    @property
    def seconds(self) -> float:
        """How long it took so far, with the run that it goes on from."""
        return self._earlier + time.perf_counter() - self._began

    def run(self, interrupts: list[int], *reports: Report) -> None:
        """Run to the end, or to the first interrupt in the list."""
        try:
            while not interrupts and self._algorithm.has_next():
                self._step()
                # some algorithms, as MOEA/D, take many steps a generation
                if self._algorithm.n_iter - 1 > len(self.history):
                    progress = self._record()
                    for report in reports:
                        report(progress)
        except KeyboardInterrupt:  # raised by a report, say
            interrupts.append(signal.SIGINT)

    def _step(self) -> None:
        # a division by a distance of zero is of no concern to a user; and pymoo's NSGA-III leaves
        # all warnings of the process switched off
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            self._algorithm.next()

    def found(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Coefficients and objectives of the feasible, finite points of the front so far."""
        if self._algorithm.opt is None:
            return np.empty((0, self.spec.profile.size)), np.empty((0, 2))
        X, F, CV = (self._algorithm.opt.get(name) for name in ("X", "F", "CV"))
        usable = (F < UNUSABLE).all(axis=1) & (CV.ravel() <= 0)
        return X[usable], F[usable]

    def _record(self) -> SearchProgress:
        _, F = self.found()
        share = float(moocore.hypervolume(F / self.reference, ref=[1.0, 1.0])) if len(F) else 0.0
        self.history.append(Generation(self.evaluations, share))
        least = F.min(axis=0) if len(F) else np.full(2, np.nan)
        return SearchProgress(
            generation=len(self.history),
            generations=self.spec.settings.generations,
            residual=float(least[0]),
            energy=float(least[1]),
            hypervolume=share,
            evaluations=self.evaluations,
            seconds=self.seconds,
            failed=self.problem.failed,
            infeasible=self.problem.infeasible,
        )
