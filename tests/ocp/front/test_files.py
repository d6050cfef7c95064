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
from quietarm.ocp.answers.encoding import plain
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


@pytest.mark.parametrize(
    "changes", [{"found": ()}, {"history": ()}, {"seed": None}, {"settings": {}}, {"failed": 0}]
)
def test_odd_but_whole_fronts_come_back(tmp_path, changes):
    front(**changes).save(tmp_path / "front.json")
    assert Front.load(tmp_path / "front.json") == front(**changes)


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


@pytest.mark.parametrize("share", [0.0, 0.01, 0.2, 0.5, 0.8, 0.99])
def test_a_truncated_file_is_refused(path, text, share):
    path.write_text(text[: int(share * len(text))])
    refused(path, "is not a front: it is not whole, valid JSON")


@pytest.mark.parametrize(
    "content",
    [
        b"a letter\nof two lines\n",
        b"\x89PNG\r\n\x1a\n" + bytes(100),
        b"\xff\xfe",
        b"[" * 100_000,
        b"[1, 2]",
        b"3",
        b"null",
        b"{}",
        b'{"format": 3, "version": 1}',
        b"PK\x03\x04" + bytes(50),
    ],
    ids=["text", "PNG", "no UTF-8", "deep", "list", "number", "null", "empty", "format 3", "zip"],
)
def test_a_foreign_file_is_refused(path, content):
    path.write_bytes(content)
    refused(path, "is not a front")


def test_a_plan_is_not_a_front(path):
    task = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8)
    plan_move(task, CycloidPolynomial(2), starts=1).save(path)
    refused(path, "is not a front: its format is 'quietarm-plan'")


def test_a_newer_front_says_so(path, text):
    path.write_text(text.replace('"version": 3', '"version": 4', 1))
    refused(path, "version 4 of the front format .* up to 3; install a newer quietarm")


@pytest.mark.parametrize("version", [1, 2])
def test_a_front_of_an_older_version_is_refused(path, text, version):
    path.write_text(text.replace('"version": 3', f'"version": {version}', 1))
    refused(path, f"version {version} of the front format .* reads 3; find the front again")


@pytest.mark.parametrize("version", ['"1"', "null", "0", "-1", "1.5", "true", "[1]"])
def test_an_odd_version_is_refused(path, text, version):
    path.write_text(text.replace('"version": 3', f'"version": {version}', 1))
    refused(path, "is not a front: its version is")


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e400"])
def test_a_number_that_is_not_finite_is_refused(path, text, number):
    assert '"energy": 0.2' in text
    path.write_text(text.replace('"energy": 0.2', f'"energy": {number}', 1))
    refused(path, "is not a front|is not a valid front")


def test_a_missing_file_is_named(path):
    refused(path, "cannot be read: no such file")


def test_a_folder_is_refused(path):
    path.mkdir()
    refused(path, "cannot be read: is a directory")


KEYS = sorted({"format", "version", *plain(front())})


@pytest.mark.parametrize("key", KEYS)
def test_a_front_that_lacks_something_names_it(path, text, key):
    document = json.loads(text)
    del document[key]
    path.write_text(json.dumps(document))
    refused(path, "format name|version" if key in ("format", "version") else f"'{key}' is missing")


ODD = {
    "points of nothing": (["points"], None),
    "points of a number": (["points"], 3),
    "points of text": (["points"], "abc"),
    "a point of a number": (["points", 0], 3),
    "a point of a list": (["points", 0], [1, 2]),
    "a point without a residual": (["points", 0], {"coefficients": [0, 0], "energy": 1.0}),
    "a residual below zero": (["points", 0, "residual"], -1.0),
    "an energy below zero": (["points", 2, "energy"], -1.0),
    "a residual of nothing": (["points", 0, "residual"], None),
    "a residual of text": (["points", 0, "residual"], "much"),
    "a residual of the text nan": (["points", 0, "residual"], "nan"),
    "a residual of a list": (["points", 0, "residual"], [1e-4]),
    "an energy of the text inf": (["points", 2, "energy"], "inf"),
    "a coefficient too few": (["points", 1, "coefficients"], [0.5]),
    "a coefficient too many": (["points", 1, "coefficients"], [0.5, 0.5, 0.5]),
    "a coefficient of text": (["points", 1, "coefficients", 0], "a"),
    "coefficients of nothing": (["points", 1, "coefficients"], None),
    "an unknown plant": (["task", "plant", "name"], "crane"),
    "a plant of a number": (["task", "plant"], 3),
    "a plant's parameter too many": (["task", "plant", "mass"], 1.0),
    "a plant's parameter of text": (["task", "plant", "omega"], "fast"),
    "an unknown profile": (["profile", "name"], "spline"),
    "a profile of text": (["profile"], "cycloid-polynomial"),
    "a profile of 99 terms": (["profile", "terms"], 99),
    "an unknown limit": (["task", "noise_limit"], 1.0),
    "a limit below zero": (["task", "torque_limit"], -1.0),
    "a duration below zero": (["task", "duration"], -0.8),
    "a target of nothing": (["task", "target"], None),
    "a task of text": (["task"], "crane"),
    "a seed of text": (["seed"], "a"),
    "a seed of a list": (["seed"], [1]),
    "a seed below zero": (["seed"], -1),
    "a reference below zero": (["reference"], [-1, 0]),
    "a reference of zero": (["reference"], [1.0, 0]),
    "a reference of one": (["reference"], [1.0]),
    "a reference of three": (["reference"], [1.0, 2.0, 3.0]),
    "a reference of nothing": (["reference"], None),
    "a history of nothing": (["history"], None),
    "a history of numbers": (["history"], [1, 2]),
    "a generation with more": (["history", 0, "more"], 1),
    "a generation with less": (["history", 0], {"evaluations": 3}),
    "a generation of text": (["history", 0, "evaluations"], "x"),
    "a generation of nothing": (["history", 0, "hypervolume"], None),
    "a hypervolume above one": (["history", 0, "hypervolume"], 1.5),
    "a gap of text": (["gaps"], [["a", "b"]]),
    "nested settings": (["settings", "bound"], {"lower": 0.1}),
    "settings of lists": (["settings", "bound"], [0.1]),
    "a version of a number": (["versions", "numpy"], 2),
    "a time below zero": (["seconds"], -5),
    "settings of nothing": (["settings"], None),
    "versions of a list": (["versions"], ["1"]),
    "a method of nothing": (["method"], None),
    "evaluations of text": (["evaluations"], "many"),
    "complete of text": (["complete"], "no"),
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
