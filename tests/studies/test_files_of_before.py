"""Files that earlier versions wrote load, are compared and reported, and state what they hold.

`tests/fixtures` has a folder for each day on which formats were as they are there, and says how
they were made.
"""

import json
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from saved_files import edit

import quietarm as qa
from quietarm.machine.identify import Identified
from quietarm.metaheuristics import NamedProblem, archive
from quietarm.metaheuristics.jobs import Job, finished_jobs
from quietarm.metaheuristics.run_files import is_sealed
from quietarm.metaheuristics.score import (
    HYPERVOLUME,
    filled,
    known_indicators,
    objectives,
    scores_on_the_way,
    shares_of_box,
)
from quietarm.ocp import FileFormatError, Floor
from quietarm.studies.answers.read_answers import load_front, load_plans
from quietarm.studies.bench.results import Results
from quietarm.studies.sweep import MoveLibrary

FIXTURES = Path(__file__).parents[1] / "fixtures"
OF_PLANS = sorted(path.parent.name for path in FIXTURES.glob("*/plan.json"))
DAYS = [name for name in OF_PLANS if (FIXTURES / name / "bench").is_dir()]
"""Folders with files of every kind; the others have those of the formats that changed."""
OF_FLOORS = [name for name in OF_PLANS if (FIXTURES / name / "floor.json").is_file()]
WITH_FIGURES = ["2026-11-26", "2026-11-27"]
"""Days whose plans held every figure; later ones state F1 and F2 alone."""
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


def _copy(name, tmp_path, monkeypatch):
    folder = shutil.copytree(FIXTURES / name, tmp_path / name)
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture(params=DAYS)
def old(request, tmp_path, monkeypatch):
    """A copy of a day's files, in which the test stands."""
    return _copy(request.param, tmp_path, monkeypatch)


@pytest.fixture(params=OF_PLANS)
def old_plans(request, tmp_path, monkeypatch):
    """The same of every format of plans."""
    return _copy(request.param, tmp_path, monkeypatch)


@pytest.fixture(params=WITH_FIGURES)
def plans_with_figures(request, tmp_path, monkeypatch):
    """The same of plans that held every figure."""
    return _copy(request.param, tmp_path, monkeypatch)


@pytest.fixture(params=OF_FLOORS)
def old_floor(request):
    """The file of a floor of every format."""
    return FIXTURES / request.param / "floor.json"


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


@pytest.mark.parametrize("name", PLANS)
def test_plans_load_and_their_figures_are_those_that_they_state(old_plans, name):
    path = old_plans / f"{name}.json"
    (plan,) = load_plans([path]).values()
    document = json.loads(path.read_text())
    stated = document.get("stated") or document["motion"]
    assert plan.energy == pytest.approx(stated["energy"], rel=SAME)
    assert plan.residual == pytest.approx(stated["residual"], rel=SAME, abs=1e-8)
    for figure in ("torque", "speed", "acceleration", "deflection", "jerk"):
        if f"peak_{figure}" in stated:
            assert plan.motion.peak(figure) == pytest.approx(stated[f"peak_{figure}"], rel=1e-5)
    assert plan.verification.agrees
    assert (plan.worst is None) == (name != "robust-plan")
    if worst := document.get("worst"):
        assert plan.worst.errors == pytest.approx(worst["errors"], rel=1e-5)
        assert plan.worst.residual == pytest.approx(worst["residual"], rel=1e-5)


@pytest.mark.parametrize("name", PLANS)
def test_plans_are_saved_to_the_same(old_plans, name):
    plan = qa.Plan.load(old_plans / f"{name}.json")
    plan.save("again.json")
    again = qa.Plan.load("again.json")
    assert again == plan
    assert (again.motion, again.worst, again.verification) == (
        plan.motion, plan.worst, plan.verification,
    )  # fmt: skip


def test_a_robot_that_was_read_in_part_moves_as_it_did_then(tmp_path, call):
    """Its URDF's damping, friction and a mimic were left out; a link and an inertial were twice."""
    folder = FIXTURES / "2026-11-28-robots"
    file = folder / "robot-plan.json"
    plan = qa.Plan.load(file)
    stated = json.loads(file.read_text())["stated"]
    assert plan.energy == pytest.approx(stated["energy"], rel=SAME)
    assert plan.residual == pytest.approx(stated["residual"], rel=SAME)
    assert plan.verification.agrees
    robot = plan.task.plant.robot
    assert (robot.friction, robot.coulomb, robot.followers) == ({}, {}, {})
    assert robot.description.links["finger"].mass == 0.1
    plan.save(tmp_path / "again.json")
    assert qa.Plan.load(tmp_path / "again.json") == plan
    assert call(f"compare {file}")[0] == 0
    # read today, its URDF is refused
    with pytest.raises(ValueError, match="link 'finger' of the URDF has two <inertial>"):
        qa.Robot(urdf=folder / "robot.urdf", elastic_joints={"a": 1e4})


def test_floors_load_and_their_figures_are_those_that_they_state(old_floor, tmp_path):
    floor = Floor.load(old_floor)
    document = json.loads(old_floor.read_text())
    stated = document.get("stated") or document["motion"]
    assert floor.energy == pytest.approx(stated["energy"], rel=SAME)
    assert floor.residual == pytest.approx(stated["residual"], rel=SAME, abs=1e-8)
    # 880 intervals differ from CVODES by 2e-4, as its report of that day says
    assert floor.verification.energy_share == pytest.approx(2e-4, rel=0.5)
    if before := document.get("verification"):
        for figure, value in before.items():
            assert getattr(floor.verification, figure) == pytest.approx(value, rel=1e-3, abs=1e-8)
    floor.save(tmp_path / "again.json")
    assert Floor.load(tmp_path / "again.json") == floor


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


@pytest.mark.slow
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
            on_the_way = scores_on_the_way(front, scale, known_indicators()[name])
            assert on_the_way[:-1].tolist() == stated
    table = Results.of_jobs(fronts).table
    assert len(table) == len(jobs)
    assert np.isfinite(table["missing"]).all()


@pytest.mark.slow_after(1)
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


def test_a_quantity_that_a_file_does_not_state_is_skipped(plans_with_figures, call):
    """As of a limit that is newer than the file: the peak is computed, and nothing is wrong."""
    text = Path("plan.json").read_text()
    (line,) = (line for line in text.splitlines(keepends=True) if '"peak_jerk"' in line)
    Path("older.json").write_text(text.replace(line, ""))
    code, _, err = call("compare older.json limited-plan.json")
    assert code == 0, err
    assert qa.Plan.load("older.json") == qa.Plan.load("plan.json")


@pytest.mark.parametrize(
    ("name", "place", "value", "words"),
    [
        ("plan", "motion/peak_jerk", 1.0, "peak jerk 1 rad/s^3"),
        ("plan", "motion/net_work", 0.02, "net work 0.02 J"),
        ("plan", "motion/overshoot", 0.1, "overshoot 0.1 rad"),
        ("plan", "motion/ranges", {"speed": [-1.0, 2.0]}, "least speed -1 rad/s"),
        ("robust-plan", "worst/residual", 0.1, "a worst-case residual of 0.1 m"),
        ("robust-plan", "worst/errors", {"damping": 0.1}, "a worst case with errors of damping"),
        ("plan", "worst", {"errors": {}, "residual": 0.1}, "a worst case with errors of none"),
    ],
)
def test_what_a_plan_of_before_states_is_checked(
    plans_with_figures, call, name, place, value, words
):
    edit(f"{name}.json", place, value)
    code, _, err = call(f"compare {name}.json")
    assert (code, f"{name}.json states {words}" in " ".join(err.split())) == (2, True), err


@pytest.mark.parametrize("missing", [("stated", "checksum"), ("stated",), ("checksum",)])
def test_a_plan_that_states_nothing_is_refused(tmp_path, monkeypatch, call, missing):
    """Files of 2.0.0 have both; without them changed coefficients would pass."""
    folder = _copy("2026-11-27-plans", tmp_path, monkeypatch)
    document = json.loads((folder / "plan.json").read_text())
    silent = {name: entry for name, entry in document.items() if name not in missing}
    Path("silent.json").write_text(json.dumps(silent))
    code, _, err = call("compare silent.json")
    assert code == 2
    assert "silent.json is not a valid plan: " in " ".join(err.split())


def test_a_figure_that_a_plan_states_is_computed_again(tmp_path, monkeypatch, call):
    _copy("2026-11-27-plans", tmp_path, monkeypatch)
    edit("plan.json", "stated/energy", 1.0)
    code, _, err = call("compare plan.json")
    assert (code, "plan.json states energy 1 J" in err) == (2, True), err


OF_TASK = {"duration": 0.81, "target": 0.5, "torque_limit": 9.0, "residual_window": 0.5}
ALTERED = {
    **{f"task/{name}": value for name, value in OF_TASK.items()},
    "task/plant/zeta": 0.02,
    "profile/terms": 7,
    "status": "not optimised",
    "record/seconds": 1e-3,
    "record/method": "mine",
    "record/iterations": 1,
    "record/versions/casadi": "0",
    "record/settings": {"starts": 3},
    "stated/energy": 0.016,
}
"""Entries that the files of plans and floors have in common, and other values for them."""
OF_KIND = {
    "plan": {"coefficients/0": 0.01, "steps": 97, "residual_limit": 0.001, "shadow_prices": {}},
    "floor": {"free/acceleration/3": 1.0, "solver_energy": 0.02, "tolerance": 0.1},
}


@pytest.mark.parametrize(
    ("kind", "place", "value"),
    [
        (kind, place, value)
        for kind, own in OF_KIND.items()
        for place, value in {**ALTERED, **own}.items()
        if (kind, place) != ("floor", "profile/terms")
    ],
)
def test_an_answer_of_2_0_0_that_was_altered_is_refused(tmp_path, kind, place, value):
    file = tmp_path / f"{kind}.json"
    shutil.copy(FIXTURES / "2026-11-27-plans" / file.name, file)
    loader = {"plan": qa.Plan, "floor": Floor}[kind]
    assert loader.load(file).record.method
    edit(file, place, value, seal=False)
    with pytest.raises(FileFormatError, match="is not a valid"):
        loader.load(file)


@pytest.mark.parametrize(
    ("place", "value"),
    [
        ("points/0/coefficients/0", 0.0012),
        ("points/0/energy", 0.04),
        ("task/plant/zeta", 0.02),
        ("record/evaluations", 10**6),
        ("reference/0", 1.0),
        ("failed", 7),
    ],
)
def test_so_is_a_front(tmp_path, place, value):
    qa.Front.load(FIXTURES / "2026-11-27" / "front.json").save(tmp_path / "front.json")
    edit(tmp_path / "front.json", place, value, seal=False)
    with pytest.raises(FileFormatError, match="not a valid front"):
        qa.Front.load(tmp_path / "front.json")


@pytest.mark.parametrize("kind", ["plan", "floor", "front", "machine"])
@pytest.mark.parametrize("depth", ["outer", "inner"])
def test_an_entry_that_is_given_twice_is_refused(tmp_path, kind, depth):
    """Python's and others' parsers take the last of two, and some the first."""
    day = "2026-11-27-plans" if kind in ("plan", "floor") else "2026-11-27"
    text = (FIXTURES / day / f"{kind}.json").read_text()
    name = "version" if depth == "outer" else "name"
    (line, *_) = (line for line in text.splitlines() if line.lstrip().startswith(f'"{name}":'))
    (tmp_path / "twice.json").write_text(text.replace(line, f"{line.rstrip(',')},\n{line}", 1))
    loader = {"plan": qa.Plan, "floor": Floor, "front": qa.Front, "machine": Identified}[kind]
    with pytest.raises(FileFormatError, match=f"entry '{name}' is given twice"):
        loader.load(tmp_path / "twice.json")
