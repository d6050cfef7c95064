"""Tests, verdicts and ranks of a bench, against scipy and all permutations."""

import os
import subprocess
import sys
from dataclasses import replace
from itertools import combinations
from math import comb

import moocore
import numpy as np
import pytest
from bench_problems import NAME, OTHERS
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from quietarm.metaheuristics import PROBLEMS, problem_of
from quietarm.studies.bench.bench_page import bench_report, problem_table
from quietarm.studies.bench.results import Results, Run, quartiles
from quietarm.studies.bench.statistics import (
    attainable_p,
    kruskal_on,
    moves_of,
    pairs_on,
    ranking_over,
    say_power,
    say_power_of,
    verdict_on,
)


@pytest.mark.slow
def test_tests_are_exact_and_no_verdict_is_given_without_power(fronts):
    searches = {job: front for job, front in fronts.items() if job.method != "epsilon"}
    results = Results.of_jobs(searches)
    table = pairs_on(results, NAME)
    assert len(table) == 3
    # five runs of each: the least p of a pair is 2 / C(10, 5)
    assert table["p"].min() == pytest.approx(2 / comb(10, 5))
    assert attainable_p(5, 5) == pytest.approx(2 / 252)
    assert table["least_p_holm"].tolist() == pytest.approx([3 * 2 / 252] * 3)
    verdict = verdict_on(results, NAME)
    assert "is best" in verdict
    assert "random search" not in verdict
    few = Results.of_jobs({job: front for job, front in searches.items() if job.seed < 3})
    assert "not significant: with 3 runs" in verdict_on(few, NAME)


def test_power_is_said_of_the_test_that_is_used():
    # Mann and Whitney's 6 * 2 / C(10, 5), and the sign test's 3 * 2 / 2^5
    assert say_power(5, 4) == (
        "with 5 runs of each of 4 methods (6 pairs) the least Holm-adjusted p is 0.048, and 0.19 "
        "against a deterministic method; use at least 7 runs to test against one"
    )
    assert say_power(7, 4).endswith("is 0.0035, or 0.047 against a deterministic method")
    assert say_power(5, 5) == (
        "with 5 runs and 10 pairs no Holm-adjusted p can be below 0.05; use at least 6 runs, or 8 "
        "to test against a deterministic method"
    )


@pytest.mark.slow
def test_against_a_repeated_method_five_runs_give_no_verdict(fronts):
    results = Results.of_jobs(fronts)  # five runs of four methods; epsilon repeats itself
    assert results.is_repeated(NAME, "epsilon(points=8)")
    table = pairs_on(results, NAME).set_index(["one", "other"])
    for (one, other), pair in table.iterrows():
        repeated = "epsilon" in one + other
        # three pairs by the sign test, after three by Mann and Whitney's
        least = 3 * 2 / 2**5 if repeated else 6 * 2 / comb(10, 5)
        assert pair["least_p_holm"] == pytest.approx(least)
        assert pair["p_holm"] >= least
    assert verdict_on(results, NAME).endswith(
        "not significantly different from it, because 5 runs are too few: "
        "epsilon constraint, SQP (points=8)"
    )
    # where the nearest is the one that repeats itself, nothing can be told
    two = {job: front for job, front in fronts.items() if job.method in ("epsilon", "random")}
    results = Results.of_jobs(two)
    assert problem_table(results, NAME)["method"][0] == "epsilon constraint, SQP (points=8)"
    assert verdict_on(results, NAME) == f"not significant: {say_power(5, 2)}"


@pytest.mark.slow
def test_runs_are_told_to_be_one_by_their_fronts(fronts):
    """Motions differ and their points do not; columns computed from them round either way."""
    problem = problem_of(NAME)
    front = next(front for job, front in fronts.items() if job.method == "epsilon")
    best = problem.reference().front

    def runs_of(method, *changed):
        return [Run(problem, method, one.restated(seed=i)) for i, one in enumerate(changed)]

    points = [
        replace(point, coefficients=tuple(0.99 * a for a in point.coefficients))
        for point in front.points
    ]
    others_between = replace(front, points=tuple(points))
    extent = np.ptp(best.energies)

    def moved(by):
        points = [replace(point, energy=point.energy + by * extent) for point in front.points]
        return replace(front, points=tuple(points))

    results = Results([
        *runs_of("between", front, others_between, front),
        *runs_of("hardly", front, moved(2e-6), moved(-2e-6)),
        *runs_of("another", front, moved(1e-3), front),
        *runs_of("fewer", front, replace(front, points=front.points[:-1]), front),
    ])  # fmt: skip
    assert results.table.query("method == 'hardly'")["energy_1mm"].nunique() == 3
    repeated = [name for name in results.methods if results.is_repeated(NAME, name)]
    assert repeated == ["between", "hardly"]
    # one value against three runs: the sign test's least p is 2 / 2^3, Mann and Whitney's 2 / 20
    least = pairs_on(results, NAME).set_index(["one", "other"])["least_p_holm"]
    assert least["another", "between"] >= 2 / 2**3


def results_with(one, other, front):
    """Two methods whose energies within 1 mm have the order of these numbers; 0 is none."""
    still = front.points[0]
    runs = []
    for method, numbers in (("one", one), ("other", other)):
        for seed, number in enumerate(numbers):
            point = replace(still, residual=0.0 if number else 1.0, energy=1.0 + number)
            own = replace(front.restated(seed=seed), points=(point,))
            runs.append(Run(problem_of(NAME), method, own))
    return Results(runs)


samples = st.lists(st.integers(0, 4), min_size=2, max_size=5).filter(lambda s: len(set(s)) > 1)


@pytest.mark.slow
@settings(max_examples=30)
@given(one=samples, other=samples)
def test_with_ties_p_is_that_of_all_permutations_and_never_below_the_least(fronts, one, other):
    (pair,) = pairs_on(results_with(one, other, next(iter(fronts.values()))), NAME, "energy_1mm").p
    ranks = stats.rankdata([number or 9 for number in (*one, *other)])
    sums = [sum(subset) for subset in combinations(ranks, len(one))]
    own = ranks[: len(one)].sum()
    tails = np.mean(np.array(sums) <= own), np.mean(np.array(sums) >= own)
    assert pair == pytest.approx(min(1.0, 2 * min(tails)))
    assert pair >= attainable_p(len(one), len(other)) * (1 - 1e-12)


@pytest.mark.slow
def test_runs_that_repeat_each_other_are_one_value(fronts):
    front = next(iter(fronts.values()))
    above = results_with([1] * 6, [2, 3, 4, 5, 2, 3], front)
    assert pairs_on(above, NAME, "energy_1mm").p.item() == pytest.approx(2 * 0.5**6)  # six tosses
    assert np.isnan(kruskal_on(above, NAME, "energy_1mm"))
    assert verdict_on(above, NAME, "energy_1mm") == "one is best"
    around = results_with([3] * 6, [1, 2, 4, 5, 3, 3], front)
    assert pairs_on(around, NAME, "energy_1mm").p.item() == 1.0
    certain = results_with([1] * 6, [2] * 6, front)
    assert pairs_on(certain, NAME, "energy_1mm").isna().sum().to_list() == [0, 0, 0, 1, 1, 1]
    assert verdict_on(certain, NAME, "energy_1mm") == "one is best"
    report = bench_report(certain, "quietarm bench").markdown()
    assert "Deterministic, and therefore one value in the tests: one; other." in report


@pytest.mark.slow
def test_what_differs_by_less_than_a_front_s_accuracy_is_a_tie(fronts):
    front = next(iter(fronts.values()))
    close = results_with([1, 2, 3], [1 + 1e-8, 2 - 1e-8, 3 + 1e-8], front)
    assert pairs_on(close, NAME, "energy_1mm").effect.item() == 0.5


def test_power_counts_what_is_imported():
    own = [(NAME, method) for method in ("nsga2", "epsilon") for _ in range(5)]
    assert say_power_of(own).startswith("with 5 runs of each of 2 methods (1 pair) the least")
    assert "5 runs of each of 3 methods (3 pairs)" in say_power_of([*own, *[(NAME, "my")] * 6])
    assert say_power_of([*own, (NAME, "my")]) == say_power_of(own)  # too few runs for a test
    assert say_power_of([(NAME, "nsga2"), (NAME, "my")]) == (
        "with 1 run and 1 pair no Holm-adjusted p can be below 0.05; use at least 4 runs, or 6 to "
        "test against a deterministic method"
    )


TIES = """
import sys
from dataclasses import replace

import quietarm as qa
from quietarm.metaheuristics import problem_of
from quietarm.studies.bench.results import Results, Run
from quietarm.studies.bench.bench_page import bench_report, brief_report

problem, front = problem_of("single-link-30deg-0.8s-2-terms"), qa.Front.load(sys.argv[1])
runs = [
    Run(problem, method, replace(front, points=front.points[i:]).restated(seed=seed))
    for method in ("gde3", "nsga2", "spea2", "random", "vepso", "nsga3", "smsemoa")
    for seed, i in enumerate((0, 1, 2, 3, 4, 5, 6, 7))
]
results = Results(runs)
print(brief_report(results).markdown(), bench_report(results, "line").markdown())
"""


@pytest.mark.slow
def test_a_report_does_not_depend_on_the_order_of_sets(fronts, tmp_path):
    """Seven methods with the same medians: their order is that of the table under any seed."""
    next(front for job, front in fronts.items() if job.method == "nsga2").save(tmp_path / "f.json")
    told = [
        subprocess.run(
            [sys.executable, "-c", TIES, str(tmp_path / "f.json")],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True, text=True, check=True, timeout=240,
        ).stdout
        for seed in ("1", "2")
    ]  # fmt: skip
    assert "not significantly different from it: NSGA-II; NSGA-III; random search;" in told[0]
    assert told[0] == told[1]


@pytest.mark.slow
def test_of_motions_that_nobody_found_there_is_no_verdict(fronts):
    far = [(job.label, replace(front, points=front.points[-1:])) for job, front in fronts.items()]
    results = Results([Run(problem_of(NAME), *one) for one in far])
    assert set(pairs_on(results, NAME, "energy_1mm")["p"]) == {1.0}
    assert verdict_on(results, NAME, "energy_1mm") == "no method has such a motion in the median"


def test_problems_of_one_move_count_once():
    groups = moves_of([problem_of(name) for name in (NAME, *OTHERS)])
    assert sorted(len(group) for group in groups) == [1, 2]
    sixteen = [one for one in PROBLEMS.values() if len(one.objectives) == 2]
    assert len(moves_of(sixteen)) == 7


@pytest.mark.slow
def test_a_tool_with_many_runs_on_one_problem_leaves_the_others_ranked(fronts):
    names = [NAME, OTHERS[0], "dual-link-90deg-0.9s"]
    done = [(job.label, front) for job, front in fronts.items()]
    runs = [Run(problem_of(name), *one) for name in names for one in done]
    own = [done[0][1].restated(seed=seed) for seed in range(30)]
    results = Results([*runs, *(Run(problem_of(NAME), "my tool", one) for one in own)])
    ranking = ranking_over(results)
    assert len(ranking.methods) == 4
    assert ranking.left_out == ("my tool (not on all problems, or too few runs)",)


@pytest.mark.slow
def test_missing_values_are_censored(fronts):
    assert quartiles([1.0, 2.0, np.nan]) == (1.0, 2.0, np.inf)
    results = Results.of_jobs(fronts)
    assert np.isinf(results.hits(NAME, "random", [1e-9])).all()
    assert np.isinf(results.expected_running_time(NAME, "random", 1e-9)).all()
    assert ranking_over(results) is None  # one move


@pytest.mark.slow
@pytest.mark.parametrize("by", ["seconds", "evaluations"])
@pytest.mark.parametrize("target", [0.9, 0.6, 0.4, 0.2])
def test_the_expected_running_time_is_cocos_with_an_interval_about_it(fronts, by, target):
    results, spent, reached = Results.of_jobs(fronts), [], []
    scale = problem_of(NAME).reference()
    for job, front in fronts.items():
        if job.method == "nsga2":
            costs = [getattr(mark, by) for mark in front.history]
            found = [front.entries.objectives(mark.evaluations) for mark in front.history[:-1]]
            found.append(np.c_[front.residuals, front.energies])
            assert max(map(len, found)) <= 100  # more would be thinned
            shares = [moocore.hypervolume(scale.scaled(F), ref=[1.1, 1.1]) for F in found]
            shares = np.divide(shares, scale.whole)
            until = [cost for cost, share in zip(costs, shares, strict=True) if 1 - share <= target]
            spent.append(until[0] if until else costs[-1])
            reached.append(bool(until))
    time, low, high = results.expected_running_time(NAME, "nsga2(population=20)", target, by)
    assert time == pytest.approx(sum(spent) / sum(reached) if any(reached) else np.inf)
    assert low <= time <= high
    row = results.running_times.query("method == 'nsga2(population=20)'").iloc[0]
    assert (row["target"], row["runs"]) == (0.1, 5)
