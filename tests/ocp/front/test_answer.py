"""Fronts: which points stay, selecting from them, and their files."""

import copy
import dataclasses
import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models import ArmOnFlexibleLink
from ocp import (
    CycloidPolynomial,
    FileFormatError,
    Front,
    FrontPoint,
    Generation,
    PointToPoint,
    non_dominated,
    plan_move,
)
from ocp.answers.encoding import plain
from ocp.answers.provenance import versions

TASK = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8, torque_limit=0.4)


def points(*figures):
    """Points of the given (residual, energy); the coefficient tells them apart."""
    return tuple(FrontPoint((float(i), -0.5), r, e) for i, (r, e) in enumerate(figures))


def front(found=None, **changes):
    given_points = points((1e-4, 0.5), (2e-4, 0.2), (8e-4, 0.1)) if found is None else found
    content = {
        "task": TASK,
        "profile": CycloidPolynomial(2),
        "points": given_points,
        "method": "nsga2",
        "settings": {"bound": 0.5, "population": 20, "generations": None},
        "seed": 3,
        "reference": (0.015, 0.25),
        "evaluations": 60,
        "failed": 2,
        "history": (Generation(20, 0.0), Generation(40, 0.1), Generation(60, 0.7 / 3)),
        "complete": False,
        "seconds": 1.25,
        **changes,
    }
    return Front(**content)


# -- which points stay --

values = st.one_of(
    st.floats(0, 1),
    st.sampled_from([0.0, -0.0, 0.25, 0.5, math.nan, math.inf, -math.inf, 5e-324, 1e308]),
)


def _by_definition(given_points):
    """Finite, no other at least as good in both and better in one, and the first of its equals."""
    finite = [p for p in given_points if math.isfinite(p.residual) and math.isfinite(p.energy)]

    def beats(one, other):
        no_worse = one.residual <= other.residual and one.energy <= other.energy
        return no_worse and (one.residual, one.energy) != (other.residual, other.energy)

    kept = []
    for i, p in enumerate(finite):
        equal_before = any((p.residual, p.energy) == (q.residual, q.energy) for q in finite[:i])
        if not equal_before and not any(beats(q, p) for q in finite):
            kept.append(p)
    return kept


@given(st.lists(st.tuples(values, values), max_size=25))
def test_the_points_that_stay_are_those_of_the_definition(figures):
    given_points = points(*figures)
    kept = non_dominated(given_points)
    expected = _by_definition(given_points)
    # by their first coefficient, which tells points of equal figures apart
    assert sorted(p.coefficients for p in kept) == sorted(p.coefficients for p in expected)
    residuals, energies = ([getattr(p, name) for p in kept] for name in ("residual", "energy"))
    assert np.all(np.diff(residuals) > 0)
    assert np.all(np.diff(energies) < 0)


@given(st.lists(st.tuples(values, values), max_size=15), st.randoms())
def test_the_order_given_does_not_matter(figures, random):
    given_points = list(points(*dict.fromkeys(figures)))
    figures_kept = [(p.residual, p.energy) for p in non_dominated(given_points)]
    random.shuffle(given_points)
    assert [(p.residual, p.energy) for p in non_dominated(given_points)] == figures_kept


@given(st.lists(st.tuples(values, values), max_size=15))
def test_what_stays_stays(figures):
    kept = non_dominated(points(*figures))
    assert non_dominated(kept) == kept


def test_of_equal_points_the_first_stays():
    given_points = points((1.0, 1.0), (1.0, 1.0), (2.0, 0.5), (2.0, 0.5))
    assert non_dominated(given_points) == (given_points[0], given_points[2])
    assert non_dominated(iter(given_points)) == (given_points[0], given_points[2])


def test_equal_in_one_is_not_better_in_both():
    # the same residual, less energy: that one alone; and the other way about
    given_points = points((1.0, 3.0), (1.0, 2.0), (1.5, 2.0))
    assert non_dominated(given_points) == (given_points[1],)


def test_of_no_points_none_stay():
    assert non_dominated([]) == ()
    assert non_dominated(points((math.nan, 1.0), (1.0, math.inf), (-math.inf, 0.0))) == ()


# -- selecting --


def test_ends():
    one = front()
    assert one.stillest() is one.points[0]
    assert one.cheapest() is one.points[-1]


@pytest.mark.parametrize(
    ("limit", "index"), [(1e-4, 0), (1.9e-4, 0), (2e-4, 1), (7e-4, 1), (8e-4, 2), (math.inf, 2)]
)
def test_the_cheapest_within_a_residual(limit, index):
    assert front().cheapest(limit).coefficients[0] == index


@pytest.mark.parametrize("limit", [9.9e-5, 0.0, -1.0])
def test_a_residual_that_no_point_keeps_is_told_with_the_least_there_is(limit):
    with pytest.raises(ValueError, match=rf"residual of {limit:g} m or less.* has 0\.0001 m") as e:
        front().cheapest(limit)
    assert "\n" not in str(e.value)


@pytest.mark.parametrize("select", ["stillest", "cheapest", "knee"])
def test_an_empty_front_says_what_to_do(select):
    with pytest.raises(ValueError, match="no point; search longer or widen the bound"):
        getattr(front(()), select)()


def _distances(one):
    """How far each point is from the line between the ends, objectives scaled to [0, 1]."""
    F = np.column_stack([one.residuals, one.energies])
    F = (F - F[-1]) / (F[0] - F[-1])  # the ends at (1, 1) and (0, 0)
    F[:, 0] = 1 - F[:, 0]  # residual rises: from (0, 1) to (1, 0)
    return (1 - F.sum(axis=1)) / math.sqrt(2)


@given(st.lists(st.tuples(st.floats(1e-6, 1e-2), st.floats(0.01, 1.0)), min_size=3, max_size=12))
def test_the_knee_is_farthest_below_the_line_between_the_ends(figures):
    one = front(non_dominated(points(*figures)))
    if len(one.points) < 3:
        assert one.knee() is one.points[0]
        return
    distance = _distances(one)
    assert distance[one.points.index(one.knee())] >= distance.max() - 1e-9


def test_the_knee_of_a_plain_case():
    assert front().knee().coefficients[0] == 1
    bent = points((0.0, 1.0), (0.1, 0.9), (0.3, 0.3), (0.5, 0.25), (1.0, 0.0))
    assert front(bent).knee() is bent[2]  # 0.4 below the line; the others 0, 0.25
    outward = points((0.0, 1.0), (0.9, 0.9), (1.0, 0.0))
    assert front(outward).knee() in (outward[0], outward[2])  # the bulge is above the line
    assert front(points((0.1, 0.2))).knee().coefficients[0] == 0


def test_the_knee_does_not_depend_on_units():
    figures = [(0.0, 1.0), (0.1, 0.6), (0.3, 0.3), (0.7, 0.05), (1.0, 0.0)]
    small = [(r * 1e-6, 5 + e * 1e3) for r, e in figures]
    assert front(points(*figures)).knee().coefficients == front(points(*small)).knee().coefficients


# -- values --


def test_figures_as_arrays():
    one = front()
    assert one.residuals.tolist() == [1e-4, 2e-4, 8e-4]
    assert one.energies.tolist() == [0.5, 0.2, 0.1]
    assert front(()).residuals.shape == front(()).energies.shape == (0,)


def test_a_front_is_frozen():
    one = front()
    for changed, name in ((one, "points"), (one.points[0], "energy"), (one.history[0],
                                                                       "hypervolume")):  # fmt: skip
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(changed, name, None)


def test_changing_an_array_of_figures_leaves_the_front_alone():
    one = front()
    for name in ("residuals", "energies"):
        array = getattr(one, name)
        if array.flags.writeable:  # then a copy
            array[:] = 0.0
    assert one == front()


def test_equality_is_of_everything_but_the_time():
    assert front() == front(seconds=99.0)
    for change in (
        {"seed": 4},
        {"method": "vepso"},
        {"failed": 3},
        {"history": ()},
        {"complete": True},
        {"points": points((1e-4, 0.5), (2e-4, 0.2))},
        {"settings": {"bound": 0.4}},
        {"reference": (0.015, 0.26)},
        {"versions": {**versions(), "numpy": "0"}},
    ):
        assert front() != front(**change), change


# -- what is made is what can be loaded --

WRONG = {
    "a method of nothing": ({"method": None}, "method is None; give a text"),
    "a seed of text": ({"seed": "one"}, "seed is 'one'; give a whole number or null"),
    "a seed below zero": ({"seed": -1}, "seed is -1; give a whole number >= 0"),
    "a reference of one": ({"reference": (1.0,)}, "reference is"),
    "a reference of zero": ({"reference": (1.0, 0.0)}, r"reference\[1\] is 0.0; give a number > 0"),
    "settings of lists": ({"settings": {"bound": [0.1]}}, "settings"),
    "settings of nothing": ({"settings": None}, "settings is None; give a table"),
    "a hypervolume above one": ({"history": (Generation(20, 1.5),)}, "hypervolume is 1.5"),
    "evaluations of a half": ({"evaluations": 0.5}, "evaluations is 0.5; give a whole number"),
    "no task": ({"task": "arm"}, "task is 'arm'; give a PointToPoint"),
    "no profile": ({"profile": None}, "profile is None; give a JointProfile"),
    "a point of a number": ({"found": (3.0,)}, "point 1 is 3.0; give a FrontPoint"),
    "a coefficient too few": ({"found": (FrontPoint((1.0,), 1e-4, 0.5),)}, "got 1 coefficients"),
    "an energy that is none": ({"found": points((1e-4, math.nan))}, "energy of point 1 is nan"),
    "a residual below zero": ({"found": points((-1e-4, 0.5))}, "residual of point 1 is -0.0001 m"),
    "a control character": ({"method": "\x1b[2J"}, "'method' has a control character"),
}


@pytest.mark.parametrize(("changes", "words"), WRONG.values(), ids=WRONG)
def test_what_could_not_be_loaded_is_not_made(changes, words):
    with pytest.raises(ValueError, match=words) as caught:
        front(**changes)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        ((3.0, 1e-4, 0.5), "coefficients are 3.0; give numbers"),
        ((("a", "b"), 1e-4, 0.5), "coefficients are .*; give numbers"),
        (((1.0,), None, 0.5), "residual is None; give a number"),
        (((1.0,), 1e-4, "0.5"), "energy is '0.5'; give a number"),
    ],
)
def test_a_point_is_of_numbers(entries, words):
    with pytest.raises(ValueError, match=words):
        FrontPoint(*entries)


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


def test_a_front_that_is_no_number_is_not_written(tmp_path):
    with pytest.raises(ValueError, match="JSON"):
        front(settings={"bound": math.nan}).save(tmp_path / "front.json")
    assert list(tmp_path.iterdir()) == []


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


def test_a_front_from_before_the_first_release_is_refused(tmp_path):
    path = tmp_path / "front.json"
    front().save(path)
    path.write_text(path.read_text().replace('"version": 3', '"version": 1', 1))
    with pytest.raises(FileFormatError, match=r"version 1 .* reads 2 to 3; find the front again"):
        Front.load(path)


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
