"""No message quotes more than 80 letters of what a file holds, wherever they stand in it."""

import json
from contextlib import suppress
from itertools import islice
from pathlib import Path

import pytest
from saved_files import renew_checksum

import quietarm as qa
from quietarm.machine.identify import Identified
from quietarm.ocp import FileFormatError, Floor

MARK = "QZ"
LONG = MARK * 3000
MOST = 80
FIXTURES = Path(__file__).parents[2] / "fixtures"
LINK = (
    '<inertial><origin xyz="0.2 0 0"/><mass value="1"/>'
    '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial>'
)
URDF = (
    f'<robot name="two"><link name="base"/><link name="l1">{LINK}</link><link name="l2">{LINK}'
    '</link><joint name="a" type="revolute"><parent link="base"/><child link="l1"/>'
    '<axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="200" velocity="8"/></joint>'
    '<joint name="b" type="revolute"><parent link="l1"/><child link="l2"/>'
    '<origin xyz="0.4 0 0" rpy="0 0 0"/><axis xyz="0 0 1"/>'
    '<limit lower="-3" upper="3" effort="200" velocity="8"/></joint></robot>'
)
ROBOT = """urdf: two.urdf
joints: [a, b]
held: {}
elastic_joints: {a: {stiffness: 8000, damping: 1}, b: 5000}
base: {stiffness: [60000, 60000], damping: [5, 5], height: 0.5}
tip: l2
gravity: [0, 0, -9.81]
rotor_inertia: {a: 0.5, b: 0.5}
friction: {a: 1, b: 1}
modes: 2
limits: limits.yaml
measured: {frequency: 3Hz, at: [0, 0]}
"""
LIMITS = "joint_limits:\n  a: {has_velocity_limits: true, max_velocity: 1.0, max_acceleration: 2}\n"
TRAJECTORY = "joint_names: [a, b]\npoints:\n- positions: [0, 0]\n- positions: [1, 1]\n"
NO_PATH = "plan robot.yaml --duration 1"
"""Refused in the end, once all files are read."""


def places_in(text, marks=' :{}[],"=<>/'):
    """The text with each of its words replaced by the long one, in turn."""
    begin = 0
    for k, letter in enumerate(text + " "):
        if letter in marks or letter == "\n":
            if k > begin:
                yield text[:begin] + LONG + text[k:]
            begin = k + 1


def replaced(document):
    """A document with each entry, and each name of an entry, replaced in turn."""
    if isinstance(document, dict):
        for name, entry in document.items():
            others = {key: value for key, value in document.items() if key != name}
            yield {**others, LONG: entry}
            yield {**document, name: LONG}
            yield from ({**document, name: inner} for inner in replaced(entry))
    elif isinstance(document, list) and document:
        yield [LONG, *document[1:]]
        yield from ([inner, *document[1:]] for inner in replaced(document[0]))


def quoted_in(err):
    """Return how many letters of the long word a message has."""
    return len(MARK) * err.count(MARK)


@pytest.fixture
def robot(folder):
    """Files of a robot, which are good."""
    for name, text in {
        "two.urdf": URDF, "robot.yaml": ROBOT, "limits.yaml": LIMITS, "path.yaml": TRAJECTORY,
    }.items():  # fmt: skip
        (folder / name).write_text(text)
    return folder


@pytest.mark.parametrize(
    ("name", "text", "line"),
    [
        ("two.urdf", URDF, NO_PATH),
        ("robot.yaml", ROBOT, NO_PATH),
        ("limits.yaml", LIMITS, NO_PATH),
        ("path.yaml", TRAJECTORY, "list robot.yaml --path path.yaml"),
    ],
)
def test_files_of_robots(call, robot, name, text, line):
    refused = 0
    for spoilt in islice(places_in(text), None, None, 3 if name == "two.urdf" else 1):
        (robot / name).write_text(spoilt)
        status, _, err = call(line)
        assert quoted_in(err) <= MOST, err
        if status:
            assert (status, err.count("\n")) == (2, 1), err
            refused += 1
    assert refused > 3


@pytest.mark.parametrize(
    ("file", "answer"),
    [
        ("2.0.0/plan.json", qa.Plan),
        ("2.0.0/floor.json", Floor),
        ("2.0.0/front.json", qa.Front),
        ("2.0.0/machine.json", Identified),
    ],
)
def test_answers(tmp_path, file, answer):
    document = json.loads((FIXTURES / file).read_text())
    quoted = 0
    for spoilt in replaced(document):
        if "checksum" in document:
            renew_checksum(spoilt)
        (tmp_path / "spoilt.json").write_text(json.dumps(spoilt))
        with suppress(FileFormatError):
            answer.load(tmp_path / "spoilt.json")
            continue
        with pytest.raises(FileFormatError) as told:
            answer.load(tmp_path / "spoilt.json")
        assert quoted_in(str(told.value)) <= MOST, told.value
        quoted += MARK in str(told.value)
    assert quoted


TABLE = "a_1,a_2,energy_J\n0.1,0.2,3\n0.3,0.1,2\n"
RECORDING = "time_s,tip_mm\n" + "\n".join(f"{k / 100},{k % 3}" for k in range(6)) + "\n"


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (TABLE, "evaluate single-link --target 1 --duration 1 --coefficients t.csv"),
        (RECORDING, "identify t.csv flexible-beam --tip tip_mm"),
        (RECORDING, "identify t.csv flexible-beam --tip none"),
        ("time_s,angle_deg\n0,0\n0.1,1\n0.2,2\n", "evaluate single-link --path t.csv"),
    ],
)
def test_tables(call, folder, text, line):
    for spoilt in places_in(text, ","):
        (folder / "t.csv").write_text(spoilt)
        _, _, err = call(line)
        assert quoted_in(err) <= MOST, err


def test_a_secret_file_for_a_urdf_is_not_shown(call, folder):
    secret = "root:x:0:0:root:/root:/bin/bash\n" * 100
    (folder / "passwd").write_text(secret)
    (folder / "robot.yaml").write_text("urdf: passwd\n")
    status, _, err = call("list robot.yaml")
    assert (status, err.count("\n")) == (2, 1)
    assert "root" not in err
    assert "urdf is no text of a URDF, which begins with <robot>" in err
