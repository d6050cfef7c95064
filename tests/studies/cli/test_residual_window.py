"""Every answer says within what time after arrival its residuals are measured."""

import math
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest
import xarray as xr
from saved_files import edit

import quietarm as qa
from quietarm.models import LinearAxis, SingleLinkManipulator
from quietarm.ocp import Front, Plan, PointToPoint, evaluate_coefficients
from quietarm.studies.answers.open_by_hand import open_file
from quietarm.studies.compare import compare_plans
from quietarm.studies.sweep.move_grid import Axis, MoveGrid
from quietarm.views.explore.by_hand import MoveByHand, open_plant

CRANE = "linear-axis --set omega1=0.6283 --set zeta1=0.002 --target 8 --duration 16 --quiet"
WITHIN = "within 20 s"  # two periods of 0.6283 rad/s
EXACTLY = 4 * math.pi / 0.6283


@pytest.mark.slow_after(1)
@pytest.mark.parametrize(
    "line",
    [
        f"plan {CRANE} --terms 4",
        f"plan {CRANE} --terms 4 --error frequency=10%",
        f"plan {CRANE} --profile zv",
        f"plan {CRANE} --profile free",
        f"evaluate {CRANE} --coefficients=0",
        f"front {CRANE} --terms 3 --points 3 --starts 1",
        f"front {CRANE} --terms 3 --points 3 --starts 1 --error frequency=10% --bound 5",
        f"search {CRANE} --terms 2 --bound 0.5 --generations 2 --population 8",
        f"sweep {CRANE.replace('16', '16s,18s')} --terms 3 --output moves.zarr",
    ],
)
def test_commands_say_it(done, folder, line):
    assert WITHIN in " ".join(done(line).split())


def test_a_named_problem_has_the_papers(done):
    assert "residuals within 1 s" in " ".join(done("list single-link-30deg-0.8s").split())
    assert "residuals within 1 s" in " ".join(done("list problems").split())


def test_one_that_was_given_is_said_and_stored(done, folder):
    line = f"evaluate {CRANE} --coefficients=0 --residual-window 3s --output e.json"
    assert "within 3 s" in done(line)
    assert Plan.load("e.json").task.residual_window == 3.0


def test_files_have_it_as_a_number(done, folder):
    front = f"front {CRANE} --terms 3 --points 3 --starts 1 --output f.json --output f.csv"
    done(f"{front} --output f.svg")
    assert Front.load("f.json").task.residual_window == pytest.approx(EXACTLY, rel=1e-12)
    table = pd.read_csv("f.csv")
    assert list(table.residual_window_s) == pytest.approx([EXACTLY] * len(table), rel=1e-12)
    # a table that quietarm wrote has no column of no use
    again = done(f"evaluate {CRANE} --coefficients f.csv")
    assert WITHIN in again
    assert "ignored" not in again


def test_a_plan_is_exported_with_it(done, folder):
    done(f"evaluate {CRANE} --coefficients=0 --output e.json")
    done("export e.json --output move.c --quiet")
    residual = 1e3 * Plan.load("e.json").residual
    assert f"residual {residual:.3g} mm {WITHIN}" in Path("move.h").read_text()


def test_tables_of_a_notebook_have_it():
    task = PointToPoint(LinearAxis(omega1=0.6283), 8.0, 16.0)
    plan = evaluate_coefficients(task, [])
    front = Front.from_coefficients(task, [[0.0], [0.1]], method="mine")
    for answer in (plan, front):
        assert f"{WITHIN}" in answer._repr_html_()


def test_plans_of_before_are_compared_with_one_of_today_within_the_longest(done, folder):
    done(f"evaluate {CRANE} --coefficients=0.05,-0.1 --output today.json")
    done(f"evaluate {CRANE} --coefficients=0.05,-0.1 --residual-window 1 --output before.json")
    today, before = Plan.load("today.json"), Plan.load("before.json")
    assert before.residual < today.residual
    out = done("compare before.json today.json --output compared")
    assert WITHIN in " ".join(out.split())
    table = pd.read_csv("compared/motions.csv")
    assert list(table["residual [mm]"]) == pytest.approx([1e3 * today.residual] * 2, rel=1e-9)
    assert list(table["residual window [s]"]) == pytest.approx([EXACTLY] * 2, rel=1e-12)
    # what differs but for the window is refused as ever
    edit("before.json", "task/duration", 17.0)
    with pytest.raises(ValueError, match="of another move than today: its duration is 17 s"):
        compare_plans({"today": today, "before": Plan.load("before.json")})


@pytest.mark.slow
def test_fronts_of_two_windows_are_told_apart_with_what_to_do(call, done, folder):
    for name, window in (("before", "--residual-window 1"), ("today", "")):
        done(f"front {CRANE} --terms 2 --points 3 --starts 1 --output {name}.json {window}")
    out = " ".join(done("compare before.json today.json --no-free-motion").split())
    assert f"Residuals within 1 s and {WITHIN} after arrival are compared apart" in out
    assert "as --residual-window" in out
    said = call("compare before.json --reference today.json --no-free-motion")[2]
    assert "its residual window is 20.00058987 s, not 1 s" in said
    assert "find it again with --residual-window 1s" in said


def test_a_grid_has_one_window_the_longest_of_its_cells():
    task = PointToPoint(LinearAxis(omega1=3.0), 1.0, 2.0)
    slowness = Axis("omega1", (0.6283, 3.0, 30.0), "rad/s")
    grid = MoveGrid(task, (slowness, Axis("duration", (2.0, 3.0), "s")))
    tasks = grid.tasks((slice(None), slice(None)))
    assert {one.residual_window for one in tasks} == {grid.task.residual_window}
    assert grid.task.residual_window == pytest.approx(EXACTLY, rel=1e-12)
    # of the arm it depends on the target: eq (13), with the numbers of eq (15)
    arm = PointToPoint(qa.ArmOnFlexibleLink(), 1.0, 1.0)
    targets = MoveGrid(arm, (Axis("target", (0.5, 1.0, 2.0), "rad"),))
    slowest = 7.320 / math.sqrt(1 - 1.055e-1 * math.cos(2.0))
    assert targets.task.residual_window == pytest.approx(4 * math.pi / slowest, rel=1e-12)
    # one that was given stays, and a single move has its own
    given = MoveGrid(replace(task, residual_window=2.0), (slowness,))
    assert {one.residual_window for one in given.tasks((slice(None),))} == {2.0}
    assert replace(MoveGrid(task, ()).task, plant=LinearAxis()).residual_window == 1.0


@pytest.mark.slow
def test_a_sweep_has_it_in_its_dataset_and_one_of_before_goes_on_with_its_own(call, done, folder):
    line = "sweep linear-axis --set omega1=0.6283,3.0 --target 1 --duration 20 --terms 2 --quiet"
    done(f"{line} --residual-window 1 --output moves.zarr")
    code, _, said = call(f"{line} --output moves.zarr")
    assert code == 2
    assert "it differs in residual_window (1 s there); give the line of that sweep" in said
    out = done(f"{line} --output today.zarr")
    assert f"at the tip {WITHIN}" in out
    dataset = xr.open_zarr("today.zarr", consolidated=False)
    assert dataset.residual.attrs["residual_window_s"] == pytest.approx(EXACTLY, rel=1e-12)


def test_the_page_measures_another_plant_within_its_own_window(folder):
    link = SingleLinkManipulator()
    crane = SingleLinkManipulator(omega=0.6283)
    begun = open_plant(link)
    assert begun.choose_plant(crane).task.residual_window == pytest.approx(EXACTLY, rel=1e-12)
    begun.motion.save("plan.json")
    loaded = open_file(Path("plan.json"))
    assert loaded.choose_plant(crane).task == begun.choose_plant(crane).task
    given = replace(begun.task, residual_window=3.0)
    explored = MoveByHand.of_plan(evaluate_coefficients(given, [0.0] * 6))
    assert explored.choose_plant(crane).task.residual_window == 3.0
