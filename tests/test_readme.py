"""The README does what it says: its commands, its examples, its files, its figures."""

import inspect
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from PIL import Image

from ocp import Front, Plan
from studies import figures
from studies.cli import quietarm

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()
BIN = Path(sys.executable).parent


def blocks(language):
    """The code blocks of one language, in order."""
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)


TWO_COMMANDS = [block.strip() for block in blocks("console")[:2]]
PYTHON = blocks("python")
NOTEBOOK = next(block.strip() for block in blocks("console") if "jupyter" in block)


# The two commands


def test_exactly_two_commands_of_one_line_stand_first():
    section = README.split("## Two commands\n", 1)[1].split("\n## ", 1)[0]
    found = re.findall(r"^```(\w*)\n(.*?)^```$", section, re.DOTALL | re.MULTILINE)
    assert [language for language, _ in found] == ["console", "console"]
    assert [body.strip() for _, body in found] == TWO_COMMANDS
    assert [body.count("\n") for _, body in found] == [1, 1]
    assert README.index("## Two commands") < README.index("```")


def test_the_first_sets_up_a_virtual_environment_and_recomputes_the_paper():
    steps = TWO_COMMANDS[0].split(" && ")
    assert steps[0] == "python3 -m venv .venv"
    assert steps[1].startswith(".venv/bin/python -m pip install")
    assert steps[-1].startswith(".venv/bin/quietarm reproduce")


def test_the_second_runs_the_tests():
    steps = TWO_COMMANDS[1].split(" && ")
    assert steps[0].startswith(".venv/bin/python -m pip install")
    assert steps[-1].startswith(".venv/bin/pytest")


@pytest.mark.parametrize("command", [*TWO_COMMANDS, NOTEBOOK])
def test_the_commands_install_with_the_constraints_that_are_here(command):
    (install,) = [step for step in command.split(" && ") if "pip install" in step]
    words = shlex.split(install)
    assert (ROOT / words[words.index("-c") + 1]).is_file()
    extras = re.fullmatch(r"\.(?:\[(.*)\])?", words[-1]).group(1)
    known = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    assert set(extras.split(",") if extras else []) <= set(known)


def test_the_gate_runs_the_two_commands_as_they_stand_here(tmp_path):
    # Run the gate's own script in a copy, with a shell that notes what it is asked to run and runs
    # nothing. The gate then stops for want of an environment to lint in.
    (tmp_path / ".ci").mkdir()
    shutil.copy(ROOT / ".ci" / "run", tmp_path / ".ci")
    shutil.copy(ROOT / "README.md", tmp_path)
    stub = tmp_path / "stub" / "bash"
    stub.parent.mkdir()
    stub.write_text('#!/bin/sh\nfor last in "$@"; do :; done\nprintf "%s\\n" "$last" >> noted\n')
    stub.chmod(0o755)
    environment = {**os.environ, "PATH": f"{stub.parent}{os.pathsep}{os.environ['PATH']}"}
    gate = subprocess.run(
        [shutil.which("bash"), ".ci/run"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert (tmp_path / "noted").read_text().splitlines() == TWO_COMMANDS
    assert gate.returncode != 0
    assert ".venv/bin/python" in gate.stderr


def test_the_gate_refuses_a_readme_without_them(tmp_path):
    (tmp_path / ".ci").mkdir()
    shutil.copy(ROOT / ".ci" / "run", tmp_path / ".ci")
    (tmp_path / "README.md").write_text("# quietarm\n\n```console\ntrue\n```\n")
    gate = subprocess.run(
        [shutil.which("bash"), ".ci/run"], cwd=tmp_path, capture_output=True, text=True, timeout=300
    )
    assert gate.returncode == 1
    assert "exactly two commands" in gate.stdout


def test_the_gate_lints_types_and_holds_the_imports():
    gate = (ROOT / ".ci" / "run").read_text()
    pyright = "pyright --pythonpath .venv/bin/python"  # else it looks for imports elsewhere
    for step in ("ruff check .", "ruff format --check .", pyright, "lint-imports"):
        assert f".venv/bin/{step}\n" in gate
    assert os.access(ROOT / ".ci" / "run", os.X_OK)


# The examples


def run_python(code, folder):
    (folder / "example.py").write_text(code)
    ran = subprocess.run(
        [sys.executable, "-W", "error", "example.py"],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert (ran.returncode, ran.stderr) == (0, "")
    return ran.stdout


def test_the_example_in_python_plans_saves_and_exports(tmp_path):
    printed = run_python(PYTHON[0], tmp_path)
    plan = Plan.load(tmp_path / "plan.json")
    assert printed == f"{plan.energy} {plan.residual} {plan.coefficients}\n"
    assert plan.residual < 1e-8  # docs/accuracy.md
    assert plan.motion.peak_torque <= 0.2 * 1.001  # docs/accuracy.md
    assert len((tmp_path / "move.csv").read_text().splitlines()) == 1 + 401  # 0.8 s at 500 Hz


def test_the_example_with_an_algorithm_of_pymoo_searches_and_saves(tmp_path):
    printed = run_python(PYTHON[1], tmp_path)
    front = Front.load(tmp_path / "sms-emoa.json")
    point = front.cheapest(10e-3)
    assert printed == f"{front.method} {len(front.points)} {point.energy}\n"
    assert front.method == "SMSEMOA"  # the name of its class


def test_the_example_of_a_front_finds_and_saves_it(tmp_path):
    printed = run_python(PYTHON[2], tmp_path)
    front = Front.load(tmp_path / "front.json")
    chosen = [front.stillest(), front.knee(), front.cheapest(5e-3)]
    assert printed == "".join(f"{point.residual} {point.energy}\n" for point in chosen)
    assert len(front.points) == 20


def test_the_example_of_robustness_says_what_a_wrong_plant_leaves(tmp_path):
    printed = run_python(PYTHON[3], tmp_path)
    low, high, residual = map(float, re.sub(r"[(),]", "", printed).split())
    assert -0.1 < low < 0 < high < 0.1  # docs/physics.md, 'Robustness': a few per cent
    # 'The published optima are not optimal': the frequency 10 % wrong leaves some 20 mm.
    assert 10e-3 < residual < 200e-3


def test_the_example_of_a_picture_draws_it(tmp_path):
    more = """
assert [ax.get_title(loc="left") for ax in (left, middle)] == [
    "joint torque [N m]", "tip displacement [mm]"
]
assert all(ax.figure is figure and ax.get_lines() for ax in (left, middle, right))
"""
    assert run_python(PYTHON[4] + more, tmp_path) == ""
    assert (tmp_path / "mine.png").read_bytes().startswith(b"\x89PNG")


def test_the_functions_that_draw_are_public_and_documented():
    section = README.split("## Pictures of your own\n", 1)[1].split("\n## ", 1)[0]
    named = set(re.findall(r"`((?:draw_|compare_)\w+|\w+_figure)`", section))
    assert named <= set(figures.__all__)
    assert {name for name in figures.__all__ if name.startswith("draw_")} <= named
    for name in figures.__all__:
        if name.startswith("draw_"):
            function = getattr(figures, name)
            given = inspect.signature(function).parameters["ax"]
            assert (given.default, given.annotation) == (None, "Axes | None")
            assert inspect.signature(function).return_annotation == "Axes"
            assert len(function.__doc__) > 100


def test_the_plant_of_your_own_is_one_file_that_everything_works_with(tmp_path):
    crane = PYTHON[5]
    use = """
from ocp import PointToPoint, plan_move

plan = plan_move(PointToPoint(Crane(), target=1.0, duration=3.0))
plan.save("crane.json")
assert type(plan).load("crane.json") == plan
print(plan.status.value, plan.residual < 1e-8, plan.task.plant.name)
"""
    assert run_python(crane + use, tmp_path) == "optimal True crane\n"


def test_no_example_is_left_untested():
    assert len(PYTHON) == 6
    languages = re.findall(r"^```(\w+)$", README, re.MULTILINE)
    assert set(languages) == {"console", "python"}


BLOCKS = [block.splitlines() for block in blocks("console")[2:] if block.strip() != NOTEBOOK]
COMMANDS = [line for block in BLOCKS for line in block]
SEARCH = ["--population", "20", "--generations", "5"]
SHORTER = {  # what is as long as the paper's, or thorough, is for the tests of its own
    "nsga2": SEARCH,
    "vepso": SEARCH,
    "epsilon": ["--points", "5"],
    "study": [*SEARCH, "--runs", "1", "--points", "4"],
    "contest": ["--runs", "1", "--evaluations", "150"],
}


def shortened(words):
    """The words of a command, with fewer generations or points."""
    method = words[words.index("--method") + 1] if "--method" in words else words[0]
    long = {"animate", "front", "polish", "robustness", "study", "contest"}
    quiet = ["--quiet"] if words[0] in long else []
    return [*words, *quiet, *(SHORTER.get(method, []) if words[0] != "plan" else [])]


@pytest.mark.parametrize("lines", BLOCKS, ids=[block[0].split()[1] for block in BLOCKS])
def test_the_commands_run_one_after_another(tmp_path, lines):
    asked = set()
    for line in lines:
        command, *words = shlex.split(line)
        assert command == ".venv/bin/quietarm"
        if "--plant-file" in words:  # the README says that its plant's lines are in it
            asked.add(words[words.index("--plant-file") + 1])
            (tmp_path / "crane.py").write_text(PYTHON[5])
        ran = subprocess.run(
            [BIN / "quietarm", *shortened(words)],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=600,
        )
        assert (ran.returncode, ran.stdout != "") == (0, True), ran.stderr
        said = ran.stderr.splitlines()
        progress = ("generation ", "refining", "finding", "solving", "integrating")
        assert [line for line in said if not line.startswith(progress)] == []
        options = ("--output", "--csv", "--figure")
        asked |= {words[i + 1] for i, word in enumerate(words) if word in options}
        assert {path.name for path in tmp_path.iterdir()} == asked


def test_what_opens_the_notebook_is_installed_before():
    install, opens = NOTEBOOK.split(" && ")
    (extra,) = re.findall(r"\.\[(\w+)\]", install)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    brought = [re.match(r"[\w-]+", one)[0] for one in project["optional-dependencies"][extra]]
    program, command, notebook = opens.split()
    assert (program, command) == (".venv/bin/jupyter", "lab")
    assert {"jupyterlab", "ipykernel"} <= set(brought)  # what `jupyter lab` is in, and its Python
    assert (ROOT / notebook).is_file()


def test_there_are_commands_for_a_move_of_your_own():
    named = {shlex.split(line)[1] for line in [*COMMANDS, *TWO_COMMANDS[0].split(" && ")]}
    assert named >= set(quietarm.commands)


# What it says


def test_files_that_it_names_are_there():
    linked = re.findall(r"!?\[[^]]*\]\(([^)#]+)\)", README)
    quoted = re.findall(r"`([\w.-]+/[\w./-]+\.\w+)`", README)
    names = [name for name in [*linked, *quoted] if "://" not in name]
    assert {"docs/move.gif", "notebooks/move.png"} <= set(names)
    assert "notebooks/01_plan_a_move.ipynb" in names
    assert [name for name in names if not (ROOT / name).exists()] == []


def test_the_order_of_the_packages_is_that_of_the_contract():
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]
    (layers,) = [  # between the packages; a contract within one names its container
        c["layers"]
        for c in contracts["contracts"]
        if c["type"] == "layers" and "containers" not in c
    ]
    assert "  <-  ".join(reversed(layers)) in README


def test_the_picture_says_what_is_computed(tmp_path):
    # The picture's text: the plain cycloid leaves so much, the plan needs such a share.
    (alt,) = re.findall(r"!\[([^]]*)\]\(docs/move\.gif\)", README)
    printed = run_python(
        """
from math import pi

from models import SingleLinkManipulator
from ocp import PointToPoint, evaluate_coefficients, plan_move

task = PointToPoint(SingleLinkManipulator(), target=pi / 6, duration=0.8)
cycloid, plan = evaluate_coefficients(task, []), plan_move(task)
print(cycloid.residual * 1e3, plan.energy / cycloid.energy, plan.residual)
""",
        tmp_path,
    )
    ringing, share, residual = map(float, printed.split())
    assert re.search(r"ringing by (\d+) mm", alt).group(1) == f"{ringing:.0f}"
    assert "a quarter of the energy" in alt
    assert share == pytest.approx(0.25, abs=0.02)
    assert residual < 1e-8


def test_the_picture_at_the_top_moves_and_is_what_its_commands_make():
    with Image.open(ROOT / "docs" / "move.gif") as picture:
        # 0.8 s and the second after it, 25 frames a second, and the first
        assert (picture.format, picture.n_frames, picture.width) == ("GIF", 46, 800)
    section = README.split("## Pictures that move\n", 1)[1].split("\n## ", 1)[0]
    assert "quietarm plan single-link --target 30deg --duration 0.8" in section
    assert README.index("(docs/move.gif)") < README.index("\n## ")


def test_the_table_of_results_is_that_of_the_physics():
    section = README.split("## What there is to gain\n", 1)[1].split("\n## ", 1)[0]
    rows = re.findall(r"^\|.*\|$", section, re.MULTILINE)
    assert len(rows) == 2 + 6
    physics = (ROOT / "docs" / "physics.md").read_text()
    table = physics.split("## The published optima are not optimal\n", 1)[1].split("\n## ", 1)[0]
    assert "\n".join(rows) in table


def test_every_reader_is_sent_to_a_section_that_is_there():
    section = README.split("## Where to go on\n", 1)[1].split("\n## ", 1)[0]
    named = set(re.findall(r"\(#([\w-]+)\)", section))
    headings = re.findall(r"^## (.*)$", README, re.MULTILINE)
    # GitHub's rule: small letters, hyphens for blanks, and no other marks
    anchors = {re.sub(r"[^\w-]", "", heading.lower().replace(" ", "-")) for heading in headings}
    assert len(named) == 6
    assert named <= anchors


def test_the_python_that_it_asks_for_is_the_packages():
    (named,) = re.findall(r"Python (3\.\d+) or newer", README)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert project["requires-python"] == f">={named}"
