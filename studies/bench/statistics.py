"""Tests whether methods differ by more than chance: ranks, exact tests, effect sizes."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import comb, sqrt
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from quietarm.metaheuristics import NamedProblem
from quietarm.studies.bench.results import ENERGIES, Results, bench_label, quartiles, told_apart
from quietarm.views.report.words import counted

Array = NDArray[np.float64]
ALPHA = 0.05


def attainable_p(runs: int, other_runs: int) -> float:
    """The least p that a pair of methods can have by its test.

    By Mann and Whitney's exact test; by the sign test where one method is a single value, as its
    runs repeat each other.
    """
    fewer, more = sorted((runs, other_runs))
    return min(1.0, 2 / comb(runs + other_runs, runs) if fewer > 1 else 2 / 2**more)


def attainable_by_holm(least: Array) -> Array:
    """The least p by Holm that each of several pairs can have, from the least of their tests.

    A pair comes before all those whose least is no lower. NaN where there is no test.
    """
    return np.minimum(1.0, least * (least[:, None] <= least).sum(axis=1))


def say_power(runs: int, methods: int) -> str:
    """Say what so many runs of so many methods can show, before they are done."""
    pairs = comb(methods, 2)
    if pairs == 0:
        return "one method alone is compared with none"
    least = pairs * attainable_p(runs, runs)
    against_one = min(1.0, (methods - 1) * attainable_p(1, runs))
    needed = _runs_needed(methods - 1, lambda number: attainable_p(1, number))
    if least >= ALPHA:
        usual = _runs_needed(pairs, lambda number: attainable_p(number, number))
        return (
            f"with {counted(runs, 'run')} and {counted(pairs, 'pair')} no Holm-adjusted p can be "
            f"below {ALPHA}; use at least {usual} runs, or {needed} to test against a "
            "deterministic method"
        )
    words = (
        f"with {runs} runs of each of {methods} methods ({counted(pairs, 'pair')}) the least "
        f"Holm-adjusted p is {least:.2g}"
    )
    if against_one < ALPHA:
        return f"{words}, or {against_one:.2g} against a deterministic method"
    return (
        f"{words}, and {against_one:.2g} against a deterministic method; use at least {needed} "
        "runs to test against one"
    )


def _runs_needed(pairs: int, least: Callable[[int], float]) -> int:
    """Return from how many runs on so many pairs can have a Holm-adjusted p below `ALPHA`."""
    return next(runs for runs in range(2, 1000) if pairs * least(runs) < ALPHA)


def say_power_of(runs: Iterable[tuple[str, str]]) -> str:
    """Say what runs, each a problem and a method, can show: the fewest of one, most methods."""
    counts = defaultdict[str, Counter[str]](Counter)
    for problem, method in runs:
        counts[problem][method] += 1
    tested = [
        [count for count in of_problem.values() if count >= _least_runs(of_problem.values())]
        for of_problem in counts.values()
    ]
    return say_power(min(map(min, tested), default=1), max(map(len, tested), default=0))


def _least_runs(counts: Collection[int]) -> float:
    """Half as many runs as is usual: fewer of one method would take the power from all tests."""
    return float(np.median(list(counts))) / 2


@dataclass(frozen=True)
class Ranking:
    """Mean ranks of methods over independent moves, best first.

    Attributes
    ----------
    methods, ranks : tuple
        Names and mean ranks.
    moves : int
        How many independent moves were ranked.
    p_value : float
        Of Friedman's test.
    critical : float
        Nemenyi's critical difference of two mean ranks at 5 %.
    left_out : tuple of str
        Methods that are not ranked, with the reason.
    """

    methods: tuple[str, ...]
    ranks: tuple[float, ...]
    moves: int
    p_value: float
    critical: float
    left_out: tuple[str, ...]

    @property
    def has_power(self) -> bool:
        """Return whether any two mean ranks could differ by the critical difference."""
        return self.critical < len(self.methods) - 1

    @property
    def best(self) -> tuple[str, ...]:
        """The first method and those not significantly different from it."""
        near = (rank - self.ranks[0] <= self.critical for rank in self.ranks)
        return tuple(name for name, is_near in zip(self.methods, near) if is_near)


def pairs_on(results: Results, problem: str, column: str = "missing") -> pd.DataFrame:
    """Every pair of methods on a problem: effect size, p, p by Holm and the least that can be.

    The effect is the share of pairs of runs in which the first is better (Vargha and Delaney's A;
    0.5 is no difference). Runs without a value come last. A method whose runs repeat each other is
    one value, which the sign test holds against the runs of another; two such differ, or not,
    without a test.
    """
    values = {
        name: runs[:1] if results.is_repeated(problem, name) else runs
        for name, runs in values_on(results, problem, column).items()
    }
    rows = [
        (first, second, *_tested(values[first], values[second]))
        for first, second in combinations(values, 2)
    ]
    table = pd.DataFrame(rows, columns=["one", "other", "effect", "p"])
    p_values = table["p"].to_numpy(dtype=float, copy=True)
    tested = np.isfinite(p_values)
    p_values[tested] = holm(p_values[tested])
    sizes = [[len(values[name]) for name in pair] for pair in combinations(values, 2)]
    least = np.array([attainable_p(*pair) for pair in sizes])
    least[~tested] = np.nan
    return table.assign(p_holm=p_values, least_p_holm=attainable_by_holm(least))


def _tested(mine: Array, theirs: Array) -> tuple[float, float]:
    """Effect size and p value of two samples."""
    # runs of the method with fewer, up to which Mann-Whitney's test is exact
    most_exact = 50
    both = np.nan_to_num(np.concatenate([mine, theirs]), nan=np.inf)
    ranks = stats.rankdata(both)  # the test may refuse infinities
    if np.ptp(ranks) == 0:  # nor does it know what is all alike
        return 0.5, 1.0
    first, second = np.split(ranks, [len(mine)])
    test = stats.mannwhitneyu(first, second, method="asymptotic")
    effect = 1 - float(test.statistic) / (len(mine) * len(theirs))
    fewer, more = sorted((first, second), key=len)
    if len(fewer) == 1:
        return effect, _sign_test(fewer[0], more) if len(more) > 1 else np.nan
    return effect, _exact_p(fewer, ranks) if len(fewer) <= most_exact else float(test.pvalue)


def _exact_p(some: Array, ranks: Array) -> float:
    """Twice the share of equally large subsets of the ranks, ties included, with a sum as far out.

    scipy's exact test knows no ties.
    """
    doubled = np.rint(2 * ranks).astype(int)  # of ties they are halves
    size = len(some)
    total = round(2 * some.sum())
    subsets = np.zeros((size + 1, np.sort(doubled)[-size:].sum() + 1))  # by size and sum
    subsets[0, 0] = 1
    for rank in doubled:
        subsets[1:, rank:] += subsets[:-1, :-rank]
    below = subsets[size, : total + 1].sum()
    above = subsets[size, total:].sum()
    return min(1.0, 2 * float(min(below, above) / subsets[size].sum()))


def _sign_test(value: float, runs: Array) -> float:
    """The p value that as many runs lie above a value as below."""
    below = np.count_nonzero(runs < value)
    above = np.count_nonzero(runs > value)
    return float(stats.binomtest(below, below + above).pvalue)


def kruskal_on(results: Results, problem: str, column: str = "missing") -> float:
    """The p value of Kruskal and Wallis' test that all methods on a problem are alike.

    Of those whose runs differ; NaN of fewer than two.
    """
    values = [
        np.nan_to_num(runs, nan=1e300)
        for name, runs in values_on(results, problem, column).items()
        if not results.is_repeated(problem, name)
    ]
    if len(values) < 2 or np.ptp(np.concatenate(values)) == 0:
        return np.nan
    return float(stats.kruskal(*values).pvalue)


def holm(p_values: Array) -> Array:
    """P values of several tests, corrected by Holm's step-down method."""
    order = np.argsort(p_values)
    steps = np.minimum(1.0, np.arange(len(order), 0, -1) * p_values[order])
    adjusted = np.maximum.accumulate(steps) if len(steps) else steps
    return adjusted[np.argsort(order)]


def values_on(results: Results, problem: str, column: str) -> Mapping[str, Array]:
    """A column of the table of runs by method, of one problem.

    Of methods with two runs or more, and half as many as is usual at least; what differs by less
    than the accuracy of a front is the same.
    """
    groups: Any = results.table[results.table["problem"] == problem].groupby("method")[column]
    by_method = {
        str(name): np.array([told_apart(value) for value in values]) for name, values in groups
    }
    least = max(2, _least_runs([len(values) for values in by_method.values()]))
    return {name: values for name, values in by_method.items() if len(values) >= least}


def moves_of(problems: Sequence[NamedProblem]) -> list[list[NamedProblem]]:
    """Problems by move: those of one plant, angle and duration are not independent.

    Each function counts as a move of its own.
    """
    moves: dict[object, list[NamedProblem]] = {}
    for problem in problems:
        moves.setdefault(_move_of(problem), []).append(problem)
    return list(moves.values())


def _move_of(problem: NamedProblem) -> object:
    """Return what tells the move of a problem from others."""
    if not problem.is_move:
        return problem.name
    task = problem.task
    return task.plant, round(task.start, 9), round(task.target, 9), round(task.duration, 9)


def ranking_over(results: Results, column: str = "missing") -> Ranking | None:
    """Rank methods by their medians on each independent move; None with less than 3 of either.

    By energies only moves are ranked, not functions. Ranked are methods that have runs on every
    problem; problems of one move count once, with the mean of their ranks. Of methods with the same
    values throughout, as a search and the same that is yet to be polished, one is ranked.
    """
    problems = results.moves if column in ENERGIES else results.problems
    names = [problem.name for problem in problems]
    known = {name: values_on(results, name, column) for name in names}
    left_out = [
        f"{bench_label(method)} (not on all problems, or too few runs)"
        for method in results.methods
        if any(method not in known[name] for name in names)
    ]
    methods = [m for m in results.methods if all(m in known[name] for name in names)]
    ranked = list[str]()
    for method in methods:
        twin = next((name for name in ranked if _same(known, name, method)), None)
        if twin is None:
            ranked.append(method)
        else:
            left_out.append(f"{bench_label(method)} (the same as {bench_label(twin)})")
    moves = moves_of(problems)
    if len(ranked) < 3 or len(moves) < 3:
        return None
    rows = list[Array]()
    for move in moves:
        medians = [
            [quartiles(known[problem.name][method])[1] for method in ranked] for problem in move
        ]
        rows.append(np.mean([stats.rankdata(row) for row in medians], axis=0))
    ranks = np.array([stats.rankdata(row) for row in rows])
    means = ranks.mean(axis=0)
    count = len(ranked)
    quantile = stats.studentized_range.ppf(1 - ALPHA, count, np.inf) / sqrt(2)
    order = np.argsort(means, kind="stable").tolist()
    return Ranking(
        methods=tuple(ranked[i] for i in order),
        ranks=tuple(means[order].tolist()),
        moves=len(moves),
        p_value=float(np.nan_to_num(stats.friedmanchisquare(*ranks.T).pvalue, nan=1.0)),
        critical=float(quantile * sqrt(count * (count + 1) / (6 * len(moves)))),
        left_out=tuple(left_out),
    )


def _same(known: Mapping[str, Mapping[str, Array]], first: str, second: str) -> bool:
    """Return whether two methods have the same values on all problems."""
    return all(
        np.array_equal(values[first], values[second], equal_nan=True) for values in known.values()
    )


def p_against_best(results: Results, problem: str, column: str = "missing") -> dict[str, float]:
    """Return the Holm-adjusted p of every method against the best one on a problem, by name."""
    medians = {name: quartiles(run)[1] for name, run in values_on(results, problem, column).items()}
    if len(medians) < 2:
        return {}
    best = min(medians, key=lambda name: medians[name])
    table = pairs_on(results, problem, column)
    p_values = dict[str, float]()
    for one, other, p in zip(table["one"], table["other"], table["p_holm"]):
        if best in (one, other):
            p_values[str(other if one == best else one)] = float(p)
    return p_values


def verdict_on(results: Results, problem: str, column: str = "missing") -> str:
    """Return which method is best on a problem, in a sentence, if the runs can show it.

    Power is that of the test which a pair has: of few runs, a method that found the same from every
    seed cannot be told from any other.
    """
    values = values_on(results, problem, column)
    if len(values) < 2:
        return "fewer than two methods have two runs: no test"
    runs = min(map(len, values.values()))
    medians = {name: quartiles(column)[1] for name, column in values.items()}
    best = min(medians, key=lambda name: medians[name])
    if not np.isfinite(medians[best]):
        return "no method has such a motion in the median"
    table = pairs_on(results, problem, column)
    beside = table[(table["one"] == best) | (table["other"] == best)]
    powerless = beside["least_p_holm"] >= ALPHA
    if powerless.sum() == np.isfinite(beside["p"]).sum() > 0:
        return f"not significant: {say_power(runs, len(values))}"
    alike = beside["p_holm"] >= ALPHA
    sentence = f"{bench_label(best)} is best"
    for which, words in (
        (alike & ~powerless, "not significantly different from it"),
        (
            alike & powerless,
            f"not significantly different from it, because {runs} runs are too few",
        ),
    ):
        named = {*beside[which]["one"], *beside[which]["other"]} - {best}
        # in the order of the table where medians are the same
        near = sorted((name for name in values if name in named), key=lambda name: medians[name])
        if near:
            sentence += f"; {words}: {'; '.join(map(bench_label, near))}"
    return sentence
