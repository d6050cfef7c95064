"""`quietarm floor`: what it says, what it writes, what it refuses."""

import math
import re

import matplotlib.pyplot as plt
import pytest
from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import Floor, FloorSettings, PointToPoint, energy_floor
from quietarm.studies.figures.motion import floor_figure
from quietarm.studies.reports.floor import plan_beside

MOVE = "arm-on-flexible-link --target pi/2 --duration 0.8"


@pytest.fixture(scope="module")
def floor():
    """The arm's floor with no limit: it starts and stops with a jolt."""
    return energy_floor(
        PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8), starts=1, tolerance=0.05
    )


@pytest.fixture
def call(call, monkeypatch):
    """Run a line in this process, with lines wide enough for every figure."""
    monkeypatch.setenv("COLUMNS", "200")
    return call


def test_it_prints_the_floor_and_writes_it(call, tmp_path):
    code, out, err = call(
        f"floor {MOVE} --acceleration-limit 100 --starts 2 --seed 3 --tolerance 0.2 "
        f"--output {tmp_path / 'f.json'} --figure {tmp_path / 'f.png'}"
    )
    assert (code, err) == (0, "")
    floor = Floor.load(tmp_path / "f.json")
    assert floor.task.limits == {"acceleration": 100.0}
    assert floor.provenance.settings == FloorSettings(smooth=False, starts=2, seed=3, tolerance=0.2)
    shown = dict(re.findall(r"^(\S+(?: \S+)*)  +(\S.*?) *$", out, re.MULTILINE))
    assert float(shown["least energy"].split()[0]) == pytest.approx(floor.energy, rel=1e-5)
    assert shown["limits"] == "acceleration 100 rad/s^2"
    assert shown["starts"].startswith(f"{floor.agreeing()} of 2")
    left = re.search(r"about (\S+) J \((\S+)%\)", shown["left"])
    assert float(left[1]) == pytest.approx(floor.left, rel=0.06)
    assert float(left[2]) == pytest.approx(100 * floor.left / floor.energy, abs=0.006)
    for level in floor.levels:
        assert f"{level.steps}: {level.energy:.6g} J" in shown["intervals"]
    plan = plan_beside(floor)
    assert shown["plan, 6 terms"].startswith(f"{plan.energy:.6g} J")
    assert f"{plan.energy / floor.energy:.3g} times the floor" in shown["plan, 6 terms"]
    assert (tmp_path / "f.png").read_bytes().startswith(b"\x89PNG")


def test_limits_without_any_plan_still_have_a_floor(call):
    # Six terms need 34 rad/s^2 on this move; a free motion does it with 27.
    code, out, err = call(
        f"floor {MOVE} --acceleration-limit 30 --starts 1 --tolerance 0.5 --quiet"
    )
    assert (code, err) == (0, "")
    assert "none within these limits" in out


def test_the_picture_holds_the_floor_over_the_plan(floor):
    plan = plan_beside(floor)
    figure = floor_figure(floor, plan)
    angle, speed, acceleration, tip, torque = figure.axes[:5]
    for axis, expected in (
        (angle, floor.trajectory.joint[:, 0]),
        (speed, floor.trajectory.joint[:, 1]),
        (acceleration, floor.trajectory.joint[:, 2]),
        (tip, floor.trajectory.tips[:, 0] * 1e3),
        (torque, floor.trajectory.torque),
    ):
        drawn = next(line for line in axis.get_lines() if "floor" in str(line.get_label()))
        assert drawn.get_ydata() == pytest.approx(expected)
    labels = [text.get_text() for text in figure.axes[5].get_legend().get_texts()]
    assert labels == [
        f"plan of 6 terms, {plan.energy:.4g} J",
        f"floor, {floor.energy:.4g} J",
    ]
    # The jolts, hundreds of N m, leave the panel; all of the plan's torque stays in it.
    assert floor.motion.peak_torque > 100
    assert plan.motion.peak_torque < torque.get_ylim()[1] < 5 * plan.motion.peak_torque
    assert "jolts left out" in torque.get_title(loc="left")
    plt.close("all")
