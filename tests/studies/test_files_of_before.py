"""Files that earlier versions wrote load, are compared and reported, and state what they hold.

`tests/fixtures` has a folder for each day on which formats were as they are there, and says how
they were made.
"""

import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import quietarm as qa
from quietarm.metaheuristics import NamedProblem, archive
from quietarm.metaheuristics.jobs import Job, finished_jobs
from quietarm.metaheuristics.run_files import is_sealed
from quietarm.metaheuristics.score import (
    HYPERVOLUME,
    INDICATORS,
    filled,
    objectives,
    scores_on_the_way,
    shares_of_box,
)
from quietarm.studies.bench.results import Results
from quietarm.studies.identify import Identified
from quietarm.studies.reading.saved import load_front, load_plans
from quietarm.studies.sweep import MoveLibrary

FIXTURES = Path(__file__).parents[1] / "fixtures"
DAYS = sorted(path.name for path in FIXTURES.iterdir() if path.is_dir())
PLANS = ["plan", "limited-plan", "robust-plan"]
SEARCHES = [f"search-seed{seed}" for seed in range(3)]
METHODS = "nsga2,epsilon,nsga2+polish"
SETTINGS = {
    "nsga2": {"population": 20}, "epsilon": {"points": 5}, "nsga2+polish": {"population": 20},
}  # fmt: skip
STATED = ("hypervolume", "igd_plus", "epsilon")
"""Indicators that marks stated; later ones are computed."""
WINDOW_THEN = {"2026-11-26": "--residual-window 1s"}
"""Where a line's default was another."""
SAME = 1e-6
"""Two versions of one library differ by less in a figure that CVODES or moocore computes."""


@pytest.fixture(params=DAYS)
def old(request, tmp_path, monkeypatch):
    """A copy of a day's files, in which the test stands."""
    folder = shutil.copytree(FIXTURES / request.param, tmp_path / request.param)
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture
def of_these_versions(old, monkeypatch):
    """The libraries that wrote the runs, since a bench goes on with those alone."""
    versions = qa.Front.load(old / "search-seed0.json").record.versions
    monkeypatch.setattr(archive, "search_versions", lambda: dict(versions))


def jobs_of(folder):
    problems = [
        NamedProblem.of_front(name, qa.Front.load(folder / f"{name}.json"))
        for name in ("front", "arm-front")
    ]
    return [
        Job(problem, method, seed, None if method == "epsilon" else 120, SETTINGS[method])
        for problem in problems
        for method in METHODS.split(",")
        for seed in (0, 1)
    ]


def test_plans_load_and_state_the_figures_of_their_motions(old):
    plans = load_plans([old / f"{name}.json" for name in PLANS])
    for plan in plans.values():
        motion = plan.candidate.motion
        assert plan.energy == pytest.approx(motion.energy, rel=SAME)
        assert plan.residual == pytest.approx(motion.residual, rel=SAME, abs=1e-8)
        for name in ("torque", "speed", "acceleration", "deflection", "jerk"):
            assert plan.motion.peak(name) == pytest.approx(motion.peak(name), rel=1e-5)
    worst = plans["robust-plan"].worst
    assert worst.residual == pytest.approx(
        plans["robust-plan"].candidate.perturbed(worst.errors).residual, rel=1e-5, abs=1e-8
    )


@pytest.mark.parametrize("name", ["front", "arm-front", *SEARCHES])
def test_fronts_and_searches_load_and_are_saved_to_the_same(old, name):
    front = load_front(old / f"{name}.json")
    front.save("again.json")
    again = qa.Front.load("again.json")
    assert again == front
    for point in front.points[::5]:
        candidate = qa.Candidate.of_profile(front.task, front.profile, point.coefficients)
        assert point.energy == pytest.approx(candidate.energy, rel=SAME)
        assert point.residual == pytest.approx(candidate.residual, rel=SAME, abs=1e-8)
    assert shares_of_box(again).tolist() == [mark.hypervolume for mark in front.history]


def test_a_machine_and_a_grid_load(old):
    machine = Identified.load(old / "machine.json")
    assert machine.plant.omega == pytest.approx(18.0, rel=1e-6)  # the recording is of 18 rad/s
    library = MoveLibrary("grid.zarr")
    plan = library.plan(target=np.radians(25.0), duration=0.85)
    assert plan.residual < 2e-4  # between four cells that arrive at rest


def test_runs_load_by_their_checksums_and_their_figures_are_computed(old, of_these_versions):
    jobs = jobs_of(old)
    fronts = finished_jobs(jobs, "bench")
    text = Path(f"bench/{jobs[0].name}.json").read_text()  # those of the first day have none
    assert list(fronts) == jobs
    assert {is_sealed(front) for front in fronts.values()} == {"checksum" in text}
    for job, front in fronts.items():
        scale = job.problem.reference()
        last = front.history[-1]
        for stated, points in ((last.quality, objectives(front)), (last.between, filled(front))):
            scores = scale.scores(points)
            for name in STATED:
                assert scores[name] == pytest.approx(getattr(stated, name), rel=1e-4, abs=1e-8)
        for name in STATED:  # on the way as they state it
            stated = [getattr(mark.quality, name) for mark in front.history[:-1]]
            on_the_way = scores_on_the_way(front, scale, INDICATORS[name])
            assert on_the_way[:-1].tolist() == stated
    table = Results.of_jobs(fronts).table
    assert len(table) == len(jobs)
    assert np.isfinite(table["missing"]).all()


def test_runs_without_a_checksum_are_evaluated_again(old, of_these_versions):
    jobs = jobs_of(old)
    for job, front in finished_jobs(jobs, "bench").items():
        settings = {k: v for k, v in front.record.settings.items() if k != "checksum"}
        front.restated(settings=settings).save(f"bench/{job.name}.json")
    fronts = finished_jobs(jobs, "bench")
    assert not any(map(is_sealed, fronts.values()))
    (job, front), *_ = fronts.items()
    assert scores_on_the_way(front, job.problem.reference(), HYPERVOLUME)[-1] > 0


@pytest.mark.slow
def test_the_commands_compare_and_report_them(old, of_these_versions, call):
    for line in (
        f"compare {' '.join(f'{name}.json' for name in PLANS)} --output plans",
        f"compare front.json {' '.join(f'{name}.json' for name in SEARCHES)} --output fronts",
        "compare bench/front --output runs",
        "identify --check machine.json ring.csv --tip tip_mm",
        "export grid.zarr --output moves.c",
    ):
        code, _, err = call(line)
        assert code == 0, err
    window = WINDOW_THEN.get(old.name, "")
    code, out, err = call(
        f"sweep single-link --target 20deg,30deg --duration 0.8,0.9 {window} --output grid.zarr"
    )
    assert (code, "chunks" in err) == (0, False), err  # nothing is left to do
    before = pd.read_csv("bench/runs.csv")
    settings = " ".join(
        f"--setting {method}.{name}={value}"
        for method, settings in SETTINGS.items()
        for name, value in settings.items()
    )
    code, out, err = call(
        f"bench front.json arm-front.json --methods {METHODS} --runs 2 --evaluations 120 "
        f"{settings} --output bench"
    )
    assert code == 0, err
    assert "12 of 12 runs are in bench" in err
    assert "wrote report.md" in out
    order = ["problem", "method", "seed"]
    after = pd.read_csv("bench/runs.csv").sort_values(order, ignore_index=True)
    before = before.sort_values(order, ignore_index=True)
    pd.testing.assert_frame_equal(after[before.columns], before, rtol=1e-4, atol=2e-6)


def test_a_quantity_that_a_file_does_not_state_is_skipped(old, call):
    """As of a limit that is newer than the file: the peak is unknown, and nothing is wrong."""
    text = Path("plan.json").read_text()
    (line,) = (line for line in text.splitlines(keepends=True) if '"peak_jerk"' in line)
    Path("older.json").write_text(text.replace(line, ""))
    code, _, err = call("compare older.json limited-plan.json")
    assert code == 0, err
    assert qa.Plan.load("older.json").motion.peak_jerk is None
    Path("wrong.json").write_text(text.replace(line, '    "peak_jerk": 1.0,\n'))
    code, _, err = call("compare wrong.json limited-plan.json")
    assert (code, "wrong.json states peak jerk 1 " in err) == (2, True), err
