"""The files of fronts: what comes back, and what is refused."""

import copy
import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_fronts import front, points
from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import (
    CycloidPolynomial,
    FileFormatError,
    Front,
    FrontPoint,
    Generation,
    PointToPoint,
    non_dominated,
    plan_move,
)
from quietarm.ocp.answers.documents import plain
from quietarm.ocp.answers.provenance import versions


@pytest.mark.parametrize("kind", [np.float64, np.float32])
def test_numpy_numbers_are_saved_and_come_back(tmp_path, kind):
    rows = np.array([[0.25, -0.5], [0.5, -0.5]], dtype=kind)  # exact in either
    found = [FrontPoint(row, kind(r), kind(e)) for row, r, e in zip(rows, (0.25, 0.5), (1.0, 0.5),
                                                                    strict=True)]  # fmt: skip
    one = front(found, seed=np.int64(3), settings={"bound": kind(0.5)}, evaluations=np.int32(60))
    same = front(points((0.25, 1.0), (0.5, 0.5)), settings={"bound": 0.5})
    assert one.points[0] == FrontPoint((0.25, -0.5), 0.25, 1.0)
    assert (one.settings, one.seed, one.evaluations) == (same.settings, 3, 60)
    one.save(tmp_path / "front.json")
    assert Front.load(tmp_path / "front.json") == one


# -- files --

figures = st.floats(min_value=-0.0, allow_infinity=False)  # residuals and energies


@given(
    st.lists(st.tuples(figures, figures), max_size=6),
    st.integers(0, 2**63),
    st.floats(0, 1),
    st.booleans(),
)
def test_a_front_comes_back_as_it_was(tmp_path_factory, figures, seed, share, complete):
    path = tmp_path_factory.mktemp("front") / "front.json"
    one = front(
        non_dominated(points(*figures)),
        seed=seed,
        complete=complete,
        history=(Generation(20, share),),
    )
    one.save(path)
    loaded = Front.load(path)
    assert loaded == one
    assert loaded.seconds == one.seconds
    assert json.dumps(plain(loaded)) == json.dumps(plain(one))  # -0.0, too


def test_a_file_has_the_keys_that_others_read(tmp_path):
    front().save(tmp_path / "front.json")
    document = json.loads((tmp_path / "front.json").read_text())
    assert (document["format"], document["version"]) == ("quietarm-front", 3)
    assert document["points"] == [
        {"coefficients": [0.0, -0.5], "residual": 1e-4, "energy": 0.5},
        {"coefficients": [1.0, -0.5], "residual": 2e-4, "energy": 0.2},
        {"coefficients": [2.0, -0.5], "residual": 8e-4, "energy": 0.1},
    ]
    task = document["task"]
    assert (task["plant"]["name"], task["target"]) == ("arm-on-flexible-link", math.pi / 2)
    assert (task["start"], task["duration"]) == (0.0, 0.8)
    assert (task["torque_limit"], task["speed_limit"]) == (0.4, None)
    assert (document["method"], document["seed"]) == ("nsga2", 3)
    assert document["settings"] == {"bound": 0.5, "population": 20, "generations": None}
    assert document["versions"] == versions()


def test_an_older_file_is_replaced_whole(tmp_path):
    path = tmp_path / "front.json"
    front().save(path)
    front(()).save(path)
    assert Front.load(path) == front(())
    assert [entry.name for entry in tmp_path.iterdir()] == ["front.json"]


# -- files that are refused --


def refused(path, match):
    """Refused in one line that names the file, which stays as it was."""
    before = path.read_bytes() if path.is_file() else None
    with pytest.raises(FileFormatError, match=match) as caught:
        Front.load(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert before == (path.read_bytes() if path.is_file() else None)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "front.json"


@pytest.fixture
def text(path):
    front().save(path)
    return path.read_text()


def test_a_plan_is_not_a_front(path):
    task = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8)
    plan_move(task, CycloidPolynomial(2), starts=1).save(path)
    refused(path, "is not a front: its format is 'quietarm-plan'")


KEYS = sorted({"format", "version", *plain(front())})


ODD = {
    "a residual below zero": (["points", 0, "residual"], -1.0),
    "a residual of text": (["points", 0, "residual"], "much"),
    "a coefficient too few": (["points", 1, "coefficients"], [0.5]),
    "an unknown plant": (["task", "plant", "name"], "crane"),
    "a limit below zero": (["task", "torque_limit"], -1.0),
    "a seed below zero": (["seed"], -1),
    "a reference of one": (["reference"], [1.0]),
    "a generation of text": (["history", 0, "evaluations"], "x"),
    "a hypervolume above one": (["history", 0, "hypervolume"], 1.5),
    "nested settings": (["settings", "bound"], {"lower": 0.1}),
}


@pytest.mark.parametrize(("where", "value"), ODD.values(), ids=ODD.keys())
def test_a_front_with_something_odd_is_refused(path, text, where, value):
    document = json.loads(text)
    inner = document
    for key in where[:-1]:
        inner = inner[key]
    inner[where[-1]] = copy.deepcopy(value)
    path.write_text(json.dumps(document))
    refused(path, "is not a")


@pytest.mark.parametrize("order", [(1, 0, 2), (2, 1, 0)])
def test_points_out_of_order_are_refused(path, text, order):
    # 'sorted by residual, stillest first': what selects from a front relies on it
    document = json.loads(text)
    document["points"] = [document["points"][i] for i in order]
    path.write_text(json.dumps(document))
    refused(path, "points are out of order")
    with pytest.raises(ValueError, match="points are out of order"):
        front(tuple(front().points[i] for i in order))


def test_points_of_which_one_is_better_are_refused(path, text):
    document = json.loads(text)
    document["points"][1]["energy"] = 0.05  # less than the third's, with less residual
    path.write_text(json.dumps(document))
    refused(path, "one is better than another")


def test_a_place_that_cannot_be_written_is_named(tmp_path):
    with pytest.raises(ValueError, match="folder"):
        front().save(tmp_path / "missing" / "front.json")
