"""The examples in README and docs run as they stand, and do what the page says."""

import math
import re
import shlex
import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest
import quietarm.studies.reports.comparison
import quietarm.studies.study.work
from pages import COMMAND_BLOCKS, PAGES, blocks
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import Front, Plan, PointToPoint, energy_floor, evaluate_coefficients
from quietarm.ocp.floor import search as floor_search
from quietarm.studies.cli import main

pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")

BIN = Path(sys.executable).parent
(SHORT,) = blocks("README", "python")
MOVE, SEQUENCE, ENERGY = blocks("moves", "python")
(MACHINE,) = blocks("machine", "python")
(CELL,) = blocks("sweeps", "python")
(BEGUN,) = blocks("start", "python")
(PROFILE,) = blocks("extend", "python")
SEARCH_OF_PYMOO, FRONT = blocks("fronts", "python")
ROBUSTNESS, ROBUST = blocks("robustness", "python")
(PICTURE,) = blocks("pictures", "python")
COUNTS, CRANE = blocks("plants", "python")


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


def test_the_short_example_plans_saves_and_draws(tmp_path):
    printed = run_python(SHORT, tmp_path)
    plan = Plan.load(tmp_path / "plan.json")
    assert printed == f"{plan.energy:.4f} J, 0.000 mm\n"
    assert plan.motion.peak_acceleration <= 40 * 1.001  # docs/accuracy.md
    assert (tmp_path / "move.png").read_bytes().startswith(b"\x89PNG")


def test_the_command_prints_what_the_page_shows(tmp_path):
    shown = blocks("README", "text")[0]
    line = next(block[0] for name, block in COMMAND_BLOCKS.items() if name.startswith("README"))
    words = [str(BIN / "quietarm"), *shlex.split(line)[1:]]
    ran = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=600)
    printed = " ".join(ran.stdout.split())
    for row in shown.strip().splitlines()[:-1]:
        kept, _, _ = row.partition("e-")  # a residual of nothing has other digits elsewhere
        assert " ".join(kept.split()[: 2 if kept != row else 3]) in printed


def test_the_example_in_python_plans_saves_and_exports(tmp_path):
    printed = run_python(MOVE, tmp_path)
    plan = Plan.load(tmp_path / "plan.json")
    assert printed == f"{plan.energy} {plan.residual} {plan.coefficients}\n"
    assert plan.residual < 1e-8  # docs/accuracy.md
    assert plan.motion.peak_torque <= 0.2 * 1.001  # docs/accuracy.md
    assert len((tmp_path / "move.csv").read_text().splitlines()) == 1 + 401  # 0.8 s at 500 Hz


def test_the_example_of_a_sequence_prints_what_the_page_shows(tmp_path):
    printed = run_python(SEQUENCE, tmp_path)
    _, shown = blocks("moves", "text")
    numbers = [re.findall(r"[\d.]+", text) for text in (printed, shown)]
    assert [float(x) for x in numbers[0]] == pytest.approx([float(x) for x in numbers[1]], abs=0.01)
    last, before = (Plan.load(tmp_path / f"move-{number}.json") for number in (3, 2))
    left = before.state_after(float(numbers[0][6]))
    assert [*last.task.initial.W] == pytest.approx(left.W, abs=1e-4)


def test_the_example_with_an_energy_of_ones_own_plans(tmp_path):
    label, energy = run_python(ENERGY, tmp_path).split()
    assert label == "recovering:0.6+copper:0.12"
    assert 0.349 < float(energy) < 0.349 + 0.0212  # of copper loss alone, with positive power


def test_the_example_with_an_algorithm_of_pymoo_searches_and_saves(tmp_path):
    printed = run_python(SEARCH_OF_PYMOO, tmp_path)
    front = Front.load(tmp_path / "sms-emoa.json")
    point = front.cheapest(10e-3)
    assert printed == f"{front.method} {len(front.points)} {point.energy}\n"
    assert front.method == "SMSEMOA"  # the name of its class


def test_the_example_of_a_front_finds_and_saves_it(tmp_path):
    printed = run_python(FRONT, tmp_path)
    front = Front.load(tmp_path / "front.json")
    chosen = [front.stillest(), front.knee(), front.cheapest(5e-3)]
    assert printed == "".join(f"{point.residual} {point.energy}\n" for point in chosen)
    assert len(front.points) == 20


def test_the_example_of_robustness_says_what_a_wrong_plant_leaves(tmp_path):
    printed = run_python(ROBUSTNESS, tmp_path)
    low, high, residual = map(float, re.sub(r"[(),]", "", printed).split())
    assert -0.1 < low < 0 < high < 0.1  # docs/physics.md, 'Robustness': a few per cent
    # 'The published optima are not optimal': the frequency 10 % wrong leaves some 20 mm.
    assert 10e-3 < residual < 200e-3


def test_the_example_of_a_robust_plan_holds_its_limit(tmp_path):
    energy, residual, _ = run_python(ROBUST, tmp_path).split(maxsplit=2)
    # 5 % of how far the plain cycloid bends the tip on its way
    cycloid = evaluate_coefficients(PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8), [])
    assert 0 < float(residual) <= 0.05 * cycloid.motion.peak_deflection * (1 + 1e-6)
    assert 0.02 < float(energy) < 0.03


def test_the_example_of_a_picture_draws_it(tmp_path):
    more = """
assert [ax.get_title(loc="left") for ax in (left, middle)] == [
    "joint torque [N m]", "tip displacement [mm]"
]
assert all(ax.figure is figure and ax.get_lines() for ax in (left, middle, right))
"""
    assert run_python(PICTURE + more, tmp_path) == ""
    assert (tmp_path / "mine.png").read_bytes().startswith(b"\x89PNG")


def test_a_cell_of_the_sweep_of_the_page_is_found(tmp_path, monkeypatch, called):
    monkeypatch.chdir(tmp_path)
    assert called([*shlex.split(COMMAND_BLOCKS["sweeps-0"][0])[1:], "--quiet"])[0] == 0
    energy = float(run_python(CELL, tmp_path).split()[0])
    assert 0.02 < energy < 0.03  # README: the link's first move takes 0.0237 J


def test_the_example_counts_the_modes_that_a_move_needs(tmp_path):
    shown = run_python(COUNTS, tmp_path)
    left = [float(each) for each in re.findall(r"with \d: ([0-9.]+) mm", shown)]
    # the page: one mode leaves 1.24 mm, two leave 0.0003 mm
    assert left[0] == pytest.approx(1.24, abs=0.01)
    assert max(left[1:]) < 1e-3


def test_the_plant_of_your_own_is_one_file_that_everything_works_with(tmp_path):
    crane = CRANE
    use = """
from quietarm.ocp import PointToPoint, plan_move

plan = plan_move(PointToPoint(Crane(), target=1.0, duration=3.0))
plan.save("crane.json")
assert type(plan).load("crane.json") == plan
print(plan.status.value, plan.residual < 1e-8, plan.task.plant.name)
"""
    assert run_python(crane + use, tmp_path) == "optimal True crane\n"


def test_the_first_lines_of_python_plan_a_move(tmp_path):
    assert run_python(BEGUN, tmp_path) == "0.0237 J, residual 0.000 mm\n"  # the page's command


def test_a_profile_of_your_own_is_planned_with(tmp_path):
    energy, at_rest = re.fullmatch(
        r"(\S+) J, residual (\S+) mm\n", run_python(PROFILE, tmp_path)
    ).groups()
    assert at_rest == "0.000"
    assert 0.0165 < float(energy) < 0.0912  # the floor's, and the plain cycloid's, of docs/moves.md


def test_no_example_is_left_untested():
    others = [page for page in PAGES if page != "problems"]  # tests/metaheuristics/problems
    assert sum(len(blocks(page, "python")) for page in others) == 15
    languages = re.findall(r"^```(\w+)$", "".join(PAGES.values()), re.MULTILINE)
    assert set(languages) == {"console", "python", "text"}


SEARCH = ["--population", "20", "--generations", "5"]
SHORTER = {  # what is as long as the paper's, or thorough, is for the tests of its own
    "epsilon": ["--points", "5"],
    "weighted": ["--points", "5"],
    "study": [*SEARCH, "--runs", "1", "--points", "4"],
    "contest": ["--runs", "1", "--evaluations", "150"],
    "floor": ["--starts", "1", "--tolerance", "0.05"],
}
QUIET = {
    "animate", "compare", "contest", "front", "identify", "import", "plan", "polish", "problems",
    "robustness", "study", "sweep", "versus",
}  # fmt: skip


def shortened(words):
    """The words of a command, with fewer generations or points."""
    quiet = ["--quiet"] * (words[0] in QUIET)
    fewer = SHORTER.get(words[0], [])
    if words[0] == "front" and "--method" in words:
        fewer = SHORTER.get(words[words.index("--method") + 1], SEARCH)
    return [*words, *quiet, *fewer]


@pytest.fixture
def started():
    """Start a command as the reader does; its status, standard output and standard error."""

    def start(words):
        ran = subprocess.run(
            [BIN / "quietarm", *words], capture_output=True, text=True, timeout=600
        )
        return ran.returncode, ran.stdout, ran.stderr

    return start


@pytest.fixture
def called(capfd, monkeypatch, quick_pictures):
    """Run a command in this process, with rough floors; status, standard output and error."""
    rough = partial(energy_floor, starts=1, tolerance=0.05)
    monkeypatch.setattr(quietarm.studies.reports.comparison, "energy_floor", rough)
    monkeypatch.setattr(quietarm.studies.study.work, "energy_floor", rough)
    monkeypatch.setattr(floor_search, "FIRST_INTERVALS", 24)

    def call(words):
        with pytest.raises(SystemExit) as ended:
            main(words)
        out, err = capfd.readouterr()
        return ended.value.code, out, err

    return call


STARTED = [name for name in COMMAND_BLOCKS if name.startswith("README")][:1]
"""Blocks whose commands are started as they stand; all others cost no process each."""


@pytest.mark.parametrize("block", STARTED)
def test_the_first_commands_run_one_after_another(tmp_path, monkeypatch, block, started):
    run_block(block, tmp_path, monkeypatch, started)


CALLED = [name for name in COMMAND_BLOCKS if name not in STARTED and name != "explore-0"]
"""The page of explore stays until Ctrl-C: tests/studies/explore opens it."""


@pytest.mark.parametrize("block", CALLED)
def test_the_commands_run_one_after_another(tmp_path, monkeypatch, block, called, request):
    given = request.getfixturevalue("machine")[0] if block.startswith("machine") else None
    run_block(block, tmp_path, monkeypatch, called, given)


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    """The recording of docs/machine.md, and what its commands have made of it before the last."""
    folder = tmp_path_factory.mktemp("machine")
    run_python(MACHINE, folder)
    (folder / "example.py").unlink()
    identify, plan = COMMAND_BLOCKS["machine-0"][0], COMMAND_BLOCKS["machine-1"][1]
    printed = [
        subprocess.run(
            [BIN / "quietarm", *shlex.split(line)[1:], "--quiet"],
            cwd=folder, capture_output=True, text=True, timeout=600, check=True,
        ).stdout
        for line in (identify, plan)
    ]  # fmt: skip
    for picture in folder.glob("*.png"):
        picture.unlink()
    return folder, printed[0]


def test_the_machine_of_the_page_is_the_one_that_was_recorded(machine):
    _, printed = machine
    (shown,) = blocks("machine", "text")
    of_page, now = (
        [[float(x) for x in re.findall(r"\d+\.\d+", line)] for line in text.splitlines()[:4]]
        for text in (shown, printed)
    )
    for before, after in zip(of_page, now, strict=True):
        assert after == pytest.approx(before, rel=2e-3, abs=0.1 * (before == of_page[3]))
    (_, low, high), (_, least, most) = ([line[0], *line[1:3]] for line in now[1:3])
    assert low < 20.1 / (2 * math.pi) < high
    assert least < 0.01 < most


def run_block(block, folder, monkeypatch, run, given=None):
    monkeypatch.chdir(folder)
    asked = set()
    if given is not None:
        shutil.copytree(given, folder, dirs_exist_ok=True)
        asked = {path.name for path in folder.iterdir()}
    for line in COMMAND_BLOCKS[block]:
        command, *words = shlex.split(line)
        assert command == ".venv/bin/quietarm"
        if "--plant-file" in words:  # the page says that its plant's lines are in it
            asked.add(words[words.index("--plant-file") + 1])
            (folder / "crane.py").write_text(CRANE)
        status, out, err = run(shortened(words))
        assert (status, out != "") == (0, True), err
        progress = ("generation ", "refining", "finding", "solving", "integrating")
        assert [line for line in err.splitlines() if not line.startswith(progress)] == []
        options = ("--output", "--csv", "--figure")
        asked |= {words[i + 1] for i, word in enumerate(words) if word in options}
        asked |= {name.replace(".c", ".h") for name in asked if name.endswith(".c")}
        assert {path.name for path in folder.iterdir()} == asked
