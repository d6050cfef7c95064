"""The runs of a bench, and what they say: indicators and cost at the end and on the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from quietarm.metaheuristics import Job, NamedProblem
from quietarm.metaheuristics.named_method import NamedMethod
from quietarm.metaheuristics.score import (
    HYPERVOLUME,
    Indicator,
    filled,
    known_indicators,
    objectives,
    scores_on_the_way,
)
from quietarm.metaheuristics.spread import Spread
from quietarm.ocp import Front
from quietarm.ocp.front.points import LEVELS, Entries, beyond
from quietarm.ocp.limits import FRONT
from quietarm.studies.bench.running_times import (
    History,
    expected_running_time,
    hits,
    running_times,
    write_histories,
)
from quietarm.views.report.method_rows import label_of

Array = NDArray[np.float64]
ENERGIES = [f"energy_{1e3 * level:g}mm" for level in LEVELS]
"""Columns of energies within these residuals."""
MISSING = "missing"
"""Column of the hypervolume that a run lacks, which a bench ranks methods by."""


@dataclass(frozen=True)
class Run:
    """One front of a bench, with its problem and its method's name with settings."""

    problem: NamedProblem
    method: str
    front: Front
    imported: bool = False

    def __post_init__(self) -> None:
        if not self.front.history:
            raise ValueError(
                f"a front of {self.method} says nothing of its cost; give one that a job or a "
                "recorded function wrote, or import its coefficients by quietarm evaluate"
            )

    @property
    def label(self) -> str:
        """Method, seed and problem in words."""
        seed = self.front.record.seed
        return f"{self.method}{'' if seed is None else f', seed {seed}'} on {self.problem.name}"

    @property
    def copies_reference(self) -> bool:
        """Return whether all points copy the reference front's motions: it searched for none."""
        # share of the box by which a run's motion may differ from the reference motion that it
        # copies: decimals that were cut, or a small shift. Neighbours on the reference fronts are
        # 2e-4 to 9e-3 of it apart in the median, so that what a search finds between them is no
        # copy
        tolerated = 1e-5
        lower, upper = self.problem.box
        known = self.problem.reference().front.coefficients
        distances = [
            (np.abs(known - point) / (upper - lower)).max(axis=1).min()
            for point in self.front.coefficients
        ]
        return len(distances) > 0 and max(distances) <= tolerated

    @cached_property
    def history(self) -> History:
        """Hypervolume that the run lacked of the reference front's, and its cost, at each mark."""
        return self.history_of(HYPERVOLUME)

    def history_of(self, indicator: Indicator) -> History:
        """Return what the run lacked by an indicator, and had cost, at each mark."""
        marks = self.front.history
        scores = scores_on_the_way(self.front, self.problem.reference(), indicator)
        counts_candidates = derivative_free(self.method)
        seconds = [mark.seconds for mark in marks]
        evaluations = [mark.evaluations if counts_candidates else np.nan for mark in marks]
        return History(
            lacking(scores, indicator),
            np.array(seconds),
            np.array(evaluations, float),
        )

    @cached_property
    def scores(self) -> dict[str, float]:
        """Every indicator of its points, by name."""
        return self.problem.reference().scores(objectives(self.front))

    @cached_property
    def scores_between(self) -> dict[str, float]:
        """Scores of the run with motions between its points."""
        return self.problem.reference().scores(filled(self.front))


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
        self.runs = tuple(
            sorted(runs, key=lambda run: (run.problem.name, run.front.record.seed or 0))
        )
        self._groups: dict[tuple[str, str], list[Run]] = {}
        for run in self.runs:
            group = self._groups.setdefault((run.problem.name, run.method), [])
            if group and group[-1].front.record.seed == run.front.record.seed:
                raise ValueError(
                    f"{run.method} on {run.problem.name} has seed {run.front.record.seed} twice; "
                    "give every run once, with the seed that it had"
                )
            group.append(run)

    @classmethod
    def of_jobs(cls, fronts: Mapping[Job, Front], imported: Sequence[Front] = ()) -> Results:
        """Make results of jobs, and of recorded runs of other libraries on the jobs' problems."""
        labels = [label for label, _ in {(job.label, job.budget) for job in fronts}]
        several = {label for label in labels if labels.count(label) > 1}
        runs = [
            Run(
                job.problem,
                _method(job, several),
                front,
            )
            for job, front in fronts.items()
        ]
        return cls([*runs, *imported_runs(imported, list(fronts))])

    @cached_property
    def problems(self) -> tuple[NamedProblem, ...]:
        """Problems that have runs, by name."""
        return tuple({run.problem.name: run.problem for run in self.runs}.values())

    @property
    def moves(self) -> tuple[NamedProblem, ...]:
        """Problems that are moves, and no functions: these have energies within residuals."""
        return tuple(problem for problem in self.problems if problem.is_move)

    @cached_property
    def methods(self) -> tuple[str, ...]:
        """Methods that have runs."""
        return tuple(sorted({run.method for run in self.runs}))

    def of(self, problem: str, method: str) -> list[Run]:
        """The runs of a method on a problem."""
        return self._groups.get((problem, method), [])

    @cached_property
    def table(self) -> pd.DataFrame:
        """Every run, a row: indicators of its points and with motions between, and its cost.

        Of every indicator less is better: ``missing`` is the share of the reference front's
        hypervolume that a run lacks, and there is a column for each of the others; ``energy_``
        columns are energies within a residual above the reference front's, as shares, NaN where the
        run has none; beside them stand figures of a user's own, of the motions with these energies.
        These columns, and those of motions between points, are of moves alone: of a function they
        are left out, and NaN beside moves. Seconds are processor time, ``seconds`` of the search
        alone, ``all_seconds`` with builds and checks.
        """
        best = {
            problem.name: [problem.reference().front.least_energy(level) for level in LEVELS]
            for problem in self.moves
        }
        return pd.DataFrame([_row(run, best.get(run.problem.name)) for run in self.runs])

    @cached_property
    def copies(self) -> list[Run]:
        """Imported runs that only evaluated motions of the reference front."""
        return [run for run in self.runs if run.imported and run.copies_reference]

    @property
    def imported(self) -> int:
        """Number of runs that are not of this bench."""
        return sum(run.imported for run in self.runs)

    def is_repeated(self, problem: str, method: str) -> bool:
        """Return whether a method found the same from every seed: its runs are not independent.

        By the residuals and energies of the fronts' points, not by what is computed from them.
        """
        return (problem, method) in self._repeated

    @cached_property
    def _repeated(self) -> frozenset[tuple[str, str]]:
        return frozenset(group for group, runs in self._groups.items() if _is_one_front(runs))

    def histories(
        self, problem: str, method: str, indicator: Indicator = HYPERVOLUME
    ) -> list[History]:
        """Return histories of a method's runs on a problem, by hypervolume or another indicator."""
        runs = self.of(problem, method)
        if indicator is HYPERVOLUME:
            return [run.history for run in runs]
        return [run.history_of(indicator) for run in runs]

    def missing(self, problem: str, method: str, by: str = "seconds") -> tuple[Array, Array]:
        """Return where the missing share changes, in processor seconds or evaluations, by run.

        Returns
        -------
        at : ndarray, shape (places,)
            All places at which any run has a mark, rising.
        missing : ndarray, shape (runs, places)
            Share after each; 1 before a run's first mark.
        """
        histories = self.histories(problem, method)
        at = np.unique(np.concatenate([history.cost(by) for history in histories]))
        rows = [
            np.append(1.0, history.missing)[
                np.searchsorted(
                    history.cost(by),
                    at,
                    side="right",
                )
            ]
            for history in histories
        ]
        return at, np.array(rows)

    def hits(
        self, problem: str, method: str, targets: Sequence[float], by: str = "seconds"
    ) -> Array:
        """Return where each run first missed no more than each target, as `running_times.hits`."""
        return hits(self.histories(problem, method), targets, by)

    def expected_running_time(
        self,
        problem: str,
        method: str,
        target: float,
        by: str = "seconds",
        indicator: Indicator = HYPERVOLUME,
    ) -> tuple[float, float, float]:
        """The time and its interval, as `running_times.expected_running_time`."""
        histories = self.histories(problem, method, indicator)
        return expected_running_time(histories, target, by)

    @cached_property
    def running_times(self) -> pd.DataFrame:
        """Expected running times to all targets, with intervals, and how many runs reached each."""
        return running_times({group: self.histories(*group) for group in self._groups})

    def write_histories(self, path: str | Path) -> None:
        """Write what every run lacked mark by mark, as `running_times.write_histories`."""
        write_histories(
            (
                (run.problem.name, bench_label(run.method), run.front.record.seed, run.history)
                for run in self.runs
            ),
            path,
        )


def _is_one_front(runs: Sequence[Run]) -> bool:
    """Return whether several runs have the same points, in residual and energy."""
    # points of two fronts, scaled to the reference front, that differ by no more are the same:
    # nearer the reference fronts are not known
    tolerated = 1e-5
    scale = runs[0].problem.reference()
    first, *rest = (scale.scaled(objectives(run.front)) for run in runs)
    return bool(rest) and all(
        points.shape == first.shape and np.abs(points - first).max(initial=0.0) <= tolerated
        for points in rest
    )


def imported_runs(fronts: Sequence[Front], jobs: Sequence[Job]) -> list[Run]:
    """Recorded runs of other libraries on the problems of the jobs that they name.

    ValueError when a front is of none of the problems, of another move, named as a method of the
    jobs, or has points beyond the box. One that searched a wider box counts at its end alone: marks
    on the way know no box.
    """
    by_name = {job.problem.name: job.problem for job in jobs}
    labels = {job.label for job in jobs}
    runs = list[Run]()
    for front in fronts:
        name = front.record.settings.get("problem")
        method = front.record.method
        if method in labels:
            raise ValueError(
                f"an imported run is of {method}, which the bench runs itself; name its method "
                "otherwise, or leave it out"
            )
        if name not in by_name:
            raise ValueError(
                f"a run of {method} is on {name or 'no named problem'}, and the bench on "
                f"{', '.join(by_name)}; give that problem too, or leave the run out"
            )
        problem = by_name[str(name)]
        if (front.task, front.profile) != (problem.task, problem.profile):
            what = "move" if problem.is_move else "function"
            raise ValueError(f"a run of {method} is of another {what} than {name}")
        if front.record.bound != problem.bound:
            _refuse_beyond(front, problem)
            front = replace(front, history=front.history[-1:], entries=Entries())
        runs.append(Run(problem, method, front, imported=True))
    return runs


def _refuse_beyond(front: Front, problem: NamedProblem) -> None:
    """Refuse a front with a point that is not within the problem's bounds."""
    lower, upper = problem.box
    table = front.coefficients
    for row, column in beyond(table, lower, upper):
        raise ValueError(
            f"a run of {front.record.method} has a_{column + 1} = {table[row, column]:.4g}, and "
            f"{problem.name} allows {lower[column]:.4g} to {upper[column]:.4g}; search within "
            "these bounds, or leave the run out"
        )


def derivative_free(method: str) -> bool:
    """Return whether all of a method's work is candidates simulated without derivatives."""
    named = NamedMethod.read(method)
    return not (named.by_gradient or named.polish)


bench_label = partial(label_of, solver="sqp")
"""A method in tables and pictures; the gradient's solver is the SQP where no other is named."""


def quartiles(values: ArrayLike) -> tuple[float, float, float]:
    """Lower quartile, median and upper quartile, by the rule of `Spread`."""
    spread = Spread.of(np.asarray(values, dtype=float).tolist())
    return spread.lower, spread.median, spread.upper


def _method(job: Job, several: set[str]) -> str:
    """A job's method, with its budget where it has several."""
    plain = job.budget is None or job.label not in several
    return job.label if plain else f"{job.label}(budget={job.budget})"


def lacking(scores: Any, indicator: Indicator) -> Any:
    """Return what scores lack to the best that there is: 1 where more is better, else 0."""
    return 1.0 - scores if indicator.more_is_better else scores


def column_of(indicator: Indicator) -> str:
    """Return the heading in tables of what an indicator lacks."""
    if indicator is HYPERVOLUME:
        return MISSING
    return f"missing_{indicator.name}" if indicator.more_is_better else indicator.name


def told_apart(share: float) -> float:
    """A share to the accuracy of a front, so that what differs by less is a tie."""
    return round(share, 6) + 0.0


def _row(run: Run, best: Sequence[float] | None) -> dict[str, Any]:
    """The figures of a run; energies as shares above the best, where the problem is a move."""
    front = run.front
    last = run.front.history[-1]
    window = {} if best is None else {"residual_window_s": front.task.residual_window}
    row: dict[str, Any] = {
        "problem": run.problem.name,
        "method": run.method,
        "seed": front.record.seed,
        **window,
        "points": len(front.points),
    }
    scored = {"": run.scores}
    if best is not None:  # motions between the points of a function would cost calls
        scored["_between"] = run.scores_between
    for name, indicator in known_indicators().items():
        column = column_of(indicator)
        if column in row:
            raise ValueError(f"{column} is a column already; give the indicator another name")
        for suffix, scores in scored.items():
            score = lacking(scores[name], indicator)
            row[f"{column}{suffix}"] = told_apart(score) if column == MISSING else score
    row |= _energies(front, best or [])
    return row | {
        "evaluations": last.evaluations,
        "gradients": last.gradients,
        "hessians": last.hessians,
        "seconds": last.seconds,
        "all_seconds": front.record.seconds,
    }


def _energies(front: Front, best: Sequence[float]) -> dict[str, float]:
    """Energies within residuals as shares above the best, with figures of a user's own there."""
    row = dict[str, float]()
    for name, level, least in zip(ENERGIES, LEVELS, best):
        row[name] = told_apart(front.least_energy(level) / least - 1)
        figures = front.figures_within(level, FRONT)
        at = name.removeprefix("energy_")
        row |= {f"{column}_{at}": value for column, value in figures.items()}
    return row
