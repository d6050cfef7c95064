"""The recipes of docs/extend.md, each made up and taken through every command that knows it.

What the page shows is what runs: its blocks of Python are the files, its lines the commands.
"""

import json
import re
import runpy
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import moocore
import numpy as np
import pandas as pd
import pytest
from pages import PAGES, ROOT

import quietarm as qa
from quietarm.metaheuristics import PRESETS, Job, Reference, problem_of, run_jobs
from quietarm.ocp import Front, Plan
from quietarm.studies.compare import compare_fronts
from quietarm.studies.sweep.library import MoveLibrary
from quietarm.views.pictures import draw_quantity, motion_figure

pytestmark = pytest.mark.usefixtures("what_is_made_up_is_forgotten", "quick_pictures")

ENTRIES = re.split(r"^## ", PAGES["extend"], flags=re.MULTILINE)[1:]
RECIPES = {entry.partition("\n")[0]: entry for entry in ENTRIES}
WITHOUT_A_TEST = {"A solver's option"}
"""A field of quietarm's own solver: tests/studies/cli/test_solver_options.py makes one up."""
IN_A_CHECKOUT = "In a checkout"
"""The section on entries of quietarm's own tables, which have recipes above it."""
LINK = qa.PointToPoint(qa.SingleLinkManipulator(), target=qa.deg(30), duration=0.8)
NAMED = "single-link-30deg-0.8s-2-terms"


def file_of(recipe):
    """The name and the content of the file that a recipe shows."""
    (code,) = re.findall(r"^```python\n(.*?)^```$", RECIPES[recipe], re.DOTALL | re.MULTILINE)
    return code.splitlines()[0].removeprefix("# "), code


def lines_of(recipe):
    """The commands that a recipe shows, without the program."""
    (block,) = re.findall(r"^```text\n(.*?)^```$", RECIPES[recipe], re.DOTALL | re.MULTILINE)
    return [line.partition(" ")[2] for line in block.splitlines()]


@pytest.fixture
def made_up(folder):
    """Write the file of a recipe into a folder of the test's own; its path."""

    def write(recipe, more=""):
        name, code = file_of(recipe)
        Path(name).write_text(code + more)
        return Path(name)

    return write


@pytest.fixture
def follow(made_up, done):
    """Type every command of a recipe, or some; what each of them prints."""

    def type_all(recipe, only=""):
        made_up(recipe)
        lines = [line for line in lines_of(recipe) if not only or line.split()[0] in only.split()]
        return [done(f"{line} --quiet") for line in lines]

    return type_all


def test_every_recipe_has_a_test_and_its_row_in_the_table():
    tested = re.findall(r'follow\("([^"]*)"\)', Path(__file__).read_text())
    recipes = [name for name in RECIPES if name != IN_A_CHECKOUT]
    assert {*tested} | WITHOUT_A_TEST == {*recipes}
    table = PAGES["extend"].partition("## ")[0]
    anchors = re.findall(r"^\| \[.*?\]\(#(.*?)\)", table, re.MULTILINE)
    slugs = [re.sub(r"[^a-z ]", "", name.lower()).replace(" ", "-") for name in recipes]
    assert anchors == slugs


def test_a_plant_in_its_first_commands(follow, refused):
    listed, *_ = follow("A plant", only="list evaluate")
    assert "from the trolley to the load" in listed
    zv = Plan.load("zv.json")
    assert zv.task.plant.name == "pendulum"
    assert zv.residual < 1e-8  # the shaper is exact for a linear oscillator
    told = refused("plan pendulm --plant-file pendulum.py --target 1 --duration 2")
    assert "did you mean 'pendulum'" in told
    code = file_of("A plant")[1]
    Path("other.py").write_text(code.replace("self.rope * W[0]", "self.rope * W[1]"))
    told = refused("evaluate --plant-file other.py --target 1 --duration 2 --profile zv")
    assert "pendulum" in told


@pytest.mark.slow
def test_a_plant(follow):
    follow("A plant")
    plan, front, search = (
        Plan.load("plan.json"),
        Front.load("front.json"),
        Front.load("search.json"),
    )
    assert {answer.task.plant.name for answer in (plan, front, search)} == {"pendulum"}
    assert plan.residual < 1e-8
    assert "pendulum" in Path("compared", "report.md").read_text()
    assert pd.read_csv("bench/runs.csv").problem.tolist() == ["front"]
    assert MoveLibrary(Path("moves.zarr")).grid.task.plant == plan.task.plant
    assert "move_at" in Path("move.c").read_text()


@pytest.mark.slow
def test_a_profile(follow, refused):
    follow("A profile")
    answers = [Plan.load("plan.json"), Front.load("front.json"), Front.load("search.json")]
    answers.append(MoveLibrary(Path("moves.zarr")))
    assert {answer.profile.label for answer in answers} == {"minimum-jerk of 4 terms"}
    least = Plan.load("least.json")
    # the motion of least jerk: 30 s^2 (1 - s)^2 at s = 1/2 is 15/8 of the mean speed
    assert least.motion.peak_speed == pytest.approx(15 / 8 * qa.deg(60) / 3, rel=1e-4)
    move = "single-link --plant-file minimum_jerk.py --target 1 --duration 2"
    assert "did you mean 'minimum-jerk'" in refused(f"plan {move} --profile minimum-jrk")
    wrong = file_of("A profile")[1].replace("15 * x", "14 * x")
    Path("minimum_jerk.py").write_text(wrong)
    assert "minimum-jerk" in refused(f"plan {move} --profile minimum-jerk")


@pytest.mark.slow
def test_an_energy_in_its_first_commands(follow, refused):
    follow("An energy", only="plan evaluate export")
    plan = Plan.load("plan.json")
    assert plan.task.energy.label == Plan.load("zv.json").task.energy.label == "friction:0.01"
    plain = qa.evaluate_coefficients(LINK, plan.coefficients, profile=plan.profile)
    # friction takes the integral of the squared speed, times the coefficient
    time = np.linspace(0, 0.8, 4001)
    friction = 0.01 * np.trapezoid(plan.sampled(time).joint[:, 1] ** 2, time)
    assert plan.energy - plain.energy == pytest.approx(friction, rel=1e-5)
    move = "single-link --plant-file friction.py --target 30deg --duration 0.8"
    assert "give friction:coefficient" in refused(f"plan {move} --energy friction")
    assert "did you mean 'friction'" in refused(f"plan {move} --energy frction:1")


@pytest.mark.slow
def test_an_energy(follow):
    follow("An energy")
    energy = Plan.load("plan.json").task.energy
    assert Front.load("front.json").task.energy.label == "0.5*positive+friction:0.01"
    assert Front.load("search.json").task.energy == energy
    assert MoveLibrary(Path("moves.zarr")).grid.task.energy == energy
    assert "friction" in Path("compared", "report.md").read_text()


def test_a_search(follow, refused):
    settings, _, table = follow("A search")
    assert re.search(r"shrink +0\.97", settings)
    front = Front.load("search.json")
    assert (front.record.method, front.record.evaluations) == ("shrinking-steps", 200)
    assert front.record.settings["shrink"] == 0.9
    assert "shrinking-steps" in table
    runs = pd.read_csv("bench/runs.csv")
    assert sorted(runs.method) == ["NSGA-II"] * 2 + ["shrinking-steps"] * 2
    kind = PRESETS["shrinking-steps"].own
    again = qa.search(
        LINK, qa.CycloidPolynomial(2), algorithm=kind(shrink=0.9), bound=0.2, evaluations=200
    )
    assert again.points == front.points
    move = "single-link --plant-file shrinking_steps.py --target 30deg --duration 0.8 --bound 0.2"
    wrong = f"search {move} --method shrinking-steps --setting"
    assert "shrink is 'fast'; give a number" in refused(f"{wrong} shrink=fast")
    assert "has no setting 'shrnk'; did you mean 'shrink'?" in refused(f"{wrong} shrnk=1")
    assert "did you mean 'shrinking-steps'" in refused(f"search {move} --method shrinking")
    # the class has changed since the folder's runs
    code = file_of("A search")[1]
    Path("shrinking_steps.py").write_text(code.replace("10, len(best)", "20, len(best)"))
    assert "as it was before; give another folder" in refused(lines_of("A search")[2] + " --quiet")
    Path("shrinking_steps.py").write_text(code.replace("steps = width", "steps = widht"))
    told = refused(f"search {move} --method shrinking-steps --generations 50")
    line = (
        code.splitlines().index(
            "            steps = width * function.upper * rng.normal(size=(10, len(best)))"
        )
        + 1
    )
    assert f"search shrinking-steps (shrinking_steps.py, line {line}) fails: NameError" in told


def test_an_algorithm_of_pymoo_is_a_search_as_well(folder, done):
    Path("sms.py").write_text(
        "import quietarm as qa\n\n\n"
        "class Selected(qa.SearchMethod):\n"
        "    name = 'selected'\n"
        "    population = 20\n\n"
        "    def algorithm(self, population):\n"
        "        from pymoo.algorithms.moo.nsga2 import NSGA2\n"
        "        return NSGA2(population)\n"
    )
    move = "single-link --plant-file sms.py --target 30deg --duration 0.8 --terms 2 --bound 0.2"
    done(f"search {move} --method selected --generations 3 --quiet --output front.json")
    front = Front.load("front.json")
    assert (front.record.method, front.record.evaluations) == ("selected", 3 * 20)
    assert front.record.settings["population"] == 20


@pytest.mark.slow
def test_workers_know_the_search_of_a_file(made_up, done):
    path = made_up("A search")
    method = "--methods shrinking-steps --runs 2 --evaluations 100 --workers 2 --quiet"
    done(f"bench {NAMED} --plant-file {path} {method} --output bench")
    assert len(pd.read_csv("bench/runs.csv")) == 2


@pytest.mark.slow
def test_an_indicator(follow, refused):
    follow("An indicator")
    runs = pd.read_csv("bench/runs.csv")
    assert {"hausdorff", "hausdorff_between"} <= {*runs}
    jobs = [Job(NAMED, "nsga2", seed, 200) for seed in range(2)]
    fronts = run_jobs(jobs, "bench")  # the runs that are there
    scale = problem_of(NAMED).reference()
    expected = [
        moocore.avg_hausdorff_dist(
            moocore.filter_dominated(scale.scaled(front.objective_values)), ref=scale.stations
        )
        for front in fronts.values()
    ]
    of_method = runs[runs.method == "NSGA-II"].sort_values("seed")
    assert of_method.hausdorff.tolist() == pytest.approx(expected)
    for report in ("bench/report.md", "compared/report.md"):
        assert "averaged Hausdorff: larger mean distance of two fronts" in Path(report).read_text()
    comparison = compare_fronts([*fronts.values()])
    run = comparison.groups[0].runs[0]
    assert "hausdorff" in run.scores
    assert Reference(scale.front).scores(scale.front.objective_values)["hausdorff"] < 1e-12
    code = file_of("An indicator")[1]
    Path("hausdorff.py").write_text(code.replace("scale.stations", "scale.station"))
    told = refused(f"{lines_of('An indicator')[1]} --quiet")
    assert "indicator hausdorff (hausdorff.py, line 14) fails: AttributeError" in told


def test_an_indicator_of_the_name_of_a_column_is_refused(folder, refused):
    Path("hausdorff.py").write_text(file_of("An indicator")[1].replace('"hausdorff"', '"points"'))
    run_jobs([Job(NAMED, "nsga2", 0, 200)], "bench")
    line = f"{lines_of('An indicator')[1]} --quiet"
    assert "points is a column already; give the indicator another name" in refused(line)


def positions(file):
    """The positions [deg] of a file of G-code, its letters and feeds."""
    blocks = re.findall(r"^G93 G1 ([A-Z])(\S+) F(\S+)$", Path(file).read_text(), re.MULTILINE)
    return [float(place) for _, place, _ in blocks], {(axis, feed) for axis, _, feed in blocks}


@pytest.mark.slow
def test_an_export_format(follow, refused, done):
    *_, printed = follow("An export format")
    plan = Plan.load("plan.json")
    times = np.arange(1, 81) / 100
    expected = np.degrees(plan.sampled(times).joint[:, 0])
    assert positions("move.nc")[0] == pytest.approx(expected, abs=1e-4)
    assert Path("move.nc").read_text() == printed
    places, words = positions("slow.nc")
    assert (places, words) == ([*positions("move.nc")[0][9::10]], {("B", "600")})
    for file in ("fastest.gcode", "zv.nc"):
        assert positions(file)[0][-1] == pytest.approx(30)
    (path,) = qa.views.export_plan(plan, "python.nc", rate=10, axis="B")
    assert path.read_text() == Path("slow.nc").read_text()
    own = "--plant-file gcode.py"
    assert "--axis TEXT" in done(
        f"export --help {own}".replace(f"export --help {own}", f"export {own} --help")
    )
    move = f"single-link {own} --target 30deg --duration 0.8"
    assert ".st, .nc" in refused(f"plan {move} --output move.ngc")
    assert ".nc, .gcode" in refused(f"export plan.json {own} --output move.ngc")
    assert ".nc" not in refused(f"front {move} --output front.nc").partition("; give")[2]
    assert "--axis is for g-code, not for csv" in refused(
        f"export plan.json {own} --output move.csv --axis B"
    )
    assert "rate is 2000 Hz; give a number from 1 up to 1000 Hz" in refused(
        f"export plan.json {own} --output move.nc --rate 2000"
    )
    code = file_of("An export format")[1]
    Path("gcode.py").write_text(code.replace("plan.sampled", "plan.sample"))
    told = refused(f"export plan.json {own} --output bad.nc")
    line = 1 + next(k for k, text in enumerate(code.splitlines()) if "plan.sampled" in text)
    assert f"format g-code (gcode.py, line {line}) fails: AttributeError" in told
    assert not Path("bad.nc").exists()
    Path("gcode.py").write_text(code.replace('".gcode"', '".csv"'))
    assert "ending .csv of GCode is that of the format csv" in refused(
        f"export plan.json {own} --output bad.nc"
    )


FRONTS = """

class Names(qa.ExportFormat):
    name = "names"
    endings = (".names",)
    meaning = "names of methods"
    takes = ("front", "several")
    beside = (".count",)

    def export(self, answers, path, report, **settings):
        labels = answers if isinstance(answers, dict) else ["answer"]
        return {path: " ".join(labels), path.with_suffix(".count"): str(len(answers))}
"""


@pytest.mark.slow
def test_an_export_format_of_fronts_and_of_several_files(made_up, done, refused, folder):
    path = made_up("An export format", FRONTS)
    move = f"single-link --plant-file {path} --target 30deg --duration 0.8 --terms 2"
    out = done(f"front {move} --points 3 --quiet --output one.json --output one.names")
    assert out.endswith("wrote one.json\nwrote one.names\nwrote one.count\n")
    shutil.copy("one.json", "two.json")
    done(f"export one.json two.json --plant-file {path} --output both.names")
    assert (Path("both.names").read_text(), Path("both.count").read_text()) == ("one two", "2")
    told = refused(f"plan {move} --output plan.names")
    assert "cannot write" in told


@pytest.mark.slow
def test_a_plot(follow, call, monkeypatch):
    drawn = []

    def note(figure, *given, **settings):
        drawn.append([ax.get_title(loc="left") for ax in figure.axes])
        return whole(figure, *given, **settings)

    whole = sys.modules["matplotlib.figure"].Figure.savefig
    monkeypatch.setattr(sys.modules["matplotlib.figure"].Figure, "savefig", note)
    follow("A plot")
    assert len(drawn) == len(lines_of("A plot"))
    assert all(any("heat of the motor [W]" in title for title in titles) for titles in drawn)
    plan = qa.evaluate_coefficients(LINK, [])
    torque = plan.trajectory.sample.torques[0]
    ax = draw_quantity([qa.pictures.Line(plan, "cycloid")], "heat")
    heats = np.concatenate([line.get_ydata() for line in ax.lines[:2]])
    assert heats.max() == pytest.approx((np.abs(torque).max() / 0.12) ** 2)
    panels = motion_figure(plan, quantities=["heat", "power"]).axes
    titles = [ax.get_title(loc="left") for ax in panels]
    assert titles == ["(a) heat of the motor [W]", "(b) power [W]"]
    runpy.run_path("heat.py", run_name="__main__")
    assert Path("heat.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(ValueError, match="did you mean 'heat'"):
        draw_quantity(plan, "heath")
    code = file_of("A plot")[1]
    Path("heat.py").write_text(code.replace("torques[0]", "torques[1]"))
    code, _, told = call(f"{lines_of('A plot')[0]} --quiet")
    assert (code, told.count("\n")) == (2, 1)
    assert "panel heat (heat.py, line 12) fails: IndexError" in told


def tip_acceleration(plan):
    """The tip's acceleration over the move, by differences of its displacements [m/s^2]."""
    time = np.linspace(0, plan.task.duration, 8001)
    tip = plan.sampled(time).tips[:, 0]
    return np.gradient(np.gradient(tip, time), time)[4:-4]


def test_a_limit(follow, refused):
    follow("A limit", only="plan evaluate export")
    plan, fastest = Plan.load("plan.json"), Plan.load("fastest.json")
    assert {str(limit) for limit in plan.task.limits} == {
        "tip acceleration 4 m/s^2",
        "jerk 2000 rad/s^3",
    }
    peak = np.abs(tip_acceleration(plan)).max()
    assert peak == pytest.approx(plan.motion.peak_tip_acceleration, rel=1e-3)
    assert peak < 4 * 1.002
    free = qa.plan_move(LINK, qa.CycloidPolynomial(6))
    assert np.abs(tip_acceleration(free)).max() > 4.2  # so the limit bites
    assert np.abs(tip_acceleration(fastest)).max() == pytest.approx(8, rel=2e-3)
    assert "tip acceleration within 4 m/s^2" in Path("move.h").read_text()
    limits = {"tip_acceleration_limit": 4.0, "jerk_limit": 2000.0}
    again = qa.PointToPoint(LINK.plant, LINK.target, LINK.duration, **limits)
    assert again == plan.task
    move = "single-link --plant-file tip_acceleration.py --target 30deg --duration 0.8"
    assert "give a positive number" in refused(f"plan {move} --tip-acceleration-limit=-1")
    assert "is not a tip acceleration" in refused(f"plan {move} --tip-acceleration-limit 3Nm")
    assert "--tip-acceleration-limit" in refused(f"plan {move} --tip-aceleration-limit 3")


@pytest.mark.slow
def test_a_limit_of_fronts_and_grids(follow):
    follow("A limit")
    (limit,) = Front.load("front.json").task.limits
    assert limit.name == "tip_acceleration"
    found = Front.load("search.json")
    assert found.objectives[-1] == "peak_tip_acceleration"
    best = found.points[0]
    again = qa.evaluate_coefficients(found.task, best.coefficients, profile=found.profile)
    assert found.objective_values[0, 2] == pytest.approx(
        again.motion.peak_tip_acceleration, rel=1e-3
    )
    assert MoveLibrary(Path("moves.zarr")).grid.task.limits == Front.load("front.json").task.limits


def test_a_figure(follow, refused):
    printed = follow("A figure", only="plan evaluate compare")
    plan = Plan.load("plan.json")
    time = np.linspace(0, 0.8, 4001)
    torque = np.ravel(plan.sampled(time).torque)
    expected = np.sqrt(np.trapezoid(torque**2, time) / 0.8)
    assert plan.motion.rms_torque == pytest.approx(expected, rel=1e-4)
    assert f"RMS torque  {expected:.4g} N m" in re.sub(" {2,}", "  ", printed[0])
    assert "RMS torque" in plan._repr_html_()
    assert json.loads(Path("plan.json").read_text())["stated"]["rms_torque"] == pytest.approx(
        expected, rel=1e-4
    )
    assert "RMS torque" in Path("compared/report.md").read_text()


@pytest.mark.slow
def test_a_figure_of_fronts_and_pages(follow):
    follow("A figure")
    assert "rms_torque_Nm" in pd.read_csv("front.csv").columns
    assert "RMS torque" in Path("front.html").read_text()
    assert "RMS torque" in Path("move.h").read_text()


PLACES = {"An export format": "views/formats", "A profile": "ocp/profiles", "A plant": "models"}
PACKAGES = "quietarm", "models", "ocp", "metaheuristics", "machine", "views", "studies"


@pytest.fixture
def checkout(folder):
    """A copy of the packages."""
    copy = folder / "checkout"
    for name in PACKAGES:
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / name, copy / name, symlinks=True, ignore=ignored)
    return copy


def run_in(checkout, line):
    """Type a line of the copy's program in a process of its own."""
    program = "import sys; from quietarm.studies.cli import main; main(sys.argv[1:])"
    return subprocess.run(
        [sys.executable, "-W", "error", "-c", program, *shlex.split(line)],
        capture_output=True, text=True, timeout=600,
        env={"PYTHONPATH": str(checkout), "PATH": ""},
    )  # fmt: skip


@pytest.mark.slow
def test_files_in_the_folders_of_a_checkout(checkout):
    for recipe, place in PLACES.items():
        name, code = file_of(recipe)
        (checkout / place / name).write_text(code)
    move = "plan pendulum --target 1 --duration 2 --profile minimum-jerk --terms 4 --quiet"
    ran = run_in(checkout, f"{move} --output move.json --output move.nc")
    assert (ran.returncode, ran.stderr) == (0, "")
    assert ran.stdout.endswith("wrote move.json\nwrote move.nc\n")


def insert(file, before, text, imports=""):
    """Write an entry into a file of the copy, and what it needs to import."""
    whole = file.read_text()
    assert whole.count(before) == 1
    begin = "from __future__ import annotations\n"
    whole = whole.replace(begin, f"{begin}\n{imports}\n").replace(before, f"{text}{before}")
    file.write_text(whole)


@pytest.mark.slow
def test_entries_of_a_checkout(checkout):
    """A limit, a figure and an option in one file each; what the option does is not made up."""
    section = RECIPES[IN_A_CHECKOUT]
    limit, figure = re.findall(r"^```text\n(.*?)^```$", section, re.DOTALL | re.MULTILINE)
    (option,) = re.findall(r"^boldness.*\n", RECIPES["A solver's option"], re.MULTILINE)
    ocp = checkout / "ocp"
    dimensions = "from quietarm.models.dimensions import"
    insert(ocp / "limits.py", "    )\n}\n_OWN", limit, f"{dimensions} SECOND")
    after = ')\n"""Figures that stand after the peaks'
    places = "from quietarm.ocp.limits import COMPARISON, FRONT"
    insert(ocp / "figures.py", after, figure, f"{dimensions} EFFORT\n{places}")
    imports = (
        "from functools import partial\nfrom quietarm.ocp.checks import positive\n"
        "from quietarm.ocp.solvers.solver import option"
    )
    solve = "    @on_one_thread\n    def solve("
    insert(ocp / "solvers" / "sqp.py", solve, f"    {option}\n", imports)
    move = "single-link --target 30deg --duration 0.8 --terms 4 --quiet"
    asked = "--tip-acceleration-limit 8 --boldness 25%"
    ran = run_in(checkout, f"front {move} --points 3 {asked} --output front.csv --output f.json")
    assert (ran.returncode, ran.stderr) == (0, "")
    assert re.search(r"least energy .*RMS torque \S+ N m", ran.stdout)
    assert "rms_torque_Nm" in pd.read_csv("front.csv")
    record = json.loads(Path("f.json").read_text())["record"]["settings"]
    assert record["solver_boldness"] == 0.25
    ran = run_in(checkout, f"plan {move} {asked}")
    words = " ".join(ran.stdout.split())
    assert "limits tip acceleration 8 m/s^2" in words
    assert "peak tip acceleration 8 m/s^2" in words or "peak tip acceleration 7" in words
    assert "RMS torque" in words
    listed = run_in(checkout, "list epsilon objectives").stdout
    assert "solver_boldness" in listed
    assert "peak-tip-acceleration" in listed
