"""Files that older versions wrote still load, with all that they say."""

import json
from dataclasses import asdict
from pathlib import Path

import pytest

from ocp import (
    FileFormatError,
    Floor,
    FloorSettings,
    Front,
    Plan,
    SolveSettings,
    evaluate_coefficients,
    resimulate,
)
from ocp.answers.encoding import plain, typed
from ocp.simulation.piecewise import PiecewiseMotion
from ocp.simulation.resimulation import resimulated

FOLDER = Path(__file__).parents[2] / "older_files"  # its README says how they were written
PLANS = ("plan-solved", "plan-given", "plan-polished")
FRONTS = ("front-searched", "front-polished", "front-epsilon", "front-weighted")


def file(name):
    return FOLDER / f"{name}.json"


def raw(name):
    return json.loads(file(name).read_text())


def assert_is_the_task(task, document):
    assert task.plant.name == document["plant"]
    assert task.plant.parameters == document["plant_parameters"]
    assert task.move == (document["start"], document["target"], document["duration"])
    assert task.residual_window == document["residual_window"]
    assert task.limits == document["limits"]


@pytest.mark.parametrize("name", PLANS)
def test_a_plan(name):
    plan, document = Plan.load(file(name)), raw(name)
    assert document["version"] == 1
    assert_is_the_task(plan.task, document)
    assert plan.coefficients == tuple(document["coefficients"])
    assert (plan.residual, plan.energy) == (document["residual"], document["energy"])
    figures = document["diagnostics"]
    assert {key: getattr(plan.motion, key) for key in figures} == figures
    assert plan.status.value == document["status"]
    assert vars(plan.verification) == document["verification"]
    assert plan.provenance.method == document["provenance"]["method"]
    assert plan.provenance.versions == document["provenance"]["versions"]
    assert plan.provenance.seconds == document["provenance"]["seconds"]
    # the figures are those of the task and the coefficients as they were loaded
    motion = resimulate(plan.task, plan.profile, plan.coefficients)
    assert motion.energy == pytest.approx(plan.energy, rel=1e-9)  # docs/accuracy.md
    assert motion.residual == pytest.approx(plan.residual, rel=3e-6, abs=1e-12)


def test_the_settings_of_a_plan_are_typed_again():
    solved = Plan.load(file("plan-solved")).provenance
    asked = SolveSettings(bound=0.5, seed=3, steps=40, guess=(0.01, -0.1))
    assert (solved.settings, solved.search) == (asked, {})
    given = Plan.load(file("plan-given")).provenance
    assert (given.settings, given.search) == (None, raw("plan-given")["provenance"]["settings"])
    polished = Plan.load(file("plan-polished")).provenance
    told = raw("plan-polished")["provenance"]["settings"]
    guess = tuple(map(float, told.pop("guess").split(",")))
    assert polished.settings == SolveSettings(0.01, bound=0.2, starts=1, seed=4, guess=guess)
    del told["starts"], told["steps"]
    assert polished.search == told
    assert (told["particles"], told["seed"], told["residual_limit"]) == (12, 4, 0.01)


@pytest.mark.parametrize("name", FRONTS)
def test_a_front(name):
    front, document = Front.load(file(name)), raw(name)
    assert document["version"] == 2
    assert_is_the_task(front.task, document["task"])
    assert [vars(point) for point in front.points] == [
        {**point, "coefficients": tuple(point["coefficients"])} for point in document["points"]
    ]
    for key in ("method", "settings", "seed", "failed", "complete", "versions", "seconds"):
        assert getattr(front, key) == document[key], key
    assert front.reference == tuple(document["reference"])
    assert [vars(entry) for entry in front.history] == document["history"]
    assert [vars(entry) for entry in front.failures] == document["failures"]
    assert front.gaps == tuple(map(tuple, document["gaps"]))
    point = front.points[0]
    found = evaluate_coefficients(front.task, point.coefficients)
    assert found.energy == pytest.approx(point.energy, rel=1e-5)  # docs/accuracy.md


@pytest.mark.parametrize(
    ("name", "evaluations", "iterations"),
    # 4 generations of 8 candidates; the file of the polished front has 142 in all
    [
        ("front-searched", 32, 0),
        ("front-polished", 32, 142 - 32),
        ("front-epsilon", 0, 271),
        ("front-weighted", 0, 249),
    ],
)
def test_candidates_and_iterations_of_a_front_are_told_apart(name, evaluations, iterations):
    front = Front.load(file(name))
    assert raw(name)["evaluations"] == evaluations + iterations
    assert (front.evaluations, front.iterations) == (evaluations, iterations)


def test_a_floor():
    floor, document = Floor.load(file("floor")), raw("floor")
    assert document["version"] == 1
    assert_is_the_task(floor.task, document)
    assert {key: values.tolist() for key, values in vars(floor.free).items()} == document["motion"]
    assert asdict(floor.motion) == {**document["figures"], "peak_jerk": None}  # not told then
    assert [vars(level) for level in floor.levels] == document["levels"]
    assert floor.starts == tuple(document["starts"])
    assert floor.provenance.settings == FloorSettings(False, 2, 5, 0.9)
    assert floor.provenance.versions == document["provenance"]["versions"]
    motion = resimulated(floor.task, PiecewiseMotion.of_free_motion(floor.task, floor.free)).motion
    assert motion.energy == pytest.approx(floor.energy, rel=1e-9)  # docs/accuracy.md


@pytest.mark.parametrize(
    ("name", "kind"), [("plan-solved", Plan), ("front-searched", Front), ("floor", Floor)]
)
def test_what_is_loaded_is_saved_in_todays_version_and_equal(tmp_path, name, kind):
    loaded = kind.load(file(name))
    loaded.save(tmp_path / "again.json")
    assert json.loads((tmp_path / "again.json").read_text())["version"] == kind.version
    assert kind.load(tmp_path / "again.json") == loaded


@pytest.mark.parametrize(
    ("name", "kind"), [("plan-solved", Plan), ("front-searched", Front), ("floor", Floor)]
)
@pytest.mark.parametrize("gone", [True, False], ids=["gone", "odd"])
def test_an_older_file_with_an_entry_gone_or_odd_is_refused(tmp_path, name, kind, gone):
    path = tmp_path / "damaged.json"
    for key in raw(name).keys() - {"format", "version"}:
        document = raw(name)
        document[key] = [[1]]
        if gone:
            del document[key]
        path.write_text(json.dumps(document))
        with pytest.raises(FileFormatError, match=r"damaged\.json is not a") as error:
            kind.load(path)
        assert "\n" not in str(error.value)
        assert not gone or f"{key}' is missing" in str(error.value)


ODD = [None, True, -1, 10**400, 0.5, "two\nlines", [[1]], {"a": 1}]


def _ways(tree, keys=()):
    """All ways into a document, the last entry of a list."""
    entries = tree.items() if isinstance(tree, dict) else [(-1, tree[-1])] if tree else []
    for key, value in entries:
        yield (*keys, key)
        if isinstance(value, dict | list):
            yield from _ways(value, (*keys, key))


@pytest.mark.parametrize(
    ("name", "kind", "older"),
    [
        ("plan-polished", Plan, True),
        ("plan-polished", Plan, False),
        ("front-weighted", Front, True),
        ("floor", Floor, False),
    ],
)
def test_any_entry_replaced_is_refused_in_one_line_or_harmless(tmp_path, name, kind, older):
    path, refused = tmp_path / "odd.json", []
    kind.load(file(name)).save(path)
    text = file(name).read_text() if older else path.read_text()
    for keys in _ways(json.loads(text)):
        for value in ODD:
            document = inner = json.loads(text)
            for key in keys[:-1]:
                inner = inner[key]
            inner[keys[-1]] = value
            path.write_text(json.dumps(document))
            try:
                loaded = kind.load(path)
            except FileFormatError as error:
                refused.append(str(error))
            else:
                assert typed(plain(loaded), kind) == loaded
    assert len(refused) > 200
    for message in refused:
        assert message.startswith(f"{path} ")
        assert "\n" not in message
        assert len(message) < 700
