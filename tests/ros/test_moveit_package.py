"""The package for ROS 2, without ROS: its planner, the planner's process, and the node's lines."""

import asyncio
import importlib
import io
import json
import os
import re
import sys
from dataclasses import MISSING, fields
from pathlib import Path
from types import SimpleNamespace
from typing import ClassVar
from xml.etree import ElementTree

import pytest
import stand_in_ros
import yaml
from moveit_messages import along, motion_plan_response, robot_trajectory
from small_robots import ARM, write_robot
from trajectories import trapezoid

import quietarm as qa
from quietarm.studies import MessagePlanner

PACKAGE = Path(__file__).parents[2] / "ros" / "quietarm_moveit"
FILE = """urdf: robot.urdf
beam: {at: tool, length: 0.5, width: 6mm, height: 10mm, youngs_modulus: 70GPa, density: 2700,
       tip_mass: 0.3, damping: 0.5%, pieces: 2}
joints: [a, b]
held: {grip: 20mm}
modes: 1
"""
STILL = robot_trajectory(["a"], [(0.0, [0.0], [0.0], [0.0]), (1.0, [0.4], [0.0], [0.0])])


@pytest.fixture
def module(monkeypatch):
    """Return what imports a module of the package, with stand-ins for ROS."""
    monkeypatch.syspath_prepend(PACKAGE)
    stand_in_ros.install(monkeypatch)

    def load(name):
        for loaded in [entry for entry in sys.modules if entry.startswith("quietarm_moveit")]:
            monkeypatch.delitem(sys.modules, loaded)
        return importlib.import_module(f"quietarm_moveit.{name}")

    return load


@pytest.fixture
def node(module, monkeypatch):
    """A node whose planner answers what the test puts into `answer`, and keeps the questions."""
    replanner = module("replanner")
    asked = []

    class Planner:
        robot: ClassVar = {"robot": "arm", "joints": ["a", "b"], "notes": ["no masses"]}
        answer: ClassVar = {
            "message": STILL,
            "report": "1 s: still",
            "remarks": ["times are not used"],
        }

        def __init__(self, python, options):
            asked.append((python, options))

        def ask(self, question):
            asked.append(question)
            return self.answer

    monkeypatch.setattr(replanner, "PlannerProcess", Planner)
    monkeypatch.setattr(
        stand_in_ros.Node, "overrides", {"robot": "arm.yaml", "quietarm_python": "/env/python"}
    )
    made = replanner.Replanner()
    made.asked = asked
    return made


def plan(node, **options):
    name, callback = node.service
    assert name == "~/plan_kinematic_path"
    response = stand_in_ros.empty_response()
    return asyncio.run(callback(stand_in_ros.request(**options), response)).motion_plan_response


def test_the_node_gives_moveits_trajectory_planned_anew(node):
    assert node.asked[0][0] == "/env/python"
    assert node.asked[0][1]["robot"] == "arm.yaml"
    assert node.log == ["no masses", "ready: arm, joints a, b"]
    of_moveit = robot_trajectory(["a"], [(0.0, [0.0], [0.0], [0.0]), (0.5, [0.4], [0.0], [0.0])])
    node.move_group.answer = stand_in_ros.message_of(motion_plan_response(of_moveit, {"a": 0.0}))
    answer = plan(node)
    question = node.asked[-1]
    assert question["message"]["trajectory"] == of_moveit
    assert question["message"]["trajectory_start"]["joint_state"]["name"] == ["a"]
    assert (question["speed_scale"], question["acceleration_scale"]) == (1.0, 0.5)
    assert stand_in_ros.dictionary_of(answer.trajectory) == STILL
    assert answer.error_code.val == 1
    assert answer.error_code.message == "1 s: still"
    assert node.log[-2:] == ["times are not used", "1 s: still"]


def test_the_node_takes_a_reference_trajectory_and_a_topic_without_moveit(node):
    reference = stand_in_ros.message_of(STILL["joint_trajectory"])
    answer = plan(node, references=[reference])
    assert node.asked[-1]["message"]["trajectory"]["joint_trajectory"] == STILL["joint_trajectory"]
    assert answer.error_code.val == 1
    name, callback = node.subscription
    assert name == "~/trajectory"
    callback(stand_in_ros.message_of(STILL))
    assert [stand_in_ros.dictionary_of(message) for message in node.published] == [STILL]


@pytest.mark.parametrize(("kind", "code"), [("no plan", -1), ("invalid", -2), ("ended", -2)])
def test_an_error_is_a_code_and_a_sentence_without_a_trajectory(node, kind, code):
    node.planner.answer = {"error": "too short", "kind": kind}
    answer = plan(node, references=[stand_in_ros.message_of(STILL["joint_trajectory"])])
    assert answer.error_code.val == code
    assert (answer.error_code.message, answer.error_code.source) == ("too short", "quietarm_moveit")
    assert answer.trajectory.joint_trajectory.points == []


def test_what_moveit_did_not_plan_is_passed_on_and_its_absence_is_said(node):
    assert plan(node).error_code.val == -25
    failed = stand_in_ros.message_of(motion_plan_response(robot_trajectory([], []), {}))
    failed.error_code.val = -12  # GOAL_IN_COLLISION
    node.move_group.answer = failed
    assert plan(node).error_code.val == -12
    assert len(node.asked) == 1  # the planner was not asked


def test_the_planner_answers_a_line_a_line(module, tmp_path):
    planner = module("planner")
    written = write_robot(tmp_path, ARM, FILE)
    questions = [{"robot": str(written), "terms": 2}, {"message": {}}]
    answers = io.StringIO()
    planner.serve(io.StringIO("\n".join(map(json.dumps, questions))), answers)
    ready, refused = map(json.loads, answers.getvalue().splitlines())
    assert ready == {"robot": "arm", "joints": ["a", "b"], "notes": ready["notes"]}
    assert refused["kind"] == "invalid"
    assert "no JointTrajectory" in refused["error"]
    for wrong in ({"robot": "nowhere.yaml"}, {"robot": str(written), "slow": 1}, {}):
        answers = io.StringIO()
        planner.serve(io.StringIO(json.dumps(wrong) + "\n{}"), answers)
        (only,) = answers.getvalue().splitlines()
        assert json.loads(only)["kind"] == "invalid"


def test_an_interpreter_that_does_not_start_is_named(module):
    process = module("planner_process")
    with pytest.raises(process.PlannerError, match=r"quietarm_python is /nowhere/python, which"):
        process.PlannerProcess("/nowhere/python", {})


@pytest.mark.slow
def test_the_process_plans_and_ends(module, tmp_path):
    process = module("planner_process")
    written = write_robot(tmp_path, ARM, FILE)
    here = {**os.environ, "PYTHONPATH": str(Path(qa.__file__).parents[1])}
    planner = process.PlannerProcess(
        sys.executable, {"robot": str(written), "terms": 2, "judge": False}, here
    )
    message = along("ab", (0.0, 0.1), (0.8, 0.6), 1.3, lambda time: trapezoid(0.3, time, 1.3))
    planned = planner.ask({"message": message})
    assert planned["message"]["joint_trajectory"]["joint_names"] == ["a", "b"]
    assert planned["report"].startswith("1.3 s, 131 points")
    planner.close()
    with pytest.raises(process.PlannerError, match="has ended"):
        planner.ask({"message": message})
    with pytest.raises(process.PlannerError, match="nowhere"):
        process.PlannerProcess(sys.executable, {"robot": "nowhere.yaml"}, here)


def test_parameters_are_the_planners_options_with_its_defaults(module):
    options = {
        entry.name: entry.default
        for entry in fields(MessagePlanner)
        if entry.default is not MISSING
    }
    assert options == module("replanner").OPTIONS
    config = yaml.safe_load((PACKAGE / "config" / "replanner.yaml").read_text())
    parameters = config["quietarm_replanner"]["ros__parameters"]
    assert parameters.pop("move_group_service") == "plan_kinematic_path"
    assert parameters == options
    assert {name: type(value) for name, value in parameters.items()} == {
        name: type(value) for name, value in options.items()
    }  # ROS takes no whole number for a real one


def test_the_package_has_what_colcon_asks_for(monkeypatch):
    described = ElementTree.parse(PACKAGE / "package.xml").getroot()
    seen = {}
    setup = SimpleNamespace(setup=lambda **entries: seen.update(entries), find_packages=lambda: [])
    monkeypatch.setitem(sys.modules, "setuptools", setup)
    exec((PACKAGE / "setup.py").read_text(), {})
    assert described.findtext("name") == seen["name"] == "quietarm_moveit"
    released = re.match(r"[0-9.]*[0-9]", qa.__version__)[0].removesuffix(".dev")
    assert described.findtext("version") == seen["version"] == released
    assert described.findtext("export/build_type") == "ament_python"
    for _, files in seen["data_files"]:
        for name in files:
            assert (PACKAGE / name).is_file()
    imported = set(
        re.findall(
            r"^(?:from|import) (\w+)",
            (PACKAGE / "quietarm_moveit" / "replanner.py").read_text()
            + (PACKAGE / "launch" / "replanner.launch.py").read_text(),
            re.MULTILINE,
        )
    )
    needed = {entry.text for entry in described.iter("exec_depend")}
    assert imported - {"time", "typing", "pathlib", "quietarm_moveit"} <= needed
    first = (PACKAGE / "README.md").read_text().split("\n\n")[1]
    assert first.startswith("**Untested with ROS")
