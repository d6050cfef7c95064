"""Histories of runs in a file, and every expected running time computed from them again."""

import gzip

import numpy as np
import pandas as pd
import pytest

from quietarm.metaheuristics import Job, NamedProblem, problem_of, run_jobs
from quietarm.studies.bench.bench_page import bench_report
from quietarm.studies.bench.results import Results
from quietarm.studies.bench.running_times import (
    History,
    expected_running_time,
    hits,
    read_histories,
    running_times,
)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Two searches and the gradient on a small problem of one's own."""
    reference = problem_of("single-link-30deg-0.8s-2-terms").fronts()[0]
    problem = NamedProblem.of_front("mine", reference)
    jobs = [
        *(Job(problem, "random", seed, 300) for seed in range(3)),
        *(Job(problem, "nsga2", seed, 300, {"population": 20}) for seed in range(3)),
        *(Job(problem, "epsilon", seed, settings={"points": 12}) for seed in range(2)),
    ]
    return Results.of_jobs(run_jobs(jobs, tmp_path_factory.mktemp("runs")))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["histories.csv", "histories.csv.gz"])
def test_all_expected_running_times_follow_from_the_file_of_histories(results, tmp_path, name):
    results.write_histories(tmp_path / name)
    again = running_times(read_histories(tmp_path / name))
    for path, write in bench_report(results, "quietarm bench").files(tmp_path):
        if path.name == "running_times.csv":
            write(path)
    published = pd.read_csv(tmp_path / "running_times.csv")
    assert 0 < np.isfinite(published["seconds"]).sum() < len(published)
    order = ["problem", "method", "target"]
    for column in ("reached", "runs", "seconds", "seconds_low", "seconds_high", "evaluations",
                   "evaluations_low", "evaluations_high"):  # fmt: skip
        values = [table.sort_values(order)[column].tolist() for table in (published, again)]
        assert values[0] == pytest.approx(values[1], rel=1e-8, nan_ok=True)


@pytest.mark.slow
def test_a_file_has_the_marks_that_improve_and_the_end_and_is_the_same_again(results, tmp_path):
    for name in ("one", "other"):
        results.write_histories(tmp_path / f"{name}.csv.gz")
    content = (tmp_path / "one.csv.gz").read_bytes()
    assert content == (tmp_path / "other.csv.gz").read_bytes()
    lines = gzip.decompress(content).decode().splitlines()
    assert lines[0] == "problem,method,seed,missing,seconds,evaluations"
    runs = {run.label: run for run in results.runs}
    assert len(lines) - 1 == sum(len(run.history.improving.missing) for run in runs.values())
    for run in runs.values():
        kept = run.history.improving
        assert (np.diff(kept.missing[:-1]) < 0).all()
        assert kept.seconds[-1] == run.front.history[-1].seconds


def test_a_run_that_gets_worse_keeps_its_best():
    # 0.5, 0.2, then 0.3 for a while: the target of 0.2 is reached at the second mark
    history = History(np.array([0.5, 0.2, 0.3, 0.3]), np.arange(1.0, 5.0), np.arange(10.0, 50, 10))
    assert [column.tolist() for column in history.improving] == [
        [0.5, 0.2, 0.3], [1.0, 2.0, 4.0], [10.0, 20.0, 40.0],
    ]  # fmt: skip
    for one in (history, history.improving):
        assert expected_running_time([one], 0.2)[0] == 2.0
        assert expected_running_time([one, one], 0.2, "evaluations") == (20.0, 20.0, 20.0)
        assert np.isinf(expected_running_time([one], 0.1)[0])


def test_a_mark_without_a_value_reaches_no_target():
    """As before a run's first point, or of an indicator that an earlier file does not state."""
    missing = np.array([np.nan, 0.5, np.nan, 0.1])
    history = History(missing, np.arange(1.0, 5.0), np.arange(10.0, 50, 10))
    assert hits([history], [0.5, 0.2, 0.05]).tolist() == [[2.0, 4.0, np.inf]]
    assert history.improving.missing.tolist() == [0.5, 0.1]
