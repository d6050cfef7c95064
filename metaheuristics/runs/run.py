"""One run of an algorithm on a task: its generations, its record, its checkpoint, its front."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import moocore
import numpy as np
import pymoo
from numpy.typing import NDArray
from pymoo.core.algorithm import Algorithm
from pymoo.termination.max_gen import MaximumGenerationTermination

from metaheuristics.algorithms.nsga2 import PaperNSGA2
from metaheuristics.algorithms.provenance import stated
from metaheuristics.algorithms.states import array_of, count_of, number_of, part_of
from metaheuristics.algorithms.vepso import VEPSO
from metaheuristics.objective.population import PopulationObjective
from metaheuristics.objective.problem import UNUSABLE, MoveProblem
from metaheuristics.runs.checkpoint import load_checkpoint, refuse_another_search, save_checkpoint
from ocp import JointProfile, PointToPoint, reference_corner
from ocp.documents import profile_to_document, reading, task_to_document, versions
from ocp.front import Front, FrontPoint, Generation, non_dominated
from ocp.rollout import default_steps

CHECKPOINT_SECONDS = 2.0


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
    failed, infeasible : int
        Candidates among them that were not finite, and that broke a limit of the task.
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


class Run:
    """The algorithm, its problem, and what is recorded on the way.

    Parameters
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    algorithm : Algorithm
        A fresh one, of this run alone.
    method : str
        Its name.
    settings : mapping
        Bound, population and generations.
    seed, threads : int
        As for `search`.

    Raises
    ------
    ValueError
        When the algorithm refuses the problem.
    """

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
        self.reference = reference_corner(task)
        self.stated = stated(algorithm)  # before the run, which adds what is no setting
        termination = MaximumGenerationTermination(settings["generations"])
        try:
            algorithm.setup(self.problem, termination=termination, seed=seed)
        except AssertionError as error:  # how pymoo's MOEA/D refuses constraints
            raise ValueError(f"{method} cannot search this task: {error}") from None

    @property
    def resumable(self) -> bool:
        """Whether the algorithm has a state that can be kept."""
        return isinstance(self.algorithm, VEPSO | PaperNSGA2)

    @property
    def seconds(self) -> float:
        """How long it took so far, with the runs that it resumes."""
        return self.before + time.perf_counter() - self.began

    def go(
        self,
        checkpoint: str | Path | None,
        report: Callable[[SearchProgress], None],
        interrupts: list[int],
    ) -> str:
        """Run to the end, or to the first interrupt in the list, and write the checkpoint.

        A search is not lost with its checkpoint: where that cannot be written it goes on, and
        tries again.

        Parameters
        ----------
        checkpoint : path or None
            File for the state.
        report : callable
            Called with a `SearchProgress` after every generation.
        interrupts : list of int
            Signals until now; a KeyboardInterrupt adds one.

        Returns
        -------
        str
            Why the last state is not in the file; empty where it is.
        """
        saved = time.perf_counter()
        try:
            while not interrupts and self.algorithm.has_next():
                progress = self._next()
                if progress is not None:
                    report(progress)
                if checkpoint and time.perf_counter() - saved > CHECKPOINT_SECONDS:
                    self._try_to_save(checkpoint)
                    saved = time.perf_counter()
        except KeyboardInterrupt:  # raised by a report, say
            interrupts.append(signal.SIGINT)
        return self._try_to_save(checkpoint) if checkpoint and self.history else ""

    def front(self) -> Front:
        """What was found until now, with figures of a finer rollout."""
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
            settings={**self.settings, **self.stated},
            seed=self.seed,
            reference=self.reference,
            evaluations=int(self.algorithm.evaluator.n_eval),
            failed=self.problem.failed,
            infeasible=self.problem.infeasible,
            history=tuple(self.history),
            versions=_versions(),
            seconds=self.seconds,
        )

    def save(self, path: str | Path) -> None:
        """Write a checkpoint; ValueError when the file cannot be written."""
        state = {
            "algorithm": self.algorithm.state(),
            "evaluations": np.array([g.evaluations for g in self.history]),
            "hypervolume": np.array([g.hypervolume for g in self.history]),
            "failed": self.problem.failed,
            "infeasible": self.problem.infeasible,
            "seconds": self.seconds,
        }
        save_checkpoint(path, self._header(), state)

    def _try_to_save(self, path: str | Path) -> str:
        try:
            self.save(path)
        except ValueError as error:
            return str(error)
        return ""

    def resume(self, path: str | Path) -> None:
        """Go on from a checkpoint of the same search.

        Parameters
        ----------
        path : str or Path
            The file; it is left as it was.

        Raises
        ------
        FileFormatError
            When it is not a whole checkpoint.
        ValueError
            When it is of another search, or of other versions of what computes one.
        """
        header, state = load_checkpoint(path)
        refuse_another_search(path, header, self._header())
        with reading(path, "checkpoint"):
            self._restore(state)

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
            failed=self.problem.failed,
            infeasible=self.problem.infeasible,
        )

    def _found(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Coefficients and objectives of the feasible, finite points of the front so far."""
        if self.algorithm.opt is None:
            return np.empty((0, self.profile.size)), np.empty((0, 2))
        X, F, CV = (self.algorithm.opt.get(name) for name in ("X", "F", "CV"))
        usable = (F < UNUSABLE).all(axis=1) & (CV.ravel() <= 0)
        return X[usable], F[usable]

    def _header(self) -> dict[str, Any]:
        return {
            "method": self.method,
            "seed": self.seed,
            "settings": self.settings,
            "algorithm": self.algorithm.settings,
            "profile": profile_to_document(self.profile),
            **task_to_document(self.task),
            # Python's own is left out: no figure depends on it
            "versions": {name: v for name, v in _versions().items() if name != "python"},
        }

    def _restore(self, state: Mapping[str, Any]) -> None:
        """Take over a state; KeyError, TypeError or ValueError where it is not one of this run."""
        self.algorithm.restore(part_of(state, "algorithm"))
        done = self.algorithm.n_iter - 1
        evaluations = array_of(state, "evaluations", (done,), least=1)
        shares = array_of(state, "hypervolume", (done,), 0.0, 1.0)
        if np.any(np.diff(evaluations) < 0) or evaluations[-1] != self.algorithm.evaluator.n_eval:
            raise ValueError("evaluations do not rise to those of the algorithm")
        for known in (self.algorithm.pop, self.algorithm.opt):
            X, F, G = known.get("X", "F", "G")
            if not (np.isfinite(F).all() and np.isfinite(G).all()):
                raise ValueError("F or G has entries that are not finite")
            if np.any(np.abs(X) > self.settings["bound"]):
                raise ValueError("X has entries beyond the bound")
        self.history = [
            Generation(int(count), float(share))
            for count, share in zip(evaluations, shares, strict=True)
        ]
        self.problem.failed = count_of(state, "failed")
        self.problem.infeasible = count_of(state, "infeasible")
        self.before = number_of(state, "seconds")


def _versions() -> dict[str, str]:
    return {**versions(), "pymoo": pymoo.__version__}
