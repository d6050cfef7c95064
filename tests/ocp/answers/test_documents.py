"""Files that are not plans: each ends in one line that names the file and what is wrong."""

import json
import math
import re
from dataclasses import asdict, replace

import pytest
from quietarm.ocp import (
    MAX_TERMS,
    CycloidPolynomial,
    FileFormatError,
    Plan,
    PointToPoint,
    evaluate_coefficients,
    plan_move,
)
from quietarm.ocp.answers.documents import read_document, write_document
from quietarm.ocp.answers.encoding import plain, typed


@pytest.fixture(scope="module")
def whole(tasks):
    """The document of a plan with a limit."""
    task = replace(tasks["single link"], torque_limit=0.5)
    plan = evaluate_coefficients(task, [0.01, -0.1])
    return json.dumps({"format": "quietarm-plan", "version": Plan.version, **plain(plan)})


@pytest.fixture
def refused(tmp_path):
    """The message of loading a file of this content: one line that names the file."""

    def load(content):
        path = tmp_path / "some.json"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        with pytest.raises(FileFormatError) as error:
            Plan.load(path)
        message = str(error.value)
        assert "\n" not in message
        assert message.startswith(f"{path} ")
        return message.removeprefix(f"{path} ")

    return load


def _changed(whole, *keys, value):
    """The document with one entry changed."""
    document = json.loads(whole)
    inner = document
    for key in keys[:-1]:
        inner = inner[key]
    inner[keys[-1]] = value
    return json.dumps(document)


def test_the_whole_document_loads(whole, tmp_path):
    # Else the tests below would find nothing.
    (tmp_path / "whole.json").write_text(whole)
    plan = Plan.load(tmp_path / "whole.json")
    assert plan.coefficients == (0.01, -0.1)
    assert plan.task.limits == {"torque": 0.5}


# -- not JSON --


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.99])
def test_a_truncated_file_is_not_whole(whole, refused, share):
    message = refused(whole[: int(share * len(whole))])
    assert re.search(r"valid JSON in UTF-8(, for it ends too early| at byte \d+); write", message)


@pytest.mark.parametrize(
    "content",
    [
        pytest.param("a table: t_s, theta_rad\n", id="text"),
        pytest.param(b"\x89PNG\r\n\x1a\n\x00\xff", id="binary"),
        pytest.param("[" * 100_000, id="deep"),
        pytest.param('{"format": "quietarm-plan", "version": 2,}', id="comma"),
    ],
)
def test_what_is_not_json_is_not_a_plan(refused, content):
    assert "is not a plan" in refused(content)


def test_the_mark_that_some_editors_put_first_does_no_harm(whole, tmp_path):
    (tmp_path / "plan.json").write_bytes(b"\xef\xbb\xbf" + whole.encode())
    (tmp_path / "without.json").write_text(whole)
    assert Plan.load(tmp_path / "plan.json") == Plan.load(tmp_path / "without.json")


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity"])
@pytest.mark.parametrize("keys", [("motion", "energy"), ("coefficients", 0)])
def test_what_json_does_not_count_as_a_number_is_refused(whole, refused, keys, number):
    content = _changed(whole, *keys, value="HERE").replace('"HERE"', number)
    assert number in content
    at = content.index(number) + number.startswith("-")
    assert f"not whole, valid JSON in UTF-8 at byte {at}; write the plan again" in refused(content)


def test_a_number_out_of_range_is_said_to_be_one(whole, refused):
    content = _changed(whole, "task", "duration", value="HERE").replace('"HERE"', "1e999")
    assert "valid JSON in UTF-8, for one of its numbers is out of range; write" in refused(content)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(FileFormatError, match=r"none\.json cannot be read: no such file"):
        Plan.load(tmp_path / "none.json")


# -- not a plan --


@pytest.mark.parametrize("name", ["quietarm-front", "other", 1, True])
def test_another_format_is_named(whole, refused, name):
    assert repr(name) in refused(_changed(whole, "format", value=name))


@pytest.mark.parametrize("version", [Plan.version + 1, 10, 10**30])
def test_a_newer_version_is_named_with_the_remedy(whole, refused, version):
    message = refused(_changed(whole, "version", value=version))
    assert f"version {version}" in message
    assert "newer quietarm" in message


# -- not whole, or with a wrong entry --


KEPT = [
    ("task",), ("task", "plant", "name"), ("task", "plant", "omega"), ("task", "start"),
    ("profile", "name"), ("coefficients",), ("motion", "energy"), ("verification", "steps"),
    ("provenance", "method"), ("provenance", "versions"),
]  # fmt: skip


@pytest.mark.parametrize("keys", KEPT, ids="/".join)
def test_a_missing_entry_is_named(whole, refused, keys):
    document = json.loads(whole)
    inner = document
    for key in keys[:-1]:
        inner = inner[key]
    del inner[keys[-1]]
    message = refused(json.dumps(document))
    if keys[-1] == "name":
        assert "'name' is missing" in message
    else:
        assert f"'{'.'.join(keys)}' is missing" in message


@pytest.mark.parametrize(
    ("keys", "value", "says"),
    [
        (("task", "plant", "name"), "rocket", "'rocket' is not known.*single-link"),
        (("profile", "name"), "spline", "profile 'spline' is not known"),
        (("profile", "terms"), MAX_TERMS + 1, f"terms is {MAX_TERMS + 1}"),
        (("profile", "terms"), -1, "terms is -1"),
        (("profile", "terms"), 3, "got 2 coefficients for a profile of 3"),
        (("coefficients",), [0.1], "got 1 coefficients"),
        (("coefficients",), [0.1, None], r"coefficients\[1\] is None; give a number"),
        (("task", "duration"), 0, "duration is 0"),
        (("task", "duration"), -0.8, r"duration is -0.8.*\(at task\)"),
        (("task", "duration"), True, "task.duration is True; give a number"),
        (("task", "target"), 0.0, "target equals start"),
        (("task", "residual_window"), 0.0, "residual window is 0"),
        (("task", "torque_limit"), -1.0, "torque limit is -1"),
        (("task", "torque_limit"), "x", "task.torque_limit is 'x'; give a number or null"),
        (("task", "noise_limit"), 1.0, "'task.noise_limit' is not known here; take it out"),
        (("more",), 1.0, "'more' is not known here; take it out"),
        (("status",), "splendid", "status is 'splendid', which is not known here"),
        (("task", "plant", "omega"), "fast", "omega is .*fast"),
        (("task", "plant", "mass"), 1.0, "plant 'single-link' has no 'mass'; take it out"),
        (("provenance",), {"speed": 0}, "'provenance.method' is missing"),
        (("provenance", "search"), {"bound": [1]}, r"provenance.search is \{'bound': \[1\]\}"),
        (("verification", "steps"), 1.5, "verification.steps is 1.5; give a whole number"),
        (("verification", "steps"), 0, "verification.steps is 0; give a whole number >= 1"),
        (("motion", "energy"), "much", "motion.energy is 'much'; give a number"),
    ],
)
def test_a_wrong_entry_is_named_with_its_value(whole, refused, keys, value, says):
    assert re.search(says, refused(_changed(whole, *keys, value=value)))


# -- any document --


def test_a_document_reads_as_it_was_written(tmp_path):
    path = tmp_path / "some.json"
    content = {"numbers": [0.1, 1e-300, -0.0], "text": "Grüße", "nothing": None}
    write_document(path, "some", 3, content)
    assert read_document(path, "some", 3, dict) == content
    with pytest.raises(FileFormatError, match=r"version 3 of the some format.*install a newer"):
        read_document(path, "some", 2, dict)
    with pytest.raises(FileFormatError, match=r"version 3 .* reads 4; find the some again"):
        read_document(path, "some", 4, dict)


def test_a_document_that_json_cannot_hold_leaves_no_file(tmp_path):
    with pytest.raises(ValueError, match="JSON"):
        write_document(tmp_path / "some.json", "some", 1, {"number": math.nan})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_a_task_is_the_same_from_its_document(tasks, name):
    task = replace(tasks[name], start=-0.3, speed_limit=9.0, deflection_limit=0.2)
    assert typed(json.loads(json.dumps(plain(task))), PointToPoint) == task


def test_a_limit_that_is_not_set_may_be_missing(tasks):
    document = plain(tasks["arm"])
    del document["speed_limit"]
    assert typed(document, PointToPoint) == tasks["arm"]


def test_a_loaded_task_plans_the_same_move(tasks, tmp_path):
    plan = plan_move(tasks["arm"], CycloidPolynomial(2), starts=1, guess=[0.1, -0.2])
    plan.save(tmp_path / "plan.json")
    loaded = Plan.load(tmp_path / "plan.json")
    again = plan_move(loaded.task, loaded.profile, **asdict(loaded.provenance.settings))
    assert again == plan
