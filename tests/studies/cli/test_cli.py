"""The command line as a person types it."""

import csv
import errno
import json
import math
import os
import re
import shlex
import signal
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest

import studies.cli.commands.evaluate
import studies.cli.commands.floor
import studies.cli.commands.plan
import studies.reproduction.recompute
import studies.runs.loading
import studies.runs.polishing
import studies.runs.searching
import studies.study.work
from models import __version__
from ocp import InfeasibleTaskError, Plan
from ocp.task.quantities import QUANTITIES
from studies.cli import quietarm
from studies.paper.printed import ROWS
from studies.reproduction.recompute import pieces_of_paper

QUIETARM = str(Path(sys.executable).parent / "quietarm")
COMMANDS = sorted(quietarm.commands)
MOVE = "single-link --target 30deg --duration 0.8"
TWO_TERMS = "--coefficients=0.003347,-0.1697"  # the paper's Table 1
EVERY_FILE = "--output plan.json --csv move.csv --figure move.png"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """A folder of the test's own, and standing in it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    return tmp_path


def run(line, **settings):
    """Run the installed command as a process of its own."""
    return subprocess.run(
        [QUIETARM, *shlex.split(line)], capture_output=True, text=True, timeout=120, **settings
    )


def contents(folder):
    """All files of a folder with what they hold, and the folders in it."""
    return {path: path.is_file() and path.read_bytes() for path in folder.rglob("*")}


@pytest.fixture
def refused(call, folder):
    """Run a line that must fail in one line, and leave the folder as it was; that line."""

    def run_refused(line, status):
        before = contents(folder)
        code, out, err = call(line)
        assert out == ""
        assert "Traceback" not in err
        assert err.startswith("quietarm: ")
        assert err.count("\n") == 1
        assert err.endswith("\n")
        assert code == status
        assert contents(folder) == before
        return err

    return run_refused


@pytest.fixture
def no_solve(monkeypatch):
    """Make a solve fail the test: what is wrong must be found before it."""

    def solve(*arguments, **settings):
        pytest.fail("a solve was begun")

    monkeypatch.setattr(studies.cli.commands.plan, "plan_move", solve)
    monkeypatch.setattr(studies.cli.commands.evaluate, "evaluate_coefficients", solve)
    for name in ("plan_move", "evaluate_coefficients", "search", "search_many"):
        monkeypatch.setattr(studies.runs.searching, name, solve)
    monkeypatch.setattr(studies.reproduction.recompute, "recompute_paper", solve)


# Answers


@pytest.fixture(scope="module")
def planned(tmp_path_factory):
    """One real run with every output, and a start that looks like an option."""
    where = tmp_path_factory.mktemp("planned")
    ran = run(
        "plan arm-on-flexible-link --start -pi/2 --target 45deg --duration 1000ms "
        "--torque-limit 0.4 --starts 2 --seed 3 --output plan.json --csv move.csv "
        "--sample-rate 250 --figure move.svg --quiet",
        cwd=where,
    )
    return where, ran


def test_a_plan_says_what_it_found_and_what_it_wrote(planned):
    where, ran = planned
    assert (ran.returncode, ran.stderr) == (0, "")
    assert ran.stdout.splitlines()[-3:] == ["wrote plan.json", "wrote move.csv", "wrote move.svg"]
    assert sorted(path.name for path in where.iterdir()) == ["move.csv", "move.svg", "plan.json"]
    found = Plan.load(where / "plan.json")
    assert "arm-on-flexible-link, -90 to 45 deg in 1 s" in ran.stdout
    assert f"{found.energy:.6g} J" in ran.stdout
    assert f"{found.motion.peak_torque:.4g} N m" in ran.stdout
    for value in found.coefficients:
        assert f"{value:.6g}" in ran.stdout


def test_a_plan_shows_its_limit_on_the_jerk_and_its_peaks(call):
    code, out, err = call(
        "plan arm-on-flexible-link --target pi/2 --duration 0.8 --jerk-limit 5e3 --starts 1 "
        "--output plan.json"
    )
    assert (code, err) == (0, "")
    motion = Plan.load("plan.json").motion
    assert motion.peak_jerk <= 5000.0 * 1.001  # README, 'How exact'
    shown = " ".join(out.split())
    assert "limits jerk 5000 rad/s^3" in shown
    for name, quantity in QUANTITIES.items():
        in_metres = quantity.unit == "m"
        words = "" if in_metres else f" {motion.peak(name):.4g} {quantity.unit}"
        assert f"peak {name}{words}" in shown


@pytest.mark.parametrize("command", ["plan", "evaluate", "front", "floor"])
def test_every_quantity_of_the_table_has_an_option(call, command):
    code, out, _ = call(f"{command} --help")
    assert code == 0
    shown = " ".join(out.split())
    for name, quantity in QUANTITIES.items():
        assert f"--{name}-limit" in shown
        assert f"Largest {quantity.label} on the way" in shown


def test_the_json_file_holds_the_plan_in_si_units(planned):
    document = json.loads((planned[0] / "plan.json").read_text())
    assert (document["format"], document["version"]) == ("quietarm-plan", 2)
    task = document["task"]
    assert task["plant"]["name"] == "arm-on-flexible-link"
    assert (task["start"], task["target"]) == (-math.pi / 2, math.pi / 4)
    assert task["duration"] == 1.0
    assert len(document["coefficients"]) == 6
    assert (task["torque_limit"], task["speed_limit"]) == (0.4, None)
    assert 0 <= document["motion"]["residual"] < 1e-8  # README, 'How exact'
    assert (
        document["motion"]["energy"] > 0.13
    )  # above the least without a limit, 0.136 J in docs/physics.md
    assert document["motion"]["peak_torque"] <= 0.4 * 1.001
    settings = document["provenance"]["settings"]
    assert (settings["starts"], settings["seed"]) == (2, 3)


def test_the_csv_file_drives_a_joint_at_the_rate_asked_for(planned):
    with open(planned[0] / "move.csv", newline="") as file:
        header, *rows = csv.reader(file)
    assert header == [
        "t_s", "theta_rad", "dtheta_rad_s", "ddtheta_rad_s2", "tip_m", "torque_Nm", "power_W"
    ]  # fmt: skip
    time, angle, speed, acceleration, tip, torque, power = np.array(rows, dtype=float).T
    np.testing.assert_allclose(time, np.arange(251) / 250, atol=1e-9)
    assert (angle[0], angle[-1]) == pytest.approx((-math.pi / 2, math.pi / 4), abs=1e-9)
    np.testing.assert_allclose([speed[[0, -1]], acceleration[[0, -1]]], 0, atol=1e-6)
    np.testing.assert_allclose(np.gradient(angle, time)[1:-1], speed[1:-1], atol=0.02)
    np.testing.assert_allclose(power, torque * speed, rtol=1e-6, atol=1e-9)
    assert abs(tip[-1]) < 1e-8
    assert np.abs(torque).max() <= 0.4 * 1.001


def test_the_picture_is_one(planned):
    root = ElementTree.parse(planned[0] / "move.svg").getroot()
    assert root.tag.endswith("}svg")


def test_given_coefficients_are_evaluated(call):
    code, out, err = call(f"evaluate single-link --target pi/6 --duration 0.8 {TWO_TERMS}")
    assert (code, err) == (0, "")
    assert "0.062973" in out  # docs/physics.md: 0.06297 J
    assert "0.256 mm" in out  # docs/physics.md: max |W| 1.12e-4 m, times 2.28
    assert "not optimised" in out


def test_evaluated_coefficients_are_written_like_a_plan(call, folder):
    code, out, _ = call(
        f"evaluate {MOVE} {TWO_TERMS} --output e.json --figure e.PNG --csv e.csv --sample-rate 100"
    )
    assert code == 0
    assert out.splitlines()[-3:] == ["wrote e.json", "wrote e.csv", "wrote e.PNG"]
    assert Plan.load("e.json").coefficients == (0.003347, -0.1697)
    assert len((folder / "e.csv").read_text().splitlines()) == 1 + 81
    assert (folder / "e.PNG").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("spelling", ["--start -pi/2", "--start=-pi/2", "--start -90deg"])
def test_an_angle_below_zero_needs_no_equals_sign(call, spelling):
    code, _, _ = call(
        f"evaluate arm-on-flexible-link {spelling} --target pi/2 --duration 1.2 "
        "--coefficients -0.1,-0.4 --output e.json"
    )
    assert code == 0
    saved = Plan.load("e.json")
    assert saved.task.start == pytest.approx(-math.pi / 2, rel=1e-15)
    assert saved.coefficients == (-0.1, -0.4)


def test_every_limit_reaches_the_solver(monkeypatch, call):
    asked = {}

    def note(task, profile, **settings):
        asked.update(task=task, profile=profile, settings=settings)
        raise InfeasibleTaskError("enough is known")

    monkeypatch.setattr(studies.cli.commands.plan, "plan_move", note)
    call(
        f"plan {MOVE} --torque-limit 0.2 --speed-limit 1.5 --acceleration-limit 9 "
        "--jerk-limit 700 --deflection-limit 80mm --residual-window 500ms --residual-limit 1mm "
        "--bound 0.3 --terms 5 --starts 7 --seed 11"
    )
    assert asked["task"].limits == {
        "torque": 0.2, "speed": 1.5, "acceleration": 9.0, "jerk": 700.0, "deflection": 0.08
    }  # fmt: skip
    assert asked["task"].residual_window == 0.5
    assert asked["profile"].terms == 5
    assert asked["settings"] == {"residual_limit": 1e-3, "bound": 0.3, "starts": 7, "seed": 11}


def test_by_default_six_terms_at_rest_without_a_box_from_zero(monkeypatch, call):
    asked = {}

    def note(task, profile, **settings):
        asked.update(task=task, profile=profile, settings=settings)
        raise InfeasibleTaskError("enough is known")

    monkeypatch.setattr(studies.cli.commands.plan, "plan_move", note)
    call(f"plan {MOVE}")
    assert (asked["task"].start, asked["task"].limits) == (0.0, {})
    assert asked["task"].residual_window == 1.0
    assert asked["profile"].terms == 6
    assert asked["settings"]["residual_limit"] == 0.0
    assert asked["settings"]["bound"] is None


# Help


def examples(text):
    """The commands of a help text, each on a line of its own."""
    lines = re.sub(r" \\\n +", " ", text.split("Example", 1)[1]).splitlines()
    return [line.strip() for line in lines if line.strip().startswith("quietarm ")]


@pytest.mark.parametrize("command", ["", *COMMANDS])
@pytest.mark.parametrize("flag", ["-h", "--help"])
def test_help_shows_examples(call, command, flag):
    code, out, err = call(f"{command} {flag}")
    assert (code, err) == (0, "")
    assert "Example" in out
    assert any(shown.startswith(f"quietarm {command}") for shown in examples(out))
    assert "\\b" not in out  # click's mark for lines that it must not fill


def test_help_names_every_option(call):
    _, out, _ = call("plan --help")
    options = (
        "start target duration terms bound residual-limit torque-limit speed-limit jerk-limit "
        "acceleration-limit deflection-limit starts seed output csv figure"
    )
    for option in options.split():
        assert f"--{option}" in out


def test_no_command_is_answered_with_help(call):
    code, out, err = call("")
    assert code == 2
    assert "quietarm plan single-link" in out
    assert err == ""


@pytest.mark.parametrize("launcher", [[QUIETARM], [sys.executable, "-m", "studies"]])
def test_the_installed_command_says_its_version(launcher):
    ran = subprocess.run([*launcher, "--version"], capture_output=True, text=True, timeout=60)
    assert (ran.returncode, ran.stdout, ran.stderr) == (0, f"quietarm, version {__version__}\n", "")


@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_examples_in_the_help_are_read_without_complaint(
    call, monkeypatch, let_sweep, folder, command
):
    _, out, _ = call(f"{command} --help")
    reached = []

    def note(*arguments, **settings):
        reached.append(settings)
        raise InfeasibleTaskError("enough is known")

    monkeypatch.setattr(studies.cli.commands.plan, "plan_move", note)
    monkeypatch.setattr(studies.cli.commands.evaluate, "evaluate_coefficients", note)
    monkeypatch.setattr(studies.runs.searching, "search", note)
    monkeypatch.setattr(studies.runs.searching, "search_many", note)
    monkeypatch.setattr(studies.runs.loading, "load_front", note)
    monkeypatch.setattr(studies.runs.polishing, "run_polish", note)
    monkeypatch.setattr(studies.study.work, "run_study", note)
    monkeypatch.setattr(studies.cli.commands.floor, "energy_floor", note)
    for name in ("epsilon", "weighted"):
        let_sweep(name, note)
    monkeypatch.setattr(studies.reproduction.recompute, "recompute_paper", note)
    shown = examples(out)
    assert shown
    for example in shown:
        code, _, err = call(example.removeprefix("quietarm "))
        assert (code, err.splitlines()[-1]) == (1, "quietarm: enough is known")
    assert len(reached) == len(shown)


# Bad input: one line that names the value and the remedy, status 2, before any solve

PLAN = f"plan {MOVE}"
BAD = [  # the line, the value that is named, the remedy
    ("plan singel-link --target 1 --duration 1", "singel-link", "did you mean 'single-link'?"),
    ("plan Single_Link --target 1 --duration 1", "Single_Link", "did you mean 'single-link'?"),
    (
        "plan arm-on-flexibel-link --target 1 --duration 1",
        "arm-on-flexibel-link",
        "did you mean 'arm-on-flexible-link'?",
    ),
    ("plan arm --target 1 --duration 1", "'arm'", "did you mean 'arm-on-flexible-link'?"),
    ("plan qqq --target 1 --duration 1", "qqq", "arm-on-flexible-link, dual-link, single-link"),
    (f"evaluate singel-link --target 1 --duration 1 {TWO_TERMS}", "singel-link", "single-link"),
    ("plan single-link --target 30degrees --duration 1", "30degrees", "30deg, pi/6"),
    ("plan single-link --target pi/0 --duration 1", "pi/0", "30deg, pi/6"),
    ("plan single-link --start up --target 1 --duration 1", "'up'", "30deg, pi/6"),
    ("plan single-link --target '' --duration 1", "''", "30deg, pi/6"),
    ("plan single-link --target nan --duration 1", "nan", "give a finite number"),
    ("plan single-link --target inf --duration 1", "inf", "give a finite number"),
    ("plan single-link --start=-inf --target 1 --duration 1", "-inf", "give a finite number"),
    ("plan single-link --target 0 --duration 1", "target equals start (0 rad)", "change one"),
    ("plan single-link --start 90deg --target pi/2 --duration 1", "1.5708 rad", "change one"),
    ("plan single-link --target 1 --duration 0", "duration is 0 s", "give a positive number"),
    ("plan single-link --target 1 --duration -1", "duration is -1 s", "give a positive number"),
    ("plan single-link --target 1 --duration nan", "duration is nan", "give a finite number"),
    ("plan single-link --target 1 --duration inf", "duration is inf", "give a finite number"),
    ("plan single-link --target 1 --duration 1h", "'1h'", "seconds (0.8) or 800ms"),
    *[
        (f"{PLAN} --{name}-limit {value}", f"{name} limit is {shown}", remedy)
        for name in ("torque", "speed", "acceleration", "deflection")
        for value, shown, remedy in (
            ("0", "0 ", "give a positive number"),
            ("-0.5", "-0.5 ", "give a positive number"),
            ("nan", "nan", "give a finite number"),
            ("inf", "inf", "give a finite number"),
        )
    ],
    (f"{PLAN} --torque-limit strong", "strong", "--torque-limit"),
    (f"{PLAN} --deflection-limit 1inch", "1inch", "metres (0.001) or 1mm"),
    (f"{PLAN} --residual-window 0", "residual window is 0 s", "give a positive number"),
    (f"{PLAN} --residual-window nan", "residual window is nan", "give a finite number"),
    (f"{PLAN} --residual-limit -1mm", "residual limit is -0.001 m", "give 0 (at rest) or more"),
    (f"{PLAN} --residual-limit nan", "residual limit is nan", "give a finite number"),
    (f"{PLAN} --residual-limit small", "small", "metres (0.001) or 1mm"),
    (f"{PLAN} --terms -1", "terms is -1", "to 32"),
    (f"{PLAN} --terms 33", "terms is 33", "to 32: beyond that double precision"),
    (f"{PLAN} --terms 1.5", "1.5", "--terms"),
    (f"{PLAN} --terms six", "six", "--terms"),
    (f"{PLAN} --bound 0", "bound on the coefficients is 0", "give a positive number"),
    (f"{PLAN} --bound -0.2", "bound on the coefficients is -0.2", "give a positive number"),
    (f"{PLAN} --bound nan", "bound on the coefficients is nan", "give a finite number"),
    (f"{PLAN} --starts 0", "starts is 0", "from 1 up"),
    (f"{PLAN} --seed -1", "seed is -1", "from 0 up"),
    (f"{PLAN} --method pso", "'pso'", "'vepso'"),
    (f"{PLAN} --method vepso --bound 0", "bound on the coefficients is 0", "give a positive"),
    (f"{PLAN} --method vepso", "bound", "0.2"),  # the paper's, eq (12)
    (f"evaluate {MOVE} --coefficients=0.1,nan", "coefficient 2 is 'nan'", "give finite numbers"),
    (f"evaluate {MOVE} --coefficients=inf", "coefficient 1 is 'inf'", "give finite numbers"),
    (f"evaluate {MOVE} --coefficients=0.1,,2", "coefficient 2 is ''", "separated by commas"),
    (f"evaluate {MOVE} --coefficients=a", "coefficient 1 is 'a'", "separated by commas"),
    (f"evaluate {MOVE} --coefficients=" + ",".join("0" * 33), "terms is 33", "to 32"),
]  # fmt: skip


@pytest.mark.parametrize(("line", "value", "remedy"), BAD, ids=[line for line, *_ in BAD])
def test_bad_input_is_refused_with_its_value_and_a_remedy(refused, line, value, remedy):
    message = refused(f"{line} {EVERY_FILE}", status=2)
    assert value in message
    assert remedy in message


FRONT = f"front {MOVE} --method nsga2"


@pytest.mark.parametrize(
    ("line", "value", "remedy"),
    [
        (FRONT, "bound", "0.2"),  # the paper's, eq (12)
        (f"{FRONT} --bound nan", "nan", "give a finite number"),
        (f"{FRONT} --bound 0.2 --population 0", "population is 0", "give"),
        (f"{FRONT} --bound 0.2 --generations 0", "generations is 0", "give"),
        (f"{FRONT} --bound 0.2 --runs 0", "runs is 0", "from 1 up"),
        (f"{FRONT} --bound 0.2 --runs 2 --workers 0", "workers is 0", "from 1 up"),
        (f"{FRONT} --bound 0.2 --workers 0", "workers is 0", "from 1 up"),
        (f"{FRONT} --bound 0.2 --seed -1", "seed is -1", "give"),
        (f"{FRONT} --bound 0.2 --terms 0", "0 terms", "give 1 term or more"),
        (f"{FRONT} --bound 0.2 --resume nowhere", "nowhere", "cannot be read"),
        (f"front {MOVE} --method annealing --bound 0.2", "annealing", "'nsga2', 'vepso'"),
        ("reproduce --seeds 0", "seeds is 0", "from 1 up"),
        ("reproduce --seeds 0 --output results", "seeds is 0", "from 1 up"),
    ],
)
def test_a_bad_search_is_refused_with_its_value_and_a_remedy(refused, line, value, remedy):
    message = refused(line, status=2)
    assert value in message
    assert remedy in message


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("replan", ["replan", "'plan'"]),
        ("plan", ["--target"]),
        ("plan single-link --duration 1", ["--target"]),
        ("plan single-link --target 1", ["--duration"]),
        (f"evaluate {MOVE}", ["--coefficients"]),
        (f"{PLAN} --torqe-limit 1", ["--torqe-limit", "--torque-limit"]),
        (f"{PLAN} 0.3", ["0.3"]),
        (f"{PLAN} --output", ["--output"]),
        ("reproduce --output", ["--output"]),
    ],
)
def test_a_command_that_is_not_whole_is_refused(refused, no_solve, line, words):
    message = refused(line, status=2)
    for word in words:
        assert word in message


@pytest.mark.parametrize("command", [PLAN, f"evaluate {MOVE} {TWO_TERMS}"])
@pytest.mark.parametrize(
    ("option", "value", "remedy"),
    [
        ("--output", "nowhere/plan.json", "folder nowhere does not exist; make it first"),
        ("--csv", "nowhere/move.csv", "folder nowhere does not exist; make it first"),
        ("--figure", "nowhere/move.png", "folder nowhere does not exist; make it first"),
        ("--output", "old.txt/plan.json", "cannot be written: not a directory"),
        ("--output", ".", "is a folder; give the name of a file in it"),
        ("--csv", "kept", "kept is a folder; give the name of a file in it"),
        ("--figure", "kept", "kept is a folder; give the name of a file in it"),
        ("--figure", "move.jpg", "move.jpg is no picture; end its name in .png, .pdf, .svg"),
        ("--figure", "move", "move is no picture; end its name in .png, .pdf, .svg"),
    ],
)
def test_an_output_that_cannot_be_is_found_before_the_solve(
    refused, no_solve, folder, command, option, value, remedy
):
    (folder / "kept").mkdir()
    (folder / "old.txt").write_text("old")
    message = refused(f"{command} {option} {value}", status=2)
    assert option in message
    assert remedy in message


@pytest.fixture
def read_only(folder, monkeypatch):
    """A folder that may not be written to."""
    locked = folder / "locked"
    locked.mkdir()
    locked.chmod(0o555)
    if os.access(locked, os.W_OK):  # root may write anywhere: answer as for anyone else
        answer = os.access
        monkeypatch.setattr(
            os, "access", lambda path, mode: Path(path).resolve() != locked and answer(path, mode)
        )
    yield locked
    locked.chmod(0o755)


@pytest.mark.parametrize(
    "line",
    [
        f"{PLAN} --output locked/plan.json",
        f"{PLAN} --csv locked/move.csv",
        f"{PLAN} --figure locked/move.png",
        "reproduce --output locked",
        "reproduce --output locked/results",
        f"front {MOVE} --method vepso --bound 0.2 --output locked/front.json",
        f"front {MOVE} --method vepso --bound 0.2 --checkpoint locked/state",
        f"front {MOVE} --method vepso --bound 0.2 --figure locked/front.png",
    ],
)
def test_a_folder_that_cannot_be_written_to_is_found_before_the_solve(
    refused, no_solve, read_only, line
):
    message = refused(line, status=2)
    assert "locked" in message
    assert "cannot be written; choose another place" in message


@pytest.mark.parametrize(
    ("rate", "value"),
    [("0", "0 Hz"), ("-5", "-5 Hz"), ("nan", "nan"), ("inf", "inf"), ("1e12", "1e+12 Hz")],
)
@pytest.mark.parametrize("command", [PLAN, f"evaluate {MOVE} {TWO_TERMS}"])
def test_a_sample_rate_that_cannot_be_is_found_before_the_solve(
    refused, no_solve, command, rate, value
):
    message = refused(f"{command} {EVERY_FILE} --sample-rate {rate}", status=2)
    assert value in message


@pytest.mark.parametrize(
    ("value", "remedy"),
    [
        ("nowhere/results", "folder nowhere does not exist; make it first"),
        ("old.txt", "old.txt is a file; give a folder"),
    ],
)
def test_a_reproduction_finds_a_bad_folder_before_its_solves(
    refused, no_solve, folder, value, remedy
):
    (folder / "old.txt").write_text("old")
    assert remedy in refused(f"reproduce --output {value}", status=2)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("plan single-link --target 1e300 --duration 1", "target is 1e+300 rad; give an angle"),
        ("plan single-link --target 1 --duration 1e-300", "duration is 1e-300 s; give 1e-06 to"),
        ("plan single-link --target 1 --duration 1e300", "duration is 1e+300 s; give 1e-06 to"),
        (f"evaluate single-link --target 1 --duration 1e300 {TWO_TERMS}", "duration is 1e+300 s"),
        (f"evaluate single-link --target 1e300 --duration 1 {TWO_TERMS}", "target is 1e+300 rad"),
    ],
)
def test_values_beyond_all_reason_are_refused(refused, no_solve, line, words):
    assert words in refused(f"{line} {EVERY_FILE}", status=2)


def test_coefficients_beyond_all_reason_fail_in_one_line(refused):
    message = refused(f"evaluate {MOVE} --coefficients=1e300 {EVERY_FILE}", status=1)
    assert "CVODES could not follow this motion" in message
    assert "largest is 1e+300" in message


# Solves that fail: status 1


def test_a_move_that_one_term_cannot_make_says_what_would_do(refused):
    message = refused(f"{PLAN} --terms 1 --starts 2 {EVERY_FILE}", status=1)
    assert "found no motion of 1 term with residual <= 0 m" in message
    assert re.search(r"feasible with the rest kept: residual limit 0\.\d+ m", message)


def test_a_torque_limit_that_is_too_low_says_the_least_that_would_do(refused, call):
    message = refused(f"{PLAN} --terms 3 --starts 2 --torque-limit 0.01 {EVERY_FILE}", status=1)
    assert "torque <= 0.01 N m" in message
    least = re.search(r"torque limit ([\d.]+) N m", message).group(1)
    code, _, _ = call(f"{PLAN} --terms 3 --starts 2 --torque-limit {least}")
    assert code == 0  # it does


def test_a_failed_solve_leaves_an_older_plan_alone(refused, folder):
    (folder / "plan.json").write_text("older")
    refused(f"{PLAN} --terms 1 --starts 1 --output plan.json", status=1)
    assert (folder / "plan.json").read_text() == "older"


def test_a_reason_of_several_lines_is_put_on_one(refused, monkeypatch):
    def end(*arguments, **settings):
        raise InfeasibleTaskError("no way\n  at all")

    monkeypatch.setattr(studies.cli.commands.plan, "plan_move", end)
    assert refused(f"{PLAN} {EVERY_FILE}", status=1) == "quietarm: no way at all\n"


def test_a_full_disk_leaves_nothing_half_written(call, folder, monkeypatch):
    (folder / "plan.json").write_text("older")

    def fail(*arguments):
        raise OSError(errno.ENOSPC, "No space left on device", "plan.json")

    monkeypatch.setattr(os, "replace", fail)
    code, _, err = call(f"evaluate {MOVE} {TWO_TERMS} --output plan.json")
    assert code == 2
    assert re.fullmatch(r"quietarm: .*plan\.json cannot be written: no space left on device\n", err)
    assert [path.name for path in folder.iterdir()] == ["plan.json"]
    assert (folder / "plan.json").read_text() == "older"


# Ctrl-C

INTERRUPTED = "quietarm: interrupted; nothing was written"
GUARD = 120
"""Seconds after which a process that does not end has hung, on any machine."""
# The command, which says when it begins to solve, so that the signal comes then and not before.
ANNOUNCED = """
import studies.cli
import studies.cli.commands.plan

solve = studies.cli.commands.plan.plan_move

def announced(*arguments, **settings):
    print("begun", flush=True)
    return solve(*arguments, **settings)

studies.cli.commands.plan.plan_move = announced
studies.cli.main()
"""


def interrupt(process, delay):
    """Send Ctrl-C after a while; what the process says then. Killed when it does not end."""
    try:
        try:
            process.wait(delay)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
        else:
            pytest.fail("the solves were over before the interrupt")
        return process.communicate(timeout=GUARD)
    finally:
        process.kill()
        process.communicate()  # closes its pipes


# The same, which says so when the third start begins.
AT_THE_THIRD = """
import studies.cli
from ocp.program.problem import Problem

solve, begun = Problem.solve, []

def announced(*given, **settings):
    begun.append(0)
    if len(begun) == 3:
        print("begun", flush=True)
    return solve(*given, **settings)

Problem.solve = announced
studies.cli.main()
"""


@pytest.fixture
def solving():
    """Begin a plan of 400 starts, until it says so."""

    def begin(code):
        words = shlex.split(f"plan {MOVE} --starts 400 {EVERY_FILE}")
        process = subprocess.Popen(
            [sys.executable, "-c", code, *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        assert process.stdout.readline() == "begun\n"
        return process

    return begin


# casadi is building the program.
@pytest.mark.parametrize("delay", [0.002, 0.03])
def test_ctrl_c_before_a_start_is_solved_writes_nothing(folder, solving, delay):
    process = solving(ANNOUNCED)
    out, err = interrupt(process, delay)
    assert (process.returncode, out) == (1, "")
    assert err.lstrip("\n") == f"{INTERRUPTED}\n"  # click first ends the terminal's line of ^C
    assert list(folder.iterdir()) == []


# IPOPT is at work. casadi has a habit of losing an interrupt: then all 400 starts are done.
def test_ctrl_c_keeps_the_best_of_the_starts_that_were_solved(solving):
    process = solving(AT_THE_THIRD)
    out, err = interrupt(process, 0.01)
    assert process.returncode == 1
    done = re.search(r"interrupted after (\d+) of 400 starts; what was found until then is", err)
    assert 1 <= int(done[1]) < 400
    plan = Plan.load("plan.json")
    assert not plan.complete
    assert plan.residual < 1e-8  # at rest: it was verified and mended
    assert f"Interrupted after {done[1]} of 400 starts: the best of these." in " ".join(out.split())


def test_ctrl_c_ends_a_reproduction_and_keeps_what_was_solved(folder):
    process = subprocess.Popen(
        [sys.executable, "-m", "studies", "reproduce", "--output", "results"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    while not process.stderr.readline().startswith("[3/"):  # the third solve has begun
        assert process.poll() is None
    out, err = interrupt(process, 0.05)
    assert process.returncode == 1
    (said,) = [line for line in err.splitlines() if not re.match(r"\[\d+/\d+\] ", line)]
    done, total = map(int, re.fullmatch(
        r"quietarm: interrupted: (\d+) of (\d+) pieces of work are done", said
    ).groups())  # fmt: skip
    assert 2 <= done < total == len(pieces_of_paper(seeds=1))
    written = (folder / "results" / "unfinished.csv").read_text()
    assert out == f"{written}wrote results/unfinished.csv\n"
    heading, *rows = csv.reader(written.splitlines())
    assert heading == ["piece", "energy_J", "residual_mm"]
    assert len(rows) == done
    assert all(float(energy) > 0 for _, energy, _ in rows)


# quietarm reproduce, with the one reproduction of these tests in place of another


@pytest.fixture
def reproduced(reproduction, monkeypatch):
    """Let the command find the paper recomputed already."""

    def at_once(begin, *rest):
        begin("the only solve")
        return reproduction

    monkeypatch.setattr(studies.reproduction.recompute, "recompute_paper", at_once)


def test_reproduce_prints_every_printed_and_recomputed_energy(call, reproduced, reproduction):
    code, out, err = call("reproduce")
    assert (code, err) == (0, f"[1/{len(pieces_of_paper(seeds=1))}] the only solve\n")
    for number in (2, 3, 5, 6):
        assert f"Table {number}: " in out
    for row in ROWS:
        assert f" {row.energy:.4g} " in out
    for result in reproduction.rows:
        assert f" {result.in_box.energy:.4g} " in out
        assert f" {result.free.energy:.4g} " in out
    for claim in ("Two terms suffice", "More terms", "above six", "beats refs [23] and [24]"):
        assert claim in out


def test_reproduce_writes_nothing_unless_asked_to(call, reproduced, folder):
    code, out, _ = call("reproduce --quiet")
    assert (code, list(folder.iterdir())) == (0, [])
    assert "wrote" not in out


def test_reproduce_quiet_shows_no_progress(call, reproduced):
    assert call("reproduce --quiet")[2] == ""


def test_reproduce_fills_a_folder_and_leaves_the_rest_of_it_alone(call, reproduced, folder):
    (folder / "results").mkdir()
    (folder / "results" / "notes.txt").write_text("mine")
    code, out, _ = call("reproduce --output results")
    assert code == 0
    written = re.findall(r"^wrote (.*)$", out, re.MULTILINE)
    assert {Path(name).suffix for name in written} == {".md", ".csv", ".png"}
    assert {Path(name) for name in written} | {Path("results/notes.txt")} == {
        path.relative_to(folder) for path in (folder / "results").iterdir()
    }
    assert (folder / "results" / "notes.txt").read_text() == "mine"


def test_reproduce_makes_the_folder(call, reproduced, folder):
    code, _, _ = call("reproduce --output results")
    assert code == 0
    assert (folder / "results" / "report.md").is_file()


# A user's own models.py


@pytest.mark.parametrize("package", ["ocp", "studies"])
@pytest.mark.parametrize("shadow", ["models.py", "models/__init__.py"])
def test_a_users_own_models_is_named_as_what_is_in_the_way(folder, package, shadow):
    (folder / shadow).parent.mkdir(exist_ok=True)
    (folder / shadow).write_text("class Car: ...\n")
    (folder / "script.py").write_text(f"import {package}\n")
    ran = subprocess.run([sys.executable, "script.py"], capture_output=True, text=True, timeout=60)
    assert ran.returncode == 1
    last = ran.stderr.splitlines()[-1]
    assert last.startswith(f"ImportError: {folder / shadow} takes the place of quietarm's package")
    assert "'models'" in last
    assert "rename that file, or move it away" in last


def test_a_users_own_models_that_is_loaded_already_is_named_too(folder):
    (folder / "models.py").write_text("class Car: ...\n")
    (folder / "script.py").write_text("import models\nimport ocp\n")
    ran = subprocess.run([sys.executable, "script.py"], capture_output=True, text=True, timeout=60)
    assert ran.returncode == 1
    assert ran.stderr.splitlines()[-1].startswith(f"ImportError: {folder / 'models.py'} takes")


def test_the_command_does_not_mind_a_users_own_models(folder):
    (folder / "models.py").write_text("raise RuntimeError('not this one')\n")
    ran = run("--version")
    assert (ran.returncode, ran.stderr) == (0, "")
