"""A bench: its jobs and files, its measures against moocore, and its tests against scipy."""

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from itertools import combinations
from math import comb

import moocore
import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from quietarm.metaheuristics import Job, finished_jobs, run_jobs
from quietarm.metaheuristics.objective.population import ACCURACY
from quietarm.metaheuristics.problems.recorded import RecordedFunction
from quietarm.metaheuristics.quality import CORNER
from quietarm.ocp.cost import COST
from quietarm.studies.bench.asked import jobs_of, problems_of
from quietarm.studies.bench.page import bench_report, problem_table
from quietarm.studies.bench.results import Results, Run, quartiles
from quietarm.studies.bench.statistics import (
    attainable_p,
    moves_of,
    pairs_on,
    ranking_over,
    say_power,
    say_power_of,
    verdict_on,
)
from scipy import stats

import quietarm as qa

NAME = "single-link-30deg-0.8s-2-terms"
OTHERS = ["arm-on-flexible-link-90deg-0.8s-2-terms", "single-link-30deg-0.8s-4-terms"]
METHODS = ["nsga2", "random", "nsga2+polish"]
SMALL = {"population": 20}


@pytest.fixture(scope="module")
def jobs():
    searches = [Job(NAME, method, seed, 200, SMALL if "nsga2" in method else None)
                for seed in range(5) for method in METHODS]  # fmt: skip
    return [*searches, *(Job(NAME, "epsilon", seed, settings={"points": 8}) for seed in range(5))]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("bench")


@pytest.fixture(scope="module")
def fronts(jobs, folder):
    return run_jobs(jobs, folder)


def test_a_job_is_a_file_and_is_not_done_again(jobs, folder, fronts, monkeypatch):
    assert list(fronts) == jobs
    for job, front in fronts.items():
        assert qa.Front.load(folder / f"{job.name}.json") == front
        assert front.record.settings["problem"] == NAME
    monkeypatch.setattr(Job, "run", lambda job: pytest.fail("it was done"))
    assert run_jobs(jobs, folder) == fronts == finished_jobs(jobs, folder)


def test_a_search_spends_its_budget_and_the_gradient_states_its_own(fronts):
    for job, front in fronts.items():
        last = front.history[-1]
        if job.method in ("nsga2", "random"):
            assert (last.evaluations, last.gradients, last.hessians) == (200, 0, 0)
        else:
            assert last.gradients > 0
        assert front.record.seconds >= last.seconds > 0


def test_measures_are_moocores_from_the_files_alone(fronts):
    reference = qa.problem_of(NAME).fronts()[0]
    best = np.c_[reference.residuals, reference.energies]
    ideal, extent = best.min(axis=0), np.ptp(best, axis=0)
    for front in fronts.values():
        points = (np.c_[front.residuals, front.energies] - ideal) / extent
        line = (best - ideal) / extent
        quality = front.history[-1].quality
        corner = [CORNER, CORNER]
        # the reference's is of the line through its points, a little more than of the points
        wanted = moocore.hypervolume(points, ref=corner) / moocore.hypervolume(line, ref=corner)
        assert quality.hypervolume == pytest.approx(wanted, rel=5e-3)
        assert quality.igd_plus == pytest.approx(moocore.igd_plus(points, ref=line))
        assert quality.epsilon == pytest.approx(moocore.epsilon_additive(points, ref=line))
        assert front.history[-1].between.hypervolume >= quality.hypervolume - 1e-12


def test_points_are_by_cvodes_and_searches_see_them_within_the_accuracy_stated(fronts):
    function = qa.problem_of(NAME).function()
    for front in fronts.values():
        seen, _ = function(front.coefficients)
        assert seen[:, 1] == pytest.approx(front.energies, rel=ACCURACY)
        plan = qa.evaluate_coefficients(front.task, front.points[-1].coefficients)
        assert front.points[-1].energy == pytest.approx(plan.energy, rel=1e-12)


LONG = ["arm-on-flexible-link-90deg-0.8s-12-terms", "single-link-30deg-0.8s-20-terms"]


@pytest.mark.parametrize("name", [*LONG, "dual-link-90deg-0.9s"])
def test_random_candidates_are_within_the_accuracy_stated(name):
    problem = qa.problem_of(name)
    own, fine = problem.function(), problem.function(steps=384)
    rows = np.random.default_rng(3).uniform(own.lower, own.upper, (100, len(own.lower)))
    assert own(rows)[0] == pytest.approx(fine(rows)[0], rel=ACCURACY)


def test_a_recorded_run_has_the_figures_of_a_job(fronts):
    job, front = next((j, f) for j, f in fronts.items() if j.method == "random")
    recorded = qa.problem_of(NAME).recorded()
    rng = np.random.default_rng(0)
    for _ in range(2):
        recorded(rng.uniform(recorded.lower, recorded.upper, (100, 2)))
    found = recorded.front("my tool", seed=7)
    assert found.record.evaluations == 200
    assert all(abs(c) <= 0.2 for point in found.points for c in point.coefficients)
    last = found.points[-1]
    assert last.energy == qa.evaluate_coefficients(found.task, last.coefficients).energy
    results = Results.of_jobs({job: front}, [found])
    assert set(results.methods) == {"random", "my tool"}
    elsewhere = qa.problem_of(OTHERS[0]).recorded()
    elsewhere(rng.uniform(-0.1, 0.1, (50, 2)))
    with pytest.raises(ValueError, match="give that problem too"):
        Results.of_jobs({job: front}, [elsewhere.front("my tool")])


def test_a_run_from_a_wider_box_is_imported_where_its_motions_lie_within_the_problem_s(fronts):
    job, front = next((j, f) for j, f in fronts.items() if j.method == "random")
    assert np.abs(front.coefficients).max() <= job.problem.bound
    unbounded = front.restated(bound=None, method="my tool")
    assert "my tool" in Results.of_jobs({job: front}, [unbounded]).methods
    rows = np.random.default_rng(0).uniform(0.3, 0.5, (20, 2))
    for bound in (0.5, None):
        beyond = qa.Front.from_coefficients(
            front.task, rows, method="my tool", profile=front.profile, bound=bound,
            settings={"problem": NAME},
        )  # fmt: skip
        words = (
            rf"a run of my tool has a_1 = 0\.\d+, and {NAME} allows -0\.2 to 0\.2; search within"
        )
        with pytest.raises(ValueError, match=words):
            Results.of_jobs({job: front}, [beyond])


def test_what_a_recorded_run_compiles_is_no_part_of_its_time():
    task = qa.PointToPoint(qa.SingleLinkManipulator(omega=7.123), target=0.5, duration=0.8)
    for rows in (100, 5, 105):  # the last are another block
        before, began = COST.copy(), time.thread_time()
        recorded = RecordedFunction(task, qa.CycloidPolynomial(2), bound=0.2)
        recorded(np.zeros((rows, 2)))
        seconds, built = recorded.archive.seconds, COST.since(before).builds
        assert 0 < seconds <= time.thread_time() - began - built
        assert (built > 0) == (rows < 105)


def test_a_function_of_ones_own_is_a_method_and_runs_in_workers(tmp_path):
    def halton(function, seed, budget):
        rng = np.random.default_rng(seed)
        while True:
            function(rng.uniform(function.lower, function.upper, (30, 2)))

    front = Job(NAME, halton, 1, budget=100).run()
    assert (front.record.method, front.record.evaluations) == ("halton", 100)
    jobs = [Job(NAME, halton, seed, budget=60) for seed in (0, 1)]
    assert list(run_jobs(jobs, tmp_path, workers=2)) == jobs


# -- statistics --


def test_tests_are_exact_and_no_verdict_is_given_without_power(fronts):
    results = Results.of_jobs(fronts)
    table = pairs_on(results, NAME)
    assert len(table) == 6
    # five runs of each: the least p of a pair is 2 / C(10, 5)
    assert table["p"].min() == pytest.approx(2 / comb(10, 5))
    assert attainable_p(5, 5, 10) == pytest.approx(10 * 2 / 252)
    assert "9 are needed" not in say_power(5, 4)
    assert say_power(5, 5) == (
        "with 5 runs and 10 pairs no p can fall below 0.05: 6 runs are needed for a verdict"
    )
    verdict = verdict_on(results, NAME)
    assert "ends nearest" in verdict
    assert "random search" not in verdict
    few = Results.of_jobs({job: front for job, front in fronts.items() if job.seed < 3})
    assert "no verdict: with 3 runs" in verdict_on(few, NAME)


def results_with(one, other, front):
    """Two methods whose energies within 1 mm have the order of these numbers; 0 is none."""
    still = front.points[0]
    runs = []
    for method, numbers in (("one", one), ("other", other)):
        for seed, number in enumerate(numbers):
            point = replace(still, residual=0.0 if number else 1.0, energy=1.0 + number)
            own = replace(front.restated(seed=seed), points=(point,))
            runs.append(Run(qa.problem_of(NAME), method, own))
    return Results(runs)


samples = st.lists(st.integers(0, 4), min_size=2, max_size=5)


@settings(max_examples=30)
@given(one=samples, other=samples)
def test_with_ties_p_is_that_of_all_permutations_and_never_below_the_least(fronts, one, other):
    (pair,) = pairs_on(results_with(one, other, next(iter(fronts.values()))), NAME, "energy_1mm").p
    ranks = stats.rankdata([number or 9 for number in (*one, *other)])
    sums = [sum(subset) for subset in combinations(ranks, len(one))]
    own = ranks[: len(one)].sum()
    tails = np.mean(np.array(sums) <= own), np.mean(np.array(sums) >= own)
    assert pair == pytest.approx(min(1.0, 2 * min(tails)))
    assert pair >= attainable_p(len(one), len(other), 1) * (1 - 1e-12)


@pytest.mark.parametrize(("mine", "theirs"), [(5, 5), (12, 12), (12, 20), (9, 6)])
def test_without_ties_p_is_scipys_exact(fronts, mine, theirs):
    numbers = 1 + np.random.default_rng(mine + theirs).permutation(mine + theirs)
    one, other = np.split(numbers, [mine])
    results = results_with(one.tolist(), other.tolist(), next(iter(fronts.values())))
    wanted = stats.mannwhitneyu(one, other, method="exact").pvalue
    assert pairs_on(results, NAME, "energy_1mm")["p"].tolist() == pytest.approx([wanted])


def test_power_counts_what_is_imported():
    own = [(NAME, method) for method in ("nsga2", "epsilon") for _ in range(5)]
    assert say_power_of(own).startswith("with 5 runs of each of 2 methods (1 pair) the least p")
    assert "5 runs of each of 3 methods (3 pairs)" in say_power_of([*own, *[(NAME, "my")] * 6])
    assert say_power_of([*own, (NAME, "my")]) == say_power_of(own)  # too few runs for a test
    assert say_power_of([(NAME, "nsga2"), (NAME, "my")]) == (
        "with 1 run and 1 pair no p can fall below 0.05: 4 runs are needed for a verdict"
    )


def test_the_command_counts_imports_and_refuses_them_before_it_runs(call, tmp_path, fronts):
    front = next(iter(fronts.values()))
    for name, task in (("mine", front.task), ("other", replace(front.task, duration=0.9))):
        replace(front, task=task).restated(method="my tool").save(tmp_path / f"{name}.json")
    line = f"bench {NAME} --methods random --runs 1 --evaluations 100 --output {tmp_path / 'out'}"
    code, _, err = call(f"{line} --import {tmp_path / 'mine.json'}")
    assert code == 0
    assert "with 1 run and 1 pair no p can fall below 0.05" in err
    code, _, err = call(f"{line}2 --import {tmp_path / 'other.json'}")
    assert code == 2
    assert "a run of my tool is of another move than" in err
    assert not (tmp_path / "out2").exists()


def test_of_motions_that_nobody_found_there_is_no_verdict(fronts):
    far = [(job.label, replace(front, points=front.points[-1:])) for job, front in fronts.items()]
    results = Results([Run(qa.problem_of(NAME), *one) for one in far])
    assert set(pairs_on(results, NAME, "energy_1mm")["p"]) == {1.0}
    assert verdict_on(results, NAME, "energy_1mm") == "no method has such a motion in the median"


def test_problems_of_one_move_count_once():
    groups = moves_of([qa.problem_of(name) for name in (NAME, *OTHERS)])
    assert sorted(len(group) for group in groups) == [1, 2]
    sixteen = [one for one in qa.PROBLEMS.values() if not one.peak]
    assert len(moves_of(sixteen)) == 7


def test_a_tool_with_many_runs_on_one_problem_leaves_the_others_ranked(fronts):
    names = [NAME, OTHERS[0], "dual-link-90deg-0.9s"]
    done = [(job.label, front) for job, front in fronts.items()]
    runs = [Run(qa.problem_of(name), *one) for name in names for one in done]
    own = [done[0][1].restated(seed=seed) for seed in range(30)]
    results = Results([*runs, *(Run(qa.problem_of(NAME), "my tool", one) for one in own)])
    ranking = ranking_over(results)
    assert len(ranking.methods) == 4
    assert ranking.left_out == ("my tool (not on all problems, or too few runs)",)


def test_a_search_leaves_numpys_error_state_as_it_was():
    with np.errstate(divide="raise", invalid="raise", over="raise"):
        before = np.geterr()
        Job(NAME, "nsga3", 0, 200).run()
        assert np.geterr() == before


def test_missing_values_are_censored(fronts):
    assert quartiles([1.0, 2.0, np.nan]) == (1.0, 2.0, np.inf)
    results = Results.of_jobs(fronts)
    assert np.isinf(results.hits(NAME, "random", [1e-9])).all()
    assert np.isinf(results.expected_running_time(NAME, "random", 1e-9)).all()
    assert ranking_over(results) is None  # one move


@pytest.mark.parametrize("by", ["seconds", "evaluations"])
@pytest.mark.parametrize("target", [0.9, 0.6, 0.4, 0.2])
def test_the_expected_running_time_is_cocos_with_an_interval_about_it(fronts, by, target):
    results, spent, reached = Results.of_jobs(fronts), [], []
    for job, front in fronts.items():
        if job.method == "nsga2":
            costs = [getattr(mark, by) for mark in front.history]
            shares = [mark.quality.hypervolume if mark.quality else 0 for mark in front.history]
            until = [cost for cost, share in zip(costs, shares, strict=True) if 1 - share <= target]
            spent.append(until[0] if until else costs[-1])
            reached.append(bool(until))
    time, low, high = results.expected_running_time(NAME, "nsga2(population=20)", target, by)
    assert time == pytest.approx(sum(spent) / sum(reached) if any(reached) else np.inf)
    assert low <= time <= high
    row = results.running_times.query("method == 'nsga2(population=20)'").iloc[0]
    assert (row["target"], row["runs"]) == (0.1, 5)


def test_the_report_has_its_tables_and_pictures(fronts, tmp_path):
    results = Results.of_jobs(fronts)
    report = bench_report(results, "quietarm bench")
    for path, write in report.files(tmp_path):
        write(path)
    assert (tmp_path / "curves.png").stat().st_size > 10_000
    text = (tmp_path / "report.md").read_text()
    assert "5 runs of each of 4 methods (6 pairs)" in text
    assert "Ranks are over 1 independent move." in text
    assert '"To 10 %" is the expected' in text
    assert "By energy within 1 mm: epsilon-constraint, SQP (points=8) ends nearest" in text
    pairs = pd.read_csv(tmp_path / "pairs.csv")
    assert pairs["measure"].value_counts().to_dict() == {"missing": 6, "energy_1mm": 6}
    assert pairs[["effect", "p", "p_holm"]].stack().between(0, 1).all()
    table = problem_table(results, NAME)
    assert table["missing [%]"].is_monotonic_increasing
    assert table["method"].iloc[-1] == "random search"


# -- bad input --


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (lambda: Job("no-such", "nsga2"), "unknown problem"),
        (lambda: Job(NAME, "nsga"), "unknown method 'nsga'"),
        (lambda: Job(NAME, "nsga2", 0, 0), "less than one generation"),
        (lambda: Job(NAME, "epsilon", 0, 100), "ends by itself; leave its budget out"),
        (lambda: Job(NAME, "nsga2", -1), "seed is -1"),
        (lambda: Job(NAME, print, budget=0), "budget is 0"),
        (lambda: Job(NAME, print, budget=9, settings={"a": 1}), "print takes no settings here"),
        (lambda: run_jobs([], "x"), "there are no jobs; give at least one problem and one method"),
        (lambda: run_jobs([Job(NAME, "nsga2")] * 2, "x"), "is given twice; give it once"),
        (lambda: problems_of([NAME, NAME]), "is given twice; give it once"),
        (lambda: jobs_of(problems_of([NAME]), ["nsga2", "nsga2"], 1, 100), "is given twice"),
        (lambda: problems_of(["single-link-30deg-0.8s-torque"]), "third objective"),
        (lambda: Results([]), "no run was done"),
    ],
)
def test_bad_input_is_refused_in_one_line(given, words):
    with pytest.raises(ValueError, match=words) as caught:
        given()
    assert "\n" not in str(caught.value)


def test_a_file_of_another_problem_is_refused(fronts, tmp_path):
    job, other = Job(NAME, "random", 0, 200), Job(OTHERS[1], "random", 0, 200)
    path = tmp_path / f"{other.name}.json"
    path.parent.mkdir(parents=True)
    fronts[job].save(path)
    with pytest.raises(ValueError, match="is of another problem than single-link-30deg"):
        run_jobs([other], tmp_path)
    old = fronts[job].restated(versions={**fronts[job].record.versions, "pymoo": "0.1"})
    (tmp_path / f"{job.name}.json").parent.mkdir(parents=True)
    old.save(tmp_path / f"{job.name}.json")
    with pytest.raises(ValueError, match=r"by pymoo 0\.1, and here is"):
        run_jobs([job], tmp_path)


def test_a_job_that_fails_stops_no_other(tmp_path):
    def broken(function, seed, budget):
        raise ValueError("it broke")

    jobs = [Job(NAME, broken, 0, 50), Job(NAME, "random", 0, 100)]
    with pytest.raises(qa.LostJobsError, match="it broke; 1 jobs are done") as caught:
        run_jobs(jobs, tmp_path)
    assert list(caught.value.fronts) == [jobs[1]]
    assert len(list(tmp_path.rglob("*.json"))) == 1


def test_workers_find_the_same_and_a_killed_run_goes_on(tmp_path):
    line = [sys.executable, "-m", "quietarm", "bench", NAME, "--methods", "random,gde3", "--runs",
            "2", "--evaluations", "200", "--quiet", "--output"]  # fmt: skip
    subprocess.run([*line, str(tmp_path / "one")], check=True, capture_output=True, timeout=240)
    subprocess.run([*line, str(tmp_path / "two"), "--part", "1/2"], check=True,
                   capture_output=True, timeout=240)  # fmt: skip
    assert len(list((tmp_path / "two").glob("single*/*/*.json"))) == 2
    subprocess.run([*line, str(tmp_path / "two"), "--workers", "2"], check=True,
                   capture_output=True, timeout=240)  # fmt: skip
    files = sorted(path.relative_to(tmp_path / "one") for path in tmp_path.glob("one/single*/*/*"))
    assert len(files) == 4
    for name in files:
        one, two = (json.loads((tmp_path / which / name).read_text()) for which in ("one", "two"))
        assert one["points"] == two["points"]


def test_a_killed_worker_loses_its_job_alone_and_the_job_is_done_again(tmp_path):
    def deadly(function, seed, budget):
        died = tmp_path / f"{seed}"
        if seed == 1 and not died.exists():
            died.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        rng = np.random.default_rng(seed)
        function(rng.uniform(function.lower, function.upper, (budget, 2)))

    jobs = [Job(NAME, deadly, seed, budget=40) for seed in range(4)]
    killed = run_jobs(jobs, tmp_path / "killed", workers=2)
    assert (tmp_path / "1").exists()
    alone = run_jobs(jobs, tmp_path / "alone")
    assert [killed[job].points for job in jobs] == [alone[job].points for job in jobs]
    files = [sorted(p.name for p in (tmp_path / one).rglob("*.*")) for one in ("killed", "alone")]
    assert files[0] == files[1]
