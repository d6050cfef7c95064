"""Runs of a bench in IOHprofiler's format, read as its documentation says."""

import json

import numpy as np
import pytest

from quietarm.metaheuristics import Job, NamedProblem, problem_of
from quietarm.studies.bench.bench_pictures import profiles_figure
from quietarm.studies.bench.iohprofiler import write_iohprofiler
from quietarm.studies.bench.results import Results
from quietarm.studies.bench.running_times import History, expected_running_time

SMALL = "single-link-30deg-0.8s-2-terms"


def read(path):
    """A description, and the rows of each of its runs: a heading stands before every run."""
    described = json.loads(path.read_text())
    runs = {}
    for scenario in described["scenarios"]:
        blocks = (path.parent / scenario["path"]).read_text().split("evaluations ")[1:]
        tables = [np.array([line.split() for line in block.splitlines()[1:]], float)
                  for block in blocks]  # fmt: skip
        assert len(tables) == len(scenario["runs"])
        runs[scenario["dimension"]] = list(zip(scenario["runs"], tables))
    return described, runs


@pytest.fixture(scope="module")
def results():
    """A search on one problem."""
    reference = problem_of(SMALL).fronts()[0]
    problem = NamedProblem.of_front("mine = 1", reference)
    jobs = [
        *(Job(problem, "nsga2", seed, 300, {"population": 20}) for seed in range(3)),
    ]
    return Results.of_jobs({job: job.run() for job in jobs})


def test_running_times_follow_from_what_was_written(results, tmp_path):
    (path,), left_out = write_iohprofiler(results, tmp_path)
    assert left_out == ()
    assert path == tmp_path / "nsga2-population-20" / "IOHprofiler_f1_mine-1.json"
    described, runs = read(path)
    assert described["algorithm"]["name"] == "nsga2(population=20)"
    assert described["function_name"] == "mine = 1"
    histories = []
    for stated, table in runs[2]:
        # the reader of IOHprofiler tells runs by their first candidate
        assert table[0, 0] == 1
        assert (np.diff(table[:, 0]) > 0).all()
        assert stated["evals"] == table[-1, 0] == 300
        assert stated["best"]["y"] == pytest.approx(table[:, 1].min(), abs=1e-9)
        histories.append(History(table[:, 1], table[:, 2], table[:, 0]))
    (runs_of,) = (results.of(problem.name, "nsga2(population=20)") for problem in results.problems)
    for (stated, _), run in zip(runs[2], runs_of):
        entries = run.front.entries
        place = entries.coefficients.index(tuple(stated["best"]["x"]))
        later = entries.candidates[place + 1 : place + 2]
        assert entries.candidates[place] <= stated["best"]["evals"] < min(later, default=1e9)
    assert [stated["instance"] for stated, _ in runs[2]] == [1, 2, 3]
    (name,) = results.problems
    expected = results.expected_running_time(name.name, "nsga2(population=20)", 0.1, "evaluations")
    assert expected_running_time(histories, 0.1, "evaluations") == expected


def test_runtime_profiles_are_over_candidates_per_coefficient(results):
    (line,) = profiles_figure(results, "evaluations").axes[0].lines
    assert line.get_xdata()[-1] == pytest.approx(300 / 2)  # candidates over coefficients
    least = np.array([np.nanmin(run.history.missing) for run in results.runs])
    targets = np.geomspace(1.0, 1e-3, 51)
    assert line.get_ydata()[-1] == pytest.approx((targets >= least[:, None]).mean())


@pytest.mark.slow
def test_the_command_writes_it_beside_its_report(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, shown, _ = call(
        f"bench {SMALL} --methods random,epsilon --setting epsilon.points=5 --runs 1 "
        "--evaluations 100 --iohprofiler --output bench"
    )
    assert code == 0
    assert "wrote 1 file for IOHprofiler" in shown
    assert "epsilon(points=5): left out, counts no candidates" in shown
    (path,) = (tmp_path / "bench" / "iohprofiler").rglob("*.json")
    assert read(path)[0]["function_name"] == SMALL
