"""Contests on conditions of one's own, and with the recorded runs of another library."""

import math
import os
import signal
import subprocess
import sys
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from quietarm.metaheuristics.problems import catalogue
from quietarm.studies.contest import held
from quietarm.studies.contest.store import Run, Store, problems_of

import quietarm as qa

LINE = (
    "contest single-link --target 20deg,40deg --duration 0.8 --bound 0.2 --terms 3 --quiet "
    "--methods nsga2,multistart --runs 2 --evaluations 300 --output folder"
)
SCRIPT = """
import sys
from math import radians
import quietarm as qa

link = qa.SingleLinkManipulator()
problems = [
    qa.NamedProblem(
        f"single-link-{angle}deg-0.8s", qa.PointToPoint(link, radians(angle), 0.8),
        qa.CycloidPolynomial(3), 0.2,
    )
    for angle in (20, 40)
]
part = int(sys.argv[1]), int(sys.argv[2])
methods = ["nsga2", "multistart"]
qa.contest(problems, methods, "folder", runs=2, evaluations=300, part=part)
"""


def part(number, of):
    return [sys.executable, "-c", SCRIPT, str(number), str(of)]


def runs_of(folder):
    return {one.place: one.front.points for one in Store(Path(folder)).of(Run)}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    subprocess.run(part(1, 1), cwd=folder, check=True)
    return folder / "folder"


def test_every_condition_has_its_exact_front_and_runs(call, folder, whole, no_pictures):
    assert call(LINE)[0] == 0
    store = Store(Path("folder"))
    assert {*store.yardsticks} == {"single-link-20deg-0.8s", "single-link-40deg-0.8s"}
    task = store.yardsticks["single-link-40deg-0.8s"].front.task
    assert (task.target, task.duration) == (pytest.approx(np.radians(40)), 0.8)
    assert len(store.of(Run)) == 2 * 2 * 2
    assert runs_of("folder") == runs_of(whole)


def test_two_parts_with_a_kill_between_end_with_the_same_runs(whole, tmp_path):
    killed = subprocess.Popen(part(1, 2), cwd=tmp_path)
    while killed.poll() is None and not [*tmp_path.glob("folder/runs/*/*/*.json")]:
        pass
    os.kill(killed.pid, signal.SIGKILL)
    killed.wait()
    for number in (1, 2):
        subprocess.run(part(number, 2), cwd=tmp_path, check=True)
    assert runs_of(tmp_path / "folder") == runs_of(whole)


def test_a_condition_that_cannot_be_is_left_out_and_it_is_said(call, folder, no_pictures):
    code, out, err = call(
        "contest single-link --target 30deg --duration 0.3,1 --bound 0.2 --terms 2 --quiet "
        "--torque-limit 0.2 --methods nsga2 --runs 1 --evaluations 200 --output some"
    )
    assert (code, err) == (0, "")
    assert "single-link-30deg-0.3s is left out: " in " ".join(out.split())
    assert {run.problem for run in Store(Path("some")).of(Run)} == {"single-link-30deg-1s"}


def random_search(problem, seed, evaluations):
    recorded = problem.recorded()
    random = np.random.default_rng(seed)
    for _ in range(evaluations // 50):
        recorded(random.uniform(recorded.lower, recorded.upper, (50, len(recorded.lower))))
    return recorded


def test_a_recorded_run_is_measured_as_those_that_are_run_here(whole, tmp_path):
    link = qa.SingleLinkManipulator()
    task = qa.PointToPoint(link, math.radians(20), 0.8)
    problem = qa.NamedProblem("single-link-20deg-0.8s", task, qa.CycloidPolynomial(3), 0.2)
    for seed in range(2):
        recorded = random_search(problem, seed, 300)
        assert recorded.evaluations == 300
        (tmp_path / "results").mkdir(exist_ok=True)
        recorded.save(tmp_path / "results" / f"seed{seed}.json", "sampling", seed)
    (arena,) = qa.contest(
        [problem], ["nsga2"], tmp_path / "folder", runs=2, evaluations=300,
        imports=[f"sampling={tmp_path / 'results'}"],
    )  # fmt: skip
    fields = {field.method: field for field in arena.fields}
    assert fields["sampling"].own
    assert fields["sampling"] in arena.alike
    assert fields["sampling"].evaluations.tolist() == fields["nsga2"].evaluations.tolist()
    assert (np.diff(fields["sampling"].missing, axis=1) <= 0).all()
    (own,) = [one for one in Store(whole).of(Run) if one.front.seed == 1
              and one.method == "nsga2" and one.problem == problem.name]  # fmt: skip
    assert fields["nsga2"].runs[1].front.points == own.front.points


def test_a_recorded_run_of_another_length_is_said_not_to_compare(call, folder, no_pictures):
    name = "single-link-30deg-0.8s-2-terms"
    (problem,) = problems_of([name])
    random_search(problem, 0, 200).save("long.json", "long", 0)
    line = f"contest {name} --methods nsga2,vepso --population 20 --runs 1 --evaluations 100"
    assert call(f"{line} --import long=long.json --output some --quiet")[0] == 0
    page = " ".join(unescape(Path("some/contest.html").read_text()).split())
    assert f"{name}: of the methods with 100 evaluations " in page
    assert "It does not compare: its evaluations are 200, those of the others 100." in page
    assert f"Run by other programs: long on {name} (1 run, evaluations 200)" in page
    assert "NSGA-II; VEPSO: 1 problem, seeds 0 to 0, 100 evaluations a run" in page


def test_what_was_recorded_elsewhere_is_refused(tmp_path):
    (problem,) = problems_of(["single-link-30deg-0.8s-2-terms"])
    recorded = problem.recorded()
    with pytest.raises(ValueError, match="no candidate was asked for"):
        recorded.run("nothing")
    recorded(np.zeros((1, 2)))
    recorded.save(tmp_path / "one.json", "one")
    (other,) = problems_of(["single-link-30deg-0.8s-4-terms"])
    with pytest.raises(
        ValueError, match=r"one\.json was recorded on single-link-30deg-0\.8s-2-terms"
    ):
        qa.contest([other], ["nsga2"], tmp_path / "folder", imports=[str(tmp_path / "one.json")])


def of_three_terms(name, duration, **limits):
    task = qa.PointToPoint(qa.SingleLinkManipulator(), math.radians(30), duration, **limits)
    return qa.NamedProblem(name, task, qa.CycloidPolynomial(3), 0.2)


def test_an_exact_front_that_was_interrupted_is_no_measure(call, folder, monkeypatch):
    (whole,) = problems_of(["single-link-30deg-0.8s-2-terms"])[0].fronts()
    part = replace(whole, points=whole.points[::50], complete=False)
    monkeypatch.setattr(catalogue, "swept_front", lambda *asked: part)
    code, _, err = call(LINE.replace("20deg,40deg", "33deg"))
    assert (code, err.count("\n")) == (1, 1)
    assert "interrupted: 0 of 5 pieces of work are done" in err
    assert [*folder.rglob("*.json")] == []
    with pytest.raises(KeyboardInterrupt):
        of_three_terms("mine", 0.83).exact()


def test_from_python_a_problem_without_a_front_is_left_out(folder):
    few = {"runs": 1, "evaluations": 100}
    problems = [of_three_terms("short", 0.3, torque_limit=0.2), of_three_terms("long", 1.0)]
    assert [arena.problem for arena in qa.contest(problems, ["nsga2"], "two", **few)] == ["long"]
    with pytest.raises(qa.SolverFailedError, match="short is left out: found no motion"):
        qa.contest(problems[:1], ["nsga2"], "one", **few)


def test_a_part_shows_what_others_have_done_meanwhile(folder, monkeypatch):
    work, asked = held.run_contest, ([of_three_terms("mine", 1.0)], ["nsga2"], "folder")

    def meanwhile(*given):
        monkeypatch.setattr(held, "run_contest", work)
        qa.contest(*asked, runs=2, evaluations=100, part=(2, 2))
        return work(*given)

    monkeypatch.setattr(held, "run_contest", meanwhile)
    (arena,) = qa.contest(*asked, runs=2, evaluations=100, part=(1, 2))
    assert [run.front.seed for run in arena.fields[0].runs] == [0, 1]


def test_names_are_those_of_files_and_each_is_given_once(folder):
    with pytest.raises(ValueError, match=r"the name '\.\./mine' does not do for a problem"):
        of_three_terms("../mine", 1.0)
    twice = [of_three_terms("mine", duration) for duration in (0.9, 1.0)]
    with pytest.raises(ValueError, match="two problems are called mine"):
        qa.contest(twice, ["nsga2"], "folder")


def test_what_a_library_asked_beyond_the_contest_does_not_count():
    (problem,) = problems_of(["single-link-30deg-0.8s-2-terms"])
    candidates = np.random.default_rng(0).uniform(-0.2, 0.2, (130, 2))
    just, more = problem.recorded(), problem.recorded()
    just(candidates[:100])
    more(candidates[:80])
    more(candidates[80:])
    one, other = just.run("one"), more.run("other", evaluations=100)
    assert (other.front.evaluations, other.front.points) == (100, one.front.points)
    assert [(m.evaluations, m.hypervolume) for m in other.marks] == [
        (m.evaluations, m.hypervolume) for m in one.marks
    ]
    assert other.visits == one.visits
    with pytest.raises(ValueError, match="evaluations is 131"):
        more.run("other", evaluations=131)
