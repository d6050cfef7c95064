"""Which differences between methods are more than chance: ranks, tests, effect sizes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.checks import install
from quietarm.studies.contest.measures import Arena, Field, methods_in

Array = NDArray[np.float64]
LEAST_RUNS = 5
"""With fewer seeds, or fewer problems, no test could find anything."""
ALPHA = 0.05


@dataclass(frozen=True)
class Ranking:
    """Mean ranks of methods, best first, and which of them the tests tell apart.

    Attributes
    ----------
    on, over : str
        What was ranked: a problem's runs, or medians on all problems.
    methods, ranks : tuple
        Names and mean ranks.
    test : str
        Of all methods together, with its `statistic` and `p_value`.
    apart : frozenset of (int, int)
        Places of every two methods that the tests of pairs tell apart, the better one first.
    critical : float or None
        How far apart mean ranks must be for that, where one distance decides.
    """

    on: str
    over: str
    methods: tuple[str, ...]
    ranks: tuple[float, ...]
    test: str
    statistic: float
    p_value: float
    apart: frozenset[tuple[int, int]]
    critical: float | None = None

    @property
    def differ(self) -> bool:
        """Whether the test of all says that the methods are not all alike."""
        return self.p_value < ALPHA

    @property
    def alike(self) -> list[tuple[int, int]]:
        """First and last place of every longest group of which no two are told apart."""
        count, ends = len(self.ranks), list[int]()
        for first in range(count):
            last = first
            while last + 1 < count and not any(
                (place, last + 1) in self.apart for place in range(first, last + 1)
            ):
                last += 1
            ends.append(last)
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
        return f"statistics are left out, as they need scipy; {install('contest')}"
    if len({field.method for arena in arenas for field in arena.alike}) < 2:
        return "one method alone is not compared: statistics are left out"
    if not any(len(_with_enough(arena)) > 1 for arena in arenas):
        return f"fewer than {LEAST_RUNS} runs of each method: statistics are left out"
    return ""


def ranking(values: Array, methods: Sequence[str], what: str, on: str = "") -> Ranking:
    """Rank methods within each block, a row, and test whether they differ.

    Friedman's test, and Nemenyi's critical difference as Demsar has it.
    """
    from scipy import stats

    blocks, count = values.shape
    means = stats.rankdata(values, axis=1).mean(axis=0)
    with np.errstate(invalid="ignore"):  # where all are equal
        found = stats.friedmanchisquare(*values.T)
    quantile = stats.studentized_range.ppf(1 - ALPHA, count, np.inf) / np.sqrt(2)
    order: list[int] = np.argsort(means, kind="stable").tolist()
    ranks, p_value = means[order], 1.0 if np.isnan(found.pvalue) else float(found.pvalue)
    critical = float(quantile * np.sqrt(count * (count + 1) / (6 * blocks)))
    far = np.argwhere(np.triu(ranks - ranks[:, None] > critical)) if p_value < ALPHA else []
    return Ranking(
        on=on,
        over=f"{blocks} {what}",
        methods=tuple(methods[i] for i in order),
        ranks=tuple(ranks.tolist()),
        test="Friedman's test",
        statistic=float(found.statistic),
        p_value=p_value,
        apart=frozenset((int(i), int(j)) for i, j in far),
        critical=critical,
    )


def ranking_on(arena: Arena) -> Ranking | None:
    """Methods ranked on one problem; None with fewer than three that have enough runs.

    Runs of different methods have nothing in common but the problem, also those from one seed, so
    all are ranked together: the Kruskal-Wallis test, and the tests of `pairs_on`.
    """
    from scipy import stats

    fields = _with_enough(arena)
    if len(fields) < 3:
        return None
    finals = [field.final for field in fields]
    together = stats.rankdata(np.concatenate(finals))
    places = np.split(together, np.cumsum([len(final) for final in finals])[:-1])
    means = np.array([one.mean() for one in places])
    order: list[int] = np.argsort(means, kind="stable").tolist()
    methods = [fields[i].method for i in order]
    all_equal = len(set(together)) == 1  # of which scipy makes an error or nan
    found = (0.0, 1.0) if all_equal else stats.kruskal(*finals)
    differ = {
        frozenset((pair.one, pair.other)) for pair in pairs_on(arena) if pair.adjusted < ALPHA
    }
    apart = (
        (i, j)
        for i, j in combinations(range(len(methods)), 2)
        if found[1] < ALPHA and frozenset((methods[i], methods[j])) in differ
    )
    return Ranking(
        on=arena.problem,
        over=f"{len(together)} runs",
        methods=tuple(methods),
        ranks=tuple(means[order].tolist()),
        test="The Kruskal-Wallis test",
        statistic=float(found[0]),
        p_value=float(found[1]),
        apart=frozenset(apart),
    )


def nearest(arena: Arena) -> list[Field]:
    """The method that ends nearest to the exact front, then those not told apart from it."""
    best, ranked = arena.best, ranking_on(arena)
    told = {frozenset((pair.one, pair.other)) for pair in pairs_on(arena) if pair.adjusted < ALPHA}
    if ranked is not None and not ranked.differ:
        told = set()
    others = [field for field in arena.alike if field is not best]
    return [best, *(f for f in others if frozenset((best.method, f.method)) not in told)]


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
    rows = [[here[method] for method in methods] for here in known if here.keys() >= set(methods)]
    if len(methods) < 3 or len(rows) < LEAST_RUNS:
        return None
    return ranking(np.array(rows), methods, "problems", "all problems")


def pairs_on(arena: Arena) -> list[Pair]:
    """Every pair of methods on a problem that both have `LEAST_RUNS` runs of one length on."""
    from scipy import stats

    pairs = list(combinations(_with_enough(arena), 2))
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


def _with_enough(arena: Arena) -> list[Field]:
    """The methods that have runs enough for a test."""
    return [field for field in arena.alike if len(field.runs) >= LEAST_RUNS]
