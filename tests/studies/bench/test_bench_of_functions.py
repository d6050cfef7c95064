"""A bench of a user's own function, whose runs have no motions: table, report, exports, imports."""

import json

import numpy as np
import pandas as pd
import pytest

import quietarm as qa
from quietarm.metaheuristics import Job, NamedProblem, problem_of, run_jobs
from quietarm.studies.bench import Results, bench_report, write_iohprofiler
from quietarm.studies.bench.bench_page import brief_report

BOX = {"lower": [-1.0, -1.0], "upper": 1.0}
NAMES = {"objectives": ["sway", "cost"], "units": ["mm", ""], "constraints": ["wall"]}
MOVE = "single-link-30deg-0.8s-2-terms"


def arm(x):
    """Two parabolas; the wall leaves the front from (0.01, 1) to (0.25, 0.25)."""
    return (x @ x, (x[0] - 1) ** 2 + x[1] ** 2), [0.1 - x[0]]


def exact_front():
    """The points of the front, which are known in closed form: x_2 = 0, x_1 from 0.1 to 1."""
    function = NamedProblem.of_function(
        "arm", arm, **BOX, **NAMES, reference_front=found()
    ).recorded()
    function(np.column_stack([np.linspace(0.1, 1, 40), np.zeros(40)]))
    return function.front("exact")


def found():
    return qa.search(arm, **BOX, **NAMES, evaluations=60, algorithm="es")


@pytest.fixture(scope="module")
def problem():
    return NamedProblem.of_function("my arm", arm, **BOX, **NAMES, reference_front=exact_front())


@pytest.fixture(scope="module")
def results(problem, tmp_path_factory):
    """Two methods from two seeds, and a run of another library."""
    folder = tmp_path_factory.mktemp("runs")
    jobs = [Job(problem, method, seed, 60) for method in ("es", "gde3") for seed in (0, 1)]
    function = problem.recorded(50)
    function(np.random.default_rng(0).uniform(-1, 1, (50, 2)))
    function.save(folder / "mine.json", "mine", seed=0)
    return Results.of_jobs(run_jobs(jobs, folder), [qa.Front.load(folder / "mine.json")])


def test_a_function_has_every_measure_but_those_of_motions(results, tmp_path):
    table = results.table
    assert table["method"].value_counts().to_dict() == {"es": 2, "gde3": 2, "mine": 1}
    of_motions = [name for name in table if "energy" in name or "between" in name]
    assert not [*of_motions, *table.filter(like="window")]
    shares = table[["missing", "igd_plus", "epsilon"]]
    assert np.isfinite(shares).all(axis=None)
    assert (shares > 0).all(axis=None)  # of few points nothing is like the exact front
    files = dict(bench_report(results, "the lines above").files(tmp_path))
    assert {path.suffix for path in files} == {".md", ".csv", ".png"}
    for path, write in files.items():
        if path.suffix != ".png":  # which a slow test draws
            write(path)
    page = (tmp_path / "report.md").read_text()
    assert "my arm: objectives are what the function gave" in page
    assert not [word for word in ("mm", "CVODES", "after arrival", "nan") if word in page]
    assert pd.read_csv(tmp_path / "runs.csv").shape == table.shape
    (brief,) = brief_report(results).tables.values()
    assert list(brief) == ["method", "runs", "hypervolume gap [%]", "p", "seconds"]


def test_three_functions_rank_three_methods():
    def moved(by):
        return lambda x: arm(x + by)

    problems = [
        NamedProblem.of_function(f"arm {by}", moved(by), **BOX, **NAMES, reference_front=found())
        for by in (0.0, 0.1, 0.2)
    ]
    jobs = [Job(of, method, seed, 20) for of in problems for method in ("es", "gde3", "random")
            for seed in (0, 1)]  # fmt: skip
    page = bench_report(Results.of_jobs({job: job.run() for job in jobs}), "these lines").markdown()
    assert "Mean ranks of the median hypervolume over 3 independent problems" in page
    assert "By energy" not in page


def test_a_run_of_a_function_is_written_for_iohprofiler(results, tmp_path):
    written, left_out = write_iohprofiler(results, tmp_path)
    assert (len(written), left_out) == (3, ())
    described = json.loads(written[0].read_text())
    assert described["scenarios"][0]["dimension"] == 2
    assert [run["evals"] for run in described["scenarios"][0]["runs"]] == [60, 60]


@pytest.mark.slow
def test_a_function_and_a_move_share_a_bench(results, problem, tmp_path):
    jobs = [Job(of, method, 0, 60) for of in (problem, MOVE) for method in ("es", "gde3", "random")]
    both = Results.of_jobs(run_jobs(jobs, tmp_path / "runs"))
    empty = both.table.groupby("problem")["residual_window_s"].count().to_dict()
    assert empty == {"my arm": 0, MOVE: 3}
    for name, of in {"one": results, "both": both}.items():
        for path, write in bench_report(of, name).files(tmp_path / name):
            write(path)
            assert path.stat().st_size
    page = (tmp_path / "both" / "report.md").read_text()
    assert page.count("By energy within 1 mm") == 1
    assert "of motions between" not in page


def test_a_run_of_another_function_is_no_import(problem):
    other = NamedProblem.of_function(
        "my arm", lambda x: arm(x), **BOX, **NAMES, reference_front=exact_front()
    ).recorded()
    other([[0.2, 0.0]])
    job = Job(problem, "es", 0, 60)
    with pytest.raises(ValueError, match="a run of mine is of another function than my arm"):
        Results.of_jobs({job: job.run()}, [other.front("mine")])


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda: Job(arm, "es", 0, 60), r"problem is a function; make NamedProblem.of_function\("),
        (lambda: Job(found(), "es", 0, 60), "problem is a front of a function; make NamedProblem"),
        (lambda: Job(3, "es", 0, 60), "problem is 3; give a name"),
        (lambda: problem_of(arm), r"name is a function; make NamedProblem.of_function\("),
        (lambda: NamedProblem.of_front("mine", found()), "no file has the function itself; make"),
        (
            lambda: NamedProblem.of_function("arm", arm, lower=[-1] * 3, upper=1, **NAMES,
                                             reference_front=found()),
            "of another function: its coefficients are 2, not 3",
        ),
        (
            lambda: NamedProblem.of_function("arm", arm, **BOX, reference_front=found()),
            "its objectives are sway, cost, not residual, energy",
        ),
        (
            lambda: NamedProblem.of_function(
                "arm", arm, **BOX, **NAMES,
                reference_front=qa.search(arm, **BOX, **NAMES, evaluations=1, algorithm="es"),
            ),
            "has [01] points; give that of a longer search",
        ),
    ],
)  # fmt: skip
def test_what_makes_a_problem_of_a_function_is_said_in_a_line(ask, words):
    with pytest.raises((TypeError, ValueError), match=words) as refused:
        ask()
    assert "\n" not in str(refused.value)


def test_a_cost_that_no_run_has_is_refused(results):
    with pytest.raises(ValueError, match="by is 'candidates'; give seconds or evaluations"):
        results.expected_running_time("my arm", "es", 0.5, by="candidates")
