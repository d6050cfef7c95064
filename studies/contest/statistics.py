"""Which differences between methods are more than chance: ranks, tests, effect sizes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from quietarm.studies.contest.measures import Arena, methods_in

Array = NDArray[np.float64]
LEAST_RUNS = 5
"""With fewer seeds, or fewer problems, no test could find anything."""
ALPHA = 0.05


@dataclass(frozen=True)
class Ranking:
    """Mean ranks of methods, and how far apart they must be to tell them apart."""

    on: str
    blocks: str
    methods: tuple[str, ...]
    ranks: tuple[float, ...]
    statistic: float
    p_value: float
    critical: float

    @property
    def differ(self) -> bool:
        """Whether Friedman's test says that the methods are not all alike."""
        return self.p_value < ALPHA

    @property
    def alike(self) -> list[tuple[int, int]]:
        """First and last place of every longest group that the tests do not tell apart."""
        last = len(self.ranks) - 1
        if not self.differ:
            return [(0, last)]
        ends = [
            max(j for j in range(i, last + 1) if self.ranks[j] - self.ranks[i] <= self.critical)
            for i in range(last + 1)
        ]
        return [(i, end) for i, end in enumerate(ends) if end > i and end not in ends[:i]]


@dataclass(frozen=True)
class Pair:
    """Two methods on one problem."""

    problem: str
    one: str
    other: str
    effect: float
    p_value: float
    adjusted: float


def why_none(arenas: Sequence[Arena]) -> str:
    """Why there are no statistics at all, in a line; empty where there are some."""
    if find_spec("scipy") is None:
        return "statistics need scipy: pip install 'quietarm[contest]'; they are left out"
    if len({field.method for arena in arenas for field in arena.alike}) < 2:
        return "one method alone is not compared: statistics are left out"
    if not any(len(_common_seeds(arena)) >= LEAST_RUNS for arena in arenas):
        return f"fewer than {LEAST_RUNS} runs of each method: statistics are left out"
    return ""


def ranking(values: Array, methods: Sequence[str], what: str, on: str = "") -> Ranking:
    """Rank methods within each block, and test whether they differ.

    Friedman's test, and Nemenyi's critical difference as Demsar has it.
    """
    from scipy import stats

    blocks, count = values.shape
    means = stats.rankdata(values, axis=1).mean(axis=0)
    with np.errstate(invalid="ignore"):  # where all are equal
        found = stats.friedmanchisquare(*values.T)
    quantile = stats.studentized_range.ppf(1 - ALPHA, count, np.inf) / np.sqrt(2)
    order: list[int] = np.argsort(means, kind="stable").tolist()
    return Ranking(
        on=on,
        blocks=f"{blocks} {what}",
        methods=tuple(methods[i] for i in order),
        ranks=tuple(float(means[i]) for i in order),
        statistic=float(found.statistic),
        p_value=1.0 if np.isnan(found.pvalue) else float(found.pvalue),
        critical=float(quantile * np.sqrt(count * (count + 1) / (6 * blocks))),
    )


def ranking_on(arena: Arena) -> Ranking | None:
    """Methods ranked on one problem, seed by seed; None with fewer than three or too few runs.

    Without those whose results came from elsewhere: they have no seeds.
    """
    fields, seeds = arena.own, _common_seeds(arena)
    if len(fields) < 3 or len(seeds) < LEAST_RUNS:
        return None
    values = [field.final[[run.front.seed in seeds for run in field.runs]] for field in fields]
    methods = [field.method for field in fields]
    return ranking(np.column_stack(values), methods, "seeds", arena.problem)


def ranking_over(arenas: Sequence[Arena]) -> Ranking | None:
    """Methods ranked by their medians, problem by problem.

    None with fewer than three methods, or fewer than `LEAST_RUNS` problems on which all of them
    have so many runs. Results from elsewhere are ranked where they are alike on every problem.
    """
    known = [
        {field.method: field.middle for field in arena.alike if len(field.runs) >= LEAST_RUNS}
        for arena in arenas
    ]
    own = {field.method for arena in arenas for field in arena.own}
    methods = [
        name for name in methods_in(arenas) if name in own or all(name in here for here in known)
    ]
    rows = [
        [here[method] for method in methods]
        for here, arena in zip(known, arenas, strict=True)
        if here.keys() >= set(methods) and len(_common_seeds(arena)) >= LEAST_RUNS
    ]
    if len(methods) < 3 or len(rows) < LEAST_RUNS:
        return None
    return ranking(np.array(rows), methods, "problems", "all problems")


def pairs_on(arena: Arena) -> list[Pair]:
    """Every pair of methods on a problem that both have `LEAST_RUNS` runs of one length on."""
    from scipy import stats

    pairs = list(combinations([f for f in arena.alike if len(f.runs) >= LEAST_RUNS], 2))
    tests = [stats.mannwhitneyu(one.final, other.final) for one, other in pairs]
    adjusted = holm([float(test.pvalue) for test in tests])
    return [
        Pair(
            problem=arena.problem,
            one=one.method,
            other=other.method,
            effect=1 - float(test.statistic) / (len(one.final) * len(other.final)),
            p_value=float(test.pvalue),
            adjusted=p_value,
        )
        for (one, other), test, p_value in zip(pairs, tests, adjusted, strict=True)
    ]


def holm(p_values: Sequence[float]) -> list[float]:
    """P-values of several tests, corrected by Holm's step-down method."""
    order = np.argsort(p_values)
    steps = np.minimum(1.0, np.arange(len(order), 0, -1) * np.array(p_values)[order])
    return np.maximum.accumulate(steps)[np.argsort(order)].tolist()


def _common_seeds(arena: Arena) -> set[int | None]:
    """Seeds from which every method was run."""
    return set.intersection(*({run.front.seed for run in field.runs} for field in arena.own))
