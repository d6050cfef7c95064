"""Jobs of a bench: their files, their cost, workers, and what they are refused for."""

import json
import os
import signal

import numpy as np
import pytest
from bench_problems import NAME, OTHERS
from pymoo.algorithms.moo.nsga2 import NSGA2

import quietarm as qa
from quietarm.metaheuristics import Job, LostJobsError, finished_jobs, run_jobs
from quietarm.studies.bench.planned_jobs import jobs_of, problems_of
from quietarm.studies.bench.results import Results

THREE = "single-link-30deg-0.8s-torque"

pytestmark = pytest.mark.slow


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


def test_a_function_of_ones_own_is_a_method_and_runs_in_workers(tmp_path):
    def halton(function, seed, budget):
        rng = np.random.default_rng(seed)
        while True:
            function(rng.uniform(function.lower, function.upper, (30, 2)))

    front = Job(NAME, halton, 1, budget=100).run()
    assert (front.record.method, front.record.evaluations) == ("halton", 100)
    jobs = [Job(NAME, halton, seed, budget=60) for seed in (0, 1)]
    fronts = run_jobs(jobs, tmp_path, workers=2)
    assert list(fronts) == jobs
    assert run_jobs(jobs, tmp_path) == fronts


def at_zero(function, seed, budget, rows=60):
    function(np.zeros((rows, 2)))


def at_a_tenth(function, seed, budget, rows=60):
    function(np.full((rows, 2), 0.1))


def at_zero_of_other_rows(function, seed, budget, rows=61):
    function(np.zeros((rows, 2)))


def enclosing(value):
    def enclosed(function, seed, budget):
        function(np.full((60, 2), value))

    return enclosed


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (at_zero, at_a_tenth),
        (at_zero, at_zero_of_other_rows),
        (enclosing(0.0), enclosing(0.1)),
        (NSGA2(pop_size=20), NSGA2(pop_size=30)),
    ],
    ids=["code", "default", "enclosed", "pymoo"],
)
def test_runs_of_a_method_that_has_changed_are_refused(tmp_path, monkeypatch, before, after):
    for method in (before, after):
        monkeypatch.setattr(method, "__name__", "mine", raising=False)
    job = Job(NAME, before, budget=60)
    assert run_jobs([job], tmp_path) == run_jobs([job], tmp_path)
    with pytest.raises(ValueError, match="is by mine as it was before; give another folder"):
        run_jobs([Job(NAME, after, budget=60)], tmp_path)


def test_a_search_leaves_numpys_error_state_as_it_was():
    with np.errstate(divide="raise", invalid="raise", over="raise"):
        before = np.geterr()
        Job(NAME, "nsga3", 0, 200).run()
        assert np.geterr() == before


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
        (lambda: Job(THREE, "weighted"), "weighted is for residual and energy alone, not for 3"),
        (lambda: Job(NAME, "epsilon", noise=0.01), "the gradient of the model, which has no noise"),
        (lambda: Job(NAME, "nsga2", noise=1.5), "noise is 1.5, not a share from 0 to 1"),
        (lambda: Job(NAME, "nsga2", noise="1%"), "noise is '1%', not a share from 0 to 1"),
        (lambda: Job(NAME, "nsga2", reevaluate=2), "reevaluate is 2, and without noise"),
        (lambda: Results([]), "no run was done"),
    ],
)
def test_bad_input_is_refused_in_one_line(given, words):
    with pytest.raises(ValueError, match=words):
        given()


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
    path.write_text(path.read_text()[:500])  # a full disk's
    with pytest.raises(ValueError, match="delete that file, and its run is done again"):
        run_jobs([other], tmp_path)


def test_a_job_that_fails_stops_no_other(tmp_path):
    def broken(function, seed, budget):
        raise ValueError("it broke")

    jobs = [Job(NAME, broken, 0, 50), Job(NAME, "random", 0, 100)]
    with pytest.raises(LostJobsError, match="it broke; 1 job is done") as caught:
        run_jobs(jobs, tmp_path)
    assert list(caught.value.fronts) == [jobs[1]]
    assert len(list(tmp_path.rglob("*.json"))) == 1


def test_workers_find_the_same_and_a_part_goes_on(call, tmp_path):
    line = f"bench {NAME} --methods random,gde3 --runs 2 --evaluations 200 --quiet"
    one, two = tmp_path / "one", tmp_path / "two"
    assert call(f"{line} --output {one}")[0] == 0
    code, _, said = call(f"{line} --output {two} --part 8/8")  # there are four jobs
    assert code != 0
    assert "no run was done; give jobs, or a folder that has some" in said
    assert call(f"{line} --output {two} --part 1/2")[0] == 0
    assert len(list(two.glob("single*/*/*.json"))) == 2
    assert call(f"{line} --output {two} --workers 2")[0] == 0
    files = [path.relative_to(one) for path in one.glob("single*/*/*")]
    assert len(files) == 4
    for name in files:
        alone, shared = (json.loads((folder / name).read_text()) for folder in (one, two))
        assert alone["points"] == shared["points"]


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


def test_the_name_of_a_method_is_one_folder(tmp_path):
    def walk(function, seed, budget):
        function(np.zeros((1, len(function.lower))))

    for name in ("../../out", "/out", "..", "a\\b"):
        walk.__name__ = name
        folder = tmp_path / "runs" / NAME
        path = (tmp_path / "runs" / Job(NAME, walk, budget=60).name).resolve()
        assert path.parent.parent == folder
