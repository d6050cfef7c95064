"""A bench: its measures against moocore, imported runs, and its report."""

import re
import time
from contextlib import nullcontext
from dataclasses import replace

import moocore
import numpy as np
import pandas as pd
import pytest
from bench_problems import NAME, OTHERS

import quietarm as qa
from quietarm.metaheuristics import problem_of
from quietarm.metaheuristics.evaluation.population import ACCURACY
from quietarm.metaheuristics.problems.recorded import RecordedFunction
from quietarm.metaheuristics.score import CORNER, known_indicators
from quietarm.ocp.cost import COST
from quietarm.studies.bench.bench_page import bench_report, compared_columns, problem_table
from quietarm.studies.bench.planned_jobs import problems_of, write_references
from quietarm.studies.bench.results import Results


@pytest.mark.slow
def test_measures_are_moocores_from_the_files_alone(fronts):
    reference = problem_of(NAME).fronts()[0]
    best = np.c_[reference.residuals, reference.energies]
    ideal, extent = best.min(axis=0), np.ptp(best, axis=0)
    for run in Results.of_jobs(fronts).runs:
        front = run.front
        points = (np.c_[front.residuals, front.energies] - ideal) / extent
        line = (best - ideal) / extent
        corner = [CORNER, CORNER]
        # the reference's is of the line through its points, a little more than of the points
        wanted = moocore.hypervolume(points, ref=corner) / moocore.hypervolume(line, ref=corner)
        assert run.scores["hypervolume"] == pytest.approx(wanted, rel=5e-3)
        assert run.scores["igd_plus"] == pytest.approx(moocore.igd_plus(points, ref=line))
        assert run.scores["epsilon"] == pytest.approx(moocore.epsilon_additive(points, ref=line))
        assert run.scores_between["hypervolume"] >= run.scores["hypervolume"] - 1e-12
        assert run.scores.keys() == known_indicators().keys()


LONG = ["arm-on-flexible-link-90deg-0.8s-12-terms", "single-link-30deg-0.8s-20-terms"]


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("name", [*LONG, "dual-link-90deg-0.9s"])
def test_random_candidates_are_within_the_accuracy_stated(name):
    problem = problem_of(name)
    own, fine = problem.function(), problem.function(steps=384)
    rows = np.random.default_rng(3).uniform(own.lower, own.upper, (100, len(own.lower)))
    assert own(rows)[0] == pytest.approx(fine(rows)[0], rel=ACCURACY)


@pytest.mark.slow
def test_a_recorded_run_has_the_figures_of_a_job(fronts):
    job, front = next((j, f) for j, f in fronts.items() if j.method == "random")
    recorded = problem_of(NAME).recorded()
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
    elsewhere = problem_of(OTHERS[0]).recorded()
    elsewhere(rng.uniform(-0.1, 0.1, (50, 2)))
    with pytest.raises(ValueError, match="give that problem too"):
        Results.of_jobs({job: front}, [elsewhere.front("my tool")])


@pytest.mark.slow
def test_a_run_from_a_wider_box_is_imported_where_its_motions_lie_within_the_problem_s(fronts):
    job, front = next((j, f) for j, f in fronts.items() if j.method == "random")
    assert np.abs(front.coefficients).max() <= job.problem.bound
    unbounded = front.restated(bound=None, method="my tool")
    results = Results.of_jobs({job: front}, [unbounded])
    (run,) = results.of(NAME, "my tool")
    assert run.front.history == front.history[-1:] != front.history  # the others know no box
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


@pytest.mark.slow
def test_the_command_counts_imports_and_refuses_them_before_it_runs(call, tmp_path, fronts):
    front = next(iter(fronts.values()))
    longer = replace(front.task, duration=0.9)
    other = qa.Front.from_coefficients(
        longer, front.coefficients, method="-", profile=front.profile
    )
    other = replace(other, history=front.history, record=front.record)
    halved = [replace(point, energy=point.energy / 2) for point in front.points]
    names = {"other": other, "halved": replace(front, points=tuple(halved)), "runs/mine": front}
    (tmp_path / "runs").mkdir()
    for name, one in names.items():
        one.restated(method="my tool").save(tmp_path / f"{name}.json")
    front.restated(method="random").save(tmp_path / "random.json")
    line = f"bench {NAME} --methods random --runs 1 --evaluations 100 --output {tmp_path / 'out'}"
    code, _, err = call(f"{line} --import {tmp_path / 'runs'}")
    assert code == 0
    assert "with 1 run and 1 pair no Holm-adjusted p can be below 0.05" in err
    for name, words in (
        ("other", "a run of my tool is of another move than"),
        ("halved", "halved.json: point 1 of 19 states energy"),
        ("random", "an imported run is of random, which the bench runs itself"),
    ):
        code, _, err = call(f"{line}2 --import {tmp_path / name}.json")
        assert (code, words in err) == (2, True), err
    assert not (tmp_path / "out2").exists()


@pytest.mark.slow
def test_a_folder_of_imports_leaves_runs_of_other_problems_out_and_names_them(call, tmp_path):
    rng = np.random.default_rng(0)
    for name, seed in ((NAME, 0), (OTHERS[0], 1)):
        recorded = problem_of(name).recorded()
        recorded(rng.uniform(recorded.lower, recorded.upper, (50, 2)))
        (tmp_path / "runs").mkdir(exist_ok=True)
        recorded.save(tmp_path / "runs" / f"{seed}.json", "my tool", seed)
    line = f"bench {NAME} --methods random --runs 2 --evaluations 100 --output {tmp_path / 'out'}"
    code, out, err = call(f"{line} --import {tmp_path / 'runs'}")
    assert code == 0
    assert f"{tmp_path / 'runs' / '1.json'} is on {OTHERS[0]}: left out" in err
    assert "my tool" in out
    table = pd.read_csv(tmp_path / "out" / "runs.csv")
    assert sorted(table["method"]) == ["my tool", "random search", "random search"]
    (tmp_path / "runs" / "0.json").unlink()
    code, _, err = call(f"{line}2 --import {tmp_path / 'runs'}")
    assert (code, f"no run to import is on {NAME}" in err) == (2, True)
    code, _, err = call(f"{line}2 --import {tmp_path / 'runs' / '1.json'}")  # by its own name
    assert (code, "give that problem too, or leave the run out" in err) == (2, True)
    assert not (tmp_path / "out2").exists()


@pytest.mark.slow
def test_an_imported_run_that_evaluates_the_reference_front_is_named(call, tmp_path):
    problem = problem_of(NAME)
    coefficients, _ = problem.optimum()
    more = np.random.default_rng(0).uniform(-problem.bound, problem.bound, (300, 2))
    # the third is moved by what changes no figure, the fourth by a twentieth of the distance (of
    # 5.6e-4 of the box in the median) of neighbouring reference motions
    shifted = coefficients * (1 - 1e-6) + 1e-9
    between = coefficients * (1 - 1e-3)
    for seed, rows in enumerate((coefficients, coefficients[::10], shifted, between, more)):
        recorded = problem.recorded()
        recorded(rows)
        recorded.save(tmp_path / f"{seed}.json", "my tool", seed)
    line = f"bench {NAME} --methods random --runs 2 --evaluations 100 --output {tmp_path / 'out'}"
    code, out, _ = call(
        line + "".join(f" --import {tmp_path / f'{seed}.json'}" for seed in range(5))
    )
    assert code == 0
    words = "; ".join(f"my tool, seed {seed} on {NAME}" for seed in range(3)) + "."
    said = " ".join(out.split())
    assert f"No motion but those of the reference front: {words}" in said
    report = (tmp_path / "out" / "report.md").read_text()
    assert f"no motion but those of the reference front: {words}" in report
    assert "5 of the runs were imported" in report


@pytest.mark.slow
def test_a_smaller_bench_leaves_the_report_of_a_larger_one(call, tmp_path):
    line = f"bench {NAME} --evaluations 100 --quiet --output {tmp_path}"
    assert call(f"{line} --methods random,gde3 --runs 2")[0] == 0
    names = ("report.md", "runs.csv", "pairs.csv", "problems.csv", "curves.png")
    before = [(tmp_path / name).read_bytes() for name in names]
    for smaller, lost in (
        ("--methods random --runs 2", "2 runs"),
        ("--methods random,gde3 --runs 1", "2 runs"),
        ("--methods random,gde3 --runs 2 --seed 1", "2 runs"),
        ("--methods random,gde3 --runs 2 --evaluations 200", "4 runs"),
    ):
        base = line.replace("--evaluations 100 ", "") if "--evaluations" in smaller else line
        code, out, _ = call(f"{base} {smaller}")
        assert code == 0
        assert f"report.md in {tmp_path} stays: {lost} in it would be lost. Ask for those" in out
        assert [(tmp_path / name).read_bytes() for name in names] == before
    code, out, _ = call(f"{line} --methods random,gde3 --runs 3")
    assert (code, "wrote report.md and" in out) == (0, True)
    assert len(pd.read_csv(tmp_path / "runs.csv")) == 6
    (tmp_path / "runs.csv").write_text("my own,table\n1,2\n")
    code, _, err = call(f"{line} --methods random --runs 1")
    assert (code, "runs.csv is no table of a bench; give another folder" in err) == (2, True)


@pytest.mark.slow
def test_runs_measured_against_another_reference_are_no_part_of_a_bench(fronts, tmp_path):
    front = next(iter(fronts.values()))
    for one in (front, replace(front, points=front.points[::2])):
        one.save(tmp_path / "mine.json")
        (problem,) = problems_of([str(tmp_path / "mine.json")])
        with nullcontext() if one is front else pytest.raises(ValueError, match="another folder"):
            write_references([problem], tmp_path)


@pytest.mark.slow
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
    assert "the largest displacements within 1 s after arrival" in text  # the problem's, eq (11)
    # of the least energy is the gradient, which repeats itself
    assert "By energy within 1 mm: not significant: with 5 runs of each of 4 methods" in text
    pairs = pd.read_csv(tmp_path / "pairs.csv")
    assert pairs["measure"].value_counts().to_dict() == dict.fromkeys(compared_columns(), 6)
    assert pairs[["effect", "p", "p_holm"]].stack().between(0, 1).all()
    table = problem_table(results, NAME)
    assert table["hypervolume gap [%]"].is_monotonic_increasing
    assert table["method"].iloc[-1] == "random search"


@pytest.mark.slow
def test_a_folder_of_runs_with_a_broken_file_imports_the_rest_and_names_it(call, tmp_path):
    recorded = problem_of(NAME).recorded()
    recorded(np.random.default_rng(0).uniform(recorded.lower, recorded.upper, (50, 2)))
    runs = tmp_path / "runs"
    runs.mkdir()
    recorded.save(runs / "0.json", "my tool", 0)
    (runs / "broken.json").write_text('{"format": "quietarm-fr')
    (runs / "other.json").write_text("[1, 2]")
    line = f"bench {NAME} --methods random --runs 2 --evaluations 100 --output {tmp_path / 'out'}"
    code, out, err = call(f"{line} --import {runs}")
    assert (code, "my tool" in out) == (0, True)
    assert re.search(r"broken.json is not a front: it is not whole, .*: left out\n", err)
    assert "other.json is not a front: its format is None; give a front file: left out" in err
    code, _, err = call(f"{line}2 --import {runs / 'broken.json'}")  # by its own name
    assert (code, err.count("\n")) == (2, 1)
    assert not (tmp_path / "out2").exists()


def test_a_scheduler_without_an_address_is_told_what_to_give(call, tmp_path):
    for address in ("", " "):
        line = ["bench", NAME, "--output", str(tmp_path / "out"), "--scheduler", address]
        code, _, err = call(line)
        assert (code, err.count("\n")) == (2, 1)
        assert "the scheduler's address is empty; give one, such as tcp://host:8786" in err
    assert not (tmp_path / "out").exists()
