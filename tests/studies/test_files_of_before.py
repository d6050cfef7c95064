"""Files that version 2.0.0 wrote load, are compared and reported, and state what they hold.

`tests/fixtures` says how they were made. Files of before are refused with the remedy.
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
from quietarm.metaheuristics.score import (
    HYPERVOLUME,
    scores_on_the_way,
)
from quietarm.ocp import FileFormatError, Floor
from quietarm.studies.answers.read_answers import load_front, load_plans
from quietarm.studies.bench.results import Results
from quietarm.studies.sweep import MoveLibrary

FIXTURES = Path(__file__).parents[1] / "fixtures"
PLANS = ["plan", "limited-plan", "robust-plan"]
SEARCHES = [f"search-seed{seed}" for seed in range(3)]
METHODS = "nsga2,epsilon,nsga2+polish"
SETTINGS = {
    "nsga2": {"population": 20}, "epsilon": {"points": 5}, "nsga2+polish": {"population": 20},
}  # fmt: skip
SAME = 1e-6
"""Two versions of one library differ by less in a figure that CVODES or moocore computes."""


@pytest.fixture
def old(tmp_path, monkeypatch):
    """A copy of the files of 2.0.0, in which the test stands."""
    folder = shutil.copytree(FIXTURES / "2.0.0", tmp_path / "2.0.0")
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


@pytest.mark.parametrize("name", PLANS)
def test_plans_load_and_their_figures_are_those_that_they_state(old, name):
    path = old / f"{name}.json"
    (plan,) = load_plans([path]).values()
    document = json.loads(path.read_text())
    stated = document["stated"]
    assert plan.energy == pytest.approx(stated["energy"], rel=SAME)
    assert plan.residual == pytest.approx(stated["residual"], rel=SAME, abs=1e-8)
    assert plan.verification.agrees
    assert (plan.worst is None) == (name != "robust-plan")


@pytest.mark.parametrize("name", PLANS)
def test_plans_are_saved_to_the_same(old, name):
    plan = qa.Plan.load(old / f"{name}.json")
    plan.save("again.json")
    again = qa.Plan.load("again.json")
    assert again == plan
    assert (again.motion, again.verification) == (plan.motion, plan.verification)
    if plan.worst is not None:
        assert again.worst.errors == plan.worst.errors
        assert again.worst.residual == plan.worst.residual


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


def test_a_floor_loads_and_its_figures_are_those_that_it_states(old, tmp_path):
    floor = Floor.load("floor.json")
    stated = json.loads(Path("floor.json").read_text())["stated"]
    assert floor.energy == pytest.approx(stated["energy"], rel=SAME)
    assert floor.residual == pytest.approx(stated["residual"], rel=SAME, abs=1e-8)
    # 880 intervals differ from CVODES by 2e-4, as its report of that day says
    assert floor.verification.energy_share == pytest.approx(2e-4, rel=0.5)
    floor.save(tmp_path / "again.json")
    assert Floor.load(tmp_path / "again.json") == floor


@pytest.mark.parametrize("name", ["front", "arm-front", *SEARCHES])
def test_fronts_and_searches_load_and_are_saved_to_the_same(old, name):
    front = load_front(old / f"{name}.json")
    front.save("again.json")
    again = qa.Front.load("again.json")
    assert again == front
    for point in front.points[::5]:
        candidate = qa.JudgedMotion.of_profile(front.task, front.profile, point.coefficients)
        assert point.energy == pytest.approx(candidate.energy, rel=SAME)
        assert point.residual == pytest.approx(candidate.residual, rel=SAME, abs=1e-8)


def test_a_machine_and_a_grid_load(old):
    machine = Identified.load(old / "machine.json")
    assert machine.plant.omega == pytest.approx(18.0, rel=1e-6)  # the recording is of 18 rad/s
    library = MoveLibrary("grid.zarr")
    plan = library.plan(target=np.radians(25.0), duration=0.85)
    assert plan.residual < 2e-4  # between four cells that arrive at rest


@pytest.mark.slow
def test_runs_are_of_their_jobs_and_their_figures_are_computed(old, of_these_versions):
    jobs = jobs_of(old)
    fronts = finished_jobs(jobs, "bench")
    assert list(fronts) == jobs
    (job, front), *_ = fronts.items()
    assert scores_on_the_way(front, job.problem.reference(), HYPERVOLUME)[-1] > 0
    table = Results.of_jobs(fronts).table
    assert len(table) == len(jobs)
    assert np.isfinite(table["missing"]).all()


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
    code, out, err = call(
        "sweep single-link --target 20deg,30deg --duration 0.8,0.9 --output grid.zarr"
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


FORMERLY = {"plan": 4, "front": 4, "floor": 3}


@pytest.mark.parametrize(("kind", "version"), FORMERLY.items())
def test_a_file_of_before_is_refused_with_the_remedy(old, call, kind, version):
    """2.0.0 reads these versions and writes its own (its `earlier` of each class)."""
    edit(f"{kind}.json", "version", version)
    loader = {"plan": qa.Plan, "floor": Floor, "front": qa.Front}[kind]
    with pytest.raises(FileFormatError, match=r"load it with quietarm 2\.0 and save it again"):
        loader.load(f"{kind}.json")
    code, _, err = call(f"export {kind}.json --output move.csv")
    assert (code, len(err.splitlines())) == (2, 1)


@pytest.mark.parametrize("missing", [("stated", "checksum"), ("stated",), ("checksum",)])
def test_a_plan_that_states_nothing_is_refused(old, call, missing):
    """Files of 2.0.0 have both; without them changed coefficients would pass."""
    document = json.loads((old / "plan.json").read_text())
    silent = {name: entry for name, entry in document.items() if name not in missing}
    Path("silent.json").write_text(json.dumps(silent))
    code, _, err = call("compare silent.json")
    assert code == 2
    assert "silent.json is not a valid plan: " in " ".join(err.split())


def test_a_figure_that_a_plan_states_is_computed_again(old, call):
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
    shutil.copy(FIXTURES / "2.0.0" / file.name, file)
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
    qa.Front.load(FIXTURES / "2.0.0" / "front.json").save(tmp_path / "front.json")
    edit(tmp_path / "front.json", place, value, seal=False)
    with pytest.raises(FileFormatError, match="not a valid front"):
        qa.Front.load(tmp_path / "front.json")


@pytest.mark.parametrize("kind", ["plan", "floor", "front", "machine"])
@pytest.mark.parametrize("depth", ["outer", "inner"])
def test_an_entry_that_is_given_twice_is_refused(tmp_path, kind, depth):
    """Python's and others' parsers take the last of two, and some the first."""
    text = (FIXTURES / "2.0.0" / f"{kind}.json").read_text()
    name = "version" if depth == "outer" else "name"
    (line, *_) = (line for line in text.splitlines() if line.lstrip().startswith(f'"{name}":'))
    (tmp_path / "twice.json").write_text(text.replace(line, f"{line.rstrip(',')},\n{line}", 1))
    loader = {"plan": qa.Plan, "floor": Floor, "front": qa.Front, "machine": Identified}[kind]
    with pytest.raises(FileFormatError, match=f"entry '{name}' is given twice"):
        loader.load(tmp_path / "twice.json")
