"""The examples in README and docs run as they stand, and do what the page says."""

import math
import re
import runpy
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from floors import coarse_floors
from pages import COMMAND_BLOCKS, PAGES, ROOT, blocks, shown_file
from robots import urdf_of

from quietarm.models import SingleLinkManipulator
from quietarm.ocp import (
    CycloidPolynomial,
    Front,
    Plan,
    PointToPoint,
    evaluate_coefficients,
    plan_move,
)
from quietarm.studies.cli import main

pytestmark = pytest.mark.usefixtures("_plants_of_this_test_are_forgotten")

(MOVE,) = blocks("moves", "python")
(ENERGY,) = blocks("energy", "python")
(MACHINE,) = blocks("machine", "python")
(LEARN,) = blocks("learn", "python")
(CELL,) = blocks("sweeps", "python")
(BEGUN,) = blocks("start", "python")
PROFILE = shown_file("extend", "minimum_jerk.py")
(PLAIN,) = blocks("casadi", "python")
(PLAIN_PRINTS,) = blocks("casadi", "text")
SEARCH_OF_PYMOO, FRONT = blocks("searches", "python")
(FOUR_OBJECTIVES,) = blocks("objectives", "python")
ROBUSTNESS, ROBUST = blocks("robustness", "python")
(PICTURE,) = blocks("pictures", "python")
(COUNTS,) = blocks("plants", "python")
CRANE, ANGLES = blocks("own_plant", "python")
(GANTRY,) = blocks("several_joints", "python")
(ROBOT,) = blocks("robots", "python")
ROBOT_FILES = {
    block.split(maxsplit=2)[1]: block for block in blocks("robots", "text") if block[0] == "#"
}
"""Files that the page of robots shows, by the name in their first line."""
STARTED = "README-0"
"""The block that is started as it stands; all others, and most of Python, cost no process each."""


def started(*words):
    """Return the output of a process that ends well and says at most that it still runs."""
    ran = subprocess.run([sys.executable, *words], capture_output=True, text=True, timeout=600)
    said = [line for line in ran.stderr.splitlines() if not line.startswith("still looking for ")]
    assert (ran.returncode, said) == (0, [])
    return ran.stdout


@pytest.fixture
def run_python(tmp_path, monkeypatch, capfd):
    """Run an example in this process, in a folder of its own; what it prints."""
    monkeypatch.chdir(tmp_path)

    def run(code, place="example.py"):
        Path(place).write_text(code)
        runpy.run_path(place, run_name="__main__")
        Path(place).unlink()
        return capfd.readouterr().out

    return run


@pytest.mark.slow
def test_the_first_commands_print_what_the_readme_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copytree(ROOT / "docs" / "recordings", Path("docs") / "recordings")
    command = str(Path(sys.executable).parent / "quietarm")
    lines = [shlex.split(line)[1:] for line in COMMAND_BLOCKS[STARTED]]
    printed = " ".join(" ".join(started(command, *line) for line in lines).split())
    shown = [row for row in blocks("README", "text")[1].splitlines() if row != "..."]
    assert len(shown) == 2
    for row in shown:
        # last digits are others elsewhere
        words = row.partition(", within")[0].partition(": within 0.1 mm")[0].split()
        assert " ".join(words) in printed
    assert Path("move.csv").is_file()


def test_the_example_in_python_plans_saves_and_exports(run_python):
    printed, plan = run_python(MOVE), Plan.load("plan.json")
    assert printed == f"{plan.energy} {plan.residual} {plan.coefficients}\n"
    assert plan.residual < 1e-8  # docs/accuracy.md
    assert plan.motion.peak_torque <= 0.2 * 1.001  # docs/accuracy.md
    assert len(Path("move.csv").read_text().splitlines()) == 1 + 401  # 0.8 s at 500 Hz


@pytest.mark.slow
def test_the_example_with_an_energy_of_ones_own_plans():
    label, energy = started("-W", "error", "-c", ENERGY).split()
    assert label == "recovering:0.6+copper:0.12"
    assert 0.349 < float(energy) < 0.349 + 0.0212  # of copper loss alone, with positive power


@pytest.mark.slow
def test_the_examples_of_fronts_find_and_save_them(run_python):
    printed, front = run_python(SEARCH_OF_PYMOO), Front.load("sms-emoa.json")
    assert printed == f"SMSEMOA {len(front.points)} {front.cheapest(10e-3).energy}\n"
    printed, front = run_python(FRONT), Front.load("front.json")
    chosen = [front.smallest_residual(), front.knee(), front.cheapest(5e-3)]
    assert printed == "".join(f"{point.residual} {point.energy}\n" for point in chosen)
    assert len(front.points) == 20


@pytest.mark.slow
def test_the_example_of_four_objectives_has_the_peaks_beside_them(run_python):
    printed = run_python(FOUR_OBJECTIVES)
    least = [float(number) for number in printed[: printed.index("]")].strip("[ ").split()]
    assert 0 <= least[0] < 1e-6  # at rest
    assert min(least[1:]) > 0
    assert "{'torque': " in printed
    assert printed.strip().endswith("]")


@pytest.mark.slow
def test_the_examples_of_robustness_say_what_is_left(run_python):
    low, high, residual = map(float, re.sub(r"[(),]", "", run_python(ROBUSTNESS)).split())
    assert -0.1 < low < 0 < high < 0.1  # docs/physics.md, 'Robustness': a few per cent
    # 'The published optima are not optimal': the frequency 10 % wrong leaves some 20 mm.
    assert 10e-3 < residual < 200e-3
    energy, residual, _ = run_python(ROBUST).split(maxsplit=2)
    # 5 % of how far the plain cycloid bends the tip on its way
    cycloid = evaluate_coefficients(PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8), [])
    assert 0 < float(residual) <= 0.05 * cycloid.motion.peak_deflection * (1 + 1e-6)
    assert 0.02 < float(energy) < 0.03


@pytest.mark.slow
def test_the_example_of_a_picture_draws_it(run_python):
    assert run_python(PICTURE) == ""
    assert Path("mine.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_the_example_counts_the_modes_that_a_move_needs(run_python):
    left = [float(each) for each in re.findall(r"with \d: ([0-9.]+) mm", run_python(COUNTS))]
    # the page: one mode leaves 1.24 mm, two leave 0.0003 mm
    assert left[0] == pytest.approx(1.24, abs=0.01)
    assert max(left[1:]) < 1e-3


@pytest.mark.slow
def test_the_examples_whose_amplitude_is_an_angle_say_it_in_the_unit_of_the_tip(run_python):
    twist, way = re.findall(r"up to ([0-9.]+) (rad|m)", run_python(ANGLES))
    assert [unit for _, unit in (twist, way)] == ["rad", "m"]
    # At least half of the static twist at the peak acceleration of the plain cycloid, 2 pi angle /
    # duration^2, by load over stiffness; the plan swings, by no more than a few times that.
    static = 2.4e-3 / 6.0 * 2 * math.pi * (math.pi / 2) / 0.2**2
    assert 0.5 * static < float(twist[0]) < 3 * static
    static = 4.0 / 9.81 * 2 * math.pi * 3.0 / 6.0**2  # rope over gravity
    assert 0.5 * static < float(way[0]) < 3 * static


def test_first_lines_and_a_profile_of_your_own_plan_a_move(run_python):
    assert run_python(BEGUN) == "0.0265 J, acts after 0.742 s\n"  # the page's command
    energy = re.fullmatch(r"(\S+) J, residual 0.000 mm\n", run_python(PROFILE))[1]
    assert 0.0165 < float(energy) < 0.0912  # floor and plain cycloid: docs/energy.md


@pytest.mark.slow
def test_plain_casadi_finds_what_the_page_says(run_python):
    assert run_python(PLAIN) == PLAIN_PRINTS
    task = PointToPoint(SingleLinkManipulator(), math.pi / 2, 1.0, torque_limit=0.3)
    plan = plan_move(task, CycloidPolynomial(6), bound=0.2, residual_limit=1e-3)
    assert plan.energy == pytest.approx(float(PLAIN_PRINTS.split()[1]), rel=5e-4)
    assert f"{plan.energy:.4f} J" in PAGES["casadi"]  # a little more, as the limits hold everywhere


def test_a_plant_of_two_joints_takes_what_the_page_says(run_python):
    (joules,) = re.findall(r"^It takes ([\d.]+) J\.$", PAGES["several_joints"], re.MULTILINE)
    assert run_python(GANTRY) == f"{joules} J\n"


@pytest.fixture
def robot_files(tmp_path):
    """The files that the page of robots shows, beside the URDF."""
    for name, text in ROBOT_FILES.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "ur5_robot.urdf").write_bytes(urdf_of("ur5_robot.urdf").read_bytes())


@pytest.mark.slow
@pytest.mark.usefixtures("robot_files")
def test_the_example_of_a_robot_plans_through_its_waypoints(run_python):
    energy, residual, sag = re.fullmatch(
        r"(\S+) J, (\S+) mm, \[(.*)\] m\n", run_python(ROBOT)
    ).groups()
    assert 20 < float(energy) < 40
    assert float(residual) == 0.0
    assert 5e-3 < math.hypot(*map(float, sag.split())) < 30e-3


def test_no_example_is_left_untested():
    elsewhere = ("problems", "own_methods")  # tests/metaheuristics/problems
    others = [page for page in PAGES if page not in elsewhere]
    assert sum(len(blocks(page, "python")) for page in others) == 30
    languages = re.findall(r"^```(\w+)$", "".join(PAGES.values()), re.MULTILINE)
    assert set(languages) == {"console", "python", "sh", "text", "xml"}


SEARCH = ["--population", "20", "--generations", "5"]
SHORTER = {  # what is as long as the paper's, or thorough, is for the tests of its own
    "front": ["--points", "5"],
    "search": SEARCH,
    "bench": ["--runs", "1", "--evaluations", "200"],
}


def shortened(words):
    """The words of a command, with fewer generations or points."""
    words = [word.replace(":90deg:", ":50deg:").replace(":1.4s:", ":1s:") for word in words]
    of_file = {"--polish", "--interpolate"} & {*words}
    fewer = [] if of_file else SHORTER.get(words[0], [])
    if words[-1].endswith(".gif"):
        fewer = ["--rate", "4", "--width", "240"]
    if "free" in words:
        fewer = ["--starts", "1"]
    if "--terms" not in words and words[0] == "sweep":
        fewer = [*fewer, "--terms", "6"]  # what 18 terms give: tests/ocp/planning/test_terms.py
    fewer = [*fewer, *(["--runs", "2"] if "--workers" in words else [])]
    for option in fewer[::2]:
        if option in words:  # an option is given once
            at = words.index(option)
            words = [*words[:at], *words[at + 2 :]]
    return [*words, "--quiet", *fewer]


@pytest.fixture
def follow(tmp_path, capfd, monkeypatch, quick_pictures):
    """Run the commands of a block in this process, on coarse grids; what each of them prints."""
    monkeypatch.chdir(tmp_path)
    asked = set()

    def run(block):
        printed = []
        asked.update(path.name for path in tmp_path.iterdir())
        for line in COMMAND_BLOCKS[block]:
            _, *words = shlex.split(line)
            if "--plant-file" in words:  # the page says that its plant's lines are in it
                asked.add("crane.py")
                Path("crane.py").write_text(CRANE)
            with pytest.raises(SystemExit) as ended:
                main(shortened(words))
            out, err = capfd.readouterr()
            assert (ended.value.code, out != "", err) == (0, True, "")
            options = ("--output", "--csv", "--figure", "--machine")
            asked.update(words[i + 1] for i, word in enumerate(words) if word in options)
            asked.update(name.replace(".c", ".h") for name in [*asked] if name.endswith(".c"))
            assert {path.name for path in tmp_path.iterdir()} == asked
            printed.append(out)
        return printed

    with coarse_floors():
        yield run


ELSEWHERE = (STARTED, "explore", "machine", "learn", "gallery", "start")
"""The page of explore stays until Ctrl-C: tests/views/page opens it. The gallery's commands
make its pictures: test_pictures.py."""
CALLED = [name for name in COMMAND_BLOCKS if not name.startswith(ELSEWHERE)]


@pytest.mark.slow
@pytest.mark.parametrize("block", CALLED)
def test_the_commands_run_one_after_another(follow, block, request):
    if block.startswith("robots"):
        request.getfixturevalue("robot_files")
    follow(block)
    if block == "sweeps-0":
        energy = float(request.getfixturevalue("run_python")(CELL).split()[0])
        assert 0.02 < energy < 0.03  # README: the link's first move takes 0.0237 J


@pytest.mark.parametrize("page", PAGES)
def test_an_excerpt_of_a_report_says_where_something_is_left_out(page):
    excerpts = [text.splitlines() for text in blocks(page, "text") if "\nresidual " in text]
    for lines in excerpts:
        assert lines[0].startswith(("This ", "..."))
        assert lines[-1].startswith(("time ", "wrote ", "..."))
    assert excerpts or page not in ("start", "arrival")


@pytest.mark.slow
def test_the_first_commands_print_what_the_page_shows_with_the_warnings_that_it_expects(follow):
    printed = [" ".join(text.split()) for text in follow("start-0")]
    shown = [text.replace("...\n", "") for text in blocks("start", "text") if "\nenergy " in text]
    assert len(shown) == 2
    for page, now in zip(shown, printed[:2], strict=True):
        for row in page.splitlines():
            # last digits are others elsewhere, and so are differences between integrators
            words = row.partition(", within")[0].split()
            assert " ".join([*words[:2], *(word[:4] for word in words[2:3])]) in now
        for warning in re.findall(r"warning: [^;]*?\d", page):
            assert warning in now
    words = "83.6 mm (warning: beyond 47.5 mm"
    assert words in " ".join("".join(shown).split())
    assert words in " ".join(printed)
    assert "warning" not in printed[1]  # the page: the plan stays below
    (first,) = [text.strip() for text in blocks("start", "text") if text.startswith("may act")]
    assert printed[1].startswith(first)


@pytest.mark.slow
def test_the_machine_of_the_page_is_the_one_that_was_recorded(run_python, follow):
    run_python(MACHINE)
    printed, _, fastest, *_ = [follow(f"machine-{number}")[0] for number in range(5)]
    (shown,) = blocks("machine", "text")
    of_page, now = (
        [[float(x) for x in re.findall(r"\d+\.\d+", line)] for line in text.splitlines()[:6]]
        for text in (shown, printed)
    )
    for before, after in zip(of_page, now, strict=True):
        assert after == pytest.approx(before, rel=2e-3)
    (_, low, high), _, (_, least, most), _ = (line[:3] for line in now[2:])
    assert low < 20.1 / (2 * math.pi) < high
    assert least < 0.01 < most
    duration = float(re.findall(r"duration of the first is ([\d.]+) s", PAGES["machine"])[0])
    printed_duration = float(re.findall(r"0 to 60 deg in ([\d.]+) s", fastest)[0])
    assert printed_duration == pytest.approx(duration, rel=0.01)


@pytest.mark.slow
def test_the_moves_of_the_page_are_learned_from(run_python, follow):
    of_page, said, _ = blocks("learn", "text")
    left = [float(mm) for mm in re.findall(r"left ([\d.]+) mm", run_python(LEARN))]
    assert left[0] == pytest.approx(float(re.findall(r"left ([\d.]+)", of_page)[0]), rel=0.01)
    assert max(left[2:]) < left[0] / 500  # of the page: 0.004 of 7.45 mm
    printed = " ".join(follow("learn-0")[0].split())
    answer = " ".join(said.partition(" and ")[0].split())  # of which the frequency has all
    assert printed.startswith(answer)


@pytest.mark.slow
def test_the_examples_of_simulators_find_and_save_fronts(run_python):
    pytest.importorskip("mujoco")
    arm, machine, energy = blocks("simulators", "python")
    assert len(arm.splitlines()) <= 30  # the page's heading
    (model,) = blocks("simulators", "xml")
    Path("arm.xml").write_text(model)
    printed = run_python(arm.replace("evaluations=200", "evaluations=40"))
    front = Front.load("arm.json")
    residual, cheapest = front.smallest_residual().residual, front.cheapest().energy
    assert printed == f"{1e3 * residual:.1f} mm, {cheapest:.4f} J\n"
    assert front.infeasible > 0  # the arm came too near to the post
    printed = run_python(machine)
    assert printed.startswith("30 candidates, ")
    assert run_python(machine) == printed  # from its state, without a new measurement
    assert run_python(energy).startswith("sway of single-link: ")
