"""The runs of a bench, and what they say: quality and cost at the end and on the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from quietarm.metaheuristics import PRESETS, Job, NamedProblem
from quietarm.metaheuristics.quality import measured
from quietarm.metaheuristics.spread import Spread
from quietarm.ocp import Front
from quietarm.ocp.front.points import LEVELS

Array = NDArray[np.float64]
AT_REST = LEVELS[0]
"""A run arrives at rest where it has a motion within this residual [m]."""
TARGETS = (0.1, 0.03, 0.01, 0.003)
"""Shares of the reference front's hypervolume that may be missing for a target to count as
reached."""
_LABELS = {"epsilon": "epsilon-constraint", "weighted": "weighted sum", "multistart": "multistart"}
_SOLVERS = {"": "SQP", "ipopt": "IPOPT"}


@dataclass(frozen=True)
class Run:
    """One front of a bench, with its problem and its method's name with settings."""

    problem: NamedProblem
    method: str
    front: Front

    def __post_init__(self) -> None:
        if not self.front.history:
            raise ValueError(
                f"a front of {self.method} says nothing of its cost; give one that a job or a "
                "recorded function wrote, or import its coefficients by quietarm evaluate"
            )


class Results:
    """Runs of methods on problems.

    Parameters
    ----------
    runs : sequence of Run
        At least one; ValueError where two of a method on a problem have one seed.
    """

    def __init__(self, runs: Sequence[Run]) -> None:
        if not runs:
            raise ValueError("no run was done; give jobs, or a folder that has some")
        self.runs = tuple(sorted(runs, key=lambda run: (run.problem.name, run.front.seed or 0)))
        seen = set[tuple[str, str, int | None]]()
        for run in self.runs:
            key = run.problem.name, run.method, run.front.seed
            if key in seen:
                raise ValueError(
                    f"{run.method} on {run.problem.name} has seed {run.front.seed} twice; give "
                    "every run once, with the seed that it had"
                )
            seen.add(key)

    @classmethod
    def of_jobs(cls, fronts: Mapping[Job, Front], imported: Sequence[Front] = ()) -> Results:
        """Those of jobs, and recorded runs of other libraries, which name a problem of the jobs."""
        problems = {job.problem.name: job.problem for job in fronts}
        budgets = {(job.label, job.budget) for job in fronts}
        labels = [label for label, _ in budgets]
        runs = [
            Run(job.problem, _method(job.label, job.budget, labels.count(job.label)), front)
            for job, front in fronts.items()
        ]
        for front in imported:
            name = front.settings.get("problem")
            if name not in problems:
                raise ValueError(
                    f"a run of {front.method} is on {name or 'no named problem'}, and the bench on "
                    f"{', '.join(problems)}; give that problem too, or leave the run out"
                )
            problem = problems[str(name)]
            if (front.task, front.profile) != (problem.task, problem.profile):
                raise ValueError(f"a run of {front.method} is of another move than {name}")
            runs.append(Run(problem, front.method, measured(front, problem.reference())))
        return cls(runs)

    @cached_property
    def problems(self) -> tuple[NamedProblem, ...]:
        """Those that have runs, by name."""
        return tuple({run.problem.name: run.problem for run in self.runs}.values())

    @cached_property
    def methods(self) -> tuple[str, ...]:
        """Those that have runs."""
        return tuple(sorted({run.method for run in self.runs}))

    def of(self, problem: str, method: str) -> list[Run]:
        """The runs of a method on a problem."""
        return [run for run in self.runs if (run.problem.name, run.method) == (problem, method)]

    @cached_property
    def table(self) -> pd.DataFrame:
        """Every run, a row: quality of its points and with motions between, and its cost.

        ``missing`` is the share of the reference front's hypervolume that a run lacks; ``energy_``
        columns are energies within a residual above the reference front's, as shares, NaN where the
        run has none; seconds are processor time, ``seconds`` of the search alone, ``all_seconds``
        with builds and checks.
        """
        return pd.DataFrame([_row(run) for run in self.runs])

    def missing(self, problem: str, method: str, by: str = "seconds") -> tuple[Array, Array]:
        """Where the missing share changes, in processor seconds or evaluations, for every run.

        Returns
        -------
        at : ndarray, shape (places,)
            All places at which any run has a mark, rising.
        missing : ndarray, shape (runs, places)
            Share after each; 1 before a run's first mark.
        """
        runs = self.of(problem, method)
        at = np.unique([getattr(mark, by) for run in runs for mark in run.front.history])
        rows = list[Array]()
        for run in runs:
            places = np.array([getattr(mark, by) for mark in run.front.history], dtype=float)
            shares = np.append(1.0, [_missing(mark.quality) for mark in run.front.history])
            rows.append(shares[np.searchsorted(places, at, side="right")])
        return at, np.array(rows)

    def hits(self, problem: str, method: str, target: float, by: str = "seconds") -> Array:
        """Where each run first missed no more than a target; infinite where it never did."""
        found = list[float]()
        for run in self.of(problem, method):
            marks = [mark for mark in run.front.history if _missing(mark.quality) <= target]
            found.append(float(getattr(marks[0], by)) if marks else np.inf)
        return np.array(found)

    def expected_running_time(
        self, problem: str, method: str, target: float, by: str = "seconds"
    ) -> float:
        """What all runs spent until the target, or in all, over the number that reached it.

        As COCO defines it: runs that did not reach it are censored, not left out; infinite where
        none did.
        """
        hits = self.hits(problem, method, target, by)
        ends = [getattr(run.front.history[-1], by) for run in self.of(problem, method)]
        reached = np.isfinite(hits)
        if not reached.any():
            return np.inf
        return float(np.where(reached, hits, ends).sum() / reached.sum())

    @cached_property
    def running_times(self) -> pd.DataFrame:
        """Expected running times to `TARGETS`, a row each, and how many runs reached it."""
        rows = []
        for problem in self.problems:
            for method in self.methods:
                if not (runs := self.of(problem.name, method)):
                    continue
                for target in TARGETS:
                    where = problem.name, method, target
                    reached = int(np.isfinite(self.hits(*where)).sum())
                    rows.append({
                        "problem": problem.name, "method": label_of(method), "target": target,
                        "reached": reached, "runs": len(runs),
                        "seconds": self.expected_running_time(*where),
                        "evaluations": self.expected_running_time(*where, by="evaluations")
                        if derivative_free(method) else np.nan,
                    })  # fmt: skip
        return pd.DataFrame(rows).replace(np.inf, np.nan)


def derivative_free(method: str) -> bool:
    """Whether all of a method's work is candidates simulated without derivatives."""
    name = method.partition("(")[0]
    return "+" not in name and name.partition(":")[0] not in _LABELS


def label_of(method: str) -> str:
    """What a method is called in tables and pictures."""
    name, bracket, settings = method.partition("(")
    search, plus, _ = name.partition("+")
    if search in PRESETS:
        words = f"{PRESETS[search].label}{', polished' if plus else ''}"
    elif search.partition(":")[0] in _LABELS:
        way, _, solver = search.partition(":")
        words = f"{_LABELS[way]}, {_SOLVERS[solver]}"
    else:
        words = name
    return f"{words} {bracket}{settings}" if bracket else words


def quartiles(values: ArrayLike) -> tuple[float, float, float]:
    """Lower quartile, median and upper quartile, by the rule of `Spread`."""
    spread = Spread.of(np.asarray(values, dtype=float).tolist())
    return spread.lower, spread.median, spread.upper


def _method(label: str, budget: int | None, budgets: int) -> str:
    """A method's name, with its budget where it has several."""
    return label if budgets == 1 or budget is None else f"{label}(budget={budget})"


def _missing(quality: Any) -> float:
    return 1.0 if quality is None else 1.0 - quality.hypervolume


def _row(run: Run) -> dict[str, Any]:
    front, last = run.front, run.front.history[-1]
    best = run.problem.reference().front
    row: dict[str, Any] = {
        "problem": run.problem.name, "method": run.method, "seed": front.seed,
        "points": len(front.points), "missing": _missing(last.quality),
        "missing_between": _missing(last.between),
    }  # fmt: skip
    for name, quality in (("", last.quality), ("_between", last.between)):
        row[f"igd_plus{name}"] = np.nan if quality is None else quality.igd_plus
        row[f"epsilon{name}"] = np.nan if quality is None else quality.epsilon
    for level in LEVELS:
        energy = front.least_energy(level) / best.least_energy(level) - 1
        row[f"energy_{1e3 * level:g}mm"] = energy
    row["at_rest"] = bool(np.isfinite(front.least_energy(AT_REST)))
    return row | {
        "evaluations": last.evaluations, "gradients": last.gradients, "hessians": last.hessians,
        "seconds": last.seconds, "all_seconds": front.seconds,
    }  # fmt: skip
